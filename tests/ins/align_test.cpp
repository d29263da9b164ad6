#include "schuler/ins/align.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/math/rotation.h"
#include "support/draws.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace schuler::ins {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

const earth::Earth earth_model;
const Geodetic place{50.45 * units::deg, 30.5 * units::deg, 150.0};

struct AtRest {
    Vector3d f_b, w_b;
};
AtRest at_rest(const Vector3d& rpy) {
    const earth::EarthTerms t = earth::terms_at(earth_model, place, Vector3d::Zero());
    const Eigen::Matrix3d C_bn = math::dcm_from_rpy(rpy).transpose();
    return {C_bn * -t.g_n, C_bn * t.w_ie_n};
}

TEST(Alignment, LevelsAndGyrocompassesWithoutErrors) {
    for (const Vector3d& rpy_deg : {Vector3d(0, 0, 0), Vector3d(10, -20, 130), Vector3d(-170, 35, 271), Vector3d(90, 60, 359)}) {
        const Vector3d rpy = rpy_deg * units::deg;
        const AtRest r = at_rest(rpy);
        const Levelling l = level(r.f_b, 0.0);
        // Gravity's north component at 150 m tilts the plumb line by 1e-7 rad.
        EXPECT_NEAR(math::wrap_pi(l.roll - rpy.x()), 0.0, 1e-6);
        EXPECT_NEAR(l.pitch, rpy.y(), 1e-6);
        const Gyrocompass g = gyrocompass(earth_model, place, r.f_b, r.w_b, 0.0, 0.0);
        EXPECT_NEAR(math::wrap_pi(g.rpy.z() - rpy.z()), 0.0, 1e-6);
        EXPECT_LT(math::rotation_vector_from_quaternion(g.q_nb * math::quaternion_from_rpy(rpy).conjugate()).norm(), 1e-6);
        EXPECT_NEAR(g.rate_misfit, 0.0, 1e-18);
        EXPECT_NEAR(g.vertical_misfit, 0.0, 1e-10);
    }
}

TEST(Alignment, PredictedSigmasAreThoseOfManyAlignments) {
    const Vector3d rpy = Vector3d(8.0, -25.0, 60.0) * units::deg;
    const AtRest r = at_rest(rpy);
    const double accel_std = 0.02, gyro_std = 0.02 * units::deg_per_hour;  // 2.5 and 2 mrad of heading
    std::mt19937_64 generator(11);
    std::normal_distribution<double> normal;
    const auto noise = [&](double s) { return Vector3d(s * test::draw3(normal, generator)); };
    const int runs = 4000;
    const Vector3d predicted = gyrocompass(earth_model, place, r.f_b, r.w_b, accel_std, gyro_std).std_rpy;
    Vector3d sum2 = Vector3d::Zero();
    for (int k = 0; k < runs; ++k) {
        const Vector3d f = r.f_b + noise(accel_std), w = r.w_b + noise(gyro_std);
        const Gyrocompass g = gyrocompass(earth_model, place, f, w, accel_std, gyro_std);
        const Vector3d e = g.rpy - rpy;
        sum2 += e.cwiseProduct(e);
    }
    const Vector3d ratio = (sum2 / runs).cwiseSqrt().cwiseQuotient(predicted);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(ratio(k), 1.0, 0.04) << k;
    EXPECT_NEAR(level(r.f_b, accel_std).std_roll, predicted.x(), 1e-3 * predicted.x());
    EXPECT_NEAR(level(r.f_b, accel_std).std_pitch, predicted.y(), 1e-3 * predicted.y());
    const AtRest flat = at_rest(Vector3d(0.0, 0.0, 1.0));
    EXPECT_NEAR(gyrocompass(earth_model, place, flat.f_b, flat.w_b, accel_std, gyro_std).std_rpy.z(),
                std::hypot(gyro_std / (7.292115e-5 * std::cos(place.lat)), accel_std * std::tan(place.lat) / 9.811), 1e-6);
}

