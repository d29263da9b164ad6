#include "schuler/receiver/loop_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace schuler::receiver {

using std::numbers::pi;

namespace {

constexpr double any_phase = 1.0 / 48.0;  ///< cycles^2, uniform within half a cycle

}  // namespace

DiscriminatorResponse phase_detector(double snr) {
    // the smaller of both limits, with a smooth transition: above the integral over the density of the angle by up to 24 % at an snr of
    // one half, below it by 5 % at three
    const double jitter = (1.0 + 1.0 / (2.0 * snr)) / (2.0 * snr) / (4.0 * pi * pi);
    return {-std::expm1(-snr), 1.0 / std::hypot(1.0 / jitter, 1.0 / any_phase)};
}

DiscriminatorResponse frequency_detector(double snr, double interval, double range) {
    const double jitter = (1.0 + 1.0 / snr) / snr / std::pow(2.0 * pi * interval, 2), one = -std::expm1(-snr);
    return {one * one, 1.0 / std::hypot(1.0 / jitter, 3.0 / (range * range))};
}

LoopModel::LoopModel(Carrier kind, const CarrierLoop& carrier_loop, const CodeLoop& code_loop, double interval,
                     double chips_per_cycle) {
    const auto next = [&](const Vector& s, double output, double code_output) {
        Vector out = s;
        CarrierLoop loop = carrier_loop;
        loop.start(s[frequency], s[acceleration]);
        if (kind == Carrier::Phase) {
            out[phase] = s[phase] + interval * s[command];
            out[command] = loop.update(output, (output - s[measured]) / interval);
            out[measured] = output;
        } else {
            out[phase] = out[measured] = 0.0;
            if (kind == Carrier::Frequency) out[command] = loop.update(0.0, output);
        }
        if (kind != Carrier::Held) out[frequency] = loop.frequency(), out[acceleration] = loop.rate();
        CodeLoop coder = code_loop;
        coder.start(s[code_rate]);
        out[code] = s[code] + interval * (s[code_command] + chips_per_cycle * s[command]);
        out[code_command] = coder.update(code_output);
        out[code_rate] = coder.rate();
        return out;
    };
    for (int i = 0; i < size; ++i) free_.col(i) = next(Vector::Unit(i), 0.0, 0.0);
    input_ = next(Vector::Zero(), 1.0, 0.0);
    input_code_ = next(Vector::Zero(), 0.0, 1.0);
    sees_.setZero();
    if (kind == Carrier::Phase) sees_[phase] = 1.0, sees_[command] = interval / 2.0;
    if (kind == Carrier::Frequency) sees_[command] = 1.0;
    sees_code_.setZero();
    sees_code_[code] = 1.0;
    sees_code_[code_command] = interval / 2.0;
    sees_code_[command] = interval / 2.0 * chips_per_cycle;
}

void LoopError::clear(LoopModel::Index state, double variance) {
    P_.row(state).setZero();
    P_.col(state).setZero();
    P_(state, state) = variance;
}

void LoopError::replace(LoopModel::Index state, LoopModel::Index by) {
    P_.row(state) = P_.row(by).eval();
    P_.col(state) = P_.col(by).eval();
}

void LoopError::start(const ReplicaUncertainty& found) {
    P_.setZero();
    P_(LoopModel::code, LoopModel::code) = found.code * found.code;
    P_(LoopModel::settled, LoopModel::settled) = found.frequency * found.frequency;
    return_to_settled();
}

void LoopError::close_phase() {
    clear(LoopModel::phase, any_phase);
    replace(LoopModel::measured, LoopModel::phase);
}

void LoopError::return_to_settled() {
    replace(LoopModel::frequency, LoopModel::settled);
    replace(LoopModel::command, LoopModel::settled);
    clear(LoopModel::acceleration);
}

void LoopError::clear_code_rate() {
    clear(LoopModel::code_command);
    clear(LoopModel::code_rate);
}

void LoopError::settle(double share) {
    P_.row(LoopModel::settled) += share * (P_.row(LoopModel::frequency) - P_.row(LoopModel::settled)).eval();
    P_.col(LoopModel::settled) += share * (P_.col(LoopModel::frequency) - P_.col(LoopModel::settled)).eval();
}

void LoopError::astray(double square) {
    P_(LoopModel::frequency, LoopModel::frequency) = std::max(P_(LoopModel::frequency, LoopModel::frequency), square);
    replace(LoopModel::command, LoopModel::frequency);
    close_phase();
}

