// ArduPilot's messages as instruments: names and units of its log definitions.
#include "schuler/io/container/raw_table.h"

#include "schuler/core/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::io {
namespace {

using Column = const std::vector<double>*;
using Columns = std::array<Column, 3>;

bool complete(const Columns& c) {
    return std::ranges::none_of(c, [](Column column) { return column == nullptr; });
}

/// Times in microseconds.
std::vector<double> times_of(const RawTable& t) {
    if (Column us = t.find({"SampleUS", "TimeUS"})) return *us;
    std::vector<double> times;
    if (Column ms = t.find({"TimeMS", "Time"}))
        for (const double v : *ms) times.push_back(1e3 * v);
    return times;
}

/// Stamps beyond 285 years are damaged: omitted as stray stamps by the readers of rows.
std::int64_t ns_of(double microseconds) {
    constexpr double most = 9e15;
    return std::isnan(microseconds) ? 0 : std::llround(std::clamp(microseconds, -most, most)) * 1000;
}
std::string label(const RawTable& t) { return t.instance > 0 ? fmt::format("{}[{}]", t.name, t.instance) : t.name; }
double value(Column column, std::size_t i, double factor = 1.0) { return column == nullptr ? not_given : (*column)[i] * factor; }

constexpr std::initializer_list<const char*> imu_columns = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s",
                                                            "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"};

void add_imu(const RawTables& tables, StreamLog& log) {
    for (const RawTable* t : tables_named(tables, "IMU")) {
        const Columns w = {t->find("GyrX"), t->find("GyrY"), t->find("GyrZ")},
                      f = {t->find("AccX"), t->find("AccY"), t->find("AccZ")};
        const std::vector<double> time = times_of(*t);
        if (time.empty() || !complete(w) || !complete(f)) continue;
        Stream s("imu", TableKind::Imu, label(*t), imu_columns);
        for (std::size_t i = 0; i < t->rows(); ++i)
            s.add(ns_of(time[i]), {(*w[0])[i], (*w[1])[i], (*w[2])[i], (*f[0])[i], (*f[1])[i], (*f[2])[i]});
        log.add(std::move(s));
    }
    const auto accels = tables_named(tables, "ACC");
    for (const RawTable* t : tables_named(tables, "GYR")) {
        const auto other = std::ranges::find(accels, t->instance, &RawTable::instance);
        const Columns w = {t->find("GyrX"), t->find("GyrY"), t->find("GyrZ")};
        if (other == accels.end() || !complete(w)) continue;
        const Columns f = {(*other)->find("AccX"), (*other)->find("AccY"), (*other)->find("AccZ")};
        const std::vector<double> time = times_of(*t), accel_time = times_of(**other);
        if (time.empty() || accel_time.empty() || !complete(f)) continue;
        std::array<std::vector<double>, 3> at_gyro;
        for (std::size_t k = 0; k < 3; ++k) at_gyro[k] = interpolated(time, accel_time, *f[k], 1e5);
        Stream s("imu_raw", TableKind::Imu, fmt::format("{} with ACC", label(*t)), imu_columns);
        for (std::size_t i = 0; i < t->rows(); ++i)
            s.add(ns_of(time[i]), {(*w[0])[i], (*w[1])[i], (*w[2])[i], at_gyro[0][i], at_gyro[1][i], at_gyro[2][i]});
        log.add(std::move(s));
    }
}

/// Heights above mean sea level less those above the ellipsoid, as ArduPilot counts them (`Und`, [ArduPilotLog]). They change by
/// centimetres per kilometre: before the receiver gives the first one, that one holds.
struct Undulation {
    std::vector<double> time, value;  ///< us, m

    [[nodiscard]] bool known() const { return !time.empty(); }
    [[nodiscard]] double at(double us) const {
        const auto later = std::ranges::upper_bound(time, us) - time.begin();
        return value[static_cast<std::size_t>(std::max<std::ptrdiff_t>(later - 1, 0))];
    }
};

