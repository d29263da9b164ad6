// Errors of the second order of a tilted solution: their formula against the exact rotation and exact moments, and what becomes of
// them in position against a mechanization that is tilted.
#include "schuler/filter/integrity/second_order.h"

#include "schuler/core/units.h"
#include "schuler/filter/integrity/integrity.h"
#include "schuler/filter/states/model.h"
#include "schuler/filter/update/separate.h"
#include "schuler/math/rotation.h"
#include "schuler/sensor/grades.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <cmath>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Vector3d second_order(const Vector3d& phi, const Vector3d& f) { return -0.5 * phi.cross(phi.cross(f)); }

// What the exact rotation leaves after the first order: q, up to phi^3 f / 6.
TEST(SecondOrder, IsTheSecondTermOfTheRotation) {
    const Vector3d axis = Vector3d(0.5, -0.3, 0.8).normalized(), f(1.0, -2.0, -9.0);
    for (const double size : {0.3, 0.03}) {
        const Vector3d phi = size * axis;
        const Vector3d exact = f - math::dcm_from_rotation_vector(phi) * f;
        EXPECT_LT((exact + phi.cross(f) - second_order(phi, f)).norm(), std::pow(size, 3) / 6.0 * f.norm());
        EXPECT_GT(second_order(phi, f).norm(), 0.3 * size * size * f.norm());
    }
}

// Gauss-Hermite quadrature with three nodes an axis is exact for the fourth degree.
TEST(SecondOrder, MomentsAreThoseOfAGaussianAttitude) {
    Matrix3d root;
    root << 0.2, 0.0, 0.0, 0.1, 0.3, 0.0, -0.15, 0.05, 0.5;
    const double nodes[] = {-std::sqrt(3.0), 0.0, std::sqrt(3.0)}, weights[] = {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0};
    for (const Vector3d& f : {Vector3d(0.0, 0.0, -9.8), Vector3d(4.0, -7.0, -9.0)}) {
        Matrix3d exact = Matrix3d::Zero();
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j)
                for (int k = 0; k < 3; ++k) {
                    const Vector3d q = second_order(root * Vector3d(nodes[i], nodes[j], nodes[k]), f);
                    exact += weights[i] * weights[j] * weights[k] * q * q.transpose();
                }
        EXPECT_LT((second_order_acceleration(root * root.transpose(), f) - exact).norm(), 1e-12 * exact.norm());
    }
}

/// A unit at rest and level whose estimate is tilted about the north axis by one sigma of its covariance, which has nothing else.
template <class Frame>
struct Tilted {
    static constexpr double tilt = 0.3, dt = 0.02;
    Settings settings;
    InertialModel model;
    InertialFilter<Frame> filter;
    SecondOrder second_order;
    NavState truth;

    static InertialModel model_of(const Settings& settings) {
        Recording recording;
        recording.baro.resize(1);
        return {settings.earth, make_layout(settings, recording), {}};
    }
    Tilted() : model(model_of(settings)), filter(model), second_order(filter.P.rows()) {
        truth.time = Time::from_seconds(100.0);
        truth.position = {0.8, 0.4, 200.0};
        truth.v_eb_n.setZero();
        truth.q_nb.setIdentity();
        NavState wrong = truth;
        wrong.q_nb = math::quaternion_from_rotation_vector(tilt * Vector3d::UnitX());
        filter.set_nav(Frame::from_geographic(model.earth, wrong));
        filter.previous = {truth.time, dt, Vector3d::Zero(), Vector3d::Zero()};
        Matrix9 P = Matrix9::Zero();
        P(Layout::attitude, Layout::attitude) = tilt * tilt;
        const Matrix9 T = filter.to_local_level(model).inverse();
        filter.P.template topLeftCorner<9, 9>() = T * P * T.transpose();
        filter.previous = increment(dt);
    }
    [[nodiscard]] ImuIncrement increment(double after) const {
        const earth::EarthTerms terms = earth::terms_at(model.earth, truth.position, truth.v_eb_n);
        return {truth.time + Duration::from_seconds(after), dt, dt * terms.w_ie_n, -dt * terms.g_n};
    }
    void run(int steps) {
        for (int k = 0; k < steps; ++k) {
            filter.propagate(model, increment((filter.time() - truth.time).seconds() + dt), {});
            estim::Transition phi;
            if (k % 25 == 24) (void)propagate_covariance(model, filter, second_order, phi);
        }
    }
    /// m, estimate minus truth, down.
    [[nodiscard]] double sunk() const { return truth.position.h - filter.geographic(model).position.h; }
    [[nodiscard]] Measurement height(double variance) const {
        Measurement m;
        m.add(-sunk(), variance).head(Layout::position + 2) = -1.0;
        return m;
    }
    /// m, one sigma of the errors of the second order, divided by the root of the fourth moment of the tilt: what they are for a tilt of
    /// one sigma.
    [[nodiscard]] double second() const {
        return std::sqrt(second_order.of_second_order(filter.to_own(model, height(1.0)))(0, 0) / 3.0);
    }
};

