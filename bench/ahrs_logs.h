// Hand-held logs of the kinds that the BROAD benchmark records, simulated with random motions, rooms, sensors and disturbances: a judge of
// the attitude filters that is not the benchmark itself. The field is that of the Earth and of iron about the room, as dipoles, so
// that places near each other have fields that are alike.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace schuler::ahrs_logs {

using Eigen::Vector3d;

enum class Kind {
    SlowRotation,
    FastRotation,
    SlowTranslation,
    FastTranslation,
    Combined,
    Vibrating,
    StationaryMagnet,
    AttachedMagnet,
    Office,
    Mixed,
    MagnetFromTheStart,
    FieldOfAMinute,
    BeginsInMotion,
    BadMagnetometer,
    Undisturbed
};
struct KindName {
    Kind kind;
    const char* name;
};
inline constexpr std::array kinds{KindName{Kind::SlowRotation, "slow rotation"},
                                  KindName{Kind::FastRotation, "fast rotation"},
                                  KindName{Kind::SlowTranslation, "slow translation"},
                                  KindName{Kind::FastTranslation, "fast translation"},
                                  KindName{Kind::Combined, "combined, breaks"},
                                  KindName{Kind::Vibrating, "vibrating"},
                                  KindName{Kind::StationaryMagnet, "past a magnet"},
                                  KindName{Kind::AttachedMagnet, "magnet attached"},
                                  KindName{Kind::Office, "office"},
                                  KindName{Kind::Mixed, "mixed"},
                                  KindName{Kind::MagnetFromTheStart, "10 uT from the start"},
                                  KindName{Kind::FieldOfAMinute, "field of a minute"},
                                  KindName{Kind::BeginsInMotion, "begins in motion"},
                                  KindName{Kind::BadMagnetometer, "bad magnetometer"},
                                  KindName{Kind::Undisturbed, "no iron at all"}};

struct Log {
    std::vector<ImuSample> imu;
    std::vector<MagSample> mag;
    std::vector<Eigen::Quaterniond> truth;  ///< q_nb at each IMU sample, north of the Earth's field
    std::vector<bool> moving;
};

/// Between `low` and `high`, evenly in the logarithm.
inline double between(math::Random& r, double low, double high) { return low * std::pow(high / low, r.uniform()); }

/// A smooth movement of one coordinate: sines of random size, period and phase, zero at zero.
struct Sway {
    std::array<double, 4> size{}, rate{}, phase{};

    Sway(math::Random& r, double reach, double shortest, double longest) {
        for (std::size_t i = 0; i < size.size(); ++i) {
            rate[i] = 2.0 * std::numbers::pi / between(r, shortest, longest);
            size[i] = 0.5 * reach * r.normal();
            phase[i] = 2.0 * std::numbers::pi * r.uniform();
        }
    }
    [[nodiscard]] double at(double s) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < size.size(); ++i) sum += size[i] * (std::sin(rate[i] * s + phase[i]) - std::sin(phase[i]));
        return sum;
    }
};

struct Dipole {
    Vector3d position, moment;  // m and A m^2
    [[nodiscard]] Vector3d field(const Vector3d& at) const {
        const Vector3d r = at - position;
        const double d = std::max(0.25, r.norm());  // nothing comes nearer than that
        return 1e-7 * (3.0 * r * moment.dot(r) / std::pow(d, 5) - moment / std::pow(d, 3));
    }
};

/// A dipole at a distance that makes a field of this size (T) at the origin.
inline Dipole dipole(math::Random& r, const Vector3d& centre, double distance, double field) {
    return {centre + distance * r.normal3().normalized(), field * 1e7 * std::pow(distance, 3) / 1.4 * r.normal3().normalized()};
}

inline Eigen::Matrix3d small_matrix(math::Random& r, double size) {
    Eigen::Matrix3d m;
    for (int i = 0; i < 3; ++i) m.col(i) = size * r.normal3();
    return m;
}