Undulation undulation_of(const RawTable* accuracy) {
    Undulation u;
    const Column und = accuracy == nullptr ? nullptr : accuracy->find("Und");
    if (und == nullptr) return u;
    const std::vector<double> time = times_of(*accuracy);
    constexpr double most = 120.0;  // m
    for (std::size_t i = 0; i < time.size(); ++i) {
        const double x = (*und)[i];
        if (!(std::abs(x) < most) || x == 0.0 || (!u.time.empty() && time[i] < u.time.back())) continue;  // zero: not known
        u.time.push_back(time[i]);
        u.value.push_back(x);
    }
    return u;
}

FixType fix_of(double status) {
    static constexpr std::array types = {FixType::None,         FixType::None,     FixType::Autonomous, FixType::Autonomous,
                                         FixType::Differential, FixType::RtkFloat, FixType::RtkFixed};
    return status >= 0.0 && status < static_cast<double>(types.size()) ? types[static_cast<std::size_t>(status)]
                                                                       : FixType::Unknown;
}

void add_gnss(const RawTables& tables, StreamLog& log) {
    const auto accuracies = tables_named(tables, "GPA");
    for (const RawTable* t : tables_named(tables, "GPS")) {
        const Column lat = t->find("Lat"), lon = t->find({"Lng", "Lon"}), height = t->find("Alt"), speed = t->find("Spd"),
                     course = t->find({"GCrs", "GCr"}), down = t->find({"VZ", "VelZ"}), status = t->find("Status"),
                     satellites = t->find({"NSats", "NSat"});
        const std::vector<double> time = times_of(*t);
        if (time.empty() || lat == nullptr || lon == nullptr) continue;
        std::array<std::vector<double>, 3> sigma;
        sigma.fill(std::vector<double>(t->rows(), not_given));
        const auto accuracy = std::ranges::find(accuracies, t->instance, &RawTable::instance);
        if (accuracy != accuracies.end()) {
            const std::vector<double> their = times_of(**accuracy);
            std::size_t k = 0;
            for (const char* name : {"HAcc", "VAcc", "SAcc"}) {
                if (const Column c = (*accuracy)->find(name)) sigma[k] = interpolated(time, their, *c, 5e5);
                ++k;
            }
        }
        const Undulation undulation = undulation_of(accuracy != accuracies.end() ? *accuracy : nullptr);
        Stream s("gnss", TableKind::Gnss, label(*t),
                 {"lat_deg", "lon_deg", undulation.known() ? "height_ellipsoidal_m" : "height_msl_m", "vel_n_m_s", "vel_e_m_s",
                  "vel_d_m_s", "std_h_m", "std_d_m", "std_vel_m_s", "satellites"});
        for (std::size_t i = 0; i < t->rows(); ++i) {
            const double v = value(speed, i), angle = value(course, i) * units::deg;
            const auto given = [](double x) { return x > 0.0 && x < 1000.0 ? x : not_given; };
            s.add(ns_of(time[i]), {(*lat)[i], (*lon)[i], value(height, i) - (undulation.known() ? undulation.at(time[i]) : 0.0),
                                   v * std::cos(angle), v * std::sin(angle), value(down, i), given(sigma[0][i]),
                                   given(sigma[1][i]), given(sigma[2][i]), value(satellites, i)});
            s.fix.push_back(status == nullptr ? FixType::Unknown : fix_of((*status)[i]));
        }
        log.add(std::move(s));
    }
}

