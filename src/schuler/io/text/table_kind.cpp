// What a table is by the names of its columns.
#include "schuler/core/samples.h"
#include "schuler/io/text/columns.h"
#include "schuler/io/text/own_frame.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>

namespace schuler::io {

bool is_estimate(std::string_view name) {
    const std::vector<std::string> words = words_of_name(name);
    static constexpr std::string_view sources[] = {"onboard",   "ahrs",   "ekf",   "est",  "estimate", "estimated",
                                                   "autopilot", "filter", "truth", "true", "ref",      "reference"};
    return !words.empty() && std::ranges::find(sources, words.front()) != std::end(sources);
}

/// Names of commanded rather than actual values.
static bool says_command(const std::vector<std::string>& words) {
    static constexpr std::string_view commands[] = {"setpoint", "setpoints", "sp",     "command", "commands",
                                                    "cmd",      "desired",   "target", "demand"};
    return std::ranges::any_of(words,
                               [&](const std::string& word) { return std::ranges::find(commands, word) != std::end(commands); });
}

/// True if every sample row has numbers there that form a unit quaternion.
static bool is_rotation(const TableLayout& layout, const std::array<int, 4>& columns) {
    std::size_t rows = 0;
    for (const std::vector<std::string>& row : layout.sample) {
        double square = 0.0;
        for (const int column : columns) {
            const double x =
                static_cast<std::size_t>(column) < row.size() ? number_from(row[static_cast<std::size_t>(column)]) : NAN;
            square += x * x;
        }
        if (std::isnan(square)) continue;
        if (std::abs(std::sqrt(square) - 1.0) > 0.02) return false;
        ++rows;
    }
    return rows > 0 || layout.sample.empty();
}

bool is_own_frame(const TableLayout& layout) {
    const ColumnPlan plan = match_columns(layout, TableKind::Reference);
    const auto has = [&](std::string_view name) { return plan.find(name) != nullptr; };
    if (!has("local_x_m") || !has("local_y_m") || !has("local_z_m") || has("lat_deg") || has("ecef_x_m")) return false;
    // An attitude that states its level axes (quat_sensor_to_enu_w) is a reference, whatever the origin of the positions.
    const ColumnMatch* attitude = plan.find("qw");
    if (attitude == nullptr) return true;
    const std::vector<std::string> words = words_of_name(attitude->file_name);
    return std::ranges::none_of(words, [](const std::string& word) { return word == "enu" || word == "ned"; });
}

/// A height beside other coordinates is that of a place, also where only one of them is recognised.
static bool names_a_place(const TableLayout& layout) {
    const ColumnPlan fixes = match_columns(layout, TableKind::Gnss);
    if (fixes.find("lat_deg") != nullptr || fixes.find("lon_deg") != nullptr) return true;
    static constexpr std::string_view coordinates[] = {"easting", "northing", "east", "north", "position"};
    return std::ranges::any_of(layout.names, [](const std::string& name) {
        return std::ranges::any_of(words_of_name(name), [](const std::string& word) {
            return std::ranges::find(coordinates, word) != std::end(coordinates);
        });
    });
}

/// An attitude beside the thrust of the vehicle is what a controller demands, or the sticks of a pilot, unless the table says where the
/// vehicle is as well.
static bool says_thrust(const TableLayout& layout) {
    const bool thrust = std::ranges::any_of(layout.names, [](const std::string& name) {
        return std::ranges::any_of(words_of_name(name), [](const std::string& word) {
            return word.starts_with("thrust") || word.starts_with("throttle");
        });
    });
    return thrust && !names_a_place(layout) && match_columns(layout, TableKind::Reference).find("local_x_m") == nullptr;
}

/// A place with a yaw and with nothing else that a receiver tells: where to go, or an estimate, which does not show.
static bool is_waypoint(const TableLayout& layout) {
    const ColumnPlan plan = match_columns(layout, TableKind::Gnss);
    const bool yaw = std::ranges::any_of(plan.unused, [](const std::string& name) {
        const std::vector<std::string> words = words_of_name(name);
        return std::ranges::find(words, "yaw") != words.end();
    });
    const auto coordinate = [](const ColumnMatch& m) {
        return m.canonical == "time_s" || m.canonical == "lat_deg" || m.canonical == "lon_deg";
    };
    return yaw && std::ranges::all_of(plan.matches, coordinate);
}

/// mx, my, mz beside forces, and without the gyros of an IMU, are the torques of a force sensor.
static bool is_torque(const TableLayout& layout) {
    const std::string letter = words_of_name(match_columns(layout, TableKind::Mag).find("mag_x_ut")->file_name).front();
    if (letter != "m" && letter != "mx") return false;
    return std::ranges::any_of(layout.names, [](const std::string& name) {
        const std::vector<std::string> words = words_of_name(name);
        if (words.empty()) return false;
        if (words.front() == "fx" || (words.size() > 1 && words[0] == "f" && words[1] == "x")) return true;
        return std::ranges::any_of(words, [](const std::string& w) { return w.starts_with("force") || w.starts_with("torque"); });
    });
}

/// The letter P alone is a pressure by numbers of the air near the ground, in Pa or hPa, and not among the gains P, I, D of a controller.
static bool is_pressure(const TableLayout& layout, const ColumnMatch& match) {
    const auto is_letter = [](const std::string& name, const char* letter) {
        const std::vector<std::string> words = words_of_name(name);
        return words.size() == 1 && words.front() == letter;
    };
    if (match.unit_stated || !is_letter(match.file_name, "p")) return true;
    if (std::ranges::any_of(layout.names, [&](const std::string& name) { return is_letter(name, "i") || is_letter(name, "d"); }))
        return false;
    std::size_t rows = 0;
    for (const std::vector<std::string>& row : layout.sample) {
        const double p = static_cast<std::size_t>(match.column) < row.size()
                             ? number_from(row[static_cast<std::size_t>(match.column)])
                             : not_given;
        if (std::isnan(p)) continue;
        if (!(p > 300.0 && p < 1200.0) && !(p > 3e4 && p < 1.2e5)) return false;
        ++rows;
    }
    return rows > 0;
}

std::optional<TableKind> guess_table_kind(const TableLayout& layout) {
    if (says_command(words_of_name(std::filesystem::path(layout.file).stem().string()))) return std::nullopt;
    const auto commanded = [](const ColumnPlan& plan, std::string_view name) {
        return says_command(words_of_name(plan.find(name)->file_name));
    };
    const auto complete = [&](TableKind kind, std::initializer_list<std::string_view> needed) {
        const ColumnPlan plan = match_columns(layout, kind);
        return std::all_of(needed.begin(), needed.end(), [&](std::string_view name) { return plan.find(name) != nullptr; });
    };
    if (complete(TableKind::Ranges, {"time_s", "source", "pseudorange_m"})) return TableKind::Ranges;
    const ColumnPlan reference = match_columns(layout, TableKind::Reference);
    bool attitude = complete(TableKind::Reference, {"time_s", "roll_deg", "pitch_deg"}) && !commanded(reference, "roll_deg");
    if (!attitude && complete(TableKind::Reference, {"time_s", "qw", "qx", "qy", "qz"}))
        attitude =
            !commanded(reference, "qw") && is_rotation(layout, {reference.find("qw")->column, reference.find("qx")->column,
                                                                reference.find("qy")->column, reference.find("qz")->column});
    attitude = attitude && !says_thrust(layout);
    // The derivative of an acceleration is computed, as in the motion file of a simulator, whose accelerations do not show gravity.
    const bool computed = std::ranges::any_of(layout.names, [](const std::string& name) {
        const std::vector<std::string> words = words_of_name(name);
        return std::ranges::find(words, "jerk") != words.end();
    });
    if (computed) return std::nullopt;
    if (complete(TableKind::Imu,
                 {"time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"}) ||
        complete(TableKind::Imu,
                 {"time_s", "dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"})) {
        return commanded(match_columns(layout, TableKind::Imu),
                         match_columns(layout, TableKind::Imu).find("gyro_x_rad_s") != nullptr ? "gyro_x_rad_s" : "dtheta_x_rad")
                   ? std::nullopt
                   : std::optional(TableKind::Imu);
    }
    if (attitude || complete(TableKind::Reference, {"time_s", "ecef_x_m", "ecef_y_m", "ecef_z_m"})) return TableKind::Reference;
    if (complete(TableKind::Gnss, {"time_s", "lat_deg", "lon_deg"}) && !is_waypoint(layout))
        return is_estimate(match_columns(layout, TableKind::Gnss).find("lat_deg")->file_name) ? TableKind::Reference
                                                                                              : TableKind::Gnss;
    if (complete(TableKind::Mag, {"time_s", "mag_x_ut", "mag_y_ut", "mag_z_ut"}) && !is_torque(layout)) return TableKind::Mag;
    if ((complete(TableKind::Baro, {"time_s", "height_m"}) && !names_a_place(layout)) ||
        (complete(TableKind::Baro, {"time_s", "pressure_pa"}) &&
         is_pressure(layout, *match_columns(layout, TableKind::Baro).find("pressure_pa"))))
        return TableKind::Baro;
    return std::nullopt;
}

}  // namespace schuler::io
