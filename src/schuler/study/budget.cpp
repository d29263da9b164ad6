// Error budget: one source at a time is simulated, the filter assumes all of them.
#include "schuler/core/parallel.h"
#include "schuler/core/units.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outcome.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/parts.h"
#include "schuler/study/studies.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace schuler::study {
namespace {

using sensor::ImuErrorModel;

struct Source {
    const char* key;
    const char* title;
    void (*keep)(const settings::ScenarioConfig& full, settings::ScenarioConfig& bare);
    bool (*present)(const settings::ScenarioConfig& full) = [](const settings::ScenarioConfig&) { return true; };
};

// The parts of a scenario with errors, for reading and writing.
constexpr auto imu = [](auto& s) -> auto& { return s.sim.imu.errors; };
constexpr auto start = [](auto& s) -> auto& { return s.initial_error; };
constexpr auto gnss = [](auto& s) -> auto& { return s.sim.gnss; };
constexpr auto gnss_slow = [](auto& s) -> auto& { return s.sim.gnss.errors; };
constexpr auto ranging = [](auto& s) -> auto& { return s.ranging.settings.errors; };
constexpr auto satellite = [](auto& s) -> auto& { return s.ranging.settings.errors.satellite; };
constexpr auto channels = [](auto& s) -> auto& { return s.receiver_channels; };
constexpr auto multipath = [](auto& s) -> auto& { return s.ranging.settings.multipath; };
constexpr auto baro = [](auto& s) -> auto& { return s.sim.baro; };
constexpr auto mag = [](auto& s) -> auto& { return s.sim.mag; };
constexpr auto gauges = [](auto& s) -> auto& { return s.instruments.gauges; };
constexpr auto velocity_log = [](auto& s) -> auto& { return s.instruments.log; };
constexpr auto compass = [](auto& s) -> auto& { return s.instruments.compass; };

/// Copies fields of one part.
template <auto Part, auto... Fields>
void keep(const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
    ((Part(bare).*Fields = Part(full).*Fields), ...);
}
/// True if the instrument exists.
template <auto Part>
bool sampled(const settings::ScenarioConfig& s) {
    return Part(s).rate > 0.0;
}
bool has_channels(const settings::ScenarioConfig& s) { return s.receiver_channels.rate > 0.0; }
bool has_ranges(const settings::ScenarioConfig& s) { return s.ranging.rate > 0.0 || has_channels(s); }
bool has_satellites(const settings::ScenarioConfig& s) { return has_ranges(s) && s.ranging.systems != "-"; }
bool has_modelled_satellites(const settings::ScenarioConfig& s) { return has_satellites(s) && !has_channels(s); }
bool has_stations(const settings::ScenarioConfig& s) { return has_ranges(s) && !s.ranging.settings.stations.empty(); }

using sensor::GnssErrorModel;
using sensor::RangeErrorModel;
using sensor::RangingErrorModel;
using settings::InitialError;
using settings::ReceiverScenarioConfig;
using sim::BaroSettings;
using sim::CompassErrors;
using sim::GaugeErrors;
using sim::GnssSettings;
using sim::LogErrors;
using sim::MagSettings;
using E = ImuErrorModel;

// clang-format off
const std::array<Source, 25> all_sources{{
    {"initial_position", "initial position", keep<start, &InitialError::position>},
    {"initial_velocity", "initial velocity", keep<start, &InitialError::velocity>},
    {"initial_level", "initial level", keep<start, &InitialError::level>},
    {"initial_heading", "initial heading", keep<start, &InitialError::heading>},
    {"gyro_bias", "gyro bias", keep<imu, &E::gyro_bias, &E::gyro_turn_on_bias, &E::gyro_rate_walk, &E::gyro_flicker>},
    {"gyro_noise", "gyro noise", keep<imu, &E::gyro_noise>},
    {"gyro_scale", "gyro scale and axes", keep<imu, &E::gyro_scale, &E::gyro_misalignment>},
    {"accel_bias", "accelerometer bias", keep<imu, &E::accel_bias, &E::accel_turn_on_bias, &E::accel_rate_walk, &E::accel_flicker>},
    {"accel_noise", "accelerometer noise", keep<imu, &E::accel_noise>},
    {"accel_scale", "accelerometer scale and axes", keep<imu, &E::accel_scale, &E::accel_misalignment>},
    {"other_imu", "temperature, g, quantization",
     keep<imu, &E::gyro_temperature, &E::accel_temperature, &E::gyro_g, &E::gyro_quantum, &E::accel_quantum>},
    {"gnss_white", "receiver, white", keep<gnss, &GnssSettings::white_position, &GnssSettings::white_velocity>, sampled<gnss>},
    {"gnss_position", "receiver, slow position",
     keep<gnss_slow, &GnssErrorModel::correlated_position, &GnssErrorModel::change_correlated_position, &GnssErrorModel::change_white_position>, sampled<gnss>},
    {"gnss_velocity", "receiver, slow velocity",
     keep<gnss_slow, &GnssErrorModel::correlated_velocity, &GnssErrorModel::change_correlated_velocity, &GnssErrorModel::change_white_velocity>, sampled<gnss>},
    {"range_white", "ranges, white", keep<satellite, &RangeErrorModel::white>, has_modelled_satellites},
    {"channels", "receiver's channels", keep<channels, &ReceiverScenarioConfig::exact_channels>, has_channels},
    {"range_slow", "ranges, slow and reflections",
     [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
         keep<satellite, &RangeErrorModel::correlated>(full, bare);
         multipath(bare).amplitude = multipath(full).amplitude;
     },
     has_satellites},
    {"range_rate", "range rates", keep<satellite, &RangeErrorModel::rate, &RangeErrorModel::correlated_rate>, has_satellites},
    {"stations", "ground stations", keep<ranging, &RangingErrorModel::station, &RangingErrorModel::network>, has_stations},
    {"clock", "receiver's clock",
     [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
         keep<ranging, &RangingErrorModel::clock>(full, bare);
         keep<channels, &ReceiverScenarioConfig::exact_clock>(full, bare);
     },
     has_ranges},
    {"baro", "barometer", keep<baro, &BaroSettings::white, &BaroSettings::bias, &BaroSettings::bias_walk>, sampled<baro>},
    {"mag", "magnetometer", keep<mag, &MagSettings::white, &MagSettings::hard_iron, &MagSettings::soft_iron>, sampled<mag>},
    {"gauges", "gauges", keep<gauges, &GaugeErrors::white, &GaugeErrors::bias>, sampled<gauges>},
    {"log", "velocity log", keep<velocity_log, &LogErrors::white, &LogErrors::scale, &LogErrors::misalignment>, sampled<velocity_log>},
    {"compass", "compass", keep<compass, &CompassErrors::white, &CompassErrors::bias>, sampled<compass>},
}};
// clang-format on

/// Root mean squares of one run.
ErrorMeasures measures_of(const solution::ResultBundle& b) {
    const analysis::ErrorSummary& s = b.evaluation.summary;
    return {s.horizontal.rms,
            s.up.rms,
            std::hypot(s.v_east.rms, s.v_north.rms, s.v_up.rms),
            std::hypot(s.roll.rms, s.pitch.rms) / units::deg,
            s.heading.rms / units::deg,
            b.evaluation.outages.empty() ? not_given : b.evaluation.outages.front().end_horizontal};
}

}  // namespace

