#include "schuler/ins/state_error.h"

#include "schuler/core/units.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"
#include "support/draws.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace schuler::ins {
namespace {

using Eigen::Vector3d;

double angle_between(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return math::rotation_vector_from_quaternion(a * b.conjugate()).norm();
}

TEST(StateError, CorrectedUndoesPerturbed) {
    const earth::Earth earth;
    std::mt19937_64 generator(7);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto vector = [&](double size) { return Vector3d(size * schuler::test::draw3(unit, generator)); };
    for (int k = 0; k < 2000; ++k) {
        NavState x;
        x.time = Time{k};
        x.position = {89.0 * units::deg * unit(generator), std::numbers::pi * unit(generator), 10000.0 * unit(generator)};
        x.v_eb_n = vector(300.0);
        x.q_nb = math::quaternion_from_rotation_vector(vector(1.8));
        Vector9 dx;
        dx.head<3>() = vector(k % 2 == 0 ? 1e5 : 10.0);
        dx.segment<3>(3) = vector(50.0);
        dx.tail<3>() = vector(1.5);

        const NavState back = corrected(earth, perturbed(earth, x, dx), dx);
        EXPECT_EQ(back.time, x.time);
        EXPECT_LT(earth::ned_difference(earth, back.position, x.position).norm(), 2e-8) << x.position.lat / units::deg;
        EXPECT_LT((back.v_eb_n - x.v_eb_n).norm(), 2e-13);
        EXPECT_LT(angle_between(back.q_nb, x.q_nb), 2e-15);

        const NavStateEcef e = to_ecef(earth, x);
        const NavStateEcef e_back = corrected(perturbed(e, dx), dx);
        EXPECT_LT((e_back.position.r - e.position.r).norm(), 5e-9);
        EXPECT_LT((e_back.v_eb_e - e.v_eb_e).norm(), 2e-13);
        EXPECT_LT(angle_between(e_back.q_eb, e.q_eb), 2e-15);
    }
}

TEST(StateError, SignsOfTheConvention) {
    // The estimate is 10 m north, 20 m east, 30 m below, 1 m/s too fast northward, and rotated.
    const earth::Earth earth;
    NavState estimate;
    estimate.position = {0.9, 0.1, 100.0};
    Vector9 dx;
    dx << 10.0, 20.0, 30.0, 1.0, 0.0, 0.0, 1e-3, 2e-3, -3e-3;
    const NavState truth = corrected(earth, estimate, dx);
    const earth::Radii r = earth::radii(earth.ellipsoid, 0.9);
    EXPECT_NEAR((estimate.position.lat - truth.position.lat) * (r.meridian + 100.0), 10.0, 1e-8);
    EXPECT_NEAR((estimate.position.lon - truth.position.lon) * (r.prime_vertical + 100.0) * std::cos(0.9), 20.0, 1e-8);
    EXPECT_NEAR(truth.position.h, 130.0, 1e-12);
    EXPECT_NEAR(truth.v_eb_n.x(), -1.0, 1e-15);
    const Eigen::Matrix3d first_order = (Eigen::Matrix3d::Identity() - math::skew(dx.tail<3>())) * truth.q_nb.toRotationMatrix();
    EXPECT_LT((estimate.q_nb.toRotationMatrix() - first_order).cwiseAbs().maxCoeff(), 1e-5);  // second order: 7e-6
}

TEST(StateError, CrossesTheDateLine) {
    const earth::Earth earth;
    NavState x;
    x.position = {0.2, std::numbers::pi - 1e-7, 0.0};
    Vector9 dx = Vector9::Zero();
    dx(1) = 50.0;
    const NavState moved = perturbed(earth, x, dx);
    EXPECT_LT(moved.position.lon, 0.0);
    EXPECT_NEAR(corrected(earth, moved, dx).position.lon, x.position.lon, 1e-14);
}

}  // namespace
}  // namespace schuler::ins
