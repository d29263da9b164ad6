#include "schuler/sim/anomaly.h"

#include "schuler/core/error.h"
#include "schuler/math/random.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace schuler::sim {

using Eigen::Vector3d;

namespace {

constexpr double points_a_length = 64.0;

bool is_random(AnomalyPart::Kind kind) {
    return kind == AnomalyPart::Kind::GaussMarkov1 || kind == AnomalyPart::Kind::GaussMarkov2;
}

/// A stationary process of unit correlation length, exact at the points: value, and slope for the second order.
std::vector<Vector3d> drawn(const AnomalyPart& part, double extent, math::Random random) {
    const auto count = static_cast<std::size_t>(std::ceil(points_a_length * extent / part.length)) + 2;
    const double d = 1.0 / points_a_length, fall = std::exp(-d);
    std::vector<Vector3d> values(count);
    Vector3d x = random.normal3();
    if (part.kind == AnomalyPart::Kind::GaussMarkov1) {
        const double kick = std::sqrt(-std::expm1(-2.0 * d));
        for (Vector3d& value : values) {
            value = part.size_n.cwiseProduct(x);
            x = fall * x + kick * random.normal3();
        }
        return values;
    }
    Eigen::Matrix2d Phi;
    Phi << (1.0 + d) * fall, d * fall, -d * fall, (1.0 - d) * fall;
    // Q(0, 0) is of the order d^3 = 4e-6 and, minus the part explained by the second element, 1e-6: ten digits remain.
    const Eigen::Matrix2d Q = Eigen::Matrix2d::Identity() - Phi * Phi.transpose();
    const double square_root_11 = std::sqrt(Q(1, 1)), ratio = Q(0, 1) / square_root_11;
    const double square_root_00 = std::sqrt(std::max(0.0, Q(0, 0) - ratio * ratio));
    Vector3d slope = random.normal3();
    for (Vector3d& value : values) {
        value = part.size_n.cwiseProduct(x);
        const Vector3d a = random.normal3(), b = random.normal3(), before = x;
        x = Phi(0, 0) * x + Phi(0, 1) * slope + ratio * a + square_root_00 * b;
        slope = (Phi(1, 0) * before + Phi(1, 1) * slope + square_root_11 * a).eval();
    }
    return values;
}

/// Interpolates between points of unit spacing; constant beyond the ends.
Vector3d between(const std::vector<Vector3d>& points, double place) {
    place = std::clamp(place, 0.0, static_cast<double>(points.size() - 1));
    const auto left = std::min(static_cast<std::size_t>(place), points.size() - 2);
    const double share = place - static_cast<double>(left);
    return (1.0 - share) * points[left] + share * points[left + 1];
}

}  // namespace

AnomalyTrack::AnomalyTrack(std::vector<AnomalyPart> parts, double extent, double duration, std::uint64_t seed) {
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const AnomalyPart& part = parts[i];
        if (!part.size_n.allFinite())
            throw input_error("the size of an anomaly is not a number", {{}, 0, 0, "anomaly.size_mgal"},
                              "give three numbers in mGal");
        if (!(part.length > 0.0))
            throw input_error("the length of an anomaly must be positive", {{}, 0, 0, "anomaly.length_m"},
                              "give metres or seconds");
        const double reach = part.by_time ? duration : extent;
        if (is_random(part.kind) && points_a_length * reach > 1e7 * part.length)
            throw input_error("the correlation length of an anomaly is too short for this track", {{}, 0, 0, "anomaly.length_m"},
                              "give at least a hundred-thousandth of the track");
        Drawn one{part, {}};
        if (is_random(part.kind)) one.values = drawn(part, reach, math::Random(seed, fmt::format("anomaly {}", i)));
        parts_.push_back(std::move(one));
    }
}

AnomalyTrack::AnomalyTrack(std::vector<AnomalyPart> parts, const GroundField& field, const TruthPath& path, double duration,
                           std::uint64_t seed)
    : AnomalyTrack(std::move(parts), distance_along(path, duration), duration, seed) {
    if (!field) return;
    for (double t = 0.0; t < duration + 2.0; t += 1.0) under_path_.push_back(field(path.at(t).position));
}

Vector3d AnomalyTrack::at(double distance, double t) const {
    Vector3d sum = under_path_.empty() ? Vector3d(Vector3d::Zero()) : between(under_path_, t);
    for (const Drawn& one : parts_) {
        const AnomalyPart& part = one.part;
        const double s = (part.by_time ? t : distance) - part.start;
        switch (part.kind) {
            case AnomalyPart::Kind::Constant: sum += part.size_n; break;
            case AnomalyPart::Kind::Step: sum += (s >= 0.0 ? 1.0 : 0.0) * part.size_n; break;
            case AnomalyPart::Kind::Ramp: sum += std::clamp(s / part.length, 0.0, 1.0) * part.size_n; break;
            case AnomalyPart::Kind::Harmonic: sum += std::sin(2.0 * std::numbers::pi * s / part.length) * part.size_n; break;
            case AnomalyPart::Kind::GaussMarkov1:
            case AnomalyPart::Kind::GaussMarkov2:
                sum += between(one.values, (s + part.start) / part.length * points_a_length);
                break;
        }
    }
    return sum;
}

double distance_along(const TruthPath& path, double duration) {
    double sum = 0.0;
    for (double t = 0.0; t < duration; t += 1.0) {
        const double dt = std::min(1.0, duration - t);
        sum += dt * path.at(t + 0.5 * dt).v_eb_n.norm();
    }
    return sum;
}

}  // namespace schuler::sim
