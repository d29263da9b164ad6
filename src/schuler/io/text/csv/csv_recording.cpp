#include "schuler/io/text/csv/csv_recording.h"

#include "schuler/core/units.h"
#include "schuler/io/text/detail/sample_rows.h"
#include "schuler/io/text/lonely_samples.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace schuler::io {
namespace {

using detail::RowAudit;
using detail::SampleColumns;

// Beyond the rotation or acceleration of any vehicle; larger values are another unit or another column.
constexpr double absurd_rate = 1e4;                         // rad/s
constexpr double absurd_acceleration = 1000.0 * units::g0;  // m/s^2
constexpr double absurd_angle_increment = 100.0;            // rad in one sample
constexpr double absurd_velocity_increment = 1000.0;        // m/s in one sample

using Axes = std::array<std::size_t, 3>;

Axes add_axes(SampleColumns& columns, const std::string& pattern, double si) {
    Axes fields{};
    for (std::size_t i = 0; i < 3; ++i) {
        std::string name = pattern;
        name.replace(name.find('@'), 1, 1, static_cast<char>('x' + i));
        fields[i] = columns.add(name, true, si);
    }
    return fields;
}

Eigen::Vector3d vector_of(const TableReader& reader, const Axes& fields) {
    return {reader.number(fields[0]), reader.number(fields[1]), reader.number(fields[2])};
}

void refuse_absurd(const TableReader& reader, const Axes& fields, const Eigen::Vector3d& value, double limit,
                   const std::string& unit, const std::string& hint) {
    for (int i = 0; i < 3; ++i) {
        if (std::abs(value(i)) <= limit) continue;
        throw reader.field_error(fields[static_cast<std::size_t>(i)],
                                 fmt::format("{:.6g} {} is beyond any instrument", value(i), unit), hint);
    }
}

/// Rates or increments, whichever columns are complete (rates if both are).
ImuKind kind_of(const SampleColumns& columns) {
    const auto count = [&](std::string_view a, std::string_view b) {
        int n = 0;
        for (const char axis : {'x', 'y', 'z'}) {
            for (std::string name : {std::string(a), std::string(b)}) {
                name.replace(name.find('@'), 1, 1, axis);
                n += columns.has(name) ? 1 : 0;
            }
        }
        return n;
    };
    return count("dtheta_@_rad", "dv_@_m_s") > count("gyro_@_rad_s", "accel_@_m_s2") ? ImuKind::Increments : ImuKind::Rates;
}

/// Leaves out samples whose numbers are no measurement.
void drop_lonely(std::vector<ImuSample>& samples, RowAudit& audit) {
    std::vector<double> rates, forces;
    rates.reserve(samples.size());
    forces.reserve(samples.size());
    for (const ImuSample& s : samples) {
        rates.push_back(s.gyro.cwiseAbs().maxCoeff());
        forces.push_back(s.accel.cwiseAbs().maxCoeff());
    }
    const std::vector<std::size_t> lonely = lonely_samples(rates, forces);
    if (lonely.empty()) return;
    for (const std::size_t i : lonely) samples[i].gyro.x() = not_given;
    std::erase_if(samples, [](const ImuSample& s) { return std::isnan(s.gyro.x()); });
    audit.counts().bad += lonely.size();
    audit.warn("lonely", "single samples skipped that are far beyond all others", lonely.size());
}

}  // namespace

