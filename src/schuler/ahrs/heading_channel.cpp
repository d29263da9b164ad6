#include "schuler/ahrs/heading_channel.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::ahrs {
namespace {

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
    field_w_.noalias() += C_wb * field_b;
    sweep_w_.noalias() += C_wb * rate_b.cross(field_b);
    C_wb_ += C_wb;
    ++samples_;
}

void HeadingChannel::start(const Eigen::Vector3d& bias) {
    if (six_axis_ || samples_ == 0) return;
    const Eigen::Vector3d field_w = field_w_ / samples_;
    heading_ = -std::atan2(field_w.y(), field_w.x());
    horizontal_ = field_w.head<2>().norm();
    vertical_ = field_w.z();
    double field_variance = squared(settings_.field_std);
    if (settings_.known_field_n.allFinite()) {
        horizontal_ = settings_.known_field_n.head<2>().norm();
        vertical_ = settings_.known_field_n.z();
        field_variance = squared(settings_.known_field_std);
    }
    lately_ = {horizontal_, vertical_};
    bias_ = bias;
    const double b = squared(tilt_.bias_std), h = squared(settings_.hard_iron_std);
    P_ = (HeadingVector() << squared(start_heading_std), b, b, b, h, h, h, field_variance, field_variance,
          squared(settings_.delay_std))
             .finished()
             .asDiagonal();
    started_ = true;
}

void HeadingChannel::propagate(const Block& block) {
    const double dt = block.duration;
    const Eigen::Vector3d vertical_b = block.C_wb.row(2).transpose();
    heading_ -= vertical_b.dot(bias_ - block.bias_used) * dt;
    P_.row(0) -= (vertical_b.transpose() * P_.middleRows<3>(1)).eval() * dt;
    P_.col(0) -= (P_.middleCols<3>(1) * vertical_b).eval() * dt;
    const double turn = squared(settings_.turn_noise) * block.turned + squared(block.doubt);
    P_(0, 0) += (squared(settings_.walk) + squared(tilt_.gyro_noise)) * dt + turn;
    const double bias = squared(tilt_.bias_walk) * dt, iron = squared(settings_.hard_iron_walk) * dt;
    const double field = squared(settings_.field_walk) * dt, delay = squared(settings_.delay_walk) * dt;
    P_.diagonal().tail<9>() +=
        (Eigen::Matrix<double, 9, 1>() << bias, bias, bias, iron, iron, iron, field, field, delay).finished();
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
    for (int i = 4; i < 9; ++i) {
        P_.row(i).setZero();
        P_.col(i).setZero();
        P_(i, i) = squared(i < 7 ? settings_.hard_iron_std : settings_.field_std);
    }
    P_(0, 0) += squared(anew_heading_std);
    const Eigen::Vector3d field_w = field_w_ / samples_ - C_wb_ / samples_ * hard_iron_;
    horizontal_ = field_w.head<2>().norm();
    vertical_ = field_w.z();
    level_ = 1.0;
    disturbed_for_ = 0.0;
}

void HeadingChannel::close(const Block& block, const Eigen::Vector3d& bias, Counters& counters, HeadingRecord* record) {
    if (!started_) {
        // without a magnetometer the heading is the tilt channel's own, from zero
        if (six_axis_) P_(0, 0) += squared(tilt_.gyro_noise) * block.duration + squared(settings_.turn_noise) * block.turned;
        start(bias);
        if (record) record->heading = heading();
    }
    if (!started_) return;
    propagate(block);
    HeadingVector dx = HeadingVector::Zero();
    int count = 0;
    const auto measure = [&](const HeadingVector& h, double computed_minus_measured, double variance) {
        const auto update = estim::update_scalar<heading_states>(dx, P_, h, computed_minus_measured, variance);
        if (record) record->updates[static_cast<std::size_t>(count)] = update;
        ++count;
    };
    const bool rest = block.rest_time > 0.0;
    if (rest) {
        for (int i = 0; i < 3; ++i) measure(HeadingVector::Unit(1 + i), bias_(i) - block.rate_b(i), squared(tilt_.rest_rate_std));
    }
    if (samples_ > 0) {
        const double c = std::cos(heading_), s = std::sin(heading_), n = samples_;
        Eigen::Matrix3d C_nw;
        C_nw << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
        const Eigen::Matrix3d C_nb = C_nw * (C_wb_ / n);
        const Eigen::Vector3d sweep = C_nw * (sweep_w_ / n);
        const Eigen::Vector3d field = C_nw * (field_w_ / n) - C_nb * hard_iron_ - delay_ * sweep;
        const Eigen::Vector3d innovation = field - Eigen::Vector3d(horizontal_, 0.0, vertical_);
        Eigen::Matrix<double, 3, heading_states> H = Eigen::Matrix<double, 3, heading_states>::Zero();
        H(0, 0) = -field.y();
        H(1, 0) = field.x();
        H.block<3, 3>(0, 4) = -C_nb;
        H(0, 7) = H(2, 8) = -1.0;
        H.col(9) = -sweep;
        watch_steadiness(field, block.duration);
        // how improbable norm, dip and direction are together, now and lately
        double nis = 0.0;
        for (int i = 0; i < 3; ++i) {
            const HeadingVector h = H.row(i).transpose();
            nis += squared(innovation(i)) / (h.dot(P_ * h) + squared(settings_.field_noise)) / 3.0;
        }
        level_ += block.duration / (settings_.adaptation_time + block.duration) * (nis - level_);
        const double disturbance = std::max({1.0, level_, nis});
        double factor = std::pow(disturbance, settings_.robustness);
        if (rest) factor *= settings_.rest_factor * std::max(1.0, block.rest_time / 5.0);
        const double r = squared(settings_.field_noise) * 2.0 * settings_.field_time / block.duration * factor;
        // the tilt error about north, with its memory, as white noise of the same effect on what is slower than it
        const Eigen::Vector2d north_w(c, -s);
        const double tilt = north_w.dot(block.P_tilt * north_w);
        const double memory = (1.0 + block.tilt_kept) / std::max(1.0 - block.tilt_kept, shortest_memory);
        measure(H.row(0).transpose(), innovation(0), r);
        measure(H.row(1).transpose(), innovation(1), r + squared(vertical_) * tilt * memory);
        measure(H.row(2).transpose(), innovation(2), r);
        const bool disturbed = disturbance > disturbed_level;
        if (disturbed) ++counters.disturbed_blocks;
        disturbed_for_ = disturbed ? disturbed_for_ + block.duration : 0.0;
    }
    heading_ -= dx(0);
    bias_ -= dx.segment<3>(1);
    hard_iron_ -= dx.segment<3>(4);
    horizontal_ -= dx(7);
    vertical_ -= dx(8);
    delay_ -= dx(9);
    q_nw_ = about_vertical(heading());
    if (disturbed_for_ >= settings_.recovery_time && steady() && !rest && samples_ > 0 && !record) {
        learn_anew();
        ++counters.recoveries;
    }
    if (record) {
        record->vertical_b = block.C_wb.row(2).transpose();
        record->duration = block.duration;
        record->active = true;
        record->P_heading = P_.col(0);
        record->heading = heading();
        record->correction = dx(0);
        record->count = count;
    }
    field_w_.setZero();
    sweep_w_.setZero();
    C_wb_.setZero();
    samples_ = 0;
}

}  // namespace schuler::ahrs
