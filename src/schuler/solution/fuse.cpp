#include "schuler/solution/fuse.h"

#include "schuler/scenario/simulated_dataset.h"
#include "schuler/scenario/simulated_receiver.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/aided_receiver.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/evaluate.h"
#include "schuler/solution/gnss_only.h"
#include "schuler/solution/load_ranges.h"
#include "schuler/solution/loaded_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::solution {
namespace {

/// Below this number of IMU epochs the filter reports all of them if there is a reference: no interpolation is then required.
constexpr std::size_t largest_full_rate = 150'000;
/// Otherwise its minimum reporting rate: the evaluation interpolates between its rows.
constexpr double least_internal_rate = 10.0;

/// The scenario with the filter states selected above it: instrument errors without their own states are then stated as
/// biases.
settings::ScenarioConfig with_states(settings::ScenarioConfig scenario, const settings::SettingList& over) {
    settings::SettingList states;
    std::ranges::copy_if(over, std::back_inserter(states), [](const settings::Setting& s) {
        return s.key == "filter.preset" || s.key == "filter.scale_factors" || s.key == "filter.misalignments";
    });
    if (!states.empty()) settings::config_table().apply(states, scenario.processing);
    return scenario;
}

/// Replaces the ranges of the receiver, and the fixes made of them, by those of loops aided by the solution of the fixes themselves.
void aid_loops(ResultBundle& bundle, const fusion::Settings& settings) {
    WarningLog heard;
    const fusion::Result alone = fusion::run_filter(bundle.data.recording, settings, heard);
    scenario::SimulatedReceiver receiver(*bundle.sky, receiver::Guidance::Loops);
    bundle.data.recording.ranges = ranges_aided_by(alone.forward.rows, settings.earth, settings.gnss.lever_arm_b, receiver);
    bundle.receiver_rows = receiver.rows();
    take_fixes_from_ranges(bundle.data);
}

/// States that the simulated sensors have errors for and the named preset has not.
void warn_of_states_left_out(const settings::Config& c, const std::set<std::string>& given, WarningLog& warnings) {
    if (!given.contains("filter.preset") || settings::coupling_of_preset(c.preset)) return;
    const sensor::ImuErrorModel& imu = c.filter.imu.errors;
    std::vector<std::string_view> lacking;
    const auto check = [&](const char* key, bool used, double error) {
        if (!used && error > 0.0 && !given.contains(key)) lacking.emplace_back(key);
    };
    check("filter.scale_factors", c.filter.scale_factors, std::max(imu.gyro_scale, imu.accel_scale));
    check("filter.misalignments", c.filter.misalignments, std::max(imu.gyro_misalignment, imu.accel_misalignment));
    if (!lacking.empty())
        warnings.add(
            "filter.preset.lacks",
            fmt::format(
                "filter.preset = \"{}\" switches off {}, and the unit has such errors; to estimate them, set these beside "
                "the preset",
                c.preset, fmt::join(lacking, " and ")));
    const sensor::GnssErrorModel& g = c.filter.gnss.errors;
    if (c.preset == "complex22" && g.correlated_position.isZero(0.0) && g.correlated_velocity.isZero(0.0))
        warnings.add(
            "filter.preset.slow",
            "filter.preset = \"complex22\" has no states for slow errors of the receiver here, because the scenario gives none "
            "(gnss.correlated_m, gnss.correlated_velocity_m_s)");
}

}  // namespace

ResultBundle simulated_bundle(const settings::ScenarioConfig& scenario, const settings::SettingList& over, WarningLog& warnings,
                              const settings::ScenarioConfig* assumed, const sim::ExactFlight* flown) {
    const settings::ScenarioConfig described = with_states(assumed != nullptr ? *assumed : scenario, over);
    scenario::SimulatedDataset simulated = assumed != nullptr ? scenario::simulate_dataset(scenario, &described, flown)
                                                              : scenario::simulate_dataset(described, nullptr, flown);
    settings::Config config = settings::config_from(settings::overlaid(simulated.settings, over));
    const sensor::ImuErrorModel& unit = scenario.sim.imu.errors;
    config.filter.imu.noiseless |= unit.gyro_noise == 0.0 && unit.accel_noise == 0.0;  // whatever is assumed
    std::set<std::string> given;
    for (const settings::SettingList* list : {&std::as_const(simulated.settings), &over})
        for (const settings::Setting& s : *list) given.insert(s.key);
    warn_of_states_left_out(config, settings::keys_of_processing(described, over), warnings);
    ResultBundle bundle;
    bundle.name = config.name;
    bundle.seed = simulated.seed;
    bundle.published = scenario.published;
    simulated.recording.gauges = std::move(simulated.instruments.gauges);
    simulated.recording.body_velocity = std::move(simulated.instruments.velocities);
    simulated.recording.heading = std::move(simulated.instruments.headings);
    bundle.data = settled_dataset(std::move(simulated.recording), config, warnings, std::move(given));
    bundle.sky = std::move(simulated.sky);
    bundle.receiver_rows = std::move(simulated.receiver_rows);
    bundle.data.true_reference = true;
    bundle.truth = hidden_truth(simulated.truth, bundle.data.config.filter.imu);
    return bundle;
}

double internal_rate(const LoadedDataset& data) {
    const double rate = data.config.filter.output_rate;
    const bool every = !data.recording.reference.empty() && data.recording.imu.size() <= largest_full_rate;
    return every || !(rate > 0.0) ? 0.0 : std::max(rate, least_internal_rate);
}

void fuse_and_evaluate(ResultBundle& bundle, WarningLog& warnings, double output_rate,
                       const std::function<void(double)>& progress, const fusion::RowSink& rows) {
    const auto begin = std::chrono::steady_clock::now();
    if (bundle.data.config.scheme == settings::Scheme::Gnss) {
        bundle.result = gnss_solution(bundle.data.recording, bundle.data.config.filter);
    } else {
        fusion::Settings settings = bundle.data.config.filter;
        settings.covariance_rate = settings.output_rate;
        settings.output_rate = output_rate;
        settings.state_rows = !bundle.truth.sensors.empty();
        std::optional<scenario::SimulatedReceiver> receiver;
        using fusion::Coupling;
        if (bundle.sky && settings.coupling == Coupling::Deep) receiver.emplace(*bundle.sky, receiver::Guidance::Generators);
        const bool aided = bundle.sky && bundle.sky->settings().aided;
        if (bundle.sky && (settings.coupling == Coupling::Intermediate || (aided && settings.coupling == Coupling::Tight)))
            receiver.emplace(*bundle.sky, receiver::Guidance::Loops);
        if (aided && settings.coupling == Coupling::Loose) aid_loops(bundle, settings);
        if (receiver)
            settings.ranging.errors.rate_span = bundle.data.config.filter.ranging.errors.rate_span = receiver->rate_span();
        fusion::ReceiverInLoop in_loop;
        if (receiver) in_loop = std::bind_front(&scenario::SimulatedReceiver::run, &*receiver);
        bundle.result = fusion::run_filter(bundle.data.recording, settings, warnings, progress, rows, in_loop);
        if (receiver) bundle.receiver_rows = receiver->rows();
    }
    bundle.timing.filter_s = seconds_since(begin);
    if (bundle.result.forward.rows.empty())
        throw computation_error("the filter gave no solution", "look at the warnings and at `schuler inspect`");
    bundle.evaluation = evaluate(bundle.data, bundle.result, bundle.truth);
    warn_of_other_point(bundle.evaluation, warnings);
}

}  // namespace schuler::solution
