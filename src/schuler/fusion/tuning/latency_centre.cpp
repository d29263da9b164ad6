#include "schuler/fusion/tuning/latency_centre.h"

#include "schuler/fusion/start.h"
#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"

#include <algorithm>
#include <cmath>
#include <string_view>

namespace schuler::fusion {
namespace {

/// Estimate of a state at the end of a run and its sigma; zero without the state.
struct Last {
    double value = 0.0, std = 0.0;
};

Last last_of(const Result& run, std::string_view name) {
    const auto block = std::ranges::find(run.states, name, &LayoutBlock::name);
    if (block == run.states.end() || run.forward.parameters.empty()) return {};
    const ParameterRow& row = run.forward.parameters.back();
    const auto i = static_cast<std::size_t>(block->offset - 9);  // after position, velocity and attitude
    if (!std::isfinite(row.value[i]) || !std::isfinite(row.std[i])) return {};
    return {row.value[i], row.std[i]};
}

void note(Findings& findings, const char* key, double sigma) {
    const auto same = std::ranges::find(findings.tuned, key, &TunedSetting::key);
    if (same == findings.tuned.end()) findings.tuned.push_back({key, sigma, false});
    else same->sigma = sigma;
}

/// The reported sigma: that of the state, within the accuracy of such fits.
double reported(const Last& x) {
    constexpr double least = 0.02;  // s
    return std::max(least, x.std);
}

double to_tenth_of_ms(double s) { return 1e-4 * std::round(1e4 * s); }

}  // namespace

bool centre_latencies(RunData& data, Settings& settings, Start start, const FixScreen& screen, Findings& findings) {
    constexpr double linear = 0.005, longest = 600.0, sigmas = 4.0;  // s, s, of the latency
    GnssSettings& g = settings.gnss;
    if (!g.latency_found || !(g.latency_std > 0.0) || settings.coupling != Coupling::Loose) return false;
    const bool own = g.velocity_latency_std > 0.0;
    PassOptions options;
    const auto end =
        std::ranges::lower_bound(data.imu.increments, start.nav.time + Duration::from_seconds(longest), {}, &ImuIncrement::time);
    options.last_increment =
        std::min(static_cast<std::size_t>(end - data.imu.increments.begin()), data.imu.increments.size() - 1);
    constexpr int rounds = 2;
    // A start from a latency that the run finds far beyond its sigma would be an assumption of the run's own: what is in error (the
    // unit, its axes) would no longer show as a contradiction between the latency and what was measured of it.
    const double most_position = sigmas * g.latency_std, most_velocity = sigmas * g.velocity_latency_std;
    double moved_position = 0.0, moved_velocity = 0.0;
    for (int round = 0; round < rounds; ++round) {
        Settings trial = settings;
        trial.output_rate = 1.0;
        trial.smooth = trial.state_rows = trial.covariance_rows = trial.backward = false;
        const Result run = run_pass(data, trial, start, options);
        const Last position = last_of(run, "gnss_latency_error"),
                   velocity = own ? last_of(run, "gnss_velocity_latency_error") : Last{};
        const auto far = [&](const Last& x) { return std::abs(x.value) > std::max(linear, x.std); };
        if (!far(position) && !far(velocity)) return round > 0;
        if (std::abs(moved_position + position.value) > most_position ||
            (own && std::abs(moved_velocity + velocity.value) > most_velocity))
            return round > 0;
        if (findings.tuned.empty()) {
            findings.tuned_from = start.nav.time;
            findings.tuned_to = data.imu.increments[options.last_increment].time;
        }
        const double by_position = to_tenth_of_ms(position.value),
                     by_velocity = own ? to_tenth_of_ms(velocity.value) : by_position;
        moved_position += by_position;
        moved_velocity += by_velocity;
        // a velocity without a latency of its own follows the position
        if (own || g.velocity_latency) {
            g.velocity_latency = g.velocity_latency.value_or(g.latency) + by_velocity;
            note(findings, "gnss.velocity_latency_s", reported(own ? velocity : position));
        }
        if (g.velocity_down_latency) *g.velocity_down_latency += by_velocity;
        g.latency += by_position;
        if (g.height_latency) *g.height_latency += by_position;
        note(findings, "gnss.latency_s", reported(position));
        start = with_later_fixes(start, settings.earth, by_position, by_velocity);
        WarningLog heard;
        data.events = make_events(*data.recording, settings, data.origin, heard, screen);
        data.still = find_still(data.imu, *data.recording, data.events, settings);
    }
    return true;
}

}  // namespace schuler::fusion
