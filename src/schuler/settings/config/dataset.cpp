#include "schuler/core/units.h"
#include "schuler/dataset/description.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {
namespace {

/// "wgs84" and so on: the ellipsoids by name.
const std::vector<std::pair<std::string, earth::Ellipsoid>>& ellipsoids() {
    static const std::vector<std::pair<std::string, earth::Ellipsoid>> list{{"wgs84", earth::wgs84},
                                                                            {"pz90", earth::pz90},
                                                                            {"pz90.11", earth::pz90_11},
                                                                            {"sk42", earth::krasovsky},
                                                                            {"international1924", earth::international1924}};
    return list;
}

bool same_figure(const earth::Ellipsoid& a, const earth::Ellipsoid& b) { return a.a == b.a && a.f == b.f; }

Option<Config> earth_model() {
    OptionSpec spec = detail::spec("earth.model", Shape::Text, "ellipsoid of all positions");
    for (const auto& [name, ellipsoid] : ellipsoids()) spec.choices.push_back(name);
    return {std::move(spec),
            [](Config& c, const Value& v) {
                for (const auto& [name, ellipsoid] : ellipsoids()) {
                    if (name == *v.text()) c.filter.earth.ellipsoid = ellipsoid;
                }
            },
            [](const Config& c) -> std::optional<Value> {
                for (const auto& [name, ellipsoid] : ellipsoids()) {
                    if (same_figure(ellipsoid, c.filter.earth.ellipsoid)) return Value{name};
                }
                return std::nullopt;
            }};
}

/// An impossible date is detected here, by its GPS week, rather than when the data are read.
void check_date(const std::string& text) {
    int y = 0, m = 0, d = 0, used = 0;
    const bool form =
        std::sscanf(text.c_str(), "%4d-%2d-%2d%n", &y, &m, &d, &used) == 3 && static_cast<std::size_t>(used) == text.size();
    if (!form || y < 1980 || y > 2200 || m < 1 || m > 12 || d < 1 || d > 31) {
        throw input_error(fmt::format("\"{}\" is not a date from 1980 on", text), {}, "write date = 2025-07-08");
    }
}

template <class Access>
void add_file(OptionTable<Config>& table, const std::string& section, const std::string& what, Access source) {
    table
        .add(text<Config>(section + ".file", what + "; relative to this file, $NAME is an environment variable",
                          [=](auto& c) -> auto& { return source(c).file; }))
        .add(text_map<Config>(section + ".columns", "canonical column name = the name in the file",
                              [=](auto& c) -> auto& { return source(c).columns; }))
        .add(number_map<Config>(section + ".scale", "canonical column name = factor to its canonical unit",
                                [=](auto& c) -> auto& { return source(c).scale; }))
        .add(number<Config>(section + ".time_offset_s", 1.0, -4e9, 4e9, "added to the times of this file",
                            [=](auto& c) -> auto& { return source(c).time_offset; }));
}

template <class Access>
void add_parts(OptionTable<Config>& table, const std::string& section, Access source) {
    table.add(file_list(
        section + ".parts",
        "further files of the log in parts, with the same columns; joined in order of time, rows that repeat are left out",
        [=](auto& c) -> auto& { return source(c).parts; }));
}

/// A log whose columns are named as in the interface.
template <class Access>
void add_plain_file(OptionTable<Config>& table, const std::string& section, const std::string& what, Access source) {
    table
        .add(text<Config>(section + ".file", what + "; relative to this file, $NAME is an environment variable",
                          [=](auto& c) -> auto& { return source(c).file; }))
        .add(number<Config>(section + ".time_offset_s", 1.0, -4e9, 4e9, "added to the times of this file",
                            [=](auto& c) -> auto& { return source(c).time_offset; }));
}

}  // namespace

