#include "schuler/core/units.h"
#include "schuler/io/container/hdf5_file.h"
#include "schuler/io/container/mat_file.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/report/run_mat.h"
#include "schuler/report/sky.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/events.h"

#include <span>

namespace schuler::report {
namespace {

using Eigen::Vector3d;

/// One table of a group: rows of triples, or wider ones, collected from a range.
template <class Rows, class Fill>
void add_table(io::TableWriter& file, const std::string& path, const Rows& rows, std::size_t columns, const std::string& names,
               const std::string& units, Fill fill) {
    std::vector<double> values;
    values.reserve(rows.size() * columns);
    for (const auto& row : rows) fill(row, values);
    file.table(path, values, columns, {{"columns", names}, {"units", units}});
}

void push(std::vector<double>& out, const Vector3d& v, double unit = 1.0) {
    for (int i = 0; i < 3; ++i) out.push_back(v[i] / unit);
}

template <class Rows>
void add_times(io::TableWriter& file, const std::string& group, const Rows& rows) {
    std::vector<std::int64_t> ns;
    std::vector<double> s;
    for (const auto& row : rows) {
        ns.push_back(row.time.ns);
        s.push_back(row.time.seconds());
    }
    file.integers(group + "/time_ns", ns, {{"units", "ns"}});
    file.table(group + "/time_s", s, 1, {{"units", "s"}});
}

void add_solution(io::TableWriter& file, const std::string& group, const std::vector<SolutionRow>& rows,
                  const std::vector<Time>& legs = {}) {
    if (rows.empty()) return;
    add_times(file, group, rows);
    if (legs.size() > 1) {
        std::vector<double> leg;
        for (const SolutionRow& r : rows) leg.push_back(io::leg_at(legs, r.time));
        file.table(group + "/leg", leg, 1, {});
    }
    add_table(file, group + "/position", rows, 3, "lat,lon,height", "deg,deg,m",
              [](const SolutionRow& r, std::vector<double>& out) {
                  push(out, {r.position.lat / units::deg, r.position.lon / units::deg, r.position.h});
              });
    add_table(file, group + "/velocity", rows, 3, "north,east,down", "m/s",
              [](const SolutionRow& r, std::vector<double>& out) { push(out, r.v_eb_n); });
    add_table(file, group + "/attitude", rows, 3, "roll,pitch,heading", "deg",
              [](const SolutionRow& r, std::vector<double>& out) { push(out, r.rpy, units::deg); });
    add_table(file, group + "/std_position", rows, 3, "north,east,down", "m",
              [](const SolutionRow& r, std::vector<double>& out) { push(out, r.std_position); });
    add_table(file, group + "/std_velocity", rows, 3, "north,east,down", "m/s",
              [](const SolutionRow& r, std::vector<double>& out) { push(out, r.std_velocity); });
    add_table(file, group + "/std_attitude", rows, 3, "roll,pitch,heading", "deg",
              [](const SolutionRow& r, std::vector<double>& out) { push(out, r.std_rpy, units::deg); });
}

/// The solution at the user's output point, and at events.
void add_chosen(io::TableWriter& file, const solution::ResultBundle& b) {
    const Eigen::Vector3d& arm = b.data.config.filter.output_lever_arm_b;
    const std::string lever_arm = fmt::format("{},{},{}", arm.x(), arm.y(), arm.z());
    if (!b.solution().point.empty()) {
        add_solution(file, "/point", b.solution().point);
        file.attribute("/point", "lever_arm_m", lever_arm);
    }
    const solution::EventRows events = solution::event_rows(b);
    if (events.rows.empty() || b.data.config.scheme == settings::Scheme::Gnss) return;
    add_solution(file, "/events", events.rows);
    file.attribute("/events", "lever_arm_m", lever_arm);
    std::vector<std::int64_t> lines;
    for (const NamedInstant& e : events.events) lines.push_back(e.line);
    file.integers("/events/line", lines, {{"units", "line of output.events"}});
}

void add_separation(io::TableWriter& file, const std::vector<analysis::SeparationRow>& rows) {
    using Row = analysis::SeparationRow;
    if (rows.empty()) return;
    add_times(file, "/separation", rows);
    const auto add = [&](const char* name, const char* columns, const char* unit, double si, Vector3d Row::*value,
                         Vector3d Row::*sigma) {
        const std::string group = "/separation/";
        add_table(file, group + name, rows, 3, columns, unit,
                  [=](const Row& r, std::vector<double>& out) { push(out, r.*value, si); });
        add_table(file, group + "std_" + name, rows, 3, columns, unit,
                  [=](const Row& r, std::vector<double>& out) { push(out, r.*sigma, si); });
    };
    add("position", "north,east,down", "m", 1.0, &Row::position, &Row::std_position);
    add("velocity", "north,east,down", "m/s", 1.0, &Row::velocity, &Row::std_velocity);
    add("attitude", "roll,pitch,heading", "deg", units::deg, &Row::rpy, &Row::std_rpy);
}

void add_sensor_errors(io::TableWriter& file, const std::string& group, const std::vector<fusion::SensorErrorRow>& rows) {
    using Row = fusion::SensorErrorRow;
    if (rows.empty()) return;
    add_times(file, group, rows);
    const auto add = [&](const char* name, const char* unit, double si, Vector3d Row::*value, Vector3d Row::*sigma) {
        add_table(file, group + "/" + name, rows, 3, "x,y,z", unit,
                  [=](const Row& r, std::vector<double>& out) { push(out, r.*value, si); });
        add_table(file, group + "/std_" + name, rows, 3, "x,y,z", unit,
                  [=](const Row& r, std::vector<double>& out) { push(out, r.*sigma, si); });
    };
    add("gyro_bias", "deg/h", units::deg_per_hour, &Row::gyro_bias, &Row::std_gyro_bias);
    add("accel_bias", "mg", units::mg, &Row::accel_bias, &Row::std_accel_bias);
    add("gyro_scale_factor", "ppm", units::ppm, &Row::gyro_scale, &Row::std_gyro_scale);
    add("accel_scale_factor", "ppm", units::ppm, &Row::accel_scale, &Row::std_accel_scale);
}

/// Estimates and sigmas of every block of states after the navigation states, in SI units.
void add_states(io::TableWriter& file, const std::string& group, const std::vector<filter::LayoutBlock>& states,
                const std::vector<filter::ParameterRow>& rows) {
    constexpr int navigation = filter::Layout::navigation;
    if (rows.empty()) return;
    add_times(file, group, rows);
    for (const filter::LayoutBlock& block : states) {
        if (block.offset < navigation) continue;
        const auto first = static_cast<std::ptrdiff_t>(block.offset - navigation);
        const auto add = [&](const std::string& name, std::vector<double> filter::ParameterRow::*values) {
            add_table(file, group + "/" + name, rows, static_cast<std::size_t>(block.size), std::string(block.name),
                      std::string(block.unit), [=](const filter::ParameterRow& r, std::vector<double>& out) {
                          const auto begin = (r.*values).begin() + first;
                          out.insert(out.end(), begin, begin + block.size);
                      });
        };
        add(std::string(block.name), &filter::ParameterRow::value);
        add("std_" + std::string(block.name), &filter::ParameterRow::std);
    }
}

/// The satellite or station of each slot of the slow errors of ranges, as an index into the attribute `sources`, -1: none. The slots
/// of a smoothed row are those of the forward row before it.
void add_range_slots(io::TableWriter& file, const std::string& group, const RangingLog& log,
                     const std::vector<filter::ParameterRow>& forward, const std::vector<filter::ParameterRow>& rows) {
    if (rows.empty() || forward.empty() || forward.front().sources.empty()) return;
    std::string names;
    for (const RangeSource& s : log.sources) names += (names.empty() ? "" : ",") + s.name;
    std::vector<double> values;
    auto at = forward.begin();
    for (const filter::ParameterRow& row : rows) {
        while (at + 1 != forward.end() && (at + 1)->time <= row.time) ++at;
        values.insert(values.end(), at->sources.begin(), at->sources.end());
    }
    file.table(group + "/range_slow_error_source", values, forward.front().sources.size(),
               {{"columns", "range_slow_error_source"}, {"units", "1"}, {"sources", names}});
}

/// Full covariances, epochs x n x n; the attribute `states` names their rows and columns.
/// `axes`: of position, velocity and attitude.
void add_covariances(io::TableWriter& file, const std::string& name, const std::string& axes, const fusion::Result& result,
                     const std::vector<filter::CovarianceRow>& rows) {
    if (rows.empty()) return;
    std::string names;
    std::size_t size = 0;
    for (const filter::LayoutBlock& block : result.states) {
        for (int i = 0; i < block.size; ++i) names += fmt::format("{}{}_{}", names.empty() ? "" : ",", block.name, i + 1);
        size += static_cast<std::size_t>(block.size);
    }
    std::vector<double> values;
    values.reserve(rows.size() * size * size);
    for (const filter::CovarianceRow& row : rows) values.insert(values.end(), row.covariance.begin(), row.covariance.end());
    file.matrices(name, values, size, {{"states", names}, {"units", "SI"}, {"axes", axes}});
    std::vector<double> times;
    for (const filter::CovarianceRow& row : rows) times.push_back(row.time.seconds());
    file.table(name + "_time_s", times, 1, {{"units", "s"}});
}

void add_sensor_truth(io::TableWriter& file, const std::vector<sim::SensorTruth>& rows) {
    if (rows.empty()) return;
    add_times(file, "/sensor_truth", rows);
    add_table(file, "/sensor_truth/gyro_bias", rows, 3, "x,y,z", "deg/h",
              [](const sim::SensorTruth& r, std::vector<double>& out) { push(out, r.gyro_bias, units::deg_per_hour); });
    add_table(file, "/sensor_truth/accel_bias", rows, 3, "x,y,z", "mg",
              [](const sim::SensorTruth& r, std::vector<double>& out) { push(out, r.accel_bias, units::mg); });
}

/// The fixes as given by the receiver, at the antenna.
void add_fixes(io::TableWriter& file, const std::vector<GnssFix>& rows) {
    if (rows.empty()) return;
    add_times(file, "/gnss", rows);
    add_table(file, "/gnss/position", rows, 3, "lat,lon,height", "deg,deg,m", [](const GnssFix& r, std::vector<double>& out) {
        push(out, {r.position.lat / units::deg, r.position.lon / units::deg, r.position.h});
    });
    add_table(file, "/gnss/quality", rows, 4, "fix,satellites,std_horizontal,std_down", "1,1,m,m",
              [](const GnssFix& r, std::vector<double>& out) {
                  out.insert(out.end(),
                             {static_cast<double>(r.fix), r.satellites >= 0 ? static_cast<double>(r.satellites) : not_given,
                              r.std_position.head<2>().maxCoeff(), r.std_position.z()});
              });
}

void add_innovations(io::TableWriter& file, const std::vector<fusion::MeasurementRecord>& records) {
    for (const filter::MeasurementInfo& info : filter::measurement_infos) {
        std::vector<fusion::MeasurementRecord> rows;
        for (const fusion::MeasurementRecord& r : records) {
            if (r.kind == info.kind) rows.push_back(r);
        }
        if (rows.empty()) continue;
        const std::string group = "/innovations/" + std::string(info.key);
        std::string components;
        for (const std::string_view c : info.components)
            components += fmt::format("{}{}", components.empty() ? "" : ",", c.empty() ? "unused" : c);
        add_times(file, group, rows);
        add_table(file, group + "/innovation", rows, 3, components, "SI",
                  [](const fusion::MeasurementRecord& r, std::vector<double>& out) { push(out, r.innovation); });
        add_table(file, group + "/sigma", rows, 3, components, "SI",
                  [](const fusion::MeasurementRecord& r, std::vector<double>& out) { push(out, r.sigma); });
        add_table(file, group + "/gate", rows, 3, "nis,dof,status (0 accepted 1 rejected 2 withheld 3 excluded)", "1",
                  [](const fusion::MeasurementRecord& r, std::vector<double>& out) {
                      push(out, {r.nis, static_cast<double>(r.dof), static_cast<double>(r.status)});
                  });
    }
}

/// One row per source and epoch; the names of the sources are an attribute of the table, in the order of their numbers.
void add_sky(io::TableWriter& file, const RangingLog& log, const std::vector<SkyRow>& rows) {
    if (rows.empty()) return;
    add_times(file, "/sky", rows);
    add_table(file, "/sky/source", rows, 2, "number,station", "1", [](const SkyRow& r, std::vector<double>& out) {
        out.push_back(r.source);
        out.push_back(r.station ? 1.0 : 0.0);
    });
    add_table(file, "/sky/direction", rows, 2, "azimuth,elevation", "deg", [](const SkyRow& r, std::vector<double>& out) {
        out.push_back(r.azimuth / units::deg);
        out.push_back(r.elevation / units::deg);
    });
    add_table(file, "/sky/range", rows, 3, "status (0 used 1 rejected 2 not asked),residual,sigma", "1,m,m",
              [](const SkyRow& r, std::vector<double>& out) {
                  push(out, {static_cast<double>(r.use), r.residual, r.sigma});
              });
    std::string names;
    for (const RangeSource& s : log.sources) names += (names.empty() ? "" : ",") + s.name;
    file.attribute("/sky/source", "names", names);
}

void add_errors(io::TableWriter& file, const std::string& group, const std::vector<analysis::ErrorRow>& rows) {
    using Row = analysis::ErrorRow;
    if (rows.empty()) return;
    add_times(file, group, rows);
    const auto add = [&](const char* name, const char* columns, const char* unit, double si, Vector3d Row::*value,
                         Vector3d Row::*sigma) {
        add_table(file, group + "/" + name, rows, 3, columns, unit,
                  [=](const Row& r, std::vector<double>& out) { push(out, r.*value, si); });
        add_table(file, group + "/std_" + name, rows, 3, columns, unit,
                  [=](const Row& r, std::vector<double>& out) { push(out, r.*sigma, si); });
    };
    add("position", "east,north,up", "m", 1.0, &Row::position, &Row::std_position);
    add("velocity", "east,north,up", "m/s", 1.0, &Row::velocity, &Row::std_velocity);
    add("attitude", "roll,pitch,heading", "deg", units::deg, &Row::rpy, &Row::std_rpy);
}

void add_reference(io::TableWriter& file, const std::vector<ReferenceSample>& rows) {
    if (rows.empty()) return;
    add_times(file, "/reference", rows);
    add_table(file, "/reference/position", rows, 3, "lat,lon,height", "deg,deg,m",
              [](const ReferenceSample& r, std::vector<double>& out) {
                  push(out, {r.position.lat / units::deg, r.position.lon / units::deg, r.position.h});
              });
    add_table(file, "/reference/velocity", rows, 3, "north,east,down", "m/s",
              [](const ReferenceSample& r, std::vector<double>& out) { push(out, r.velocity_n); });
    add_table(file, "/reference/attitude", rows, 3, "roll,pitch,heading", "deg",
              [](const ReferenceSample& r, std::vector<double>& out) { push(out, r.rpy, units::deg); });
}

void add_outages(io::TableWriter& file, const std::string& group, const std::vector<fusion::OutageEpoch>& rows) {
    if (rows.empty()) return;
    add_times(file, group, rows);
    add_table(file, group + "/error", rows, 3, "north,east,down", "m",
              [](const fusion::OutageEpoch& r, std::vector<double>& out) { push(out, r.error); });
    add_table(file, group + "/sigma", rows, 3, "north,east,down", "m",
              [](const fusion::OutageEpoch& r, std::vector<double>& out) { push(out, r.sigma); });
    add_table(file, group + "/outage", rows, 2, "outage,end", "1", [](const fusion::OutageEpoch& r, std::vector<double>& out) {
        out.push_back(r.outage);
        out.push_back(r.end ? 1.0 : 0.0);
    });
}

void write_run(io::TableWriter& file, const solution::ResultBundle& b) {
    add_solution(file, "/solution", b.solution().rows, b.result.legs);
    if (b.smoothed()) add_solution(file, "/forward", b.result.forward.rows, b.result.legs);
    add_chosen(file, b);
    add_solution(file, "/backward", b.result.backward);
    add_separation(file, b.evaluation.separation);
    add_sensor_errors(file, "/sensor_errors", b.solution().sensor_errors);
    add_states(file, "/states", b.result.states, b.solution().parameters);
    add_range_slots(file, "/states", b.data.recording.ranges, b.result.forward.parameters, b.solution().parameters);
    const bool ecef = b.data.config.filter.mechanization == fusion::Mechanization::Ecef;
    const std::string axes = ecef ? "Earth-fixed x,y,z" : "north,east,down";
    add_covariances(file, "/covariance", axes, b.result, b.result.forward.covariances);
    add_covariances(file, "/covariance_smoothed", axes, b.result, b.result.smoothed.covariances);
    add_sensor_truth(file, b.truth.sensors);
    add_fixes(file, b.data.recording.gnss);
    add_innovations(file, b.result.measurements);
    add_sky(file, b.data.recording.ranges, sky_rows(b));
    add_outages(file, "/outages", b.solution().outage_epochs);
    add_reference(file, b.reference());
    add_errors(file, "/errors", b.evaluation.errors);
    add_errors(file, "/errors_forward", b.evaluation.errors_forward);
    file.attribute("/", "name", b.name);
    file.attribute("/", "version", b.version);
    file.attribute("/", "config", b.config_toml);
    file.attribute("/", "origin_s", fmt::format("{}", b.data.origin.seconds()));
    file.commit();
}

}  // namespace

void write_run_h5(const std::filesystem::path& path, const solution::ResultBundle& b) {
    io::Hdf5Writer file(path);
    write_run(file, b);
}

void write_run_mat(const std::filesystem::path& path, const solution::ResultBundle& b) {
    io::MatWriter file(path);
    write_run(file, b);
}

}  // namespace schuler::report