inline Log simulated(Kind kind, std::uint64_t seed, double seconds = 150.0) {
    math::Random r(seed, "log"), noise(seed, "noise");
    const auto any = [&](std::initializer_list<Kind> these) { return std::ranges::find(these, kind) != these.end(); };
    const double dt = 1.0 / 200.0;
    const double rest = kind == Kind::BeginsInMotion ? 0.0 : 10.0 + 20.0 * r.uniform();
    const double end = seconds - 10.0;
    const double pace = any({Kind::FastRotation, Kind::FastTranslation}) ? between(r, 2.0, 4.0) : between(r, 0.6, 2.0);
    const double turning = any({Kind::SlowTranslation, Kind::FastTranslation}) ? 0.1 : 1.0;
    const double travel = any({Kind::SlowRotation, Kind::FastRotation}) ? 0.03 : 0.25;
    const bool breaks = any({Kind::Combined, Kind::Mixed}) || r.uniform() < 0.3;
    const double break_every = 8.0 + 8.0 * r.uniform();
    const std::array<Sway, 3> turn{Sway(r, 1.2 * turning, 2.0, 20.0), Sway(r, 1.2 * turning, 2.0, 20.0),
                                   Sway(r, 1.8 * turning, 2.0, 30.0)};
    const std::array<Sway, 3> way{Sway(r, travel, 1.5, 8.0), Sway(r, travel, 1.5, 8.0), Sway(r, 0.6 * travel, 1.5, 8.0)};
    const Vector3d spin = turning < 1.0 || r.uniform() < 0.5 ? Vector3d::Zero().eval() : (0.4 * r.normal3()).eval();
    const Eigen::Quaterniond q0 = math::quaternion_from_rpy({0.1 * r.normal(), 0.1 * r.normal(), 6.28 * r.uniform()});
    const auto attitude = [&](double s) {
        return q0 * math::quaternion_from_rotation_vector(spin * s) *
               math::quaternion_from_rotation_vector({turn[0].at(s), turn[1].at(s), turn[2].at(s)});
    };
    const auto place = [&](double s) { return Vector3d(way[0].at(s), way[1].at(s), way[2].at(s)); };

    // the room: iron of 0.3 to 1.5 uT each, a table with some of its own where the sensor rests, and what belongs to the kind
    const double dip = (55.0 + 15.0 * r.uniform()) * units::deg, size = 45e-6 + 6e-6 * r.uniform();
    const Vector3d earth(size * std::cos(dip), 0.0, size * std::sin(dip));
    std::vector<Dipole> iron;
    if (kind != Kind::Undisturbed) {
        for (int i = 0; i < 5; ++i) iron.push_back(dipole(r, Vector3d::Zero(), between(r, 0.8, 3.0), between(r, 0.3e-6, 1.5e-6)));
        if (r.uniform() < 0.5) iron.push_back(dipole(r, Vector3d::Zero(), 0.4, between(r, 0.5e-6, 2e-6)));
        if (any({Kind::Office})) {
            for (int i = 0; i < 6; ++i)
                iron.push_back(dipole(r, Vector3d::Zero(), between(r, 0.5, 1.5), between(r, 0.5e-6, 2e-6)));
        }
        if (any({Kind::StationaryMagnet, Kind::Mixed}))
            iron.push_back(dipole(r, Vector3d(0.0, 0.0, 0.0), between(r, 0.35, 0.6), between(r, 1e-6, 6e-6)));
    }
    const Vector3d table = Vector3d(0.3, 0.0, 0.2) + 0.1 * r.normal3();

    // magnets on the sensor, fields that come and go
    Vector3d magnet = Vector3d::Zero(), room = Vector3d::Zero();
    double magnet_from = 0.0, magnet_to = seconds, room_from = 0.0, room_to = 0.0;
    if (any({Kind::AttachedMagnet, Kind::Mixed})) {
        magnet = between(r, 5e-6, 150e-6) * r.normal3().normalized();
        const double when = r.uniform(), middle = seconds * (0.4 + 0.2 * r.uniform());
        if (when < 0.34) magnet_from = middle;
        if (when > 0.67) magnet_to = middle;
    }
    if (kind == Kind::MagnetFromTheStart) magnet = 10e-6 * r.normal3().normalized();
    if (kind == Kind::FieldOfAMinute) {
        room = 10e-6 * r.normal3().normalized();
        room_from = 60.0;
        room_to = 120.0;
    }

    // the sensor
    const Vector3d gyro_bias = 0.3 * units::deg_per_s * r.normal3(), accel_bias = 0.04 * r.normal3();
    const Eigen::Matrix3d gyro_error = small_matrix(r, 0.003), accel_error = small_matrix(r, 0.003);
    const bool bad = kind == Kind::BadMagnetometer;
    const Eigen::Matrix3d mag_error = Eigen::Matrix3d::Identity() + small_matrix(r, bad ? 0.05 : 0.01);
    const Vector3d hard_iron = bad ? (20e-6 * r.normal3()).eval() : (0.7e-6 * r.normal3()).eval();
    const double late = 0.015 * r.uniform(), gyro_noise = between(r, 0.03, 0.15) * units::deg_per_s,
                 accel_noise = between(r, 0.02, 0.08), mag_noise = between(r, 0.2e-6, 0.8e-6);

    Log log;
    const int n = static_cast<int>(seconds / dt);
    double s = 0.0;
    Eigen::Quaterniond q = attitude(0.0);
    std::array<Vector3d, 3> track{place(0.0), place(0.0), place(0.0)};
    std::vector<Vector3d> fields;
    Vector3d drift = Vector3d::Zero();
    for (int i = 1; i <= n; ++i) {
        const double t = i * dt;
        // how fast time runs along the path: nothing at rest, smoothly to `pace`
        double going = std::clamp(std::min(t - rest, end - t) / 1.0, 0.0, 1.0);
        if (rest == 0.0) going = std::clamp(end - t, 0.0, 1.0);
        if (breaks) {
            const double phase = std::fmod(t, break_every);
            going = std::min(going, std::clamp(std::min(phase - 4.0, break_every - phase) / 0.7, 0.0, 1.0));
        }
        going = going * going * (3.0 - 2.0 * going);
        s += going * pace * dt;
        const Eigen::Quaterniond before = q;
        q = attitude(s);
        // from the table to the middle of the room within some seconds, and back in the end
        double out = rest == 0.0 ? 1.0 : std::clamp(std::min(t - rest, end - t) / 4.0, 0.0, 1.0);
        out = out * out * out * (10.0 - 15.0 * out + 6.0 * out * out);
        track = {track[1], track[2], place(s) + (1.0 - out) * table};
        const Vector3d acceleration =
            i > 2 ? ((track[2] - 2.0 * track[1] + track[0]) / (dt * dt)).eval() : Vector3d::Zero().eval();
        Vector3d force = q.conjugate() * (acceleration - Vector3d(0.0, 0.0, 9.81));
        Vector3d rate = math::rotation_vector_from_quaternion(before.conjugate() * q) / dt;
        Vector3d field_n = earth;
        for (const Dipole& d : iron) field_n += d.field(track[2]);
        if (t >= room_from && t < room_to) field_n += room;
        Vector3d field = mag_error * (q.conjugate() * field_n) + hard_iron;
        if (t >= magnet_from && t < magnet_to) field += magnet;
        if (kind == Kind::Vibrating && t > rest && std::fmod(t, 10.0) < 5.0) {
            force += 8.0 * std::sin(2.0 * std::numbers::pi * 71.0 * t) * Vector3d(0.3, 1.0, 0.5);
            rate += Vector3d(0.003, -0.003, 0.003);
            field += 8e-6 * std::sin(2.0 * std::numbers::pi * 47.0 * t) * Vector3d(1.0, 0.4, -0.5);
        }
        drift += 0.002 * units::deg_per_s * std::sqrt(dt) * noise.normal3();
        log.imu.push_back({Time::from_seconds(t), rate + gyro_error * rate + gyro_bias + drift + gyro_noise * noise.normal3(),
                           force + accel_error * force + accel_bias + accel_noise * noise.normal3()});
        fields.push_back(field);
        log.truth.push_back(q);
        log.moving.push_back(going > 0.05);
        if (i % 2 == 0 && i > 10) {
            const std::size_t then = fields.size() - 1 - static_cast<std::size_t>(late / dt);
            log.mag.push_back({Time::from_seconds(t), fields[then] + mag_noise * noise.normal3()});
        }
    }
    return log;
}

}  // namespace schuler::ahrs_logs
