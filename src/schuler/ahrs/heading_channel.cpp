#include "schuler/ahrs/heading_channel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::ahrs {
namespace {

using S = HeadingState;

constexpr double squared(double x) { return x * x; }

constexpr double start_heading_std = 0.2;        // rad
constexpr double unknown_heading_variance = squared(std::numbers::pi) / 3.0;  // rad^2, uniform, until the field is seen
constexpr double anew_heading_std = 0.1;         // rad, how far a disturbance may have drawn the heading before recovery
constexpr double shortest_memory = 1e-3;
constexpr double disturbed_level = 3.0;
constexpr double steady_time = 10.0;             // s over which a field is to be steady before it is learnt
constexpr double steady_field = 4e-6;            // T; a magnet fixed to a sensor that turns moves the field by far more

Eigen::Quaterniond about_vertical(double angle) { return {std::cos(0.5 * angle), 0.0, 0.0, std::sin(0.5 * angle)}; }

}  // namespace

HeadingChannel::HeadingChannel(const HeadingSettings& settings, const TiltSettings& tilt, bool six_axis)
    : settings_(settings), tilt_(tilt), six_axis_(six_axis), q_nw_(about_vertical(settings.declination)) {
    if (!six_axis) P_(0, 0) = unknown_heading_variance;
}

void HeadingChannel::gather(const Eigen::Matrix3d& C_wb, const Eigen::Vector3d& rate_b, const Eigen::Vector3d& field_b) {
    means_.add(C_wb, rate_b, field_b);
    ++samples_;
}

void HeadingChannel::start(const Eigen::Vector3d& bias) {
    if (six_axis_ || samples_ == 0) return;
    const Eigen::Vector3d field_w = means_.field_w() / samples_;
    estimate_.heading = -std::atan2(field_w.y(), field_w.x());
    estimate_.horizontal = field_w.head<2>().norm();
    estimate_.vertical = field_w.z();
    double field_variance = squared(settings_.field_std);
    if (settings_.known_field_n.allFinite()) {
        estimate_.horizontal = settings_.known_field_n.head<2>().norm();
        estimate_.vertical = settings_.known_field_n.z();
        field_variance = squared(settings_.known_field_std);
    }
    lately_ = {estimate_.horizontal, estimate_.vertical};
    estimate_.bias = bias;
    HeadingVector variance;
    variance(S::heading) = squared(start_heading_std);
    variance.segment<3>(S::bias).setConstant(squared(tilt_.bias_std));
    variance.segment<9>(S::gyro_matrix).setConstant(squared(settings_.gyro_matrix_std));
    variance.segment<3>(S::hard_iron).setConstant(squared(settings_.hard_iron_std));
    variance.segment<9>(S::soft_iron).setConstant(squared(settings_.soft_iron_std));
    variance(S::horizontal) = variance(S::vertical) = field_variance;
    variance(S::delay) = squared(settings_.delay_std);
    P_ = variance.asDiagonal();
    started_ = true;
}

/// The strapdown of the block goes on with the bias and the matrix of this channel instead of those that it has used.
void HeadingChannel::pass(const Block& block) {
    const double dt = block.duration;
    const HeadingTurn turn = heading_turn(estimate_, block);
    estimate_.heading += turn.angle;
    transition_ += turn.row;
    noise_ += (squared(settings_.walk) + squared(tilt_.gyro_noise)) * dt + squared(settings_.turn_noise) * block.turned + squared(block.doubt);
    duration_ += dt;
}

void HeadingChannel::propagate() {
    const HeadingVector column = P_ * transition_;
    P_.col(0) += column;
    P_.row(0) += column.transpose();
    P_(0, 0) += transition_.dot(column) + noise_;
    const double dt = duration_;
    P_.diagonal().segment<3>(S::bias).array() += squared(tilt_.bias_walk) * dt;
    P_.diagonal().segment<3>(S::hard_iron).array() += squared(settings_.hard_iron_walk) * dt;
    P_(S::horizontal, S::horizontal) += squared(settings_.field_walk) * dt;
    P_(S::vertical, S::vertical) += squared(settings_.field_walk) * dt;
    P_(S::delay, S::delay) += squared(settings_.delay_walk) * dt;
}

void HeadingChannel::watch_steadiness(const Eigen::Vector3d& field_n, double dt) {
    const Eigen::Vector2d now(field_n.head<2>().norm(), field_n.z());
    const double gain = dt / (steady_time + dt);
    const Eigen::Vector2d change = now - lately_;
    lately_ += gain * change;
    unsteadiness_ += gain * (change.squaredNorm() - unsteadiness_);
}