void add_baro_and_mag(const RawTables& tables, StreamLog& log) {
    for (const RawTable* t : tables_named(tables, "BARO")) {
        const Column height = t->find("Alt"), pressure = t->find("Press");
        const std::vector<double> time = times_of(*t);
        if (time.empty() || (height == nullptr && pressure == nullptr)) continue;
        Stream s("baro", TableKind::Baro, label(*t), {"height_m", "pressure_pa"});
        for (std::size_t i = 0; i < t->rows(); ++i) s.add(ns_of(time[i]), {value(height, i), value(pressure, i)});
        log.add(std::move(s));
    }
    for (const RawTable* t : tables_named(tables, "MAG")) {
        const Columns m = {t->find("MagX"), t->find("MagY"), t->find("MagZ")};  // milligauss, the offsets OfsX, ... subtracted
        const std::vector<double> time = times_of(*t);
        if (time.empty() || !complete(m)) continue;
        Stream s("mag", TableKind::Mag, label(*t), {"mag_x_ut", "mag_y_ut", "mag_z_ut"});
        for (std::size_t i = 0; i < t->rows(); ++i) s.add(ns_of(time[i]), {0.1 * (*m[0])[i], 0.1 * (*m[1])[i], 0.1 * (*m[2])[i]});
        log.add(std::move(s));
    }
}

/// The autopilot's own attitude, with its velocity and position at the same times.
void add_reference(const RawTables& tables, StreamLog& log) {
    const auto attitudes = tables_named(tables, "ATT");
    if (attitudes.empty()) return;
    const RawTable& t = *attitudes.front();
    const Columns angles = {t.find("Roll"), t.find("Pitch"), t.find("Yaw")};
    const std::vector<double> time = times_of(t);
    if (time.empty() || !complete(angles)) return;
    std::array<std::vector<double>, 6> rest;
    rest.fill(std::vector<double>(t.rows(), not_given));
    const auto fill = [&](std::initializer_list<const char*> messages,
                          std::initializer_list<std::initializer_list<std::string_view>> fields, std::size_t first) {
        for (const char* message : messages) {
            const auto others = tables_named(tables, message);
            if (others.empty()) continue;
            const std::vector<double> their = times_of(*others.front());
            for (const auto& names : fields) {
                if (const Column c = others.front()->find(names)) rest[first] = interpolated(time, their, *c, 5e5);
                ++first;
            }
            return;
        }
    };
    fill({"POS"}, {{"Lat"}, {"Lng", "Lon"}, {"Alt"}}, 0);
    fill({"XKF1", "NKF1", "EKF1"}, {{"VN"}, {"VE"}, {"VD"}}, 3);
    const auto accuracies = tables_named(tables, "GPA");
    const Undulation undulation = undulation_of(accuracies.empty() ? nullptr : accuracies.front());
    for (std::size_t i = 0; undulation.known() && i < t.rows(); ++i) rest[2][i] -= undulation.at(time[i]);
    Stream s("reference", TableKind::Reference, "ATT, POS, XKF1",
             {"onboard_lat_deg", "onboard_lon_deg", undulation.known() ? "onboard_height_m" : "onboard_height_msl_m",
              "onboard_vel_n_m_s", "onboard_vel_e_m_s", "onboard_vel_d_m_s", "onboard_roll_deg", "onboard_pitch_deg",
              "onboard_heading_deg"});
    for (std::size_t i = 0; i < t.rows(); ++i)
        s.add(ns_of(time[i]), {rest[0][i], rest[1][i], rest[2][i], rest[3][i], rest[4][i], rest[5][i], (*angles[0])[i],
                               (*angles[1])[i], (*angles[2])[i]});
    log.add(std::move(s));
}

constexpr std::array<std::string_view, 12> messages = {"IMU", "ACC", "GYR", "GPS",  "GPA",  "BARO",
                                                       "MAG", "ATT", "POS", "XKF1", "NKF1", "EKF1"};

}  // namespace

bool is_ardupilot_message(std::string_view name) { return std::ranges::find(messages, name) != messages.end(); }

StreamLog ardupilot_streams(const RawTables& tables) {
    StreamLog log;
    add_imu(tables, log);
    add_gnss(tables, log);
    add_baro_and_mag(tables, log);
    add_reference(tables, log);
    return log;
}

}  // namespace schuler::io
