#include "schuler/app/attitude/ahrs.h"

#include "schuler/app/attitude/ahrs_outputs.h"
#include "schuler/core/units.h"
#include "schuler/dataset/recognise.h"
#include "schuler/math/rotation.h"
#include "schuler/report/outcome.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_folder.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/events.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/ignored_here.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>

namespace schuler::app {
namespace {

/// Warnings about excluded samples, one line per instrument.
void tell(const ahrs::Counters& c, WarningLog& warnings) {
    const auto one = [&](const char* name, const ahrs::InstrumentCount& n) {
        if (n.rejected() == 0) return;
        warnings.add(std::string("ahrs.") + name,
                     fmt::format("{}: {} of {} samples left out: {} not finite, {} saturated, {} stuck", name, n.rejected(),
                                 n.samples, n.not_finite, n.saturated, n.stuck));
    };
    one("gyro", c.gyro);
    one("accelerometer", c.accel);
    one("magnetometer", c.field);
    if (c.gaps > 0)
        warnings.add("ahrs.gaps", fmt::format("{} gaps in the IMU log: the attitude may have turned in them", c.gaps));
}

AhrsEvaluation evaluate(const std::vector<ahrs::AttitudeRow>& rows, const std::vector<ReferenceSample>& reference) {
    AhrsEvaluation e;
    const auto pairs = attitude_pairs(rows, reference);
    e.broad = analysis::broad_errors(pairs);
    std::vector<double> roll, pitch, heading;
    for (const analysis::AttitudePair& p : pairs) {
        const Eigen::Vector3d a = math::rpy_from_quaternion(p.q_estimate), b = math::rpy_from_quaternion(p.q_reference);
        roll.push_back(math::wrap_pi(a.x() - b.x()));
        pitch.push_back(a.y() - b.y());
        heading.push_back(math::wrap_pi(a.z() - b.z() - e.broad.heading_offset));
    }
    e.roll = analysis::spread_of(std::move(roll));
    e.pitch = analysis::spread_of(std::move(pitch));
    e.heading = analysis::spread_of(std::move(heading));
    return e;
}

/// A field that points up is that of the southern hemisphere, or all three axes have the wrong sign: only the place tells which.
void warn_of_field_upward(const AhrsBundle& b, WarningLog& warnings) {
    constexpr double clearly = 5e-6;  // T
    if (b.six_axis || b.field_from_model || b.filter != "mekf" || b.result.field.vertical > -clearly) return;
    warnings.add(
        "ahrs.mag.upward",
        "the magnetic field points up, as it does south of the equator only: if the log is not from there, all three axes "
        "of the magnetometer have the wrong sign and the heading is off by 180 deg; initial.lat_deg and lon_deg with a date "
        "decide it");
}

}  // namespace

report::Outcome ahrs_dataset(const AhrsRequest& request) {
    const auto begin = std::chrono::steady_clock::now();
    const settings::Dataset dataset =
        settings::open_dataset(request.common.input, dataset::Needs::Attitude, request.common.over({}));
    const settings::Config config = settings::config_from(dataset.settings);
    WarningLog warnings;
    AhrsBundle b;
    b.name = config.name.empty() ? dataset.name : config.name;
    b.version = request.common.version;
    b.data = solution::load_dataset(dataset, config, warnings);
    b.ignored = solution::leave_out_chosen(b.data);
    std::ranges::move(solution::ignored_by_attitude(b.data.config, b.data.given), std::back_inserter(b.ignored));
    const auto wants = [&](std::string_view file) { return config.output.wants(file); };
    if (wants("states") || wants("covariance") || wants("mat"))
        b.ignored.push_back({"output.files", "attitude filters write no \"states\", \"covariance\" or \"mat\""});
    solution::warn_of_ignored_here(b.ignored, request.common.above, warnings);
    AhrsInput input = ahrs_input(b.data, request, warnings);
    b.filter = request.filter;
    b.offline = request.offline;
    b.six_axis = input.settings.mekf.six_axis;
    b.field_from_model = input.field_from_model;
    b.declination = input.settings.mekf.heading.declination;
    b.axes = input.axes;
    b.magnet_b = input.magnet_b;
    b.mag_delay = input.mag_delay;
    b.calibration = input.calibration;
    b.imu_epochs = input.imu.size();

    const auto filter_begin = std::chrono::steady_clock::now();
    b.result = ahrs::run(input.imu, input.mag, input.speed, input.settings);
    b.timing.filter_s = solution::seconds_since(filter_begin);
    if (b.result.rows.empty())
        throw input_error("the log is too short for an attitude, or has no usable accelerometer sample", {},
                          "give at least 0.1 s of samples; `schuler inspect` shows what is wrong with them");
    tell(b.result.counters, warnings);
    if (!b.result.resting_rate.isZero())
        warnings.add("ahrs.gyro.bias", fmt::format("the gyros read {:.2f} deg/s at rest, which is subtracted as bias",
                                                   b.result.resting_rate.norm() / units::deg_per_s));
    warn_of_field_upward(b, warnings);
    if (input.settings.filter != ahrs::FilterKind::Mekf && input.field_from_model) turn_to_true_north(b);
    b.evaluation = evaluate(b.result.rows, b.data.recording.reference);
    b.warnings = warnings.summary();
    b.config_toml = settings::to_toml(settings::config_table().used(b.data.config), settings::config_table().specs(), true);

    report::Outcome out;
    out.notice = dataset.inferred_toml;
    report::ResultFolder files(out, request.common.folder_for(b.name));
    const auto write_begin = std::chrono::steady_clock::now();
    files.add_written(write_ahrs_outputs(b, files.path()));
    b.timing.write_s = solution::seconds_since(write_begin);
    b.timing.read_s = b.data.read_seconds;
    b.timing.wall_s = solution::seconds_since(begin);
    out.json = ahrs_summary_json(b);
    files.write("summary.json", out.json);
    files.publish();
    out.tables = ahrs_summary_tables(b);
    out.warnings = b.warnings;
    return out;
}

}  // namespace schuler::app
