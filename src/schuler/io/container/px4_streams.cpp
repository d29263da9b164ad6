// PX4's topics as instruments: names and units of its message definitions.
#include "schuler/io/container/raw_table.h"

#include "schuler/core/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::io {
namespace {

constexpr double gauss = 100.0;  // microtesla

/// Stamps beyond 285 years are damaged: omitted as stray stamps by the readers of rows.
std::int64_t ns_of(double microseconds) {
    constexpr double most = 9e15;
    return std::isnan(microseconds) ? 0 : std::llround(std::clamp(microseconds, -most, most)) * 1000;
}

std::string label(const RawTable& t) { return t.instance > 0 ? fmt::format("{}[{}]", t.name, t.instance) : t.name; }

using Columns = std::array<const std::vector<double>*, 3>;

bool complete(const Columns& c) {
    return std::ranges::none_of(c, [](const auto* column) { return column == nullptr; });
}

Columns vector_fields(const RawTable& t, std::string_view name) {
    return {t.find(fmt::format("{}[0]", name)), t.find(fmt::format("{}[1]", name)), t.find(fmt::format("{}[2]", name))};
}
Columns xyz_fields(const RawTable& t) { return {t.find("x"), t.find("y"), t.find("z")}; }

constexpr std::initializer_list<const char*> imu_columns = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s",
                                                            "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"};

void add_imu(const RawTables& tables, StreamLog& log) {
    for (const RawTable* t : tables_named(tables, "sensor_combined")) {
        const auto* time = t->find("timestamp");
        const Columns w = vector_fields(*t, "gyro_rad"), f = vector_fields(*t, "accelerometer_m_s2");
        if (time == nullptr || !complete(w) || !complete(f)) continue;
        Stream s("imu", TableKind::Imu, label(*t), imu_columns);
        for (std::size_t i = 0; i < t->rows(); ++i)
            s.add(ns_of((*time)[i]), {(*w[0])[i], (*w[1])[i], (*w[2])[i], (*f[0])[i], (*f[1])[i], (*f[2])[i]});
        log.add(std::move(s));
    }
    // Single sensors: the accelerometer of the same number, at the times of the gyroscope.
    const auto accels = tables_named(tables, "sensor_accel");
    for (const RawTable* t : tables_named(tables, "sensor_gyro")) {
        const auto other = std::ranges::find(accels, t->instance, &RawTable::instance);
        const Columns w = xyz_fields(*t);
        const auto* time = t->find({"timestamp_sample", "timestamp"});
        if (other == accels.end() || time == nullptr || !complete(w)) continue;
        const Columns f = xyz_fields(**other);
        const auto* accel_time = (*other)->find({"timestamp_sample", "timestamp"});
        if (accel_time == nullptr || !complete(f)) continue;
        std::array<std::vector<double>, 3> at_gyro;
        for (std::size_t k = 0; k < 3; ++k) at_gyro[k] = interpolated(*time, *accel_time, *f[k], 1e5);
        Stream s("imu_raw", TableKind::Imu, fmt::format("{} with sensor_accel", label(*t)), imu_columns);
        for (std::size_t i = 0; i < t->rows(); ++i)
            s.add(ns_of((*time)[i]), {(*w[0])[i], (*w[1])[i], (*w[2])[i], at_gyro[0][i], at_gyro[1][i], at_gyro[2][i]});
        log.add(std::move(s));
    }
}

FixType fix_of(double type) {
    static constexpr std::array types = {FixType::None,         FixType::None,     FixType::Autonomous, FixType::Autonomous,
                                         FixType::Differential, FixType::RtkFloat, FixType::RtkFixed};
    return type >= 0.0 && type < static_cast<double>(types.size()) ? types[static_cast<std::size_t>(type)] : FixType::Unknown;
}

double value(const std::vector<double>* column, std::size_t i, double factor = 1.0) {
    return column == nullptr ? not_given : (*column)[i] * factor;
}