/// Whether the field, disturbed or not, belongs to the place: horizontal and vertical part stay the same while the sensor moves.
bool HeadingChannel::steady() const { return unsteadiness_ < squared(steady_field); }

void HeadingChannel::learn_anew() {
    for (const int i : {S::hard_iron, S::hard_iron + 1, S::hard_iron + 2, S::horizontal, S::vertical}) {
        P_.row(i).setZero();
        P_.col(i).setZero();
        P_(i, i) = squared(i < S::soft_iron ? settings_.hard_iron_std : settings_.field_std);
    }
    P_(0, 0) += squared(anew_heading_std);
    const Eigen::Vector3d field_w = means_.field_w() - means_.C_wb * estimate_.hard_iron;
    estimate_.horizontal = field_w.head<2>().norm();
    estimate_.vertical = field_w.z();
    level_ = 1.0;
    disturbed_for_ = 0.0;
}

void HeadingChannel::close(const Block& block, const Eigen::Vector3d& bias, Counters& counters, HeadingRecord* record) {
    if (!started_) {
        // without a magnetometer the heading is the tilt channel's own, from zero
        if (six_axis_) P_(0, 0) += squared(tilt_.gyro_noise) * block.duration + squared(settings_.turn_noise) * block.turned;
        start(bias);
    } else {
        pass(block);
    }
    if (record) record->path = heading();
    if (!started_) return;
    // half a block early rather than one late
    if (duration_ >= settings_.block - 0.5 * block.duration) update(block, counters, record);
    q_nw_ = about_vertical(heading());
}

void HeadingChannel::update(const Block& block, Counters& counters, HeadingRecord* record) {
    if (record) record->transition = transition_;
    propagate();
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
        const FieldMeasurement m = field_measurement(estimate_, means_);
        watch_steadiness(m.field_n, duration_);
        // how improbable norm, dip and direction are together, now and lately
        double nis = 0.0;
        for (int i = 0; i < 3; ++i) {
            const HeadingVector h = m.H.row(i).transpose();
            nis += squared(m.innovation(i)) / (h.dot(P_ * h) + squared(settings_.field_noise)) / 3.0;
        }
        level_ += duration_ / (settings_.adaptation_time + duration_) * (nis - level_);
        const bool known = record != nullptr && std::isfinite(record->disturbance);
        const double disturbance = known ? std::max(1.0, record->disturbance) : std::max({1.0, level_, nis});
        // what has lasted so long has at least that memory: it tells no more for being measured again
        double factor = std::pow(disturbance, settings_.robustness) * std::max(1.0, disturbed_for_ / settings_.field_time);
        if (rest) factor *= settings_.rest_factor * std::max(1.0, block.rest_time / 5.0);
        const double r = squared(settings_.field_noise) * 2.0 * settings_.field_time / duration_ * factor;
        // the tilt error about north, with its memory, as white noise of the same effect on what is slower than it
        const Eigen::Vector2d north_w(std::cos(estimate_.heading), -std::sin(estimate_.heading));
        const double tilt = north_w.dot(block.P_tilt * north_w);
        const double memory = (1.0 + block.tilt_kept) / std::max(1.0 - block.tilt_kept, shortest_memory) * block.duration / duration_;
        measure(m.H.row(0).transpose(), m.innovation(0), r);
        measure(m.H.row(1).transpose(), m.innovation(1), r + squared(estimate_.vertical) * tilt * memory);
        measure(m.H.row(2).transpose(), m.innovation(2), r);
        const bool disturbed = disturbance > disturbed_level;
        if (disturbed) ++counters.disturbed_blocks;
        disturbed_for_ = disturbed ? disturbed_for_ + duration_ : 0.0;
    }
    estimate_.correct(dx);
    if (disturbed_for_ >= settings_.recovery_time && steady() && !rest && samples_ > 0 && !record) {
        learn_anew();
        ++counters.recoveries;
    }
    if (record) {
        record->active = true;
        record->P_heading = P_.col(0);
        record->correction = dx(0);
        record->count = count;
        record->field = samples_ > 0;
    }
    means_ = FieldMeans{};
    transition_.setZero();
    duration_ = noise_ = 0.0;
    samples_ = 0;
}

}  // namespace schuler::ahrs
