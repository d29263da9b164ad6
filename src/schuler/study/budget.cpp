// Where the errors come from: one source at a time is simulated, the filter assumes all of them.
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

bool has_fixes(const settings::ScenarioConfig& s) { return s.sim.gnss.rate > 0.0; }
bool has_baro(const settings::ScenarioConfig& s) { return s.sim.baro.rate > 0.0; }
bool has_satellites(const settings::ScenarioConfig& s) { return s.ranging.rate > 0.0 && s.ranging.systems != "-"; }
bool has_stations(const settings::ScenarioConfig& s) { return s.ranging.rate > 0.0 && !s.ranging.settings.stations.empty(); }

/// Copies fields of the errors of satellites' ranges.
template <double sensor::RangeErrorModel::*Field>
void keep_range(const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
    bare.ranging.settings.errors.satellite.*Field = full.ranging.settings.errors.satellite.*Field;
}

/// Copies fields of the IMU's error model.
template <double ImuErrorModel::*... Fields>
void keep_imu(const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
    ((bare.sim.imu.errors.*Fields = full.sim.imu.errors.*Fields), ...);
}
template <double settings::InitialError::*Field>
void keep_initial(const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
    bare.initial_error.*Field = full.initial_error.*Field;
}

const std::array<Source, 24> all_sources{
    {{"initial_position", "initial position", keep_initial<&settings::InitialError::position>},
     {"initial_velocity", "initial velocity", keep_initial<&settings::InitialError::velocity>},
     {"initial_level", "initial level", keep_initial<&settings::InitialError::level>},
     {"initial_heading", "initial heading", keep_initial<&settings::InitialError::heading>},
     {"gyro_bias", "gyro bias",
      keep_imu<&ImuErrorModel::gyro_bias, &ImuErrorModel::gyro_turn_on_bias, &ImuErrorModel::gyro_rate_walk,
               &ImuErrorModel::gyro_flicker>},
     {"gyro_noise", "gyro noise", keep_imu<&ImuErrorModel::gyro_noise>},
     {"gyro_scale", "gyro scale and axes", keep_imu<&ImuErrorModel::gyro_scale, &ImuErrorModel::gyro_misalignment>},
     {"accel_bias", "accelerometer bias",
      keep_imu<&ImuErrorModel::accel_bias, &ImuErrorModel::accel_turn_on_bias, &ImuErrorModel::accel_rate_walk,
               &ImuErrorModel::accel_flicker>},
     {"accel_noise", "accelerometer noise", keep_imu<&ImuErrorModel::accel_noise>},
     {"accel_scale", "accelerometer scale and axes", keep_imu<&ImuErrorModel::accel_scale, &ImuErrorModel::accel_misalignment>},
     {"other_imu", "temperature, g, quantization",
      keep_imu<&ImuErrorModel::gyro_temperature, &ImuErrorModel::accel_temperature, &ImuErrorModel::gyro_g,
               &ImuErrorModel::gyro_quantum, &ImuErrorModel::accel_quantum>},
     {"gnss_white", "receiver, white",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.sim.gnss.white_position = full.sim.gnss.white_position;
          bare.sim.gnss.white_velocity = full.sim.gnss.white_velocity;
      },
      has_fixes},
     {"gnss_position", "receiver, slow position",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.sim.gnss.errors.correlated_position = full.sim.gnss.errors.correlated_position;
          bare.sim.gnss.errors.change_correlated_position = full.sim.gnss.errors.change_correlated_position;
          bare.sim.gnss.errors.change_white_position = full.sim.gnss.errors.change_white_position;
      },
      has_fixes},
     {"gnss_velocity", "receiver, slow velocity",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.sim.gnss.errors.correlated_velocity = full.sim.gnss.errors.correlated_velocity;
          bare.sim.gnss.errors.change_correlated_velocity = full.sim.gnss.errors.change_correlated_velocity;
          bare.sim.gnss.errors.change_white_velocity = full.sim.gnss.errors.change_white_velocity;
      },
      has_fixes},
     {"range_white", "ranges, white", keep_range<&sensor::RangeErrorModel::white>, has_satellites},
     {"range_slow", "ranges, slow and reflections",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          keep_range<&sensor::RangeErrorModel::correlated>(full, bare);
          bare.ranging.settings.multipath.amplitude = full.ranging.settings.multipath.amplitude;
      },
      has_satellites},
     {"range_rate", "range rates", keep_range<&sensor::RangeErrorModel::rate>, has_satellites},
     {"stations", "ground stations",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.ranging.settings.errors.station = full.ranging.settings.errors.station;
          bare.ranging.settings.errors.network = full.ranging.settings.errors.network;
      },
      has_stations},
     {"clock", "receiver's clock",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.ranging.settings.errors.clock = full.ranging.settings.errors.clock;
      },
      [](const settings::ScenarioConfig& s) { return s.ranging.rate > 0.0; }},
     {"baro", "barometer",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.sim.baro.white = full.sim.baro.white;
          bare.sim.baro.bias = full.sim.baro.bias;
          bare.sim.baro.bias_walk = full.sim.baro.bias_walk;
      },
      has_baro},
     {"mag", "magnetometer",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.sim.mag.white = full.sim.mag.white;
          bare.sim.mag.hard_iron = full.sim.mag.hard_iron;
          bare.sim.mag.soft_iron = full.sim.mag.soft_iron;
      },
      [](const settings::ScenarioConfig& s) { return s.sim.mag.rate > 0.0; }},
     {"gauges", "gauges",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.aids.gauges.white = full.aids.gauges.white;
          bare.aids.gauges.bias = full.aids.gauges.bias;
      },
      [](const settings::ScenarioConfig& s) { return s.aids.gauges.rate > 0.0; }},
     {"log", "velocity log",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.aids.log.white = full.aids.log.white;
          bare.aids.log.scale = full.aids.log.scale;
          bare.aids.log.misalignment = full.aids.log.misalignment;
      },
      [](const settings::ScenarioConfig& s) { return s.aids.log.rate > 0.0; }},
     {"compass", "compass",
      [](const settings::ScenarioConfig& full, settings::ScenarioConfig& bare) {
          bare.aids.compass.white = full.aids.compass.white;
          bare.aids.compass.bias = full.aids.compass.bias;
      },
      [](const settings::ScenarioConfig& s) { return s.aids.compass.rate > 0.0; }}}};

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
    for (sensor::RangeErrorModel* of : {&ranges.satellite, &ranges.station}) of->white = of->correlated = of->rate = 0.0;
    ranges.network = 0.0;
    ranges.clock = {0.0, 0.0, 0.0, 0.0};
    bare.ranging.settings.multipath.amplitude = 0.0;
    bare.sim.mag.white = bare.sim.mag.hard_iron = bare.sim.mag.soft_iron = 0.0;
    bare.aids.gauges.white = bare.aids.gauges.bias = 0.0;
    bare.aids.log.white = bare.aids.log.scale = bare.aids.log.misalignment = 0.0;
    bare.aids.compass.white = bare.aids.compass.bias = 0.0;
    bare.initial_error.position = bare.initial_error.velocity = 0.0;
    if (bare.initial_error.given()) bare.initial_error.level = bare.initial_error.heading = 0.0;
    return bare;
}

report::Outcome analyze_budget(const StudyRequest& request) {
    const settings::SettingList base = settings::scenario_settings(request.scenario, request.seed);
    const settings::ScenarioConfig first = settings::scenario_from(base);
    if (first.receiver_channels.rate > 0.0)
        throw input_error("a receiver at correlator level has no errors that could be taken one at a time",
                          {.file = {}, .key = "receiver.rate_hz"}, "give ranges.rate_hz and their errors instead");
    std::vector<const Source*> sources;
    for (const Source& s : all_sources)
        if (s.present(first)) sources.push_back(&s);
    const std::size_t rows = sources.size() + 1;  // the last one: everything at once
    std::vector<std::vector<ErrorMeasures>> all(rows, std::vector<ErrorMeasures>(request.runs));
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
            solution::ResultBundle bundle = solution::simulated_bundle(simulated, request.above, unheard, &full);
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
