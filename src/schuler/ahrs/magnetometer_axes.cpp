#include "schuler/ahrs/magnetometer_axes.h"

#include "schuler/math/rotation.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double interval = 0.2, longest_step = 0.5;  // s between the compared readings
constexpr double least_turned = 1.0;                  // rad, root of the sum of squares of the changes of direction
constexpr double clearly_worse = 1.3;                 // unexplained part of the others relative to that of the best
constexpr double least_evidence = 15.0;               // log-likelihood ratio of the best to the others
constexpr double alike = 10.0;  // neighbouring pairs with correlated residuals: local disturbances last for seconds
constexpr double enough_explained = 0.5;
constexpr double least_turn = 0.01;  // rad in an interval, below which it contains no information

/// Two readings and the rotation between them from the gyro.
struct Pair {
    Vector3d first, change;
    Matrix3d turn;  // C_b2b1 - I: change of a field fixed in space
};

std::vector<Pair> pairs_of(std::span<const ImuSample> imu, std::span<const MagSample> mag) {
    std::vector<Pair> out;
    std::size_t i = 0, first = 0;
    Eigen::Quaterniond q = Eigen::Quaterniond::Identity();
    bool whole = true;
    for (std::size_t m = 1; m < mag.size(); ++m) {
        for (; i + 1 < imu.size() && imu[i + 1].time <= mag[m].time; ++i) {
            if (imu[i + 1].time <= mag[first].time) continue;
            whole = whole && imu[i + 1].gyro.allFinite();
            const double dt = (imu[i + 1].time - std::max(imu[i].time, mag[first].time)).seconds();
            if (whole) q = q * math::quaternion_from_rotation_vector(imu[i + 1].gyro * dt);
        }
        const double span = (mag[m].time - mag[first].time).seconds();
        if (span < interval) continue;
        const Vector3d &a = mag[first].field_b, &b = mag[m].field_b;
        const double angle = 2.0 * std::atan2(q.vec().norm(), std::abs(q.w()));
        if (whole && span < longest_step && angle > least_turn && a.allFinite() && b.allFinite())
            out.push_back({a, b - a, q.conjugate().toRotationMatrix() - Matrix3d::Identity()});
        first = m;
        q.setIdentity();
        whole = true;
    }
    return out;
}

/// One of each pair of opposite signs: 24 of the 48 signed permutations.
std::vector<Matrix3d> candidates() {
    std::vector<Matrix3d> out;
    std::array<int, 3> order{0, 1, 2};
    do {
        for (int signs = 0; signs < 4; ++signs) {
            Matrix3d C = Matrix3d::Zero();
            C(0, order[0]) = 1.0;
            C(1, order[1]) = (signs & 1) != 0 ? -1.0 : 1.0;
            C(2, order[2]) = (signs & 2) != 0 ? -1.0 : 1.0;
            out.push_back(C);
        }
    } while (std::next_permutation(order.begin(), order.end()));
    return out;
}

/// Robust measure of the unexplained changes: the largest residuals of a disturbed field are limited to the outlier bound.
double unexplained(const std::vector<Pair>& pairs, const Matrix3d& C, double bound) {
    Matrix3d N = 1e-9 * static_cast<double>(pairs.size()) * Matrix3d::Identity();
    Vector3d right = Vector3d::Zero();
    for (const Pair& p : pairs) {
        N.noalias() += p.turn.transpose() * p.turn;
        right.noalias() += p.turn.transpose() * (p.turn * (C * p.first) - C * p.change);
    }
    const Vector3d iron = N.ldlt().solve(right);
    double sum = 0.0;
    for (const Pair& p : pairs) sum += std::min(bound, (C * p.change - p.turn * (C * p.first - iron)).squaredNorm());
    return sum;
}

/// Mean component of the field opposite to the specific force, T: positive downwards.
double downward(std::span<const ImuSample> imu, std::span<const MagSample> mag, const Matrix3d& C) {
    double sum = 0.0;
    std::size_t i = 0;
    for (const MagSample& s : mag) {
        while (i + 1 < imu.size() && imu[i + 1].time <= s.time) ++i;
        const double size = imu[i].accel.norm();
        if (size > 0.0 && std::isfinite(size) && s.field_b.allFinite()) sum -= imu[i].accel.dot(C * s.field_b) / size;
    }
    return sum;
}

}  // namespace

MagnetometerAxes recognise_axes(std::span<const ImuSample> imu, std::span<const MagSample> mag, double field_down) {
    MagnetometerAxes out;
    if (imu.size() < 2 || mag.size() < 2) return out;
    const std::vector<Pair> pairs = pairs_of(imu, mag);
    if (pairs.empty()) return out;
    double changes = 0.0, sizes = 0.0;
    for (const Pair& p : pairs) {
        changes += p.change.squaredNorm();
        sizes += p.first.squaredNorm();
    }
    const double size2 = sizes / static_cast<double>(pairs.size());
    if (!(changes > least_turned * least_turned * size2)) return out;
    const double bound = 9.0 * changes / static_cast<double>(pairs.size());
    double capped = 0.0;
    for (const Pair& p : pairs) capped += std::min(bound, p.change.squaredNorm());
    double best = std::numeric_limits<double>::infinity(), second = best, given = best;
    Matrix3d C = Matrix3d::Identity();
    for (const Matrix3d& candidate : candidates()) {
        const double left = unexplained(pairs, candidate, bound);
        if (candidate.isIdentity()) given = left;
        if (left < best) {
            second = best;
            best = left;
            C = candidate;
        } else {
            second = std::min(second, left);
        }
    }
    out.as_given = 1.0 - given / capped;
    out.explained = out.as_given;
    const double evidence = 1.5 * static_cast<double>(pairs.size()) / alike * std::log(second / best);
    if (second < clearly_worse * best || evidence < least_evidence || best > (1.0 - enough_explained) * capped) return out;
    const bool known = std::isfinite(field_down);
    if (C.isIdentity() && !known) return out;  // all three axes reversed, or south of the equator
    const bool down = downward(imu, mag, C) > 0.0;
    out.C_bs = down == (!known || field_down > 0.0) ? C : Matrix3d(-C);
    out.swapped = !out.C_bs.isIdentity();
    out.sign_assumed = out.swapped && !known;
    out.explained = 1.0 - best / capped;
    return out;
}

std::string axes_text(const Matrix3d& C_bs) {
    constexpr std::array names{'x', 'y', 'z'};
    std::string out;
    for (std::size_t r = 0; r < 3; ++r) {
        Eigen::Index c = 0;
        C_bs.row(static_cast<Eigen::Index>(r)).cwiseAbs().maxCoeff(&c);
        if (r > 0) out += ", ";
        out += names[r];
        out += C_bs(static_cast<Eigen::Index>(r), c) < 0.0 ? " = -" : " = ";
        out += names[static_cast<std::size_t>(c)];
    }
    return out;
}

}  // namespace schuler::ahrs
