#include "schuler/gravimetry/settings.h"

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;

StateMatrix prior_covariance(const SurveySettings& settings, const Ecef& position_e) {
    const Geodetic place = earth::geodetic_from_ecef(settings.earth.ellipsoid, position_e);
    const Matrix3d C_en = earth::C_en(place.lat, place.lon);
    const auto turned = [](const Matrix3d& C, const Vector3d& sigma_n) {
        return Matrix3d(C * sigma_n.cwiseAbs2().asDiagonal() * C.transpose());
    };
    const Matrix3d axes = settings.disturbance.from_local_level(C_en);
    StateMatrix P = StateMatrix::Zero();
    const auto set = [&P](int first, const Matrix3d& block) { P.block<3, 3>(first, first) = block; };
    const auto even = [](double sigma) { return Matrix3d(sigma * sigma * Matrix3d::Identity()); };
    const Prior& prior = settings.prior;
    set(position, even(prior.position));
    set(velocity, even(prior.velocity));
    set(attitude, turned(C_en, prior.attitude_n));
    set(accel_bias, even(prior.accel_bias));
    set(gyro_bias, even(prior.gyro_bias));
    set(gnss_position, turned(C_en, prior.gnss_position_n));
    set(gnss_velocity, even(prior.gnss_velocity));
    set(systematic, turned(axes, prior.disturbance_n));
    const Matrix3d stationary = settings.disturbance.stationary(), random_part = turned(axes, settings.disturbance.sigma_n);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) P.block<3, 3>(random + 3 * i, random + 3 * j) = stationary(i, j) * random_part;
    if (settings.disturbance.degree() > 0) set(slope, even(prior.slope));
    if (settings.disturbance.degree() > 1) set(curvature, even(prior.curvature));
    return P;
}

}  // namespace schuler::gravimetry
