#include "schuler/gravimetry/model.h"

#include "schuler/core/error.h"
#include "schuler/ins/error_model.h"
#include "schuler/math/rotation.h"

#include <Eigen/Geometry>

#include <cmath>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;

namespace {

/// Derivative of (value, slope, curvature) by distance, k = 1/length, and the density of the noise that drives the last of them
/// for unit sigma. [Jordan1972] for the second and third order.
struct Chain {
    Matrix3d F = Matrix3d::Zero();
    int driven = 0;
    double psd = 0.0;
};

Chain chain_of(const DisturbanceModel& m) {
    Chain c;
    const double k = m.kind == DisturbanceKind::Constant ? 0.0 : 1.0 / m.length;
    switch (m.kind) {
        case DisturbanceKind::Constant: break;
        case DisturbanceKind::FirstOrder:
        case DisturbanceKind::RampAndFirstOrder:
        case DisturbanceKind::QuadraticAndFirstOrder:
            c.F(0, 0) = -k;
            c.psd = 2.0 * k;
            break;
        case DisturbanceKind::SecondOrder:
            c.F.topLeftCorner<2, 2>() << 0.0, 1.0, -k * k, -2.0 * k;
            c.driven = 1;
            c.psd = 4.0 * k * k * k;
            break;
        case DisturbanceKind::ThirdOrder:
            c.F << 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -k * k * k, -3.0 * k * k, -3.0 * k;
            c.driven = 2;
            c.psd = 16.0 / 3.0 * std::pow(k, 5);
            break;
    }
    return c;
}

}  // namespace

void DisturbanceModel::check() const {
    if (!(sigma_n.array() >= 0.0).all() || !sigma_n.allFinite())
        throw input_error("sigmas of the disturbance must be numbers >= 0", {{}, 0, 0, "sigma_mgal"}, "give three sigmas in mGal");
    const bool chained = kind == DisturbanceKind::SecondOrder || kind == DisturbanceKind::ThirdOrder;
    if (kind != DisturbanceKind::Constant && (!(length > 0.0) || (chained && !std::isfinite(length))))
        throw input_error("the correlation length of the disturbance must be positive", {{}, 0, 0, "length_m"},
                          "give metres along the track, for example 5000");
}

int DisturbanceModel::states() const {
    switch (kind) {
        case DisturbanceKind::Constant:
        case DisturbanceKind::FirstOrder: return slope;
        case DisturbanceKind::RampAndFirstOrder:
        case DisturbanceKind::SecondOrder: return curvature;
        case DisturbanceKind::QuadraticAndFirstOrder:
        case DisturbanceKind::ThirdOrder: break;
    }
    return curvature + 3;
}

Matrix3d DisturbanceModel::stationary() const {
    Matrix3d S = Matrix3d::Zero();
    if (kind == DisturbanceKind::Constant) return S;
    const double k2 = 1.0 / (length * length);
    S(0, 0) = 1.0;
    if (kind == DisturbanceKind::SecondOrder) S(1, 1) = k2;
    if (kind == DisturbanceKind::ThirdOrder) {
        S(1, 1) = k2 / 3.0;
        S(0, 2) = S(2, 0) = -k2 / 3.0;
        S(2, 2) = k2 * k2;
    }
    return S;
}

Matrix3d random_part_dynamics(const DisturbanceModel& disturbance) { return chain_of(disturbance).F; }

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
    const Chain chain = chain_of(disturbance);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) F.block<3, 3>(random + 3 * i, random + 3 * j) = pace * chain.F(i, j) * Matrix3d::Identity();
    if (disturbance.degree() > 0) F.block<3, 3>(systematic, slope) = pace * Matrix3d::Identity();
    if (disturbance.degree() > 1) F.block<3, 3>(slope, curvature) = pace * Matrix3d::Identity();
    return F;
}

NoiseMatrix gravity_noise_input(const earth::Earth& earth, const DisturbanceModel& disturbance, const SensorNoise& noise,
                                const Motion& motion) {
    const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, motion.position);
    const Chain chain = chain_of(disturbance);
    NoiseMatrix G = NoiseMatrix::Zero();
    G.block<3, 3>(attitude, 0) = -std::sqrt(noise.gyro_psd) * motion.C_eb;
    G.block<3, 3>(velocity, 3) = std::sqrt(noise.accel_psd) * motion.C_eb;
    G.block<3, 3>(random + 3 * chain.driven, 6) = std::sqrt(disturbance.pace(motion.v_eb_e) * chain.psd) *
                                                  disturbance.from_local_level(earth::C_en(place.lat, place.lon)) *
                                                  disturbance.sigma_n.asDiagonal();
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
