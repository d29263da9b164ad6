#include "inspect/synthetic_car.h"
#include "schuler/core/units.h"
#include "support/draws.h"

#include <Eigen/Geometry>

#include <unistd.h>
#include <algorithm>
#include <cmath>

#include <cstdio>
#include <fstream>
#include <numbers>
#include <random>
#include <system_error>
#include <vector>

namespace schuler::inspect::test {
namespace {

constexpr double gravity_there = 9.806;  // at 45 deg of latitude, near enough
using units::deg;

double gate(double t) {  // 0 to 20 s still, then away within 5 s
    const double x = std::clamp((t - 20.0) / 5.0, 0.0, 1.0);
    return x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
}
double speed(double t) { return gate(t) * (9.0 + 4.0 * std::sin(0.35 * t)); }
double course(double t) { return 0.5 + gate(t) * (0.9 * std::sin(0.21 * t) + 0.5 * std::sin(0.47 * t)); }
double slope(double t) { return gate(t) * 0.05 * std::sin(0.4 * t); }

Eigen::Vector3d velocity(double t) {
    return speed(t) * Eigen::Vector3d(std::cos(slope(t)) * std::cos(course(t)), std::cos(slope(t)) * std::sin(course(t)),
                                      -std::sin(slope(t)));
}
Eigen::Matrix3d C_nb(double t) {
    return (Eigen::AngleAxisd(course(t), Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(slope(t), Eigen::Vector3d::UnitY()))
        .toRotationMatrix();
}
Eigen::Vector3d acceleration(double t) { return (velocity(t + 1e-4) - velocity(t - 1e-4)) / 2e-4; }
Eigen::Vector3d rate_b(double t) {
    const Eigen::AngleAxisd turn(C_nb(t - 1e-4).transpose() * C_nb(t + 1e-4));
    return turn.axis() * turn.angle() / 2e-4;
}

// North, east, down from the start; grown by Simpson's rule as time goes on.
class Position {
public:
    Eigen::Vector3d at(double t) {
        constexpr double h = 0.02;
        while (time_ + h < t) {
            p_ += h / 6.0 * (velocity(time_) + 4.0 * velocity(time_ + 0.5 * h) + velocity(time_ + h));
            time_ += h;
        }
        return p_ + (t - time_) * velocity(0.5 * (t + time_));
    }

private:
    double time_ = -2.0;
    Eigen::Vector3d p_ = Eigen::Vector3d::Zero();
};

}  // namespace

void write_car(const std::filesystem::path& folder, const CarLog& car) {
    std::filesystem::create_directories(folder);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    const auto noise = [&](double sigma) { return Eigen::Vector3d(sigma * schuler::test::draw3(normal, random)); };
    const double bob_rate = 2.0 * std::numbers::pi * car.bob_frequency;
    const auto bob = [&](double t) { return car.bob_speed * gate(t) * std::sin(bob_rate * t); };
    const auto bob_accel = [&](double t) { return Eigen::Vector3d(0, 0, (bob(t + 1e-4) - bob(t - 1e-4)) / 2e-4); };
    char line[512];
    const char* s = car.separator.c_str();

    std::ofstream imu(folder / car.imu_name);
    if (!car.imu_header.empty()) imu << car.imu_header << "\n";
    const double dt = 1.0 / car.imu_rate;
    for (int i = 0; i * dt < car.duration; ++i) {
        const double t = i * dt;
        const double mid = car.increments ? t - 0.5 * dt : t, scale = car.increments ? dt : 1.0;
        const Eigen::Vector3d f_b =
            C_nb(mid).transpose() * (acceleration(mid) + bob_accel(mid) - Eigen::Vector3d(0, 0, gravity_there));
        const Eigen::Vector3d w = scale * car.gyro_factor * (car.C_sb * rate_b(mid) + car.gyro_bias + noise(0.002));
        const Eigen::Vector3d f = scale * car.accel_factor * (car.C_sb * f_b + car.accel_bias + noise(0.03));
        std::snprintf(line, sizeof line, "%.6f%s%.9g%s%.9g%s%.9g%s%.9g%s%.9g%s%.9g\n", (car.imu_start + t) * car.time_factor, s,
                      w.x(), s, w.y(), s, w.z(), s, f.x(), s, f.y(), s, f.z());
        imu << line;
    }
    std::ofstream gnss(folder / car.gnss_name);
    if (!car.gnss_header.empty()) gnss << car.gnss_header << "\n";
    Position position;
    for (int k = 0; k / car.gnss_rate < car.duration; ++k) {
        const double t = k / car.gnss_rate;
        const Eigen::Vector3d p = position.at(t - car.position_latency) + noise(car.position_noise);
        const double valid = t - car.velocity_latency, down = valid - car.down_latency;
        const Eigen::Vector3d v =
            Eigen::Vector3d(velocity(valid).x(), velocity(valid).y(), velocity(down).z() + bob(down)) + noise(0.03);
        const double lat = 45.0 + p.x() / 6367382.0 / deg, lon = 7.0 + p.y() / (6388838.0 * std::cos(45.0 * deg)) / deg;
        int n = std::snprintf(line, sizeof line, "%.6f%s%.11g%s%.11g%s%.4f", (car.gnss_start + t) * car.time_factor, s,
                              lat * car.angle_factor, s, lon * car.angle_factor, s, 300.0 - p.z());
        if (car.write_velocity)
            n += std::snprintf(line + n, sizeof line - static_cast<std::size_t>(n), "%s%.4f%s%.4f%s%.4f", s, v.x(), s, v.y(), s,
                               v.z());
        else n += std::snprintf(line + n, sizeof line - static_cast<std::size_t>(n), "%s0.01%s0.01%s0.02", s, s, s);
        gnss << line << "\n";
    }
}

std::filesystem::path fresh_folder(const std::string& name) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() /
        ("schuler_inspect_" + std::to_string(::getpid()) + "_" + name);  // test programs run side by side
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    static struct Folders {
        std::vector<std::filesystem::path> all;
        ~Folders() {
            std::error_code ec;
            for (const auto& path : all) std::filesystem::remove_all(path, ec);
        }
    } made;  // gone with the program
    made.all.push_back(folder);
    return folder;
}

void write_file(const std::filesystem::path& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
}

}  // namespace schuler::inspect::test
