#include "schuler/ahrs/heading_channel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::ahrs {
namespace {

using S = HeadingState;

constexpr double squared(double x) { return x * x; }

constexpr double strongest_field = 70e-6;  // T, of the Earth; the excess of a reading is due to iron
constexpr double unknown_heading_variance = squared(std::numbers::pi) / 3.0;  // rad^2, uniform, until a field is measured
constexpr double tail = 4.0;                                                  // degrees of freedom of the field's disturbances
constexpr double shortest_memory = 1e-3;
constexpr double disturbed_level = 3.0;

Eigen::Quaterniond about_vertical(double angle) { return {std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle)}; }

}  // namespace

HeadingChannel::HeadingChannel(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis)
    : settings_(settings), tilt_(tilt), six_axis_(six_axis), q_nw_(about_vertical(settings.declination)) {}

double FreeTurn::std_since(const FreeTurn& before) const {
    const double unknown = std::sqrt(unknown_heading_variance);
    return levellings > before.levellings ? unknown
                                          : std::min(unknown, std::hypot(std::sqrt(noise - before.noise), drift - before.drift));
}

void HeadingChannel::gather(const Eigen::Matrix3d& C_wb, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b) {
    means_.add(C_wb, rate_b, field_b);
    ++samples_;
}

/// Variance of the direction of the level field; for a poorly known field that of an unknown heading.
double HeadingChannel::variance() const {
    if (!started_ && six_axis_) return squared(free_turn_.std_since({}));
    if (!started_ || forget_) return unknown_heading_variance;
    const double size2 = estimate_.level_field.squaredNorm();
    const Eigen::Vector2d across(-estimate_.level_field.y(), estimate_.level_field.x());
    const double square = across.dot(P_.topLeftCorner<2, 2>() * across);
    if (!(size2 > 0.0)) return unknown_heading_variance;
    // the tilt of the accelerometer bias persists, and with it its part of the field
    const double tilted = heading_of_tilt(estimate_.level_field, estimate_.vertical, tilt_of_accel_bias_).squaredNorm();
    return std::min(unknown_heading_variance, square / (size2 * size2) + tilted);
}

/// The first reading is the field plus the irons: the uncertainty of the irons is also that of the field.
void HeadingChannel::start(const Block& block, const Eigen::Vector3d& bias) {
    if (six_axis_ || samples_ == 0) return;
    FieldMeans means = means_;
    means.scale(1.0 / samples_);
    const Eigen::Vector3d field_w = means.field_w();
    estimate_.level_field = field_w.head<2>();
    estimate_.vertical = field_w.z();
    estimate_.bias = bias;
    const double surplus = std::max(0.0, field_w.norm() - strongest_field);
    HeadingVector variance = HeadingVector::Zero();
    variance.segment<3>(S::bias).setConstant(squared(tilt_.bias_std));
    variance.segment<9>(S::gyro_matrix).setConstant(squared(settings_.gyro_matrix_std));
    variance.segment<3>(S::hard_iron).setConstant(squared(settings_.hard_iron_std) + squared(surplus));
    variance.segment<9>(S::soft_iron).setConstant(squared(settings_.soft_iron_std));
    variance(S::delay) = squared(settings_.delay_std);
    P_ = variance.asDiagonal();
    // the field is the reading minus the irons
    Eigen::Matrix<double, 3, heading_states> H = field_measurement(estimate_, means).H;
    H.col(0).setZero();
    H.col(1).setZero();
    H.col(S::vertical).setZero();
    const Eigen::Matrix<double, 3, heading_states> rows = H * P_;
    const Eigen::Matrix3d field = rows * H.transpose();
    constexpr std::array place{S::level_field, S::level_field + 1, S::vertical};
    for (int i = 0; i < 3; ++i) {
        P_.row(place[i]) = rows.row(i);
        P_.col(place[i]) = rows.row(i).transpose();
    }
    for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) P_(place[i], place[k]) = field(i, k);
        // local contribution at the current position
        P_(place[i], place[i]) += squared(settings_.field_noise) + squared(settings_.place_std);
    }
    // if levelled by a force that included accelerations, the vertical field has a horizontal component
    P_(S::level_field, S::level_field) += squared(estimate_.vertical) * block.P_tilt(1, 1);
    P_(S::level_field + 1, S::level_field + 1) += squared(estimate_.vertical) * block.P_tilt(0, 0);
    if (settings_.known_field_n.allFinite()) {
        HeadingVector dx = HeadingVector::Zero(), h = HeadingVector::Zero();
        const double r = squared(settings_.known_field_std), horizontal = estimate_.horizontal();
        if (horizontal > 0.0) {
            h.head<2>() = estimate_.level_field / horizontal;
            estim::update_scalar<heading_states>(dx, P_, h, horizontal - settings_.known_field_n.head<2>().norm(), r);
        }
        estim::update_scalar<heading_states>(dx, P_, HeadingVector::Unit(S::vertical),
                                             estimate_.vertical - settings_.known_field_n.z(), r);
        estimate_.correct(dx);
    }
    P_(S::place, S::place) = P_(S::place + 1, S::place + 1) = squared(settings_.place_std);
    forget_ = false;
    started_ = true;
}

