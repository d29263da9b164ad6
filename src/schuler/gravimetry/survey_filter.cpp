#include "schuler/gravimetry/survey_filter.h"

#include "schuler/estim/dense.h"
#include "schuler/gravimetry/discretize.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

#include <cmath>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;

SurveyFilter::SurveyFilter(const SurveySettings& settings, const NavStateEcef& start)
    : settings_(settings),
      reference_{start},
      P_(prior_covariance(settings, start.position)),
      next_feedback_(start.time + Duration::from_seconds(settings.feedback_period)),
      from_(start.position) {
    settings.disturbance.check();
}

void SurveyFilter::advance(const ImuIncrement& raw) {
    const ImuIncrement felt = without_sensor_errors(reference_, raw);
    const Matrix3d before = reference_.nav.q_eb.toRotationMatrix();
    reference_ = advanced(settings_.earth, settings_.disturbance, reference_, ins::compensate(previous_, felt));
    const Matrix3d mean = 0.5 * (before + reference_.nav.q_eb.toRotationMatrix());
    C_eb_sum_ += raw.dt * mean;
    f_e_sum_ += mean * felt.dv;
    elapsed_ += raw.dt;
    previous_ = felt;
}

SurveyState SurveyFilter::estimate() const {
    return settings_.loop == estim::Loop::Closed ? reference_ : corrected(reference_, error_);
}

/// Covariance and kept errors carried from the last measurement to now.
FixStep SurveyFilter::carried() {
    FixStep record;
    record.Phi.setIdentity();
    if (elapsed_ > 0.0) {
        // Along the reference trajectory, but for the pace of the disturbance, which is that of the vehicle.
        const Vector3d pace = (reference_.nav.position.r - from_.r) / elapsed_ - error_.segment<3>(velocity);
        const Motion motion{Ecef{0.5 * (from_.r + reference_.nav.position.r)}, pace, C_eb_sum_ / elapsed_, f_e_sum_ / elapsed_};
        DiscreteStep step =
            discretized(gravity_error_dynamics(settings_.earth, settings_.disturbance, motion),
                        gravity_noise_input(settings_.earth, settings_.disturbance, settings_.noise, motion), elapsed_);
        step.Phi.middleCols<3>(attitude) *= turn_;
        turn_.setIdentity();
        estim::propagate<max_states>(P_, step.Phi, step.Q);
        error_ = step.Phi.lazyProduct(error_).eval();
        record.Phi = step.Phi;
        record.f_e = motion.f_e + error_.segment<3>(attitude).cross(motion.f_e) + motion.C_eb * error_.segment<3>(accel_bias);
    }
    return record;
}

void SurveyFilter::correct(const StateVector& dx) {
    error_ += dx;
    const bool due = settings_.loop == estim::Loop::Mixed && reference_.nav.time >= next_feedback_;
    if (due || settings_.loop == estim::Loop::Closed) {
        // What is left of an attitude error is counted from the new reference: e + a x e/2 for a correction by a. A tilt of 1e-4
        // rad turns an azimuth error of 1e-3 into 1e-7 rad of tilt, which shows by then; after a single fix it is nothing.
        if (due) turn_ += 0.5 * math::skew(error_.segment<3>(attitude));
        reference_ = corrected(reference_, error_);
        error_.setZero();
        next_feedback_ = reference_.nav.time + Duration::from_seconds(settings_.feedback_period);
    }
    elapsed_ = 0.0;
    C_eb_sum_.setZero();
    f_e_sum_.setZero();
    from_ = reference_.nav.position;
}

void SurveyFilter::open_disturbance() {
    const StateMatrix prior = prior_covariance(settings_, reference_.nav.position);
    P_.block<3, 3>(systematic, systematic) += prior.block<3, 3>(systematic, systematic);
}

double FixStep::nis() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < used; ++i) sum += updates[i].innovation * updates[i].innovation / updates[i].s;
    return sum;
}