template <class Frame>
void sinks() {
    Tilted<Frame> unit;
    unit.run(1000);  // 20 s: g tilt^2/2 t^2/2 = 88 m
    EXPECT_NEAR(unit.sunk(), 0.5 * units::g0 * (1.0 - std::cos(unit.tilt)) * 400.0, 2.0);
    const Measurement m = unit.filter.to_own(unit.model, unit.height(0.0));
    const double first = std::sqrt(unit.filter.innovation_covariance(m)(0, 0)),
                 all = std::sqrt(examined_covariance(unit.filter, unit.second_order, m)(0, 0));
    // The first order, with the force of the tilted estimate, sinks by g tilt^2, twice as deep as the unit; the third is left.
    EXPECT_NEAR(unit.sunk(), first - unit.second(), std::pow(unit.tilt, 4) / 6.0 * units::g0 * 200.0);
    EXPECT_GT(first - unit.sunk(), 80.0);
    EXPECT_NEAR(all, std::hypot(first, std::sqrt(3.0) * unit.second()), 1e-6);
}

TEST(SecondOrder, IsWhatTheFirstOrderLacksInTheGeographicFrame) { sinks<GeographicFrame>(); }
TEST(SecondOrder, IsWhatTheFirstOrderLacksInTheEarthFixedFrame) { sinks<EarthFixedFrame>(); }

// The barometer's loop of the separate scheme takes the errors of the second order back as it does the height's.
TEST(SecondOrder, FollowsTheCorrections) {
    Tilted<GeographicFrame> unit;
    constexpr double tau = 20.0;
    double largest = 0.0;
    for (int second = 1; second <= 40; ++second) {
        unit.run(50);
        largest = std::max(largest, std::abs(unit.sunk()));
        const Measurement m = unit.height(0.25);
        const Gains gains = barometer_gains(unit.filter.P.rows(), unit.filter.estimate(unit.model).C_nb, 1.0, tau);
        if (second > 5) {
            // 1/2 tilt^2 of the estimated force, which is tilted itself
            EXPECT_NEAR(unit.second() / (std::cos(unit.tilt) * unit.sunk()), 1.0, 0.05) << second;  // the Earth is round
        }
        unit.second_order.correct(m, gains);
        unit.filter.correct(unit.model, m, gains);
    }
    EXPECT_GT(largest, 30.0);
    EXPECT_LT(largest, 60.0) << "the loop is open";
}

// The worse of the horizontal axes, whatever the heading.
TEST(SecondOrder, TiltIsWithoutTheHeading) {
    const auto check = [](auto unit) {
        Matrix9 P = Matrix9::Zero();
        P(6, 6) = P(7, 7) = 0.5;
        P(6, 7) = P(7, 6) = 0.3;
        P(8, 8) = 9.0;
        const Matrix9 T = unit.filter.to_local_level(unit.model).inverse();
        unit.filter.P.template topLeftCorner<9, 9>() = T * P * T.transpose();
        EXPECT_NEAR(tilt_sigma(unit.model, unit.filter), std::sqrt(0.8), 1e-9);
    };
    check(Tilted<GeographicFrame>());
    check(Tilted<EarthFixedFrame>());
}

// Without states, as in every scheme that estimates its attitude, the tests are those of the covariance to the last digit.
TEST(SecondOrder, IsNothingWhereTheAttitudeIsEstimated) {
    Tilted<GeographicFrame> unit;
    unit.second_order = {};
    unit.run(100);
    const Measurement m = unit.height(1.0);
    EXPECT_EQ(examined_covariance(unit.filter, unit.second_order, m), unit.filter.innovation_covariance(m));
    EXPECT_TRUE(unit.second_order.of_second_order(m).isZero(0.0));
}

}  // namespace
}  // namespace schuler::filter