void add_gnss(const RawTable& t, StreamLog& log) {
    const auto *time = t.find({"timestamp_sample", "timestamp"}), *arrival = t.find("timestamp"), *lat7 = t.find("lat"),
               *lon7 = t.find("lon"), *lat = t.find("latitude_deg"), *lon = t.find("longitude_deg");
    if (time != nullptr && std::ranges::none_of(*time, [](double v) { return v > 0.0; })) time = arrival;
    const bool fine = lat != nullptr && lon != nullptr;
    if (time == nullptr || (!fine && (lat7 == nullptr || lon7 == nullptr))) return;
    const auto *ellipsoid_mm = t.find("alt_ellipsoid"), *msl_mm = t.find("alt"), *ellipsoid = t.find("altitude_ellipsoid_m"),
               *msl = t.find("altitude_msl_m");
    // simulators and some drivers set the ellipsoidal height to zero
    const auto given = [](const std::vector<double>* c) {
        return c != nullptr && std::ranges::any_of(*c, [](double v) { return v != 0.0; });
    };
    const bool above_ellipsoid = fine ? given(ellipsoid) : given(ellipsoid_mm);
    const auto* height = fine ? (above_ellipsoid ? ellipsoid : msl) : above_ellipsoid ? ellipsoid_mm : msl_mm;
    const auto *eph = t.find("eph"), *epv = t.find("epv"), *speed = t.find("s_variance_m_s"), *type = t.find("fix_type"),
               *satellites = t.find("satellites_used");
    const Columns v = {t.find("vel_n_m_s"), t.find("vel_e_m_s"), t.find("vel_d_m_s")};
    const auto* valid = t.find("vel_ned_valid");
    Stream s("gnss", TableKind::Gnss, label(t),
             {"lat_deg", "lon_deg", above_ellipsoid ? "height_ellipsoidal_m" : "height_msl_m", "vel_n_m_s", "vel_e_m_s",
              "vel_d_m_s", "std_h_m", "std_d_m", "std_vel_m_s", "satellites"});
    for (std::size_t i = 0; i < t.rows(); ++i) {
        const bool moving = complete(v) && (valid == nullptr || (*valid)[i] != 0.0);
        // eph and epv of 0 or above a kilometre are written by drivers for "unknown"
        const auto sigma = [&](const std::vector<double>* c) {
            const double x = value(c, i);
            return x > 0.0 && x < 1000.0 ? x : not_given;
        };
        s.add(ns_of((*time)[i]),
              {fine ? (*lat)[i] : (*lat7)[i] * 1e-7, fine ? (*lon)[i] : (*lon7)[i] * 1e-7, value(height, i, fine ? 1.0 : 1e-3),
               moving ? (*v[0])[i] : not_given, moving ? (*v[1])[i] : not_given, moving ? (*v[2])[i] : not_given, sigma(eph),
               sigma(epv), sigma(speed), value(satellites, i)});
        s.fix.push_back(type == nullptr ? FixType::Unknown : fix_of((*type)[i]));
    }
    log.add(std::move(s));
}

void add_baro(const RawTables& tables, StreamLog& log) {
    for (const char* name : {"vehicle_air_data", "sensor_baro", "sensor_combined"}) {  // the last one until 2018
        for (const RawTable* t : tables_named(tables, name)) {
            const auto *time = t->find({"timestamp_sample", "timestamp"}), *height = t->find({"baro_alt_meter", "altitude"});
            if (time != nullptr && std::ranges::none_of(*time, [](double v) { return v > 0.0; })) time = t->find("timestamp");
            const auto* pressure = t->find({"baro_pressure_pa", "pressure"});
            if (time == nullptr || (height == nullptr && pressure == nullptr)) continue;
            Stream s("baro", TableKind::Baro, label(*t), {"height_m", "pressure_pa"});
            for (std::size_t i = 0; i < t->rows(); ++i) {
                const double p = value(pressure, i);  // millibars until 2022, then pascals
                s.add(ns_of((*time)[i]), {value(height, i), p < 2000.0 ? 100.0 * p : p});
            }
            log.add(std::move(s));
        }
    }
}

