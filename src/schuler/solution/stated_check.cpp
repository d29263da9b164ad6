#include "schuler/solution/stated_check.h"

#include "schuler/fusion/run_filter.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/loaded_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::solution {
namespace {

using Eigen::Vector3d;

struct Estimate {
    Vector3d value, std;
};

/// The lever arm at the end of a run with it as a state.
std::optional<Estimate> at_the_end(const LoadedDataset& data, fusion::Settings settings) {
    WarningLog heard;  // already
    settings.smooth = settings.covariance_rows = settings.backward = false;
    settings.state_rows = true;
    settings.output_instants.clear();
    settings.output_lever_arm_b.setZero();
    constexpr double rate = 1.0;  // Hz
    settings.output_rate = rate;
    fusion::Result r;
    try {
        r = fusion::run_filter(data.recording, settings, heard);
    } catch (const Error&) {
        return std::nullopt;
    }
    const auto block = std::ranges::find(r.states, std::string_view("lever_arm"), &fusion::LayoutBlock::name);
    if (block == r.states.end() || r.forward.parameters.empty()) return std::nullopt;
    constexpr int navigation = 9;  // states before the first parameter
    Estimate e;
    const fusion::ParameterRow& last = r.forward.parameters.back();
    for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(block->offset - navigation + i);
        e.value(i) = last.value[at];
        e.std(i) = last.std[at];
    }
    return e;
}

std::string numbers(const Vector3d& v) { return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", v.x(), v.y(), v.z()); }

}  // namespace

std::string LeverArmDoubt::text() const {
    return fmt::format("the data contradict gnss.lever_arm_m: {} m is given; the fixes show {} +- {} m; {}", numbers(given_b),
                       numbers(found_b), numbers(std_b),
                       refuted ? "what they show is used, and is a state" : "the given one is used, and is a state");
}

std::optional<LeverArmDoubt> doubt_of_lever_arm(const LoadedDataset& data, const fusion::Result& result) {
    if (!data.given.contains("gnss.lever_arm_m") || data.config.scheme != settings::Scheme::Loose || !result.findings.in_force ||
        !data.config.run.self_check)
        return std::nullopt;
    LeverArmDoubt doubt;
    doubt.settings = *result.findings.in_force;
    if (doubt.settings.estimate_lever_arm) return std::nullopt;
    doubt.settings.estimate_lever_arm = true;
    doubt.given_b = doubt.settings.gnss.lever_arm_b;
    constexpr int walks = 3;
    constexpr double settled = 0.5;  // m, half the initial sigma of the state
    for (int k = 0; k < walks; ++k) {
        fusion::Settings trial = doubt.settings;
        if (k > 0) trial.gnss.lever_arm_b = doubt.found_b;
        const std::optional<Estimate> e = at_the_end(data, trial);
        if (!e || !e->value.allFinite() || e->value.norm() > 100.0) return std::nullopt;
        doubt.found_b = e->value;
        doubt.std_b = e->std.cwiseMax(0.02);
        if ((e->value - trial.gnss.lever_arm_b).cwiseAbs().maxCoeff() < settled) break;
    }
    const Vector3d off = (doubt.found_b - doubt.given_b).cwiseAbs();
    // without tilt the down component is absorbed by the height of the unit; centimetres are within the receiver's errors
    constexpr double least = 0.1, sure = 0.3;  // m
    const auto beyond = [&](double sigmas, double metres) {
        return ((off.array() > sigmas * doubt.std_b.array()) && (off.array() > metres)).any();
    };
    if (!beyond(3.0, least)) return std::nullopt;
    doubt.refuted = beyond(10.0, sure) && !data.config.run.keep_given;
    if (doubt.refuted) doubt.settings.gnss.lever_arm_b = doubt.found_b;
    return doubt;
}

}  // namespace schuler::solution
