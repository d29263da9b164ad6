#include "schuler/gravimetry/attainable.h"

#include "schuler/estim/dense.h"
#include "schuler/estim/scalar_update.h"
#include "schuler/gravimetry/discretize.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

Motion motion_at(const earth::Earth& earth, const LevelSurvey& survey, const Geodetic& place) {
    const earth::EarthTerms terms = earth::terms_at(earth, place, survey.v_eb_n);
    const Matrix3d C_en = earth::C_en(place.lat, place.lon);
    const Vector3d f_n = (2.0 * terms.w_ie_n + terms.w_en_n).cross(survey.v_eb_n) - terms.g_n;
    return {earth::ecef_from_geodetic(earth.ellipsoid, place), C_en * survey.v_eb_n,
            C_en * math::dcm_from_rpy({0.0, 0.0, survey.heading}), C_en * f_n};
}

}  // namespace

Attained attained(const DisturbanceModel& disturbance, double t, const StateMatrix& P, const Matrix3d& C_en,
                  const Matrix3d& C_eb) {
    const Matrix3d C_nb = C_en.transpose() * C_eb;
    const auto sigma = [](const Matrix3d& C, const Matrix3d& block) {
        return Vector3d((C.transpose() * block * C).diagonal().cwiseMax(0.0).cwiseSqrt());
    };
    const auto block = [&P](int i, int j) { return Matrix3d(P.block<3, 3>(i, j)); };
    const Matrix3d crossed = block(systematic, random);
    return {t,
            sigma(C_en, block(attitude, attitude)),
            sigma(C_en, block(velocity, velocity)),
            sigma(C_en, block(position, position)),
            sigma(C_nb.transpose(), block(gyro_bias, gyro_bias)),
            sigma(disturbance.from_local_level(C_en),
                  block(systematic, systematic) + block(random, random) + crossed + crossed.transpose())};
}

std::vector<Attained> attainable(const SurveySettings& settings, const LevelSurvey& survey, const std::vector<int>& times) {
    settings.disturbance.check();
    Geodetic place = survey.start;
    Motion motion = motion_at(settings.earth, survey, place);
    StateMatrix P = prior_covariance(settings, motion.position);
    std::vector<Attained> out;
    int second = 0;
    for (const int time : times) {
        for (; second < time; ++second) {
            const Geodetic middle = earth::moved_by_ned(settings.earth, place, 0.5 * survey.v_eb_n);
            place = earth::moved_by_ned(settings.earth, place, survey.v_eb_n);
            motion = motion_at(settings.earth, survey, middle);
            const DiscreteStep step =
                discretized(gravity_error_dynamics(settings.earth, settings.disturbance, motion),
                            gravity_noise_input(settings.earth, settings.disturbance, settings.noise, motion), 1.0);
            estim::propagate<max_states>(P, step.Phi, step.Q);
            motion = motion_at(settings.earth, survey, place);
            const GnssRows H = gravity_gnss_rows(motion.C_eb, settings.lever_arm_b, Vector3d::Zero());
            StateVector dx = StateVector::Zero();
            for (int i = 0; i < 6; ++i) {
                const double sigma = i < 3 ? survey.sigma_position : survey.sigma_velocity;
                (void)estim::update_scalar<max_states>(dx, P, H.row(i).transpose(), 0.0, sigma * sigma);
            }
        }
        out.push_back(attained(settings.disturbance, time, P, earth::C_en(place.lat, place.lon), motion.C_eb));
    }
    return out;
}

}  // namespace schuler::gravimetry
