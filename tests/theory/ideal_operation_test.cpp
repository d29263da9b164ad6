// Paper C's complete equations: the printed matrix A against their complex-step derivatives, both integrations against the closed
// form, and the order of what the linear equations leave out.
#include "schuler/theory/ideal_operation.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <complex>
#include <random>

namespace schuler::theory {
namespace {

using Complex = std::complex<double>;

/// C_nu of section 2, written out: inertial components (pole, meridian, east) to north, up, east.
template <class T>
Eigen::Matrix<T, 3, 3> C_nu(const T& latitude, const T& longitude) {
    using std::cos, std::sin;
    const T sp = sin(latitude), cp = cos(latitude), sl = sin(longitude), cl = cos(longitude);
    Eigen::Matrix<T, 3, 3> C;
    C << cp, -sp * cl, -sp * sl, sp, cp * cl, cp * sl, T(0.0), -sl, cl;
    return C;
}

TEST(IdealOperation, PrintedMatrixIsTheDerivative) {
    const PaperCEarth earth;
    std::mt19937_64 generator(5);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    for (int point = 0; point < 20; ++point) {
        Vector6 x;
        // clang-format off
        x << 300.0 * unit(generator), 60.0 * unit(generator), 500.0 * unit(generator), 1e4 * (1.0 + unit(generator)),
            85.0 * units::deg * unit(generator), 3.0 * unit(generator);
        // clang-format on
        const Eigen::Vector3d force{5.0 * unit(generator), 9.8 + unit(generator), 5.0 * unit(generator)};
        const Eigen::Vector3d inertial = C_nu<double>(x(lat), x(lon)).transpose() * force;  // what ideal attitude holds
        const Matrix6 A = error_dynamics(earth, x, force);
        for (int j = 0; j < 6; ++j) {
            constexpr double step = 1e-100;
            Eigen::Matrix<Complex, 6, 1> z = x.cast<Complex>();
            z(j) += Complex(0.0, step);
            const Vector3<Complex> a = C_nu<Complex>(z(lat), z(lon)) * inertial.cast<Complex>();
            const Vector6 column = navigation_rates<Complex>(earth, z, a).imag() / step;
            for (int i = 0; i < 6; ++i)
                EXPECT_NEAR(A(i, j), column(i), 2e-12 * std::abs(A(i, j))) << point << ": " << i << ", " << j;
        }
    }
}

TEST(IdealOperation, AttitudeKinematicsIsTheRotationOfTheMatrix) {
    // d/dt of C(kappa): body to geographic, = C [w_b x] - [w_n x] C, with elementary matrices instead of quaternions.
    const PaperCEarth earth;
    IdealState<double> x;
    x << 120.0, -5.0, 230.0, 3000.0, 0.7, -1.2, Eigen::Vector4d(0.6, -0.3, 0.5, 0.4).normalized();
    const Vector3<double> w(0.02, -0.01, 0.03), a(0.4, 9.7, -0.2);
    const auto matrix_of = [](const Eigen::Vector4d& q) { return Eigen::Quaterniond(q(0), q(1), q(2), q(3)).toRotationMatrix(); };
    const auto skew = [](const Eigen::Vector3d& v) { return Eigen::Matrix3d(misalignment_matrix(v)); };
    const IdealState<double> d = ideal_operation<double>(earth, x, w, a);
    const double h = 1e-4;
    const Eigen::Vector4d q = x.tail<4>(), dq = d.tail<4>();
    const Eigen::Matrix3d rate = (matrix_of(q + h * dq) - matrix_of(q - h * dq)) / (2.0 * h);
    const IdealRates<double> k = ideal_rates<double>(earth, x.head<6>());
    const Eigen::Matrix3d C = matrix_of(q);
    EXPECT_LT((rate - (C * skew(w) - skew({k.w_N, k.w_H, k.w_E}) * C)).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_LT((d.head<6>() - navigation_rates<double>(earth, x.head<6>(), C * a)).cwiseAbs().maxCoeff(), 1e-14);
    const Eigen::Vector4d nu = geographic_frame(0.7, -1.2);
    EXPECT_LT((matrix_of(nu).transpose() - C_nu<double>(0.7, -1.2)).cwiseAbs().maxCoeff(), 1e-15);
}

/// Initial errors with every component, of a given size.
Vector6 mixed(double size) { return size * (Vector6() << 0.05, -0.02, 0.04, 30.0, 8e-6, -5e-6).finished(); }

TEST(IdealOperation, OnTheSphereTheLinearEquationsAreTheClosedForm) {
    PaperCEarth sphere;
    sphere.e2 = 0.0;
    for (const double v : {600.0, 10.0, -465.0}) {
        const double h = v == 600.0 ? 10000.0 : 0.0;
        const Vector6 start = (Vector6() << 0.0, 0.0, v, h, 0.0, 0.4).finished();
        EXPECT_LT(
            (error_dynamics(sphere, start, steady_force(sphere, start)) - EquatorFlight(v, h).dynamics()).cwiseAbs().maxCoeff(),
            1e-14);
        const std::vector<Comparison> compared = compare_integrations(sphere, start, mixed(1.0), 7200.0, 4);
        for (const Comparison& c : compared) {
            const Vector6 closed = EquatorFlight(v, h).transition(c.t) * mixed(1.0);
            for (int i = 0; i < 6; ++i)
                EXPECT_NEAR(c.linear(i), closed(i), 1e-9 * std::abs(closed(i)) + 1e-18) << v << " " << c.t << " " << i;
        }
    }
}

/// Largest part of each error that the linear equations miss, in units of sqrt(g R), R and rad.
double missed(const PaperCEarth& earth, const Vector6& start, double size) {
    const Comparison last = compare_integrations(earth, start, mixed(size), 1800.0, 3).back();
    const Vector6 scale = (Vector6() << 7900.0, 7900.0, 7900.0, 6.4e6, 1.0, 1.0).finished();
    return (last.nonlinear - last.linear).cwiseQuotient(scale).cwiseAbs().maxCoeff();
}

TEST(IdealOperation, WhatIsMissedIsOfSecondOrder) {
    const PaperCEarth earth;
    const double deg = units::deg;
    for (const Vector6& start : {(Vector6() << 0.0, 0.0, 600.0, 10000.0, 0.0, 0.0).finished(),
                                 (Vector6() << 150.0, 2.0, -200.0, 8000.0, 40.0 * deg, 2.0).finished(),
                                 (Vector6() << -250.0, -1.0, 100.0, 9000.0, -60.0 * deg, -1.0).finished()}) {
        double full = missed(earth, start, 20.0);
        EXPECT_GT(full, 1e-8);
        for (int halvings = 1; halvings <= 3; ++halvings) {
            const double half = missed(earth, start, std::ldexp(20.0, -halvings));
            EXPECT_NEAR(full / half, 4.0, 0.05) << start.transpose() << ", halved " << halvings << " times";
            full = half;
        }
    }
}

TEST(IdealOperation, UnusableStarts) {
    const PaperCEarth earth;
    Vector6 start = Vector6::Zero();
    start(lat) = 1.5705;
    EXPECT_THROW((void)compare_integrations(earth, start, Vector6::Zero(), 10.0, 1), Error);
    start = Vector6::Zero();
    start(vh) = std::nan("");
    EXPECT_THROW((void)compare_integrations(earth, start, Vector6::Zero(), 10.0, 1), Error);
    start = (Vector6() << 0.0, 0.0, 600.0, 10000.0, 0.0, 0.0).finished();
    try {
        (void)compare_integrations(earth, start, (Vector6() << 0.0, 0.0, 0.0, -1e5, 0.0, 0.0).finished(), 7200.0, 10);
        FAIL() << "a fall into the Earth goes unnoticed";
    } catch (const Error& e) {
        EXPECT_EQ(e.kind(), ErrorKind::Computation);
    }
}

}  // namespace
}  // namespace schuler::theory
