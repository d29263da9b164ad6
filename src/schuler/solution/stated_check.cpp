#include "schuler/solution/stated_check.h"

#include "schuler/core/units.h"
#include "schuler/fusion/heading_search.h"
#include "schuler/fusion/legs.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/math/rotation.h"
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
    double heading_std = 0.0;   // rad
    double speed = 0.0;         // m/s, root mean square
    double std_velocity = 0.0;  // m/s, median of its norm
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
    constexpr std::size_t most = 2'000'000;  // IMU epochs: hours, which show it as well as a day
    const Recording& log = data.recording;
    fusion::Result r;
    try {
        r = log.imu.size() > most
                ? fusion::run_filter(fusion::part_of(log, log.imu.front().time, log.imu[most].time), settings, heard)
                : fusion::run_filter(log, settings, heard);
    } catch (const Error&) {
        return std::nullopt;
    }
    const auto block = std::ranges::find(r.states, std::string_view("lever_arm"), &fusion::LayoutBlock::name);
    if (block == r.states.end() || r.forward.parameters.empty()) return std::nullopt;
    constexpr int navigation = filter::Layout::navigation;
    Estimate e;
    const fusion::ParameterRow& last = r.forward.parameters.back();
    for (int i = 0; i < 3; ++i) {
        const auto at = static_cast<std::size_t>(block->offset - navigation + i);
        e.value(i) = last.value[at];
        e.std(i) = last.std[at];
    }
    e.heading_std = r.forward.rows.back().std_rpy.z();
    for (const SolutionRow& row : r.forward.rows)
        e.speed += row.v_eb_n.squaredNorm() / static_cast<double>(r.forward.rows.size());
    e.speed = std::sqrt(e.speed);
    std::vector<double> std_velocity;
    for (const SolutionRow& row : r.forward.rows) std_velocity.push_back(row.std_velocity.norm());
    const auto middle = std_velocity.begin() + static_cast<std::ptrdiff_t>(std_velocity.size() / 2);
    std::ranges::nth_element(std_velocity, middle);
    e.std_velocity = *middle;
    return e;
}

/// Mean square of the angular rate about its mean, body axes, rad^2/s^2.
Vector3d turning_of(const Recording& log, const fusion::ImuSettings& imu) {
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(imu.mounting_rpy) * imu.C_bs;
    Vector3d sum = Vector3d::Zero(), square = Vector3d::Zero();
    double n = 0.0;
    for (std::size_t k = 1; k < log.imu.size(); ++k) {
        const double dt = (log.imu[k].time - log.imu[k - 1].time).seconds();
        if (!(dt > 0.0)) continue;
        const Vector3d rate = C_bs * log.imu[k].gyro / (imu.kind == ImuKind::Increments ? dt : 1.0);
        if (!rate.allFinite()) continue;
        sum += rate;
        square += rate.cwiseAbs2();
        n += 1.0;
    }
    return n > 0.0 ? Vector3d((square / n - (sum / n).cwiseAbs2()).cwiseMax(0.0)) : Vector3d(Vector3d::Zero());
}

/// True if an antenna where the log leaves it possible would move against the unit as fast as the velocity is uncertain.
bool matters(const Estimate& e, const Vector3d& turning) {
    constexpr double part = 0.5;
    const Vector3d possible = e.value.cwiseAbs() + e.std.cwiseMin(2.0);   // m
    const Vector3d across = Vector3d::Constant(turning.sum()) - turning;  // about the other two axes
    return std::sqrt(possible.cwiseAbs2().dot(across)) > part * e.std_velocity;
}

std::string numbers(const Vector3d& v) { return fmt::format("[{:.2f}, {:.2f}, {:.2f}]", v.x(), v.y(), v.z()); }

}  // namespace

std::string LeverArmDoubt::text() const {
    if (unknown)
        return fmt::format(
            "gnss.lever_arm_m is not given, and the log shows no more of it than {} +- {} m: the solution is that of the antenna; "
            "give the lever arm for that of the unit",
            numbers(found_b), numbers(std_b));
    if (!given && told_only)
        return fmt::format(
            "gnss.lever_arm_m is not given; the fixes show that the antenna is {} +- {} m from the unit (forward, right, down), "
            "which tight coupling does not use: give it",
            numbers(found_b), numbers(std_b));
    if (!given)
        return fmt::format(
            "gnss.lever_arm_m is not given; the fixes show that the antenna is {} +- {} m from the unit (forward, right, down), "
            "which is used and is a state",
            numbers(found_b), numbers(std_b));
    return fmt::format("the data contradict gnss.lever_arm_m: {} m is given; the fixes show {} +- {} m; {}", numbers(given_b),
                       numbers(found_b), numbers(std_b),
                       told_only ? "the given one is used"
                       : refuted ? "what they show is used, and is a state"
                                 : "the given one is used, and is a state");
}

