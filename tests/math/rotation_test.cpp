#include "schuler/math/rotation.h"
#include "schuler/math/steep_attitude.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace schuler::math {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Matrix exponential by scaling and squaring of a long Taylor series: knows nothing of Rodrigues' formula.
Matrix3d exponential(const Matrix3d& A) {
    const Matrix3d S = A / 1024.0;
    Matrix3d term = Matrix3d::Identity(), sum = term;
    for (int k = 1; k < 20; ++k) {
        term = term * S / k;
        sum += term;
    }
    for (int k = 0; k < 10; ++k) sum = sum * sum;
    return sum;
}

class RotationVector : public testing::TestWithParam<double> {};

TEST_P(RotationVector, DcmAndQuaternionAreTheExponential) {
    const Vector3d r = GetParam() * Vector3d(0.36, -0.48, 0.8);
    const Matrix3d expected = exponential(skew(r));
    EXPECT_LT((dcm_from_rotation_vector(r) - expected).cwiseAbs().maxCoeff(), 2e-13);
    EXPECT_LT((quaternion_from_rotation_vector(r).toRotationMatrix() - expected).cwiseAbs().maxCoeff(), 2e-13);
    EXPECT_NEAR(quaternion_from_rotation_vector(r).norm(), 1.0, 1e-15);
}

TEST_P(RotationVector, LogarithmInverts) {
    const Vector3d r = GetParam() * Vector3d(0.36, -0.48, 0.8);
    const auto q = quaternion_from_rotation_vector(r);
    EXPECT_LT((rotation_vector_from_quaternion(q) - r).norm(), 1e-15 + 4e-15 * r.norm());
    const Eigen::Quaterniond minus(-q.w(), -q.x(), -q.y(), -q.z());
    EXPECT_LT((rotation_vector_from_quaternion(minus) - r).norm(), 1e-15 + 4e-15 * r.norm());
}

// Both sides of the switches from series to closed form (|r| = 0.1), and near pi.
INSTANTIATE_TEST_SUITE_P(Sizes, RotationVector,
                         testing::Values(0.0, 1e-12, 1e-8, 1e-3, std::nextafter(0.1, 0.0), std::nextafter(0.1, 1.0), 1.0, 2.5,
                                         std::numbers::pi - 1e-9));

TEST(Euler, RoundTripAndQuaternionAgree) {
    std::mt19937 rng(7);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    for (int i = 0; i < 1000; ++i) {
        const Vector3d rpy{std::numbers::pi * u(rng), 1.55 * u(rng), std::numbers::pi * (1.0 + u(rng))};
        const Matrix3d C = dcm_from_rpy(rpy);
        const Matrix3d by_axes = (Eigen::AngleAxisd(rpy.z(), Vector3d::UnitZ()) * Eigen::AngleAxisd(rpy.y(), Vector3d::UnitY()) *
                                  Eigen::AngleAxisd(rpy.x(), Vector3d::UnitX()))
                                     .toRotationMatrix();
        EXPECT_LT((C - by_axes).cwiseAbs().maxCoeff(), 2e-15);
        EXPECT_LT((quaternion_from_rpy(rpy).toRotationMatrix() - C).cwiseAbs().maxCoeff(), 2e-15);
        const Vector3d back = rpy_from_dcm(C);
        EXPECT_NEAR(wrap_pi(back.x() - rpy.x()), 0.0, 1e-13);
        EXPECT_NEAR(back.y(), rpy.y(), 1e-13);
        EXPECT_NEAR(wrap_pi(back.z() - rpy.z()), 0.0, 1e-13);
        EXPECT_GE(back.z(), 0.0);
        EXPECT_LT(back.z(), 2.0 * std::numbers::pi);
    }
}

TEST(Euler, GimbalLockStillReproducesTheMatrix) {
    for (const double pitch : {std::numbers::pi / 2, -std::numbers::pi / 2}) {
        const Matrix3d C = dcm_from_rpy({0.4, pitch, 1.3});
        EXPECT_LT((dcm_from_rpy(rpy_from_dcm(C)) - C).cwiseAbs().maxCoeff(), 1e-7);
    }
}

TEST(Euler, ErrorMapIsTheDerivative) {
    const Vector3d rpy(0.3, -0.5, 2.1);
    const Matrix3d J = rpy_error_from_phi(rpy);
    for (int k = 0; k < 3; ++k) {
        constexpr double d = 1e-6;
        const auto at = [&](double s) -> Vector3d {
            return rpy_from_dcm(dcm_from_rotation_vector(-s * Vector3d::Unit(k)) * dcm_from_rpy(rpy));
        };
        const Vector3d derivative = (at(d) - at(-d)) / (2 * d);
        EXPECT_LT((J.col(k) - derivative).norm(), 1e-9);
    }
}

TEST(Orthonormalised, RemovesSmallDrift) {
    Matrix3d C = dcm_from_rpy({0.1, 0.2, 0.3});
    C(0, 1) += 1e-6;
    C *= 1.0 + 1e-6;
    EXPECT_LT((orthonormalised(C).transpose() * orthonormalised(C) - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 1e-11);
}

/// Of an attitude known to the same sigma about every axis no reported sigma is larger; below 80 deg the angles' own are reported.
TEST(SteepAttitude, SigmasStayThoseOfTheRotation) {
    for (const double pitch : {1.41, 1.5707, -1.5707, std::numbers::pi / 2}) {
        const Matrix3d J = attitude_error_from_phi({0.4, pitch, 2.0});
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(J.row(i).norm(), 1.0, 1e-12) << pitch;
    }
    const Vector3d gentle(0.4, 1.2, 2.0);
    EXPECT_EQ(attitude_error_from_phi(gentle), rpy_error_from_phi(gentle));
    // a turn about the vertical is one of heading, one about the body's x axis one of roll
    const Vector3d rpy(0.4, 1.55, 2.0);
    EXPECT_NEAR((attitude_error_from_phi(rpy) * Vector3d(0, 0, -0.01)).z(), 0.01, 1e-15);
    EXPECT_NEAR((attitude_error_from_phi(rpy) * (-0.01 * dcm_from_rpy(rpy).col(0))).x(), 0.01, 1e-12);
}

}  // namespace
}  // namespace schuler::math