settings::ScenarioConfig without_errors(const settings::ScenarioConfig& full) {
    settings::ScenarioConfig bare = full;
    const ImuErrorModel& e = full.sim.imu.errors;
    bare.sim.imu.errors = sensor::imu_grade("perfect");
    bare.sim.imu.errors.gyro_bias_time = e.gyro_bias_time;
    bare.sim.imu.errors.accel_bias_time = e.accel_bias_time;
    bare.sim.gnss.white_position.setZero();
    bare.sim.gnss.white_velocity.setZero();
    const sensor::GnssErrorModel slow = full.sim.gnss.errors;
    bare.sim.gnss.errors = {};
    bare.sim.gnss.errors.correlated_time = slow.correlated_time;
    bare.sim.gnss.errors.correlated_distance = slow.correlated_distance;
    bare.sim.gnss.errors.correlated_velocity_time = slow.correlated_velocity_time;
    bare.sim.baro.white = bare.sim.baro.bias = bare.sim.baro.bias_walk = 0.0;
    sensor::RangingErrorModel& ranges = bare.ranging.settings.errors;
    for (sensor::RangeErrorModel* of : {&ranges.satellite, &ranges.station})
        of->white = of->correlated = of->rate = of->correlated_rate = 0.0;
    ranges.network = 0.0;
    // A receiver at correlator level has its clock, and channels with all their errors, in any case: availability and the stated sigmas
    // are theirs. What it measures is made exact.
    if (!has_channels(full)) ranges.clock = {0.0, 0.0, 0.0, 0.0};
    bare.receiver_channels.exact_channels = bare.receiver_channels.exact_clock = true;
    bare.ranging.settings.multipath.amplitude = 0.0;
    bare.sim.mag.white = bare.sim.mag.hard_iron = bare.sim.mag.soft_iron = 0.0;
    bare.instruments.gauges.white = bare.instruments.gauges.bias = 0.0;
    bare.instruments.log.white = bare.instruments.log.scale = bare.instruments.log.misalignment = 0.0;
    bare.instruments.compass.white = bare.instruments.compass.bias = 0.0;
    bare.initial_error.position = bare.initial_error.velocity = 0.0;
    if (bare.initial_error.given()) bare.initial_error.level = bare.initial_error.heading = 0.0;
    return bare;
}