double LoopError::unsettled_variance() const {
    using L = LoopModel;
    return P_(L::frequency, L::frequency) + P_(L::settled, L::settled) - 2.0 * P_(L::frequency, L::settled);
}

void LoopError::hold(double variance) {
    P_(LoopModel::command, LoopModel::command) = std::max(P_(LoopModel::command, LoopModel::command), variance);
}

void LoopError::take_for_settled() { replace(LoopModel::settled, LoopModel::frequency); }

void LoopError::update(const LoopModel& model, const DiscriminatorNoise& noise) {
    output_ = noise.carrier_slope * noise.carrier_slope * (model.sees_ * P_ * model.sees_.transpose())(0) +
              noise.carrier_variance + noise.walk / 3.0;
    LoopModel::Matrix A = model.free_;
    A.noalias() += noise.carrier_slope * model.input_ * model.sees_;
    A.noalias() += noise.code_slope * model.input_code_ * model.sees_code_;
    P_ = (A * P_ * A.transpose()).eval();
    P_.noalias() += noise.carrier_variance * model.input_ * model.input_.transpose();
    P_.noalias() += noise.code_variance * model.input_code_ * model.input_code_.transpose();
    P_(LoopModel::phase, LoopModel::phase) += noise.walk;
    // A phase that has wandered to the end of the discriminator's range locks at another half cycle: the error is within that range again,
    // and does not take the code back with it.
    constexpr double range = 1.0 / 4.0;  // cycles
    constexpr double regains = 0.5;      // of the slope
    if (P_(LoopModel::phase, LoopModel::phase) <= range * range || noise.carrier_slope < regains) return;
    const double kept = range / std::sqrt(P_(LoopModel::phase, LoopModel::phase));
    P_.row(LoopModel::phase) *= kept;
    P_.col(LoopModel::phase) *= kept;
    for (const LoopModel::Index carrier : {LoopModel::phase, LoopModel::command, LoopModel::frequency, LoopModel::acceleration,
                                           LoopModel::measured, LoopModel::settled})
        for (const LoopModel::Index code : {LoopModel::code, LoopModel::code_command, LoopModel::code_rate})
            P_(carrier, code) = P_(code, carrier) = 0.0;
}

PhaseStress::PhaseStress(double bandwidth, double interval, double clock)
    : rate_(2.0 * bandwidth), gain_(std::min(1.0, rate_ * interval)), clock_(clock) {
    // sum of the squares of the difference's impulse response g r^k (1 - g (k + 1)), r = 1 - g
    const double q = (1.0 - gain_) * (1.0 - gain_), left = 1.0 - q;
    difference_ = gain_ * gain_ * (1.0 / left - 2.0 * gain_ / (left * left) + gain_ * gain_ * (1.0 + q) / (left * left * left));
}

void PhaseStress::add(double output, double variance) {
    square_ += gain_ * (output * output - square_);
    expected_ += gain_ * (variance + clock_ - expected_);
    mean_ += gain_ * (output - mean_);
    earlier_ += gain_ * (mean_ - earlier_);
    changes_ += gain_ * ((mean_ - earlier_) * (mean_ - earlier_) - changes_);
}

double PhaseStress::phase() const {
    // a mean of n squares of Gaussian numbers scatters by sqrt(2 / n) of its expectation: three sigmas of it are beyond noise
    const double limit = 1.0 + 3.0 * std::sqrt(2.0 * gain_ / (2.0 - gain_));
    return square_ > limit * expected_ ? std::sqrt(square_ - expected_) : 0.0;
}

double PhaseStress::frequency() const {
    // The two means are one memory of the loop apart. Under a jerk that begins the phase error grows as the cube of time, and its
    // rate is up to three times that of the means, which lag.
    constexpr double beyond = 2.5, lag = 3.0;  // sigmas of noise; -
    const double now = (mean_ - earlier_) * (mean_ - earlier_), noise = difference_ * (expected_ - clock_) + clock_;
    const double lately = changes_ > (1.0 + 3.0 * std::sqrt(2.0 * gain_)) * noise ? changes_ - noise : 0.0;
    return lag * rate_ * std::sqrt(std::max(lately, now > beyond * beyond * noise ? now : 0.0));
}

}  // namespace schuler::receiver