/// Variance of the noise part of a block's rotation, rad^2.
double HeadingChannel::turn_noise(const Block& block) const {
    return (squared(settings_.walk) + squared(tilt_.gyro_noise)) * block.duration + squared(settings_.turn_noise) * block.turned +
           squared(block.doubt);
}

/// Applies the strapdown of the block with the bias and matrix of this channel instead of those used before.
void HeadingChannel::pass(const Block& block) {
    const double dt = block.duration;
    const HeadingTurn turn = heading_turn(estimate_, block);
    estimate_.turn(turn.angle);
    turned_ += turn.angle;
    turn_row_ += turn.row;
    noise_ += turn_noise(block);
    duration_ += dt;
}

/// Transition I + E A, where A are the rows of the states in w axes: their errors rotate with them, and with the rotation's error.
void HeadingChannel::propagate(TurningRows& A) {
    constexpr int n = S::turning;
    const double keep = std::exp(-duration_ / settings_.place_time);
    Eigen::Matrix<double, n, 1> across;  // d(states)/d(turn)
    across << estimate_.level_field.y(), -estimate_.level_field.x(), estimate_.place.y(), -estimate_.place.x();
    estimate_.place *= keep;
    const Eigen::Matrix2d R = Eigen::Rotation2Dd(-turned_).toRotationMatrix();
    A = across * turn_row_.transpose();
    A.middleCols<2>(S::level_field).topRows<2>() += R - Eigen::Matrix2d::Identity();
    A.middleCols<2>(S::place).bottomRows<2>() += keep * R - Eigen::Matrix2d::Identity();
    if (forget_) {  // after a new levelling the azimuth of w is arbitrary
        A.setZero();
        A.leftCols<n>().diagonal().setConstant(-1.0);
        estimate_.place.setZero();
        noise_ = 0.0;
    }
    const TurningRows rows = A.lazyProduct(P_);  // small: without the packing of large products
    const Eigen::Matrix<double, n, n> corner = rows * A.transpose();
    P_.topRows<n>() += rows;
    P_.leftCols<n>() += rows.transpose();
    P_.topLeftCorner<n, n>() += corner + noise_ * across * across.transpose();
    P_.diagonal().segment<2>(S::place).array() += (forget_ ? 1.0 : 1.0 - keep * keep) * squared(settings_.place_std);
    if (forget_) P_.diagonal().head<2>().array() += squared(2.0 * estimate_.horizontal());
    forget_ = false;
    const double dt = duration_;
    P_.diagonal().segment<3>(S::bias).array() += squared(tilt_.bias_walk) * dt;
    P_.diagonal().segment<3>(S::hard_iron).array() += squared(settings_.hard_iron_walk) * dt;
    P_.diagonal().head<2>().array() += squared(settings_.field_walk) * dt;
    P_(S::vertical, S::vertical) += squared(settings_.field_walk) * dt;
    P_(S::delay, S::delay) += squared(settings_.delay_walk) * dt;
}

void HeadingChannel::close(const Block& block, const Eigen::Vector3d& bias, Counters& counters, HeadingRecord* record) {
    if (block.levelled) {  // the samples gathered so far refer to an invalid horizon
        means_ = FieldMeans{};
        samples_ = 0;
        forget_ = true;
    }
    free_turn_.noise += turn_noise(block);
    free_turn_.drift += block.down_bias_std * block.duration;
    if (block.levelled) ++free_turn_.levellings;
    tilt_of_accel_bias_ = block.tilt_of_accel_bias;
    if (!started_) {  // without a magnetometer the heading is that of the tilt channel, starting at zero
        start(block, bias);
    } else {
        pass(block);
    }
    if (record) record->path = estimate_.level_field;
    if (!started_) return;
    // half a block early rather than one late
    if (duration_ >= settings_.block - 0.5 * block.duration) update(block, counters, record);
    q_nw_ = about_vertical(heading());
}

