#include "schuler/ahrs/mekf.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::ahrs {
namespace {

constexpr double levelling = 0.1;    // s of specific force used for the first tilt
constexpr double not_gravity = 0.5;  // m/s^2, above accelerometer errors: the log starts in motion
constexpr double turn_in_gap = 0.5;  // rad/s, possible unobserved rotation
// s: rates this far apart are unrelated, in a hand that swings. The error of a rotation interpolated over less grows with the square of
// the interval, as that of the trapezoidal rule does.
constexpr double unrelated = 0.35;

}  // namespace

Mekf::Mekf(const MekfSettings& settings)
    : settings_(settings),
      tilt_(settings.tilt, settings.rest),
      heading_(settings.heading, settings.tilt, settings.six_axis),
      watch_(settings.heading, settings.tilt, settings.six_axis),
      gyro_guard_(settings.guard.gyro_range, settings.guard.stuck_after),
      accel_guard_(settings.guard.accel_range, settings.guard.stuck_after),
      field_guard_(settings.guard.field_range, settings.guard.stuck_after) {
    settings.check();
}

bool Mekf::step(double dt, const Eigen::Vector3d& gyro_b, const Eigen::Vector3d& accel_b, TiltRecord* tilt,
                HeadingRecord* heading) {
    const bool rate_known = gyro_guard_.usable(gyro_b, counters_.gyro);
    const bool force_known = accel_guard_.usable(accel_b, counters_.accel);
    if (!(dt > 0.0)) return false;
    const bool gap = usual_step_.exceeded_by(dt, settings_.guard.gap_factor);
    if (!tilt_.started()) {
        if (!force_known) return false;
        start_force_ += accel_b * dt;
        if (rate_known) start_turn_ += gyro_b.norm() * dt;
        start_time_ += dt;
        if (start_time_ >= levelling && start_force_.norm() > 0.0) {
            const bool moving = start_turn_ > settings_.rest.largest_rate * start_time_ ||
                                std::abs(start_force_.norm() / start_time_ - settings_.tilt.gravity) > not_gravity;
            tilt_.start(start_force_, moving);
        }
        return false;
    }
    if (dt > settings_.guard.longest_step) {
        ++counters_.gaps;
        tilt_.doubt(std::max(turn_in_gap, swing_) * dt);
        dt = settings_.block;  // the filter continues from here; the gap is covered by the increased uncertainty
    } else if (gap) {
        ++counters_.gaps;
        const double apart = std::min(1.0, dt / unrelated);
        tilt_.doubt(apart * apart * swing_ * dt);
    }
    const Eigen::Vector3d rate = gap && rate_known ? Eigen::Vector3d(0.5 * (last_rate_ + gyro_b))
                                 : rate_known      ? gyro_b
                                                   : last_rate_;
    if (rate_known) last_rate_ = gyro_b;
    tilt_.integrate(dt, rate, rate_known, force_known ? &accel_b : nullptr);
    swing_ = std::max(tilt_.rate_b().norm(), swing_ * (1.0 - dt));
    // half a sample early rather than one late: blocks of equal length on a regular log
    if (tilt_.pending() < settings_.block - 0.5 * dt) return false;
    const Block block = tilt_.close(tilt);
    if (block.rest_time > 0.0) ++counters_.rest_blocks;
    if (!heading) watch_.share(heading_);
    heading_.close(block, tilt_.gyro_bias(), counters_, heading);
    if (!heading) watch_.close(heading_, block, tilt_.gyro_bias(), counters_);
    return true;
}

void Mekf::magnetometer(const Eigen::Vector3d& field_b) {
    if (!field_guard_.usable(field_b, counters_.field) || !tilt_.started() || settings_.six_axis) return;
    heading_.gather(tilt_.q_wb().toRotationMatrix(), tilt_.rate_b(), field_b);
}

Eigen::Quaterniond Mekf::q_nb() const { return heading_.q_nw() * tilt_.q_wb(); }

Eigen::Matrix3d Mekf::covariance_phi() const {
    const double c = std::cos(heading_.heading()), s = std::sin(heading_.heading());
    Eigen::Matrix3d C_nw, P = Eigen::Matrix3d::Zero();
    C_nw << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
    P.topLeftCorner<2, 2>() = tilt_.tilt_covariance();
    P(2, 2) = heading_.variance();
    return C_nw * P * C_nw.transpose();
}

Eigen::Vector3d Mekf::std_phi() const { return covariance_phi().diagonal().cwiseSqrt(); }

}  // namespace schuler::ahrs