TEST(Alignment, NotAtRestShowsInTheMisfit) {
    const AtRest r = at_rest(Vector3d(0.1, 0.2, 0.3));
    const Gyrocompass g = gyrocompass(earth_model, place, r.f_b, r.w_b + Vector3d(0.0, 0.0, 1e-3), 1e-3, 1e-8);
    EXPECT_GT(std::abs(g.vertical_misfit), 9e-4);
    EXPECT_GT(g.rate_misfit, 8e-4);
}

TEST(Alignment, MagneticHeading) {
    // Inclination 66 deg, declination 8 deg east.
    const double declination = 8.0 * units::deg, inclination = 66.0 * units::deg;
    const Vector3d field_n = 50e-6 * Vector3d(std::cos(inclination) * std::cos(declination),
                                              std::cos(inclination) * std::sin(declination), std::sin(inclination));
    for (const double heading_deg : {0.0, 77.0, 185.0, 355.0}) {
        const Vector3d rpy = Vector3d(-30.0, 20.0, heading_deg) * units::deg;
        const Vector3d field_b = math::dcm_from_rpy(rpy).transpose() * field_n;
        const double heading = heading_from_magnetometer(field_b, rpy.x(), rpy.y(), declination);
        EXPECT_GE(heading, 0.0);
        EXPECT_NEAR(math::wrap_pi(heading - rpy.z()), 0.0, 1e-14);
    }
}

TEST(Alignment, AttitudeFromSpecificForceAndHeading) {
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int k = 0; k < 1000; ++k) {
        const Vector3d rpy = Vector3d(0.0, 0.0, 3.1) + Vector3d(0.6, 0.6, 3.1).cwiseProduct(test::draw3(unit, generator));
        const Quaterniond truth = math::quaternion_from_rpy(rpy);
        const Vector3d f_n = Vector3d(0.0, 0.0, -9.8) + Vector3d(6.0, 6.0, 0.0).cwiseProduct(test::draw3(unit, generator));
        const Vector3d f_b = 1.01 * (truth.conjugate() * f_n);  // a scale factor must not matter
        const Quaterniond q = attitude_from_specific_force(f_b, f_n, rpy.z());
        EXPECT_LT(math::rotation_vector_from_quaternion(q * truth.conjugate()).norm(), 1e-7) << rpy.transpose();
        // whatever the true heading, the two promises hold
        const double other = rpy.z() + 2.0 * unit(generator);
        const Quaterniond turned = attitude_from_specific_force(f_b, f_n, other);
        EXPECT_LT(((turned * f_b).normalized() - f_n.normalized()).norm(), 1e-14);
    }
}

TEST(Alignment, AttitudeFromVerticalForceIsLevellingWithAnyHeading) {
    for (const double heading : {0.0, 1.0, 3.0, 6.0}) {
        const Vector3d rpy(2.8, -0.4, heading);  // upside down
        const Vector3d f_b = math::dcm_from_rpy(rpy).transpose() * Vector3d(0.0, 0.0, -9.8);
        const Quaterniond q = attitude_from_specific_force(f_b, Vector3d(0.0, 0.0, -1.0), heading);
        EXPECT_LT((q.toRotationMatrix() - math::dcm_from_rpy(rpy)).cwiseAbs().maxCoeff(), 1e-14);
    }
}

TEST(Alignment, UnusableInputIsRefused) {
    const AtRest r = at_rest(Vector3d::Zero());
    EXPECT_THROW((void)level(Vector3d::Zero(), 0.1), Error);
    EXPECT_THROW((void)level(Vector3d(0.0, NAN, -9.8), 0.1), Error);
    EXPECT_THROW((void)gyrocompass(earth_model, place, r.f_b, Vector3d::Zero(), 0.1, 1e-7), Error);
    EXPECT_THROW((void)gyrocompass(earth_model, {1.5707, 0.0, 0.0}, r.f_b, r.w_b, 0.1, 1e-7), Error);
    EXPECT_THROW((void)attitude_from_specific_force(Vector3d::Zero(), r.f_b, 0.0), Error);
}

}  // namespace
}  // namespace schuler::ins