/// Of the last increment, less the estimated errors, rad/s.
Vector3d SurveyFilter::body_rate() const {
    return previous_.dt > 0.0 ? Vector3d(previous_.dtheta / previous_.dt + error_.segment<3>(gyro_bias)) : Vector3d::Zero();
}

FixStep SurveyFilter::take(const HeightFix& fix) {
    FixStep record = carried();
    const SurveyState now = estimate();
    record.satellites = false;
    const Vector3d& lever_arm_b = settings_.gauge_lever_arms_b[static_cast<std::size_t>(fix.gauge)];
    StateVector dx = StateVector::Zero();
    record.updates[record.used++] =
        estim::update_scalar<max_states>(dx, P_, gravity_height_row(settings_.earth, now, lever_arm_b, fix.gauge),
                                         height_innovation(settings_.earth, now, lever_arm_b, fix), fix.sigma * fix.sigma);
    correct(dx);
    return record;
}

FixStep SurveyFilter::take(const BodyVelocityFix& fix) {
    FixStep record = carried();
    const SurveyState now = estimate();
    record.satellites = false;
    const BodyVelocityRows H = gravity_body_velocity_rows(settings_.earth, now, settings_.log_lever_arm_b, body_rate());
    const Vector3d z = body_velocity_innovation(settings_.earth, now, settings_.log_lever_arm_b, body_rate(), fix);
    StateVector dx = StateVector::Zero();
    for (int i = 0; i < 3; ++i)
        if (std::isfinite(fix.sigma_b(i)))
            record.updates[record.used++] =
                estim::update_scalar<max_states>(dx, P_, H.row(i).transpose(), z(i), fix.sigma_b(i) * fix.sigma_b(i));
    correct(dx);
    return record;
}

FixStep SurveyFilter::take(const HeadingFix& fix) {
    FixStep record = carried();
    const SurveyState now = estimate();
    record.satellites = false;
    StateVector dx = StateVector::Zero();
    record.updates[record.used++] =
        estim::update_scalar<max_states>(dx, P_, gravity_heading_row(settings_.earth, now),
                                         heading_innovation(settings_.earth, now, fix), fix.sigma * fix.sigma);
    correct(dx);
    return record;
}

FixStep SurveyFilter::take(const AntennaFix& fix) {
    FixStep record = carried();
    const SurveyState now = estimate();
    const Matrix3d C_eb = now.nav.q_eb.toRotationMatrix();
    const Vector3d w_ib_b = body_rate();
    const Vector3d w_eb_b = w_ib_b - C_eb.transpose() * Vector3d(0.0, 0.0, settings_.earth.ellipsoid.w_ie);
    const GnssRows H = gravity_gnss_rows(C_eb, settings_.lever_arm_b, w_eb_b);
    const Eigen::Matrix<double, 6, 1> z = gnss_innovation(settings_.earth, now, settings_.lever_arm_b, w_ib_b, fix);
    const Geodetic place = earth::geodetic_from_ecef(settings_.earth.ellipsoid, now.nav.position);
    const Matrix3d C_en = earth::C_en(place.lat, place.lon);
    StateVector dx = StateVector::Zero();
    for (int i = 0; i < 6; ++i) {
        // The sigmas are those of north, east and down: one component of them after the other.
        const int first = i < 3 ? 0 : 3;
        const Vector3d axis = C_en.col(i - first);
        const double sigma = i < 3 ? fix.sigma_position_n(i) : fix.sigma_velocity_n(i - first);
        if (!std::isfinite(sigma)) continue;
        const StateVector h = H.middleRows<3>(first).transpose() * axis;
        record.updates[record.used++] =
            estim::update_scalar<max_states>(dx, P_, h, axis.dot(z.segment<3>(first)), sigma * sigma);
    }
    correct(dx);
    return record;
}

}  // namespace schuler::gravimetry