ImuTable read_imu_csv(const TextInput& input, const CsvOptions& options, WarningLog& log) {
    SampleColumns columns(input, TableKind::Imu, options);
    ImuTable table;
    table.plan = columns.plan();
    table.kind = kind_of(columns);
    columns.add("time_s", true, 1.0, FieldKind::Time);
    const bool rates = table.kind == ImuKind::Rates;
    const Axes gyro = add_axes(columns, rates ? "gyro_@_rad_s" : "dtheta_@_rad", 1.0);
    const Axes accel = add_axes(columns, rates ? "accel_@_m_s2" : "dv_@_m_s", 1.0);
    const double gyro_limit = rates ? absurd_rate : absurd_angle_increment;
    const double accel_limit = rates ? absurd_acceleration : absurd_velocity_increment;

    TableReader reader = columns.reader();
    RowAudit audit(input.name(), columns.section(), log);
    const auto make = [&](const TableReader& row, ImuSample& sample) {
        sample.gyro = vector_of(row, gyro);
        sample.accel = vector_of(row, accel);
        if (sample.gyro.cwiseAbs().maxCoeff() > gyro_limit) [[unlikely]] {
            refuse_absurd(
                row, gyro, sample.gyro, gyro_limit, rates ? "rad/s" : "rad in one sample",
                rates ? "is the unit deg/s? write [imu] scale = { gyro_rad_s = 0.017453292519943295 }, or name the right column"
                      : "are these rates? name the columns gyro_x_rad_s or gyro_x_deg_s, ... in [imu] columns");
        }
        if (sample.accel.cwiseAbs().maxCoeff() > accel_limit) [[unlikely]] {
            refuse_absurd(
                row, accel, sample.accel, accel_limit, rates ? "m/s2" : "m/s in one sample",
                rates ? "is the unit mg or a raw count? write [imu] scale = { accel_m_s2 = ... }, or name the right column"
                      : "are these accelerations? name the columns accel_x_m_s2, ... in [imu] columns");
        }
        return true;
    };
    table.samples = detail::read_samples<ImuSample>(reader, audit, columns.layout().estimated_rows, options.time_offset, make);
    if (rates) drop_lonely(table.samples, audit);
    detail::put_in_time_order(table.samples, audit,
                              [](const ImuSample& a, const ImuSample& b) { return a.gyro == b.gyro && a.accel == b.accel; });
    table.rows = audit.counts();
    return table;
}

BaroTable read_baro_csv(const TextInput& input, const CsvOptions& options, WarningLog& log) {
    SampleColumns columns(input, TableKind::Baro, options);
    BaroTable table;
    table.plan = columns.plan();
    columns.add("time_s", true, 1.0, FieldKind::Time);
    const bool has_height = columns.has("height_m"), has_pressure = columns.has("pressure_pa");
    if (!has_height && !has_pressure) throw columns.missing("pressure_pa");
    if (has_height) table.height = columns.plan().find("height_m")->height;
    const std::size_t height = columns.add("height_m", has_height && !has_pressure);
    const std::size_t pressure = columns.add("pressure_pa", has_pressure && !has_height);

    TableReader reader = columns.reader();
    RowAudit audit(input.name(), columns.section(), log);
    const auto make = [&](const TableReader& row, BaroSample& sample) {
        if (has_height) sample.height = row.number(height);
        if (has_pressure) sample.pressure = row.number(pressure);
        if (std::isnan(sample.height) && std::isnan(sample.pressure)) {
            audit.bad_row(row, has_pressure ? pressure : height);
            return false;
        }
        if (std::abs(sample.height) > 1e5) {
            throw row.field_error(height, fmt::format("{:.6g} m is beyond the atmosphere", sample.height),
                                  "is the unit mm or cm? write [baro] scale = { height_m = 0.001 }, or name the right column");
        }
        if (sample.pressure < 500.0 || sample.pressure > 2e5) {
            throw row.field_error(
                pressure, fmt::format("{:.6g} Pa is not a valid air pressure", sample.pressure),
                "is the unit hPa or kPa? write [baro] scale = { pressure_pa = 100 } or 1000, or name the right column");
        }
        return true;
    };
    table.samples = detail::read_samples<BaroSample>(reader, audit, columns.layout().estimated_rows, options.time_offset, make);
    detail::put_in_time_order(table.samples, audit, [](const BaroSample& a, const BaroSample& b) {
        return detail::same_value(a.height, b.height) && detail::same_value(a.pressure, b.pressure);
    });
    table.rows = audit.counts();
    return table;
}

MagTable read_mag_csv(const TextInput& input, const CsvOptions& options, WarningLog& log) {
    SampleColumns columns(input, TableKind::Mag, options);
    MagTable table;
    table.plan = columns.plan();
    columns.add("time_s", true, 1.0, FieldKind::Time);
    const Axes field = add_axes(columns, "mag_@_ut", units::microtesla);

    TableReader reader = columns.reader();
    RowAudit audit(input.name(), columns.section(), log);
    const auto make = [&](const TableReader& row, MagSample& sample) {
        sample.field_b = vector_of(row, field);
        refuse_absurd(
            row, field, sample.field_b, 0.1, "T",
            "is the unit nT or mgauss? write [mag] scale = { mag_ut = 0.001 } (nT) or 0.1 (mgauss), or name the right column");
        return true;
    };
    table.samples = detail::read_samples<MagSample>(reader, audit, columns.layout().estimated_rows, options.time_offset, make);
    detail::put_in_time_order(table.samples, audit,
                              [](const MagSample& a, const MagSample& b) { return a.field_b == b.field_b; });
    table.rows = audit.counts();
    return table;
}

}  // namespace schuler::io
