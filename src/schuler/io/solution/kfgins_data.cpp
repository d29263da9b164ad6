#include "schuler/core/units.h"
#include "schuler/io/place.h"
#include "schuler/io/solution/kfgins.h"
#include "schuler/io/text/detail/sample_rows.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace schuler::io {
namespace {

using detail::RowAudit;

/// Requests for columns known by position.
std::vector<FieldRequest> by_place(std::initializer_list<const char*> names, std::size_t required) {
    std::vector<FieldRequest> requests;
    for (const char* name : names) {
        FieldRequest r;
        r.column = static_cast<int>(requests.size());
        r.name = name;
        r.required = requests.size() < required;
        if (requests.empty()) r.kind = FieldKind::Time;
        requests.push_back(std::move(r));
    }
    return requests;
}

TableLayout layout_of(const TextInput& input, int columns, const char* what) {
    TableLayout layout = inspect_table(input);
    if (layout.first_data_line == 0 || layout.data_columns < columns) {
        throw input_error(fmt::format("has {} columns, not the {} of KF-GINS {} text", layout.data_columns, columns, what),
                          place_in(input.name(), std::max(layout.first_data_line, layout.header_line)),
                          std::string(what) == "IMU"
                              ? "it must be: time, angle increments x y z, velocity increments x y z"
                              : "it must be: time, latitude, longitude, height, three standard deviations");
    }
    return layout;
}

}  // namespace

KfGinsImu read_kfgins_imu(const TextInput& input, WarningLog& log, Duration time_offset) {
    const TableLayout layout = layout_of(input, 7, "IMU");
    TableReader reader(input, layout, by_place({"time", "dtheta_x", "dtheta_y", "dtheta_z", "dvel_x", "dvel_y", "dvel_z"}, 7));
    RowAudit audit(input.name(), "imu", log);
    const auto make = [](const TableReader& row, ImuSample& sample) {
        sample.gyro = {row.number(1), row.number(2), row.number(3)};
        sample.accel = {row.number(4), row.number(5), row.number(6)};
        if (sample.gyro.cwiseAbs().maxCoeff() > 10.0) [[unlikely]] {
            throw row.field_error(1, "an angle increment of more than 10 rad in one sample",
                                  "the columns must be increments in rad, not rates or degrees");
        }
        if (sample.accel.cwiseAbs().maxCoeff() > 1000.0) [[unlikely]] {
            throw row.field_error(4, "a velocity increment of more than 1000 m/s in one sample",
                                  "the columns must be increments in m/s");
        }
        return true;
    };
    KfGinsImu imu;
    imu.samples = detail::read_samples<ImuSample>(reader, audit, layout.estimated_rows, time_offset, make);
    detail::put_in_time_order(imu.samples, audit,
                              [](const ImuSample& a, const ImuSample& b) { return a.gyro == b.gyro && a.accel == b.accel; });
    imu.rows = audit.counts();
    return imu;
}

KfGinsGnss read_kfgins_gnss(const TextInput& input, WarningLog& log, Duration time_offset) {
    const TableLayout layout = layout_of(input, 4, "GNSS");
    const bool velocity = layout.data_columns >= 13;
    std::vector<FieldRequest> requests = by_place({"time", "latitude", "longitude", "height", "std_n", "std_e", "std_d", "vel_n",
                                                   "vel_e", "vel_d", "std_vn", "std_ve", "std_vd"},
                                                  4);
    if (!velocity) requests.resize(7);
    TableReader reader(input, layout, requests);
    RowAudit audit(input.name(), "gnss", log);
    const auto make = [velocity](const TableReader& row, GnssFix& fix) {
        if (std::abs(row.number(1)) > 90.0)
            throw row.field_error(1, fmt::format("a latitude of {:.8g} deg", row.number(1)),
                                  "the columns must be time, latitude, longitude (deg), height");
        if (std::abs(row.number(2)) > 360.0)
            throw row.field_error(2, fmt::format("a longitude of {:.8g} deg", row.number(2)),
                                  "the columns must be time, latitude, longitude (deg), height");
        fix.position = {row.number(1) * units::deg, row.number(2) * units::deg, row.number(3)};
        if (std::abs(fix.position.lon) > std::numbers::pi)
            fix.position.lon = std::remainder(fix.position.lon, 2.0 * std::numbers::pi);
        fix.std_position = {row.number(4), row.number(5), row.number(6)};
        if (velocity) {
            fix.velocity_n = {row.number(7), row.number(8), row.number(9)};
            fix.std_velocity = {row.number(10), row.number(11), row.number(12)};
        }
        return true;
    };
    KfGinsGnss gnss;
    gnss.fixes = detail::read_samples<GnssFix>(reader, audit, layout.estimated_rows, time_offset, make);
    detail::put_in_time_order(gnss.fixes, audit, [](const GnssFix& a, const GnssFix& b) {
        return a.position.lat == b.position.lat && a.position.lon == b.position.lon && a.position.h == b.position.h;
    });
    gnss.rows = audit.counts();
    return gnss;
}

}  // namespace schuler::io
