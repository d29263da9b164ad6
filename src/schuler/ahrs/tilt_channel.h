// Tilt channel: strapdown attitude in the level frame w, gyro bias, and a small velocity that separates tilt from acceleration.
//
// The specific force is integrated in the frame maintained by the gyro, so that oscillating accelerations cancel before they
// affect the tilt (filtering in an almost inertial frame is the idea of [LaidigSeel2023]; here the filter has a velocity state
// with its covariance). The velocity measurement is zero, with a large sigma in motion and a small one at rest, or the forward
// speed of a vehicle if given: the centripetal correction. No magnetic quantity is used.
//
// A sensor that keeps its attitude cannot distinguish an accelerometer bias b from a tilt of b/g, and the tilt's covariance without it
// would shrink far below that. The bias is considered, not estimated: the velocity of a hand varies with the attitude of the
// sensor (a swinging arm), which looks like a bias fixed to the body. The sensitivity of all errors to it is computed along with
// the gains, which it does not change, and its share is added to the published covariance.
#pragma once

#include "schuler/ahrs/block.h"
#include "schuler/ahrs/guard.h"
#include "schuler/ahrs/settings.h"
#include "schuler/estim/scalar_update.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>

namespace schuler::ahrs {

inline constexpr int tilt_states = 7;
using TiltVector = Eigen::Matrix<double, tilt_states, 1>;
using TiltMatrix = Eigen::Matrix<double, tilt_states, tilt_states>;

/// Indices of the states: tilt north-like and east-like (w axes, rad), velocity (w, m/s), gyro bias (b, rad/s).
struct TiltState {
    static constexpr int tilt = 0, velocity = 2, gyro_bias = 4;
    static constexpr int changing = 4;  ///< the first ones, which the others act on
};
using TiltRows = Eigen::Matrix<double, TiltState::changing, tilt_states>;
/// Derivatives of the errors with respect to the accelerometer bias (b).
using AccelBiasEffect = Eigen::Matrix<double, tilt_states, 3>;

/// Data of one block required by the smoother.
struct TiltRecord {
    Block block;
    Eigen::Matrix<double, 2, tilt_states> P_tilt;  ///< rows of the covariance after the updates
    std::array<estim::ScalarUpdate<tilt_states>, 5> updates;
    std::array<Eigen::RowVector3d, 5> from_accel_bias;  ///< derivatives of their innovations
    int count = 0;
};

class TiltChannel {
public:
    TiltChannel(const TiltSettings& settings, const RestSettings& rest);

    /// Level attitude from a mean specific force (b), heading zero; `moving`: the force includes accelerations.
    void start(const Eigen::Vector3d& force_b, bool moving);
    [[nodiscard]] bool started() const { return started_; }

    /// Strapdown over dt (s) with the gyro's rate; `force_b` null if unusable; `rate_known` false for an old rate.
    void integrate(double dt, const Eigen::Vector3d& rate_b, bool rate_known, const Eigen::Vector3d* force_b);
    /// A pause in the log: the attitude may have rotated by `angle` (rad), the velocity change is unknown.
    void doubt(double angle);
    /// Forward speed along b's x axis (m/s) with its one sigma, from a satellite receiver; used for `valid` s.
    void forward_speed(double speed, double std, double valid = 1.5);

    [[nodiscard]] double pending() const { return block_.duration; }
    /// How often the accumulated data were discarded because of a doubt beyond what the filter follows.
    [[nodiscard]] int restarts() const { return restarts_; }
    /// Filter update over the accumulated data. Returns the block; fills `record` if given.
    Block close(TiltRecord* record = nullptr);

    [[nodiscard]] const Eigen::Quaterniond& q_wb() const { return q_wb_; }
    [[nodiscard]] const Eigen::Vector3d& rate_b() const { return rate_b_; }  ///< last rate minus bias
    [[nodiscard]] const Eigen::Vector3d& gyro_bias() const { return bias_; }
    /// Of the tilt, w axes, rad^2; includes the accelerometer bias.
    [[nodiscard]] Eigen::Matrix2d tilt_covariance() const;
    [[nodiscard]] const Eigen::Quaterniond& q_before() const { return q_before_; }  ///< before the last block's updates
    [[nodiscard]] const Eigen::Vector2d& tilt_correction() const { return tilt_correction_; }  ///< removed by them, rad

private:
    void watch_rest();
    void level_anew();
    void propagate();
    void correct(const TiltVector& dx);
    void forget_velocity();

    TiltSettings settings_;
    RestSettings rest_;
    bool started_ = false;
    Eigen::Quaterniond q_wb_ = Eigen::Quaterniond::Identity(), q_before_ = Eigen::Quaterniond::Identity();
    Eigen::Vector2d tilt_correction_ = Eigen::Vector2d::Zero();
    Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
    Eigen::Vector2d velocity_ = Eigen::Vector2d::Zero();
    TiltMatrix P_ = TiltMatrix::Zero();
    AccelBiasEffect from_accel_bias_ = AccelBiasEffect::Zero();
    Eigen::Vector3d rate_b_ = Eigen::Vector3d::Zero();
    Block block_;
    int samples_ = 0, forces_ = 0, restarts_ = 0;
    double acceleration_level_ = 1.0;
    Eigen::Vector3d slow_rate_ = Eigen::Vector3d::Zero(), slow_force_ = Eigen::Vector3d::Zero();
    bool watching_ = false;
    double quiet_ = 0.0;
    double speed_ = 0.0, speed_std_ = 0.0, speed_valid_ = 0.0;
    bool speed_known_ = false, level_wanted_ = false;
};

/// Error transition of the tilt channel over a block: phi' = C_wb db, dv' = f x phi + C_wb a with f = (0, 0, -g) and the
/// accelerometer bias a. It differs from the identity in the first rows only.
struct TiltTransition {
    TiltRows rows = TiltRows::Zero();  ///< these rows, minus the identity
    Eigen::Matrix<double, TiltState::changing, 3> from_accel_bias = Eigen::Matrix<double, TiltState::changing, 3>::Zero();

    TiltTransition(const Block& block, double gravity);
    [[nodiscard]] TiltMatrix matrix() const;
    /// F P F^T, and the effect of the accelerometer bias
    void propagate(TiltMatrix& P, AccelBiasEffect& effect) const;
    /// F^T lambda and F^T Lambda F
    void propagate_back(estim::Adjoint<tilt_states>& adjoint) const;
};

}  // namespace schuler::ahrs
