#include "schuler/app/attitude/ahrs_outputs.h"

#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/math/rotation.h"
#include "schuler/report/inner/json.h"
#include "schuler/report/outputs.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/config/config.h"

#include <algorithm>
#include <cmath>

namespace schuler::app {
namespace {

report::Json in_degrees(double x) { return report::json_number(x / units::deg); }
report::Json rms_of(double x) { return {{"rms", in_degrees(x)}}; }
SolutionRow solution_row(const ahrs::AttitudeRow& a) {
    SolutionRow row;
    row.time = a.time;
    row.position = {not_given, not_given, not_given};
    row.v_eb_n = row.std_position = row.std_velocity = not_given3();
    const Eigen::Matrix3d C_nb = a.q_nb.toRotationMatrix();
    row.rpy = math::rpy_from_dcm(C_nb);
    const Eigen::Matrix3d J = math::rpy_error_from_phi(row.rpy);
    row.std_rpy = (J.cwiseAbs2() * a.std_phi.cwiseAbs2()).cwiseSqrt();
    return row;
}

report::Json errors_of(const AhrsBundle& b) {
    const AhrsEvaluation& e = b.evaluation;
    if (e.broad.epochs == 0) return nullptr;
    report::Json out;
    out["position_m"] = nullptr;
    out["velocity_m_s"] = nullptr;
    out["attitude_deg"] = {{"roll", report::spread(e.roll, units::deg)},
                           {"pitch", report::spread(e.pitch, units::deg)},
                           {"heading", report::spread(e.heading, units::deg)}};
    out["broad_deg"] = {{"total", rms_of(e.broad.total)},
                        {"heading", rms_of(e.broad.heading)},
                        {"inclination", rms_of(e.broad.inclination)},
                        {"heading_offset", in_degrees(e.broad.heading_offset)},
                        {"epochs", e.broad.epochs}};
    out["broad_raw_deg"] = {{"total", rms_of(e.broad.raw_total)},
                            {"heading", rms_of(e.broad.raw_heading)},
                            {"inclination", rms_of(e.broad.inclination)},
                            {"epochs", e.broad.epochs}};
    return out;
}

report::Json count_of(const ahrs::InstrumentCount& c) {
    return {{"samples", c.samples}, {"not_finite", c.not_finite}, {"saturated", c.saturated}, {"stuck", c.stuck}};
}

report::Json vector_of(const Eigen::Vector3d& v, double unit) { return {v.x() / unit, v.y() / unit, v.z() / unit}; }

double rate_of(const AhrsBundle& b) {
    const double span = (b.result.rows.back().time - b.result.rows.front().time).seconds();
    return span > 0.0 ? static_cast<double>(b.result.rows.size() - 1) / span : not_given;
}

}  // namespace

void turn_to_true_north(AhrsBundle& b) {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(b.declination, Eigen::Vector3d::UnitZ()));
    for (ahrs::AttitudeRow& row : b.result.rows) row.q_nb = turn * row.q_nb;
}

std::vector<std::filesystem::path> write_ahrs_outputs(const AhrsBundle& b, const std::filesystem::path& folder) {
    report::make_folder(folder);
    const settings::OutputConfig& o = b.data.config.output;
    std::vector<std::filesystem::path> written;
    if (o.wants("solution")) {
        std::vector<SolutionRow> rows;
        rows.reserve(b.result.rows.size());
        for (const ahrs::AttitudeRow& a : b.result.rows) rows.push_back(solution_row(a));
        written.push_back(folder / "solution.csv");
        io::write_solution_csv(written.back(), rows);
    }
    if (o.wants("report")) {
        written.push_back(folder / "report.html");
        io::write_file(written.back(), ahrs_report_html(b));
    }
    if (o.wants("config")) {
        written.push_back(folder / "config.toml");
        io::write_file(written.back(), b.config_toml);
    }
    return written;
}