void add_mag(const RawTables& tables, StreamLog& log) {
    const auto add = [&](const RawTable& t, const Columns& m) {
        const auto* time = t.find("timestamp");
        if (time == nullptr || !complete(m)) return;
        Stream s("mag", TableKind::Mag, label(t), {"mag_x_ut", "mag_y_ut", "mag_z_ut"});
        for (std::size_t i = 0; i < t.rows(); ++i)
            s.add(ns_of((*time)[i]), {gauss * (*m[0])[i], gauss * (*m[1])[i], gauss * (*m[2])[i]});
        log.add(std::move(s));
    };
    for (const RawTable* t : tables_named(tables, "vehicle_magnetometer")) add(*t, vector_fields(*t, "magnetometer_ga"));
    for (const RawTable* t : tables_named(tables, "sensor_mag")) add(*t, xyz_fields(*t));
    for (const RawTable* t : tables_named(tables, "sensor_combined")) add(*t, vector_fields(*t, "magnetometer_ga"));
}

/// The autopilot's own attitude, with its velocity and position at the same times.
void add_reference(const RawTables& tables, StreamLog& log) {
    const auto attitudes = tables_named(tables, "vehicle_attitude");
    if (attitudes.empty()) return;
    const RawTable& t = *attitudes.front();
    const auto* time = t.find("timestamp");
    const std::array<const std::vector<double>*, 4> q = {t.find("q[0]"), t.find("q[1]"), t.find("q[2]"), t.find("q[3]")};
    if (time == nullptr || std::ranges::any_of(q, [](const auto* c) { return c == nullptr; })) return;
    std::array<std::vector<double>, 6> rest;
    rest.fill(std::vector<double>(t.rows(), not_given));
    constexpr double reach = 5e5;  // us
    const auto fill = [&](const char* topic, std::initializer_list<const char*> names, std::size_t first) {
        const auto others = tables_named(tables, topic);
        if (others.empty() || others.front()->find("timestamp") == nullptr) return;
        for (const char* name : names) {
            if (const auto* column = others.front()->find(name))
                rest[first] = interpolated(*time, *others.front()->find("timestamp"), *column, reach);
            ++first;
        }
    };
    fill("vehicle_local_position", {"vx", "vy", "vz"}, 3);
    fill("vehicle_global_position", {"lat", "lon", "alt"}, 0);
    Stream s("reference", TableKind::Reference, "vehicle_attitude, vehicle_local_position, vehicle_global_position",
             {"onboard_lat_deg", "onboard_lon_deg", "onboard_height_msl_m", "onboard_vel_n_m_s", "onboard_vel_e_m_s",
              "onboard_vel_d_m_s", "onboard_quat_body_to_ned_w", "onboard_quat_body_to_ned_x", "onboard_quat_body_to_ned_y",
              "onboard_quat_body_to_ned_z"});
    for (std::size_t i = 0; i < t.rows(); ++i)
        s.add(ns_of((*time)[i]), {rest[0][i], rest[1][i], rest[2][i], rest[3][i], rest[4][i], rest[5][i], (*q[0])[i], (*q[1])[i],
                                  (*q[2])[i], (*q[3])[i]});
    log.add(std::move(s));
}

constexpr std::array<std::string_view, 13> topics = {"sensor_combined",
                                                     "sensor_gyro",
                                                     "sensor_accel",
                                                     "vehicle_gps_position",
                                                     "sensor_gps",
                                                     "vehicle_air_data",
                                                     "sensor_baro",
                                                     "vehicle_magnetometer",
                                                     "sensor_mag",
                                                     "vehicle_attitude",
                                                     "vehicle_local_position",
                                                     "vehicle_global_position",
                                                     "vehicle_gps_fix"};

}  // namespace

bool is_px4_topic(std::string_view name) { return std::ranges::find(topics, name) != topics.end(); }

StreamLog px4_streams(const RawTables& tables) {
    StreamLog log;
    add_imu(tables, log);
    // the receiver's own messages if present; vehicle_gps_position may be a blend of several
    const auto own = tables_named(tables, "vehicle_gps_position");
    for (const RawTable* t : own) add_gnss(*t, log);
    for (const RawTable* t : tables_named(tables, "sensor_gps")) add_gnss(*t, log);
    add_baro(tables, log);
    add_mag(tables, log);
    add_reference(tables, log);
    return log;
}

}  // namespace schuler::io