void HeadingChannel::update(const Block& block, Counters& counters, HeadingRecord* record) {
    TurningRows transition;
    propagate(transition);
    HeadingVector dx = HeadingVector::Zero();
    int count = 0;
    const auto measure = [&](const HeadingVector& h, double computed_minus_measured, double variance) {
        const auto update = estim::update_scalar<heading_states>(dx, P_, h, computed_minus_measured, variance);
        if (record) record->updates[static_cast<std::size_t>(count)] = update;
        ++count;
    };
    const bool rest = block.rest_time > 0.0;
    if (rest) {
        const double variance = squared(tilt_.rest_rate_std) * block.duration / duration_;
        for (int i = 0; i < 3; ++i) measure(HeadingVector::Unit(S::bias + i), estimate_.bias(i) - block.rate_b(i), variance);
    }
    if (samples_ > 0) {
        means_.scale(1.0 / samples_);
        const FieldMeasurement m = field_measurement(estimate_, means_, rest);
        // joint improbability of norm, dip and direction, current and recent
        double nis = 0.0, spread = 0.0;
        for (int i = 0; i < 3; ++i) {
            const HeadingVector h = m.H.row(i).transpose();
            double predicted = 0.0;
            for (int c = 0; c < heading_states; ++c) {
                if (h(c) != 0.0) predicted += h(c) * h.dot(P_.col(c));
            }
            const double share = predicted / squared(settings_.field_noise) + 1.0;
            nis += squared(m.innovation(i) / settings_.field_noise) / share / 3.0;
            spread += std::log(share);
        }
        // Student's distribution, because local disturbances exceed a normal distribution; correlated samples count once
        const double fresh = std::min(1.0, duration_ / (2.0 * settings_.field_time)) / (rest ? settings_.rest_factor : 1.0);
        evidence_ -= fresh * 0.5 * (spread + (tail + 3.0) * std::log1p(3.0 * nis / tail));
        unexplained_ = m.innovation.norm();
        level_ += duration_ / (settings_.adaptation_time + duration_) * (nis - level_);
        const bool known = record != nullptr && std::isfinite(record->disturbance);
        const double disturbance = known ? std::max(1.0, record->disturbance) : std::max({1.0, level_, nis});
        // a long disturbance is correlated at least over its duration: repeated measurements add no information
        double factor = std::pow(disturbance, settings_.robustness) * std::max(1.0, disturbed_for_ / settings_.field_time);
        if (rest) factor *= settings_.rest_factor * std::max(1.0, block.rest_time / 5.0);
        const double r = squared(settings_.field_noise) * 2.0 * settings_.field_time / duration_ * factor;
        // the correlated tilt error, as white noise of the same effect on slower variations
        const double memory =
            (1.0 + block.tilt_kept) / std::max(1.0 - block.tilt_kept, shortest_memory) * block.duration / duration_;
        const double tilt = squared(estimate_.vertical) * memory;
        measure(m.H.row(0).transpose(), m.innovation(0), r + tilt * block.P_tilt(1, 1));
        measure(m.H.row(1).transpose(), m.innovation(1), r + tilt * block.P_tilt(0, 0));
        measure(m.H.row(2).transpose(), m.innovation(2), r);
        const bool disturbed = disturbance > disturbed_level;
        if (disturbed) ++counters.disturbed_blocks;
        disturbed_for_ = disturbed ? disturbed_for_ + duration_ : 0.0;
    }
    estimate_.correct(dx);
    if (record) {
        record->active = true;
        record->transition = transition;
        record->P_level = P_.leftCols<2>();
        record->correction = dx.head<2>();
        record->count = count;
        record->field = samples_ > 0;
    }
    means_ = FieldMeans{};
    turn_row_.setZero();
    turned_ = duration_ = noise_ = 0.0;
    samples_ = 0;
}

double HeadingChannel::hard_iron_std() const { return std::sqrt(P_.diagonal().segment<3>(S::hard_iron).maxCoeff()); }

void HeadingChannel::share_samples(const HeadingChannel& other) {
    means_ = other.means_;
    samples_ = other.samples_;
}

void HeadingChannel::doubt_iron(double std) {
    P_.diagonal().segment<3>(S::hard_iron).array() += squared(std);
    level_ = 1.0;
    disturbed_for_ = evidence_ = 0.0;
}

void HeadingChannel::doubt_place(double std) {
    P_.diagonal().segment<2>(S::place).array() += squared(std);
    P_(S::vertical, S::vertical) += squared(std);
    level_ = 1.0;
    disturbed_for_ = evidence_ = 0.0;
}

void HeadingChannel::adopt(const HeadingChannel& other) {
    const HeadingSettings settings = settings_;
    *this = other;
    settings_ = settings;
}

}  // namespace schuler::ahrs
