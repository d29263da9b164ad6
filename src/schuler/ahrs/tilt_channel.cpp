#include "schuler/ahrs/tilt_channel.h"

#include "schuler/math/rotation.h"

#include <algorithm>
#include <cmath>

namespace schuler::ahrs {
namespace {

using S = TiltState;

constexpr double start_tilt_std = 0.03;        // rad
constexpr double moving_tilt_std = 0.15;       // rad, for a log that starts in motion: accelerations of 1.5 m/s^2
constexpr double unknown_rate = 0.3;           // fraction of the last known rate: uncertainty of a missing sample's rate
constexpr double unknown_force = 3.0;          // m/s^2, possible acceleration while the accelerometer is unusable
constexpr double least_doubt = 1e-3;           // rad, smaller rotations may have been missed at rest
constexpr double linear_tilt = 0.3;            // rad; beyond this a tilt error is treated as unknown tilt
constexpr double largest_tilt_variance = 1.0;  // rad^2

/// d(tilt)/d(accelerometer bias) of a tilt taken from the force: the horizontal part of the bias is taken for gravity.
Eigen::Matrix<double, 2, 3> levelled_by_force(const Eigen::Matrix3d& C_wb, double gravity) {
    Eigen::Matrix<double, 2, 3> out;
    out << C_wb.row(1) / gravity, -C_wb.row(0) / gravity;
    return out;
}

}  // namespace

TiltChannel::TiltChannel(const TiltSettings& settings, const RestSettings& rest) : settings_(settings), rest_(rest) {}

void TiltChannel::start(const Eigen::Vector3d& force_b, bool moving) {
    q_wb_ = Eigen::Quaterniond::FromTwoVectors(force_b, Eigen::Vector3d(0.0, 0.0, -1.0)).normalized();
    // FromTwoVectors leaves the heading arbitrary: choose the one with b's x axis near north
    const Eigen::Vector3d x_w = q_wb_ * Eigen::Vector3d::UnitX();
    const double azimuth = x_w.head<2>().norm() > 1e-6 ? std::atan2(x_w.y(), x_w.x()) : 0.0;
    q_wb_ = Eigen::AngleAxisd(-azimuth, Eigen::Vector3d::UnitZ()) * q_wb_;
    const double tilt_std = moving ? moving_tilt_std : start_tilt_std;
    TiltVector std;
    std << tilt_std, tilt_std, settings_.velocity_std, settings_.velocity_std, Eigen::Vector3d::Constant(settings_.bias_std);
    P_ = std.cwiseAbs2().asDiagonal();
    from_accel_bias_.setZero();
    from_accel_bias_.topRows<2>() = levelled_by_force(q_wb_.toRotationMatrix(), settings_.gravity);
    started_ = true;
}

void TiltChannel::integrate(double dt, const Eigen::Vector3d& rate_b, bool rate_known, const Eigen::Vector3d* force_b) {
    rate_b_ = rate_b - bias_;
    q_wb_ = q_wb_ * math::quaternion_from_rotation_vector(rate_b_ * dt);
    const Eigen::Matrix3d C_wb = q_wb_.toRotationMatrix();
    const double turn = rate_b_.norm() * dt;
    block_.C_wb += C_wb;
    block_.rate_b += rate_b;
    block_.turned += turn;
    block_.duration += dt;
    if (!rate_known) block_.doubt += unknown_rate * turn;
    ++samples_;
    if (force_b) {
        block_.force_b += *force_b;
        block_.force_w.noalias() += C_wb * *force_b;
        ++forces_;
    }
}

void TiltChannel::doubt(double angle) {
    block_.doubt += angle;
    if (angle > linear_tilt) {
        level_wanted_ = true;
        const double doubt = block_.doubt;  // earlier forces contain no information about the tilt after the gap
        block_ = Block{};
        block_.doubt = doubt;
        samples_ = forces_ = 0;
        ++restarts_;
    }
    forget_velocity();
    quiet_ = 0.0;
}

void TiltChannel::forget_velocity() {
    velocity_.setZero();
    P_.middleRows<2>(S::velocity).setZero();
    P_.middleCols<2>(S::velocity).setZero();
    P_.diagonal().segment<2>(S::velocity).setConstant(settings_.velocity_std * settings_.velocity_std);
    from_accel_bias_.middleRows<2>(S::velocity).setZero();
}

Eigen::Matrix2d TiltChannel::tilt_covariance() const {
    const auto effect = settings_.accel_bias_std * from_accel_bias_.topRows<2>();
    return P_.topLeftCorner<2, 2>() + effect * effect.transpose();
}

void TiltChannel::forward_speed(double speed, double std, double valid) {
    speed_ = speed;
    speed_std_ = std;
    speed_valid_ = valid;
}

void TiltChannel::watch_rest() {
    const double gain = block_.duration / (rest_.memory + block_.duration);
    if (!watching_) {
        slow_rate_ = block_.rate_b;
        slow_force_ = block_.force_b;
        watching_ = true;
    }
    const Eigen::Vector3d rate = block_.rate_b - slow_rate_, force = block_.force_b - slow_force_;
    slow_rate_ += gain * rate;
    slow_force_ += gain * force;
    const bool quiet = block_.force_known && block_.doubt < least_doubt && rate.norm() < rest_.rate_change &&
                       force.norm() < rest_.force_change && slow_rate_.norm() < rest_.largest_rate;
    quiet_ = quiet ? quiet_ + block_.duration : 0.0;
    block_.rest_time = quiet_ >= rest_.after ? quiet_ : 0.0;
}

TiltTransition::TiltTransition(const Block& block, double gravity) {
    if (block.levelled) {  // tilt and velocity start anew
        rows.leftCols<S::changing>().diagonal().setConstant(-1.0);
        from_accel_bias.topRows<2>() = levelled_by_force(block.C_wb, gravity);
        return;
    }
    const Eigen::Matrix<double, 2, 3> turned = block.C_wb.topRows<2>() * block.duration;
    const double g_dt = gravity * block.duration;
    rows.block<2, 3>(S::tilt, S::gyro_bias) = turned;
    rows(S::velocity, S::tilt + 1) = g_dt;
    rows(S::velocity + 1, S::tilt) = -g_dt;
    rows.block<1, 3>(S::velocity, S::gyro_bias) = 0.5 * g_dt * turned.row(1);
    rows.block<1, 3>(S::velocity + 1, S::gyro_bias) = -0.5 * g_dt * turned.row(0);
    from_accel_bias.bottomRows<2>() = turned;
}

TiltMatrix TiltTransition::matrix() const {
    TiltMatrix F = TiltMatrix::Identity();
    F.topRows<S::changing>() += rows;
    return F;
}

void TiltTransition::propagate(TiltMatrix& P, AccelBiasEffect& effect) const {
    TiltRows added;
    added.noalias() = rows * P;
    const Eigen::Matrix<double, S::changing, S::changing> corner = added * rows.transpose();
    P.topRows<S::changing>() += added;
    P.leftCols<S::changing>() += added.transpose();
    P.topLeftCorner<S::changing, S::changing>() += corner;
    effect.topRows<S::changing>() += (rows * effect + from_accel_bias).eval();
}

void TiltTransition::propagate_back(estim::Adjoint<tilt_states>& adjoint) const {
    const TiltRows top = adjoint.Lambda.topRows<S::changing>();
    const Eigen::Matrix<double, S::changing, S::changing> corner = top.leftCols<S::changing>();
    adjoint.Lambda.noalias() += rows.transpose() * (top + corner * rows);
    adjoint.Lambda.noalias() += top.transpose() * rows;
    adjoint.Lambda = (0.5 * (adjoint.Lambda + adjoint.Lambda.transpose())).eval();
    const Eigen::Matrix<double, S::changing, 1> lambda = adjoint.lambda.head<S::changing>();
    adjoint.lambda.noalias() += rows.transpose() * lambda;
}

/// After a gap with unknown rotation: the mean force of the block is taken as gravity, as at the start.
void TiltChannel::level_anew() {
    if (!block_.force_known || !(block_.force_w.norm() > 0.0)) return;
    level_wanted_ = false;
    block_.levelled = true;
    block_.level = Eigen::Quaterniond::FromTwoVectors(block_.force_w, Eigen::Vector3d(0.0, 0.0, -1.0)).normalized();
    q_wb_ = (block_.level * q_wb_).normalized();
    block_.C_wb = (block_.level.toRotationMatrix() * block_.C_wb).eval();
    block_.force_w = (block_.level * block_.force_w).eval();
    velocity_.setZero();
}

void TiltChannel::propagate() {
    TiltTransition(block_, settings_.gravity).propagate(P_, from_accel_bias_);
    const double dt = block_.duration, s = settings_.gyro_noise, t = settings_.turn_noise;
    const double tilt = s * s * dt + t * t * block_.turned + block_.doubt * block_.doubt;
    double velocity = settings_.force_noise * settings_.force_noise * dt;
    if (block_.force_known) {
        velocity_ += block_.force_w.head<2>() * dt;
    } else {
        velocity += unknown_force * unknown_force * dt * dt;
    }
    P_.diagonal().segment<2>(S::tilt).array() += tilt;
    P_.diagonal().segment<2>(S::velocity).array() += velocity;
    P_.diagonal().segment<3>(S::gyro_bias).array() += settings_.bias_walk * settings_.bias_walk * dt;
    if (block_.levelled) {
        P_.diagonal().segment<2>(S::tilt).setConstant(moving_tilt_std * moving_tilt_std);
        P_.diagonal().segment<2>(S::velocity).setConstant(settings_.velocity_std * settings_.velocity_std);
        velocity_.setZero();
    }
    for (int i = 0; i < 2; ++i) P_(i, i) = std::min(P_(i, i), largest_tilt_variance + P_(i, i) * 1e-9);
}

void TiltChannel::correct(const TiltVector& dx) {
    // C_true = (I + [phi x]) C_est; the azimuth of the level frame is not affected here
    q_wb_ = math::quaternion_from_rotation_vector({dx(0), dx(1), 0.0}) * q_wb_;
    velocity_ -= dx.segment<2>(S::velocity);
    bias_ -= dx.segment<3>(S::gyro_bias);
}

Block TiltChannel::close(TiltRecord* record) {
    q_wb_.coeffs() *= 1.5 - 0.5 * q_wb_.squaredNorm();  // over a block the products of unit quaternions stay so to rounding
    const double n = samples_;
    block_.C_wb /= n;
    block_.rate_b /= n;
    block_.force_known = 2 * forces_ >= samples_;
    if (forces_ > 0) {
        block_.force_b /= forces_;
        block_.force_w /= forces_;
    }
    block_.bias_used = bias_;
    block_.down_bias_std = std::sqrt(
        std::max(0.0, block_.C_wb.row(2).dot(P_.block<3, 3>(S::gyro_bias, S::gyro_bias) * block_.C_wb.row(2).transpose())));
    watch_rest();
    if (level_wanted_) level_anew();
    propagate();

    const double dt = block_.duration;
    const bool rest = block_.rest_time > 0.0;
    Eigen::Vector2d expected = Eigen::Vector2d::Zero();
    double r = settings_.velocity_std * settings_.velocity_std * 2.0 * settings_.velocity_time / dt;
    if (rest) {
        r = settings_.rest_velocity_std * settings_.rest_velocity_std;
    } else if (speed_valid_ > 0.0) {
        expected = speed_ * block_.C_wb.col(0).head<2>();
        r = (settings_.slip_std * settings_.slip_std + speed_std_ * speed_std_) * 2.0 * settings_.velocity_time / dt;
        if (!speed_known_) velocity_ = expected;  // so far it was the change of velocity, not the velocity
    }
    speed_known_ = speed_valid_ > 0.0 && !rest;
    speed_valid_ -= dt;

    Eigen::Vector2d innovation = velocity_ - expected;
    const double nis = innovation.squaredNorm() / (P_.diagonal().segment<2>(S::velocity).sum() + 2.0 * r);
    acceleration_level_ = rest ? 1.0 : acceleration_level_ + dt / (settings_.adaptation_time + dt) * (nis - acceleration_level_);
    r *= std::max(1.0, acceleration_level_);

    const double tilt_before = P_(0, 0) + P_(1, 1);
    TiltVector dx = TiltVector::Zero();
    int count = 0;
    const auto measure = [&](int state, double computed_minus_measured, double variance) {
        TiltVector h = TiltVector::Zero();
        h(state) = 1.0;
        const auto update = estim::update_scalar<tilt_states>(dx, P_, h, computed_minus_measured, variance);
        const Eigen::RowVector3d effect = from_accel_bias_.row(state);
        from_accel_bias_.noalias() -= update.k * effect;
        if (record) {
            record->updates[static_cast<std::size_t>(count)] = update;
            record->from_accel_bias[static_cast<std::size_t>(count)] = effect;
        }
        ++count;
    };
    for (int i = 0; i < 2; ++i) measure(S::velocity + i, innovation(i), r);
    if (rest) {
        const double variance = settings_.rest_rate_std * settings_.rest_rate_std;
        for (int i = 0; i < 3; ++i) measure(S::gyro_bias + i, bias_(i) - block_.rate_b(i), variance);
    }
    q_before_ = q_wb_;
    tilt_correction_ = dx.head<2>();
    correct(dx);
    block_.P_tilt = P_.topLeftCorner<2, 2>();
    block_.tilt_of_accel_bias = settings_.accel_bias_std * from_accel_bias_.topRows<2>();
    block_.tilt_kept = (P_(0, 0) + P_(1, 1)) / tilt_before;
    const Block done = block_;
    if (record) {
        record->block = done;
        record->count = count;
        record->P_tilt = P_.topRows<2>();
    }
    block_ = Block{};
    samples_ = forces_ = 0;
    return done;
}

}  // namespace schuler::ahrs