void add_dataset_options(OptionTable<Config>& table) {
    using fusion::VehicleKind;
    table.add(text<Config>("name", "name of the data set and of its output folder", [](auto& c) -> auto& { return c.name; }))
        .add(choice<Config, TimeScale>(
            "time.scale",
            {{"gps", TimeScale::Gps}, {"utc", TimeScale::Utc}, {"boot", TimeScale::Boot}, {"relative", TimeScale::Relative}},
            "time scale of the times in the files", [](auto& c) -> auto& { return c.time.scale; }))
        .add(integer<Config>("time.week", 0, 20000, "GPS week, where times are seconds of week",
                             [](auto& c) -> auto& { return c.time.week; }))
        .add(special<Config>(
            "time.date", "a date such as 2025-07-08", "day, where times are seconds of day",
            [](Config& c, const Value& v) {
                if (v.text() == nullptr)
                    throw input_error(fmt::format("is {}, expected a date", kind_of(v)), {}, "write date = 2025-07-08");
                check_date(*v.text());
                c.time.date = *v.text();
            },
            [](const Config& c) -> std::optional<Value> {
                if (c.time.date.empty()) return std::nullopt;
                return Value{c.time.date};
            }))
        .add(choice<Config, VehicleKind>("vehicle.kind",
                                         {{"car", VehicleKind::Car},
                                          {"air", VehicleKind::Air},
                                          {"ship", VehicleKind::Ship},
                                          {"hand", VehicleKind::Hand},
                                          {"static", VehicleKind::Static}},
                                         "chooses constraints and start-up; car enables the non-holonomic constraint",
                                         [](auto& c) -> auto& { return c.filter.vehicle; }))
        .add(number<Config>(
            "vehicle.leeway_deg", units::deg, 0, 45,
            "ship without a heading sensor: one sigma of the angle between bow and course over ground; 0 = the course is not used",
            [](auto& c) -> auto& { return c.leeway; }))
        .add(earth_model())
        .add(special<Config>(
            "earth.gravity", "\"somigliana\", \"grs80\", \"kf-gins\", \"paper_a\" or \"paper_c\"", "gravity model",
            [](Config& c, const Value& v) {
                if (v.text() == nullptr)
                    throw input_error(fmt::format("is {}, expected text", kind_of(v)), {},
                                      "write for example gravity = \"somigliana\"");
                c.filter.earth.gravity = earth::gravity_model_from_name(*v.text());
            },
            [](const Config& c) -> std::optional<Value> { return Value{std::string(earth::name_of(c.filter.earth.gravity))}; }))
        .add(number<Config>("earth.rotation_rad_s", 1.0, 0.0, 1e-3, "rotation rate of the Earth",
                            [](auto& c) -> auto& { return c.filter.earth.ellipsoid.w_ie; }));
    add_file(table, "imu", "IMU log: CSV or the text format of KF-GINS", [](auto& c) -> auto& { return c.imu; });
    add_parts(table, "imu", [](auto& c) -> auto& { return c.imu; });
    table.add(number<Config>(
        "imu.clock_drift_ppm", 1e-6, -1e4, 1e4,
        "clock rate error, positive if fast, shared with the logs of barometer, magnetometer and odometer; counted from the first row",
        [](auto& c) -> auto& { return c.clock_drift; }));
    add_file(table, "gnss", "receiver's solution: CSV, RTKLIB .pos, NMEA or the text format of KF-GINS",
             [](auto& c) -> auto& { return c.gnss; });
    add_parts(table, "gnss", [](auto& c) -> auto& { return c.gnss; });
    add_file(table, "baro", "barometer log", [](auto& c) -> auto& { return c.baro; });
    add_parts(table, "baro", [](auto& c) -> auto& { return c.baro; });
    add_file(table, "mag", "magnetometer log", [](auto& c) -> auto& { return c.mag; });
    add_parts(table, "mag", [](auto& c) -> auto& { return c.mag; });
    add_plain_file(table, "odometer", "wheel speed, time_s, speed_m_s [, std_m_s]", [](auto& c) -> auto& { return c.odometer; });
    add_plain_file(table, "heading", "heading of a dual-antenna receiver or a gyrocompass, time_s, heading_deg [, std_deg]",
                   [](auto& c) -> auto& { return c.heading; });
    add_file(table, "stations", "pseudoranges to satellites and ground stations, ranges.csv",
             [](auto& c) -> auto& { return c.ranges; });
    table.add(text<Config>("stations.coordinates", "places of the ground stations, stations.csv",
                           [](auto& c) -> auto& { return c.station_coordinates; }));
    add_file(table, "reference", "truth or another program's solution to compare with",
             [](auto& c) -> auto& { return c.reference; });
    table.add(choice<Config, dataset::Quaternion>(
        "reference.quaternion",
        {{"body_to_ned", dataset::Quaternion::BodyToNed}, {"sensor_to_enu", dataset::Quaternion::SensorToEnu}},
        "rotation that qw, qx, qy, qz of the reference describe", [](auto& c) -> auto& { return c.quaternion; }));
}

}  // namespace schuler::settings