report::Outcome analyze_budget(const StudyRequest& request) {
    const settings::SettingList base = settings::scenario_settings(request.scenario, request.seed);
    const settings::ScenarioConfig first = settings::scenario_from(base);
    std::vector<const Source*> sources;
    for (const Source& s : all_sources)
        if (s.present(first)) sources.push_back(&s);
    const std::size_t rows = sources.size() + 1;  // the last one: all sources together
    std::vector<std::vector<ErrorMeasures>> all(rows, std::vector<ErrorMeasures>(request.runs));
    const auto flown = sim::exact_flight(first.sim);  // all rows and seeds fly the same path
    for_each_run(
        rows * request.runs, request.jobs,
        [&](std::size_t job) {
            const std::size_t row = job / request.runs, k = job % request.runs;
            settings::SettingList settings = base;
            settings.push_back({"seed", {static_cast<std::int64_t>(first.sim.seed + k)}, {}});
            const settings::ScenarioConfig full = settings::scenario_from(settings);
            settings::ScenarioConfig simulated = full;
            if (row < sources.size()) {
                simulated = without_errors(full);
                sources[row]->keep(full, simulated);
            }
            WarningLog unheard;
            solution::ResultBundle bundle = solution::simulated_bundle(simulated, request.above, unheard, &full, flown.get());
            solution::fuse_and_evaluate(bundle, unheard, full.sim.reference_rate, {});
            all[row][k] = measures_of(bundle);
        },
        request.progress);

    report::ResultTable table =
        source_table(fmt::format("{}: root mean squares over {} runs, one source at a time", first.name, request.runs));
    ErrorMeasures sum{};
    for (std::size_t row = 0; row < rows; ++row) {
        ErrorMeasures rms{};
        for (const ErrorMeasures& m : all[row])
            for (std::size_t i = 0; i < rms.size(); ++i) rms[i] += m[i] * m[i] / static_cast<double>(request.runs);
        for (std::size_t i = 0; i < rms.size(); ++i) {
            if (row < sources.size()) sum[i] += rms[i];
            rms[i] = std::sqrt(rms[i]);
        }
        if (row < sources.size()) {
            add_source(table, sources[row]->key, sources[row]->title, rms);
            continue;
        }
        for (double& x : sum) x = std::sqrt(x);
        add_source(table, "root_sum_square", "root of the sum of squares", sum);
        add_source(table, "all", "all at once", rms);
    }
    report::Outcome out;
    out.tables = report::table_text(table);
    out.json = report::text_of(report::Json{{"name", first.name}, {"runs", request.runs}, {"rows", report::table_json(table)}});
    return out;
}

}  // namespace schuler::study
