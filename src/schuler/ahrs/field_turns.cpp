#include "schuler/ahrs/field_turns.h"

#include "schuler/math/rotation.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double interval = 0.2, longest_step = 0.5;  // s between the compared readings
constexpr double least_turn = 0.01;                   // rad in an interval, below which it contains no information
constexpr double least_turned = 1.0;                  // rad, root of the sum of squares of the changes of direction
constexpr double alike = 10.0;  // neighbouring pairs with correlated residuals: local disturbances last for seconds

}  // namespace

Turning::Turning(std::span<const ImuSample> imu)
    : imu_(imu), q_(imu.size(), Eigen::Quaterniond::Identity()), broken_(imu.size()) {
    for (std::size_t i = 1; i < imu.size(); ++i) {
        const double dt = (imu[i].time - imu[i - 1].time).seconds();
        const bool usable = imu[i].gyro.allFinite() && dt >= 0.0 && dt <= longest_step;
        broken_[i] = broken_[i - 1] + (usable ? 0 : 1);
        q_[i] = usable ? (q_[i - 1] * math::quaternion_from_rotation_vector(imu[i].gyro * dt)).normalized() : q_[i - 1];
    }
}

std::size_t Turning::before(Time t) const {
    const auto after = std::ranges::upper_bound(imu_, t, {}, &ImuSample::time);
    return static_cast<std::size_t>(after - imu_.begin()) - 1;
}

Eigen::Quaterniond Turning::at(std::size_t i, Time t) const {
    const double dt = (t - imu_[i].time).seconds();
    return dt > 0.0 && i + 1 < imu_.size() ? q_[i] * math::quaternion_from_rotation_vector(imu_[i + 1].gyro * dt) : q_[i];
}

std::optional<Matrix3d> Turning::between(Time a, Time b) const {
    if (imu_.empty() || a < imu_.front().time || b > imu_.back().time || b < a) return std::nullopt;
    const std::size_t i = before(a), k = before(b);
    if (broken_[std::min(k + 1, imu_.size() - 1)] != broken_[i]) return std::nullopt;
    return (at(k, b).conjugate() * at(i, a)).toRotationMatrix();
}

std::vector<ReadingPair> reading_pairs(std::span<const MagSample> mag, std::size_t enough) {
    std::vector<ReadingPair> all;
    std::size_t first = 0;
    for (std::size_t m = 1; m < mag.size(); ++m) {
        const double span = (mag[m].time - mag[first].time).seconds();
        if (span < interval) continue;
        if (span < longest_step && mag[first].field_b.allFinite() && mag[m].field_b.allFinite())
            all.push_back({&mag[first], &mag[m]});
        first = m;
    }
    if (all.size() <= enough) return all;
    std::vector<ReadingPair> out;
    for (std::size_t i = 0; i < enough; ++i) out.push_back(all[i * all.size() / enough]);
    return out;
}

FieldTurns::FieldTurns(const Turning& turning, std::span<const ReadingPair> readings, double delay) {
    const Duration age = Duration::from_seconds(delay);
    for (const auto& [first, second] : readings) {
        const auto C = turning.between(first->time - age, second->time - age);
        if (C && std::acos(std::clamp(0.5 * (C->trace() - 1.0), -1.0, 1.0)) > least_turn)
            pairs_.push_back({first->field_b, second->field_b - first->field_b, *C - Matrix3d::Identity()});
    }
    for (const Pair& p : pairs_) {
        changes_ += p.change.squaredNorm();
        sizes_ += p.first.squaredNorm();
    }
    bound_ = pairs_.empty() ? 0.0 : 9.0 * changes_ / static_cast<double>(pairs_.size());
    for (const Pair& p : pairs_) capped_ += std::min(bound_, p.change.squaredNorm());
}

bool FieldTurns::enough() const {
    return !pairs_.empty() && changes_ > least_turned * least_turned * sizes_ / static_cast<double>(pairs_.size());
}

FieldTurns::Unexplained FieldTurns::unexplained(const Matrix3d& C) const {
    Unexplained out;
    Matrix3d N = 1e-9 * static_cast<double>(pairs_.size()) * Matrix3d::Identity();
    Vector3d right = Vector3d::Zero();
    for (const Pair& p : pairs_) {
        N.noalias() += p.turn.transpose() * p.turn;
        right.noalias() += p.turn.transpose() * (p.turn * (C * p.first) - C * p.change);
    }
    const Matrix3d inverse = N.inverse();
    out.hard_iron_b = inverse * right;
    for (const Pair& p : pairs_)
        out.left += std::min(bound_, (C * p.change - p.turn * (C * p.first - out.hard_iron_b)).squaredNorm());
    const double variance = alike * out.left / (3.0 * static_cast<double>(std::max<std::size_t>(1, pairs_.size())));
    out.std = std::sqrt(variance * inverse.diagonal().maxCoeff());
    return out;
}

bool FieldTurns::clearly_worse(double worse, double better) const {
    constexpr double least = 15.0;  // log-likelihood ratio
    return worse > equal_within * better && 1.5 * static_cast<double>(pairs_.size()) / alike * std::log(worse / better) > least;
}

std::vector<Matrix3d> axes_candidates() {
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

}  // namespace schuler::ahrs