std::string ahrs_summary_json(const AhrsBundle& b) {
    const ahrs::RunResult& r = b.result;
    report::Json out;
    out["name"] = b.name;
    out["command"] = "ahrs";
    out["filter"] = b.filter;
    out["six_axis"] = b.six_axis;
    out["scheme"] = nullptr;
    out["mechanization"] = nullptr;
    out["loop"] = "closed";
    out["smoothed"] = b.offline;
    out["seed"] = nullptr;
    out["version"] = b.version;
    out["duration_s"] = (r.rows.back().time - r.rows.front().time).seconds();
    out["imu"] = {{"epochs", b.imu_epochs}, {"rate_hz", rate_of(b)}, {"gaps", r.counters.gaps}};
    out["gnss"] = nullptr;
    out["reference"] = b.evaluation.broad.epochs > 0 ? report::Json("file") : report::Json(nullptr);
    out["errors"] = errors_of(b);
    out["settled_after_s"] = nullptr;
    out["consistency"] = nullptr;
    out["outages"] = report::Json::array();
    const ahrs::FieldFindings& f = r.field;
    out["findings"] = {{"gyro_bias_deg_s", vector_of(r.rows.back().gyro_bias, units::deg_per_s)},
                       {"hard_iron_ut", vector_of(b.magnet_b + f.hard_iron_b, units::microtesla)},
                       {"horizontal_field_ut", f.horizontal / units::microtesla},
                       {"vertical_field_ut", f.vertical / units::microtesla},
                       {"mag_delay_s", b.mag_delay + f.delay},
                       {"mag_axes", b.axes.swapped ? report::Json(ahrs::axes_text(b.axes.C_bs)) : report::Json(nullptr)},
                       {"declination_deg", b.field_from_model ? in_degrees(b.declination) : report::Json(nullptr)}};
    out["samples"] = {{"gyro", count_of(r.counters.gyro)},
                      {"accelerometer", count_of(r.counters.accel)},
                      {"magnetometer", count_of(r.counters.field)},
                      {"blocks_at_rest", r.counters.rest_blocks},
                      {"blocks_disturbed", r.counters.disturbed_blocks},
                      {"field_learnt_anew", r.counters.recoveries},
                      {"magnets_found", r.counters.magnets}};
    out["calibration"] = b.calibration;
    out["gravity"] = nullptr;
    out["montecarlo"] = nullptr;
    out["timing"] = report::timing(b.timing, b.imu_epochs, b.timing.filter_s);
    out["ignored"] = report::ignored_json(b.ignored);
    out["warnings"] = b.warnings;
    return report::text_of(out);
}

std::string ahrs_summary_tables(const AhrsBundle& b) {
    const AhrsEvaluation& e = b.evaluation;
    std::string out = fmt::format("{}: {}{}{}, {} IMU epochs over {:.1f} s\n", b.name, b.filter, b.six_axis ? ", six axes" : "",
                                  b.offline ? ", offline" : "", b.imu_epochs,
                                  (b.result.rows.back().time - b.result.rows.front().time).seconds());
    if (e.broad.epochs > 0) {
        report::ResultTable table =
            report::table_for_people("", {"error in movement, rms", "total, deg", "heading, deg", "inclination, deg"});
        const auto add = [&](const char* name, double total, double heading) {
            table.rows.push_back({name, total / units::deg, heading / units::deg, e.broad.inclination / units::deg});
        };
        add("heading offset removed", e.broad.total, e.broad.heading);
        add("raw, as BROAD counts", e.broad.raw_total, e.broad.raw_heading);
        out += report::table_text(table);
    }
    for (const std::string& line : b.calibration) out += fmt::format("calibration of the {}\n", line);
    const ahrs::Counters& c = b.result.counters;
    out += fmt::format(
        "left out: {} gyro, {} accelerometer, {} magnetometer samples; {} blocks at rest, {} magnetically disturbed\n",
        c.gyro.rejected(), c.accel.rejected(), c.field.rejected(), c.rest_blocks, c.disturbed_blocks);
    return out;
}

}  // namespace schuler::app
