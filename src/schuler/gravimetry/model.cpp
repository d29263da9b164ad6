#include "schuler/gravimetry/model.h"

#include "schuler/ins/error_model.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

int states_of(const DisturbanceModel& disturbance) {
    const int order = disturbance.has_random_part() ? std::max(disturbance.degree() + 1, disturbance.random_part().order) : 1;
    return slope + 3 * (order - 1);
}

StateMatrix gravity_error_dynamics(const earth::Earth& earth, const DisturbanceModel& disturbance, const Motion& motion) {
    StateMatrix F = StateMatrix::Zero();
    F.topLeftCorner<9, 9>() = ins::matrix(ins::error_e(earth, motion.position, motion.f_e));
    F.block<3, 3>(velocity, accel_bias) = -motion.C_eb;
    F.block<3, 3>(attitude, gyro_bias) = motion.C_eb;
    const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, motion.position);
    const Matrix3d felt = disturbance.to_earth_fixed(earth::C_en(place.lat, place.lon));
    F.block<3, 3>(velocity, systematic) = felt;
    F.block<3, 3>(velocity, random) = felt;
    const double pace = disturbance.pace(motion.v_eb_e);
    if (disturbance.has_random_part()) {
        const filter::DisturbanceChain chain = disturbance.random_part();
        const Matrix3d by_distance = chain.dynamics();
        for (int i = 0; i < chain.order; ++i)
            for (int j = 0; j < chain.order; ++j)
                F.block<3, 3>(random + 3 * i, random + 3 * j) = pace * by_distance(i, j) * Matrix3d::Identity();
    }
    if (disturbance.degree() > 0) F.block<3, 3>(systematic, slope) = pace * Matrix3d::Identity();
    if (disturbance.degree() > 1) F.block<3, 3>(slope, curvature) = pace * Matrix3d::Identity();
    return F;
}

NoiseMatrix gravity_noise_input(const earth::Earth& earth, const DisturbanceModel& disturbance, const SensorNoise& noise,
                                const Motion& motion) {
    const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, motion.position);
    NoiseMatrix G = NoiseMatrix::Zero();
    G.block<3, 3>(attitude, 0) = -std::sqrt(noise.gyro_psd) * motion.C_eb;
    G.block<3, 3>(velocity, 3) = std::sqrt(noise.accel_psd) * motion.C_eb;
    if (disturbance.has_random_part()) {
        const filter::DisturbanceChain chain = disturbance.random_part();
        G.block<3, 3>(random + 3 * (chain.order - 1), 6) = std::sqrt(disturbance.pace(motion.v_eb_e) * chain.psd()) *
                                                           disturbance.from_local_level(earth::C_en(place.lat, place.lon)) *
                                                           disturbance.sigma_n.asDiagonal();
    }
    G.block<3, 3>(accel_bias, 9) = std::sqrt(noise.accel_bias_psd) * Matrix3d::Identity();
    G.block<3, 3>(gyro_bias, 12) = std::sqrt(noise.gyro_bias_psd) * Matrix3d::Identity();
    return G;
}

GnssRows gravity_gnss_rows(const Matrix3d& C_eb, const Vector3d& lever_arm_b, const Vector3d& w_eb_b) {
    GnssRows H = GnssRows::Zero();
    H.block<3, 3>(0, position).setIdentity();
    H.block<3, 3>(0, attitude) = skew(C_eb * lever_arm_b);
    H.block<3, 3>(0, gnss_position).setIdentity();
    H.block<3, 3>(3, velocity).setIdentity();
    H.block<3, 3>(3, attitude) = skew(C_eb * w_eb_b.cross(lever_arm_b));
    H.block<3, 3>(3, gyro_bias) = C_eb * skew(lever_arm_b);
    H.block<3, 3>(3, gnss_velocity).setIdentity();
    return H;
}

}  // namespace schuler::gravimetry
