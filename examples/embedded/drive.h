// A car's drive as its instruments would tell it, the same bits on every machine: closed formulas, rounded as by a converter.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdint>

namespace embedded {

using Eigen::Vector3d;
using schuler::Time;
namespace units = schuler::units;

/// Rounds to whole steps: sines of different C libraries differ in the last bit, what comes out of here does not.
inline double converted(double x, double step) { return std::round(x / step) * step; }
inline Vector3d converted(const Vector3d& x, double step) {
    return {converted(x.x(), step), converted(x.y(), step), converted(x.z(), step)};
}

/// Nearly normal, mean zero, variance one: the sum of twelve uniform numbers of a linear congruential generator.
class Noise {
public:
    explicit Noise(std::uint64_t seed) : state_(seed) {}
    double operator()() {
        std::int64_t sum = 0;
        for (int i = 0; i < 12; ++i) {
            state_ = state_ * 6364136223846793005u + 1442695040888963407u;
            sum += static_cast<std::int64_t>(state_ >> 33);
        }
        return static_cast<double>(sum) / 2147483648.0 - 6.0;
    }
    Vector3d three(double sigma) {
        const double x = (*this)(), y = (*this)(), z = (*this)();
        return {sigma * x, sigma * y, sigma * z};
    }

private:
    std::uint64_t state_;
};

/// Stands for 20 s, then drives around a roundabout of 60 m, faster and slower.
class Drive {
public:
    static constexpr std::size_t sources = 8;
    static constexpr double interval = 0.01, field_interval = 0.02, fix_interval = 0.2, baro_interval = 0.1;  // s

    static Time time(double t) { return Time{static_cast<std::int64_t>(std::llround(t * 1e9)) + 1'000'000'000'000}; }

    /// Mean rates and specific force over the interval that ends at t, body axes.
    schuler::ImuSample imu(double t) {
        const Motion m = at(t - 0.5 * interval);
        const schuler::earth::EarthTerms e = schuler::earth::terms_at({}, place_, m.v);
        const Vector3d rate = to_body(m, e.w_ie_n + e.w_en_n + Vector3d(0.0, 0.0, m.turn)) + Vector3d(2e-4, -3e-4, 4e-4);
        const Vector3d force = to_body(m, m.a + (2.0 * e.w_ie_n + e.w_en_n).cross(m.v) - e.g_n) + Vector3d(0.01, -0.015, 0.02);
        return {time(t), converted(rate + noise_.three(6e-4), 0x1p-30), converted(force + noise_.three(8e-3), 0x1p-24)};
    }
    /// Of the wheels, m/s.
    static double speed(double t) { return converted(at(t).v.norm(), 0x1p-10); }
    Vector3d field(double t) { return converted(to_body(at(t), {2e-5, 0.0, 4e-5}) + noise_.three(3e-7), 0x1p-36); }
    /// Pseudoranges and their rates to transmitters that stand high above the Earth; a receiver's clock, no air.
    std::array<schuler::RangeSample, sources> ranges(double t) {
        const Motion m = at(t);
        const schuler::Geodetic p = schuler::earth::moved_by_ned({}, place_, m.p);
        const Eigen::Matrix3d C_en = schuler::earth::C_en(p.lat, p.lon);
        const Vector3d r = schuler::earth::ecef_from_geodetic(schuler::earth::wgs84, p).r, v = C_en * m.v;
        const double turn = schuler::earth::wgs84.w_ie / light;
        std::array<schuler::RangeSample, sources> list;
        for (std::size_t i = 0; i < sources; ++i) {
            const double azimuth = 0.8 * static_cast<double>(i), elevation = 0.3 + 0.15 * static_cast<double>(i);
            const Vector3d n(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                             -std::sin(elevation));
            const Vector3d x = converted(r_start_ + 2.2e7 * (C_en_start_ * n), 0x1p-4);
            const double distance = (r - x).norm(), drift = 0.3;
            schuler::RangeSample& s = list[i];
            s.source = static_cast<std::uint16_t>(i);
            s.tx.r = x;
            s.tx_velocity.setZero();
            s.pseudorange =
                converted(distance + turn * (x.x() * r.y() - x.y() * r.x()) + 40.0 + drift * t + 0.7 * noise_(), 0x1p-12);
            s.range_rate = converted((r - x).dot(v) / distance + drift + 0.03 * noise_(), 0x1p-16);
            s.std = 0.7;
            s.std_rate = 0.03;
        }
        return list;
    }
    schuler::BaroSample baro(double t) { return {time(t), converted(place_.h + 3.0 + 0.3 * noise_(), 0x1p-10)}; }
    schuler::GnssFix fix(double t) {
        const Motion m = at(t);
        const Vector3d off = m.p + noise_.three(1.0);
        const schuler::Geodetic p = schuler::earth::moved_by_ned({}, place_, off);
        schuler::GnssFix fix;
        fix.time = time(t);
        fix.position = {converted(p.lat, 0x1p-37), converted(p.lon, 0x1p-37), converted(p.h, 0x1p-12)};
        fix.velocity_n = converted(m.v + noise_.three(0.05), 0x1p-16);
        fix.std_position = {1.0, 1.0, 1.0};
        fix.std_velocity = {0.05, 0.05, 0.05};
        fix.fix = schuler::FixType::Autonomous;
        return fix;
    }

private:
    static constexpr double light = 299'792'458.0;  // m/s

    struct Motion {
        Vector3d p, v, a;      ///< north, east, down of the place of the start
        double heading, turn;  ///< rad, rad/s
    };

    static Motion at(double t) {
        constexpr double start = 20.0, radius = 60.0, fastest = 0.15, quickness = 0.15, swing = 0.3, beat = 0.25, first = 0.7;
        const double s = std::max(0.0, t - start), fading = std::exp(-quickness * s);
        const double angle = fastest * (s - (1.0 - fading) / quickness) + swing * (1.0 - std::cos(beat * s));
        const double turn = fastest * (1.0 - fading) + swing * beat * std::sin(beat * s);
        const double faster = s > 0.0 ? fastest * quickness * fading + swing * beat * beat * std::cos(beat * s) : 0.0;
        const double heading = first + angle;
        const Vector3d ahead(std::cos(heading), std::sin(heading), 0.0), right(-ahead.y(), ahead.x(), 0.0);
        const Vector3d first_right(-std::sin(first), std::cos(first), 0.0);
        return {radius * (first_right - right), radius * turn * ahead, radius * (faster * ahead + turn * turn * right), heading,
                turn};
    }
    static Vector3d to_body(const Motion& m, const Vector3d& x) {
        const double c = std::cos(m.heading), s = std::sin(m.heading);
        return {c * x.x() + s * x.y(), c * x.y() - s * x.x(), x.z()};
    }

    const schuler::Geodetic place_{55.0 * units::deg, 37.0 * units::deg, 150.0};
    const Eigen::Matrix3d C_en_start_ = schuler::earth::C_en(place_.lat, place_.lon);
    const Vector3d r_start_ = schuler::earth::ecef_from_geodetic(schuler::earth::wgs84, place_).r;
    Noise noise_{20260722};
};

}  // namespace embedded