std::optional<LeverArmDoubt> doubt_of_lever_arm(const LoadedDataset& data, const fusion::Result& result) {
    const bool to_base = data.config.scheme == settings::Scheme::Tight && !data.recording.ranges.carriers.empty();
    if ((data.config.scheme != settings::Scheme::Loose && !to_base) || !result.findings.in_force || !data.config.run.self_check)
        return std::nullopt;
    LeverArmDoubt doubt;
    doubt.settings = *result.findings.in_force;
    doubt.settings.coupling = fusion::Coupling::Loose;
    doubt.told_only = to_base;
    doubt.given_b = doubt.settings.gnss.lever_arm_b;
    doubt.given = data.given.contains("gnss.lever_arm_m");
    if (doubt.settings.estimate_lever_arm || (!doubt.given && !doubt.given_b.isZero(0.0))) return std::nullopt;
    doubt.settings.estimate_lever_arm = true;
    double& prior = doubt.settings.gnss.lever_arm_std;
    if (!doubt.given) prior = fusion::unknown_lever_arm_std(doubt.settings);
    // without tilt the down component is absorbed by the height of the unit; centimetres are within the receiver's errors
    constexpr double least = 0.1, sure = 0.3;  // m
    const auto beyond = [&](double sigmas, double metres) {
        const Vector3d off = (doubt.found_b - doubt.given_b).cwiseAbs();
        return ((off.array() > sigmas * doubt.std_b.array()) && (off.array() > metres)).any();
    };
    constexpr int walks = 3;
    const double settled = 0.5 * prior;         // m
    constexpr double known = 3.0 * units::deg;  // a lever arm turned by the error of the heading is another one
    constexpr double centimetres = 0.05;        // m
    // s: latencies and the times over which receivers average act along the track as a lever arm does. At the speed of an aircraft that
    // is as much as the lever arm itself.
    constexpr double averaging = 0.01, short_arm = 0.3;  // m
    const fusion::Settings& in_force = doubt.settings;
    const bool movable = !doubt.given && !to_base && fusion::only_of_unit(data.recording, in_force) == nullptr;
    const auto at_antenna = [&](const Estimate& e, const Vector3d& from) -> std::optional<LeverArmDoubt> {
        if (!movable || !matters(e, turning_of(data.recording, in_force.imu))) return std::nullopt;
        doubt.unknown = doubt.settings.output_at_antenna = true;
        doubt.settings.gnss.lever_arm_b = from;
        doubt.settings.gnss.found_lever_arm_std.setZero();
        doubt.found_b = e.value;
        doubt.std_b = e.std;
        return doubt;
    };
    std::optional<Estimate> e;
    bool direction = false;  // of the lever arm, known
    for (int k = 0; k < walks; ++k) {
        fusion::Settings trial = doubt.settings;
        if (k > 0) trial.gnss.lever_arm_b = doubt.found_b;
        e = at_the_end(data, trial);
        if (!e || !e->value.allFinite() || e->value.norm() > 100.0) return std::nullopt;
        const double along = averaging * e->speed;
        direction = e->heading_std < known && (doubt.given || along < short_arm);
        if (!direction && !movable) return std::nullopt;
        doubt.found_b = e->value;
        doubt.settings.gnss.found_lever_arm_std = {std::hypot(centimetres, along), centimetres, centimetres};
        doubt.std_b = (e->std.cwiseAbs2() + doubt.settings.gnss.found_lever_arm_std.cwiseAbs2()).cwiseSqrt();
        if (!beyond(5.0, least)) return at_antenna(*e, doubt.given_b);
        if ((e->value - trial.gnss.lever_arm_b).cwiseAbs().maxCoeff() < settled) break;
    }
    if (!direction) return at_antenna(*e, e->value);
    if (to_base) return doubt;
    doubt.refuted = !doubt.given || (beyond(10.0, sure) && !data.config.run.keep_given);
    if (doubt.refuted) doubt.settings.gnss.lever_arm_b = doubt.found_b;
    return doubt;
}

}  // namespace schuler::solution
