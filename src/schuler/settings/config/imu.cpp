#include "schuler/core/units.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/config/sections.h"
#include "schuler/settings/imu_error_options.h"
#include "schuler/settings/option_builders.h"

namespace schuler::settings {
namespace {

Option<Config> axes_option(const std::string& key, const std::string& help, std::string Config::*field, bool imu) {
    return special<Config>(
        key, "\"frd\", \"flu\", \"fur\" or \"x=forward, y=left, z=up\"", help,
        [=](Config& c, const Value& v) {
            if (v.text() == nullptr)
                throw input_error(fmt::format("is {}, expected text", kind_of(v)), {}, "write for example axes = \"flu\"");
            const Eigen::Matrix3d C_bs = axes_from_text(*v.text());
            c.*field = *v.text();
            if (imu) c.filter.imu.C_bs = C_bs;
        },
        [=](const Config& c) -> std::optional<Value> {
            if ((c.*field).empty()) return std::nullopt;
            return Value{c.*field};
        });
}

Option<Config> mounting_option() {
    return special<Config>(
        "imu.mounting_deg", "[roll, pitch, yaw] or \"estimate\"",
        "rotation from body to sensor, after axes; \"estimate\" finds it",
        [](Config& c, const Value& v) {
            if (v.text() != nullptr && *v.text() == "estimate") {
                c.filter.imu.estimate_mounting = true;
                return;
            }
            const auto bad = [] {
                return input_error("is neither three angles nor \"estimate\"", {},
                                   "write mounting_deg = [0, 0, 0] or \"estimate\"");
            };
            if (v.list() == nullptr || v.list()->size() != 3) throw bad();
            for (int i = 0; i < 3; ++i) {
                const Value& angle = (*v.list())[static_cast<std::size_t>(i)];
                if (!angle.is_number() || !(std::abs(angle.number()) <= 360.0)) throw bad();
                c.filter.imu.mounting_rpy[i] = angle.number() * units::deg;
            }
            c.filter.imu.estimate_mounting = false;
        },
        [](const Config& c) -> std::optional<Value> {
            if (c.filter.imu.estimate_mounting) return Value{std::string("estimate")};
            const Eigen::Vector3d& m = c.filter.imu.mounting_rpy;
            return Value{ValueList{{in_unit(m.x(), units::deg)}, {in_unit(m.y(), units::deg)}, {in_unit(m.z(), units::deg)}}};
        });
}

}  // namespace

void add_imu_options(OptionTable<Config>& table) {
    table
        .add(choice<Config, ImuKind>("imu.kind", {{"rates", ImuKind::Rates}, {"increments", ImuKind::Increments}},
                                     "rates, or increments over each sample", [](auto& c) -> auto& { return c.filter.imu.kind; }))
        .add(choice<Config, ImuStamp>(
            "imu.stamp", {{"start", ImuStamp::Start}, {"center", ImuStamp::Center}, {"end", ImuStamp::End}},
            "what the time stamp of a sample marks", [](auto& c) -> auto& { return c.filter.imu.stamp; }))
        .add(axes_option("imu.axes", "directions of the sensor's x, y, z axes", &Config::axes, true))
        .add(mounting_option())
        .add(number<Config>("imu.mounting_std_deg", units::deg, 1e-4, 90,
                            "one sigma of the mounting's forward axis, where the mounting is given",
                            [](auto& c) -> auto& { return c.filter.imu.mounting_std; }))
        .add(number<Config>("imu.found_mounting_std_deg", units::deg, 0, 90,
                            "one sigma of pitch and yaw of a mounting that was found; the reported attitude includes it",
                            [](auto& c) -> auto& { return c.filter.imu.found_mounting_std; }))
        .add(imu_grade_option<Config>([](auto& c) -> auto& { return c.grade; },
                                      [](auto& c) -> auto& { return c.filter.imu.errors; }));
    add_imu_error_options(table, "imu.", [](auto& c) -> auto& { return c.filter.imu.errors; });
    table.add(flag<Config>("imu.estimate_noise", "fit the white noise to the innovations; default: where the noise is not given",
                           [](auto& c) -> auto& { return c.filter.imu.estimate_noise; }));
    table.add(
        number<Config>("imu.gyro_vibration", 1.0, 0, 100,
                       "fraction of the sample-to-sample variation of the gyros that adds to the stated white noise; default: "
                       "fitted with the noise",
                       [](auto& c) -> auto& { return c.filter.imu.gyro_vibration; }));
    table.add(number<Config>(
        "imu.accel_vibration", 1.0, 0, 100,
        "fraction of the sample-to-sample variation of the accelerometers that adds to the stated white noise; default: fitted with the noise",
        [](auto& c) -> auto& { return c.filter.imu.accel_vibration; }));
    table.add(number<Config>(
        "imu.gyro_noise_scale", 1.0, 0.01, 1000,
        "factor of the gyros' noise and bias variation in the filter; default: found by the self-check of `process`",
        [](auto& c) -> auto& { return c.filter.imu.gyro_noise_scale; }));
    table.add(number<Config>(
        "imu.accel_noise_scale", 1.0, 0.01, 1000,
        "factor of the accelerometers' noise and bias variation in the filter; default: found by the self-check of `process`",
        [](auto& c) -> auto& { return c.filter.imu.accel_noise_scale; }));
    table.add(number<Config>("imu.gap_factor", 1.0, 1.1, 1e6,
                             "a sampling interval longer than this multiple of the median is a gap",
                             [](auto& c) -> auto& { return c.filter.imu.gap_factor; }));
    table.add(axes_option("mag.axes", "directions of the magnetometer's x, y, z axes; default: as the IMU's", &Config::mag_axes,
                          false));
}

}  // namespace schuler::settings
