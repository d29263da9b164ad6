#include "schuler/settings/kfgins_settings.h"

#include "schuler/settings/config/config.h"

#include <algorithm>
#include <cmath>

namespace schuler::settings {
namespace {

// KF-GINS has separate numbers for each axis; the three identical sensors of ImuErrorModel have their root mean square.
double of_axes(const Eigen::Vector3d& v) { return v.x() == v.y() && v.y() == v.z() ? v.x() : std::sqrt(v.squaredNorm() / 3.0); }

/// The part of the initial sigma not covered by the in-run bias.
double turn_on(double initial, double in_run) {
    return initial > in_run * (1.0 + 1e-9) ? std::sqrt(initial * initial - in_run * in_run) : 0.0;
}

std::string relative_to(const std::filesystem::path& file, const std::filesystem::path& folder) {
    const std::filesystem::path base = folder.empty() ? std::filesystem::path(".") : folder;
    const std::filesystem::path relative = file.lexically_relative(base);
    if (!relative.empty() && *relative.begin() != "..") return relative.string();
    std::error_code ec;
    return std::filesystem::absolute(file, ec).lexically_normal().string();
}

}  // namespace

SettingList kfgins_settings(const io::KfGinsProject& p, const std::filesystem::path& file) {
    Config c;
    c.imu.file = relative_to(p.imu_path, file.parent_path());
    c.gnss.file = relative_to(p.gnss_path, file.parent_path());
    c.filter.vehicle = fusion::VehicleKind::Car;
    c.nonholonomic = false;  // the project does not state the vehicle: the log must show it
    c.filter.constraints.nonholonomic_auto = true;
    c.filter.earth.gravity = earth::GravityModel::KfGins;
    c.filter.earth.ellipsoid.w_ie = 7.2921151467e-5;
    c.preset = "ins21";
    c.scale_factors = true;
    c.misalignments = false;
    c.filter.imu.kind = ImuKind::Increments;
    sensor::ImuErrorModel& e = c.filter.imu.errors;
    e = {};
    e.gyro_noise = of_axes(p.noise.angle_random_walk);
    e.accel_noise = of_axes(p.noise.velocity_random_walk);
    e.gyro_bias = of_axes(p.noise.gyro_bias);
    e.accel_bias = of_axes(p.noise.accel_bias);
    e.gyro_bias_time = e.accel_bias_time = p.noise.correlation_time;
    e.gyro_turn_on_bias = turn_on(of_axes(p.std_gyro_bias), e.gyro_bias);
    e.accel_turn_on_bias = turn_on(of_axes(p.std_accel_bias), e.accel_bias);
    e.gyro_scale = std::max(of_axes(p.noise.gyro_scale), of_axes(p.std_gyro_scale));
    e.accel_scale = std::max(of_axes(p.noise.accel_scale), of_axes(p.std_accel_scale));
    c.filter.gnss.lever_arm_b = p.lever_arm_b;
    c.filter.gnss.std_floor_position.setZero();
    fusion::InitialSettings& i = c.filter.initial;
    c.initial_time = p.start.seconds();
    i.position = p.position;
    i.velocity_n = p.velocity_n;
    i.rpy = p.rpy;
    i.std_position = p.std_position;
    i.std_velocity = p.std_velocity;
    i.std_rpy = p.std_rpy;
    i.gyro_bias = p.gyro_bias;
    i.accel_bias = p.accel_bias;
    c.run.start = RunTime{p.start.seconds(), true};
    if (p.end) c.run.stop = RunTime{p.end->seconds(), true};
    SettingList list = config_table().used(c);
    // settings not from the project remain open for others
    std::erase_if(list, [](const Setting& s) {
        return s.key.starts_with("output.") || s.key == "filter.smooth" || s.key == "filter.mechanization" ||
               s.key == "imu.grade";
    });
    for (Setting& s : list) s.place = {file.string(), 0, 0, s.key};
    return list;
}

}  // namespace schuler::settings
