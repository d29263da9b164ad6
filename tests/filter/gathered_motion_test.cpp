// Motion gathered over a tenth of a second against the covariance propagated at every step, and against dense products of a fine step.
#include "schuler/core/units.h"
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

Layout layout_of(bool gains) {
    Layout L;
    if (!gains) return L;
    L.gyro_scale = L.add("gyro_scale", "1", 3);
    L.accel_scale = L.add("accel_scale", "1", 3);
    L.gyro_misalignment = L.add("gyro_misalignment", "rad", 6);
    L.accel_misalignment = L.add("accel_misalignment", "rad", 6);
    return L;
}

InertialModel model_of(const Layout& layout) { return {earth::Earth{}, layout, sensor::imu_grade("mems")}; }

template <class Frame>
InertialFilter<Frame> started(const InertialModel& model, double heading = 0.01) {
    InertialFilter<Frame> f(model);
    NavState nav;
    nav.position = {0.8, 0.5, 300.0};
    nav.v_eb_n = {20.0, -5.0, 1.0};
    nav.q_nb = math::quaternion_from_rpy(Vector3d(0.05, -0.03, 1.0));
    f.set_nav(Frame::from_geographic(model.earth, nav));
    f.P.diagonal().template segment<3>(0).setConstant(4.0);
    f.P.diagonal().template segment<3>(3).setConstant(0.04);
    f.P.diagonal().template segment<3>(6).setConstant(1e-4);
    // less than two degrees of heading over the run: an unknown heading is a matter of its own (HeadingForce)
    f.P.diagonal().template segment<3>(9).setConstant(1e-8);
    f.P.diagonal().template segment<3>(12).setConstant(1e-3);
    const Vector3d down = f.to_local_level(model).template block<3, 3>(6, 6).transpose().col(2);
    f.P.template block<3, 3>(6, 6) += (heading * heading - 1e-4) * down * down.transpose();
    if (model.layout.size > 15) f.P.diagonal().segment(15, model.layout.size - 15).setConstant(1e-6);
    return f;
}

/// A lively drive: turns, brakes, shakes at up to 5 Hz.
ImuIncrement increment_at(double t, double dt) {
    const double m = t - 0.5 * dt;
    const Vector3d w(0.1 * std::sin(9.0 * m), 0.2 * std::sin(31.0 * m), 0.3 + 0.2 * std::sin(2.0 * m));
    const Vector3d f(2.0 * std::sin(1.3 * m), 3.0 + 2.0 * std::sin(30.0 * m), -9.8 + 3.0 * std::sin(20.0 * m));
    return {Time::from_seconds(t), dt, w * dt, f * dt};
}

/// Covariance after 30 s with a fix a second, propagated every `every` steps.
template <class Frame>
StateMatrix run(const InertialModel& model, int every, double heading) {
    InertialFilter<Frame> f = started<Frame>(model, heading);
    constexpr double dt = 0.005;
    estim::Transition phi;
    for (int k = 1; k <= 6000; ++k) {
        f.propagate(model, increment_at(k * dt, dt), {});
        const bool fix = k % 200 == 0;
        if (k % every == 0 || fix) (void)f.propagate_covariance(model, phi);
        if (!fix) continue;
        const Estimate e = f.estimate(model);
        Measurement m = gnss_position(e, e.nav.position, Vector3d::Constant(0.25), {0.5, 0.2, -1.0}, {});
        m.innovation.setZero();
        (void)f.update(model, f.to_own(model, m), [](const auto&) {});
    }
    return f.P;
}

template <class Frame>
void compare(bool gains, double heading = 0.01, double tolerance = 1e-6) {
    const InertialModel model = model_of(layout_of(gains));
    const StateMatrix fine = run<Frame>(model, 1, heading), gathered = run<Frame>(model, 20, heading);
    const int n = model.layout.size;
    for (int i = 0; i < n; ++i) {
        const double sigma = std::sqrt(fine(i, i));
        EXPECT_NEAR(std::sqrt(gathered(i, i)) / sigma, 1.0, tolerance) << "state " << i;
        for (int j = 0; j < i; ++j)
            EXPECT_NEAR((gathered(i, j) - fine(i, j)) / (sigma * std::sqrt(fine(j, j))), 0.0, 3.0 * tolerance)
                << "states " << i << ", " << j;
    }
}

TEST(GatheredMotion, IsThatOfEveryStepToAMillionthOfASigma) {
    compare<GeographicFrame>(false);
    compare<GeographicFrame>(true);
    compare<EarthFixedFrame>(false);
    compare<EarthFixedFrame>(true);
}

/// What is withheld from the column of an unknown heading depends on how often the bound is formed, a little.
TEST(GatheredMotion, OfAnUnknownHeadingIsThatOfEveryStepToAHundredthOfASigma) {
    compare<GeographicFrame>(false, 0.8, 1e-2);
    compare<EarthFixedFrame>(false, 0.8, 1e-2);
}

/// Dense products of 2000 steps a second: F and the noise's density written from the error model alone.
TEST(GatheredMotion, IsTheProductOfFineSteps) {
    const InertialModel model = model_of(Layout{});
    InertialFilter<GeographicFrame> f = started<GeographicFrame>(model);
    MatrixXd P = f.P;
    constexpr double dt = 0.0005;
    estim::Transition phi;
    for (int k = 1; k <= 4000; ++k) {
        const Matrix3d C0 = f.C;
        const ImuIncrement raw = increment_at(k * dt, dt);
        f.propagate(model, raw, {});
        const Matrix3d C = 0.5 * (C0 + f.C);
        MatrixXd F = MatrixXd::Zero(16, 16), Q = F;
        F.topLeftCorner<9, 9>() = ins::matrix(ins::error_n(model.earth, f.nav.position, f.nav.v_eb_n, C * raw.dv / dt));
        F.block<3, 3>(6, 9) = C;
        F.block<3, 3>(3, 12) = -C;
        for (int i = 0; i < 3; ++i) {
            Q(3 + i, 3 + i) = model.accel_psd;
            Q(6 + i, 6 + i) = model.gyro_psd;
        }
        for (int i = 9; i < 15; ++i) {
            F(i, i) = -model.process[static_cast<std::size_t>(i)].decay;
            Q(i, i) = model.process[static_cast<std::size_t>(i)].psd;
        }
        const MatrixXd A = MatrixXd::Identity(16, 16) + dt * F + 0.5 * dt * dt * F * F;
        P = (A * P * A.transpose() + 0.5 * dt * (Q + A * Q * A.transpose())).eval();
        if (k % 200 == 0) (void)f.propagate_covariance(model, phi);
    }
    for (int i = 0; i < 15; ++i) {
        EXPECT_NEAR(std::sqrt(f.P(i, i) / P(i, i)), 1.0, 1e-5) << "state " << i;
        for (int j = 0; j < i; ++j)
            EXPECT_NEAR((f.P(i, j) - P(i, j)) / std::sqrt(P(i, i) * P(j, j)), 0.0, 1e-5) << "states " << i << ", " << j;
    }
}

/// An output between two propagations of the covariance sees the covariance of its own time.
TEST(GatheredMotion, OutputsSeeTheirOwnTime) {
    const InertialModel model = model_of(layout_of(true));
    InertialFilter<EarthFixedFrame> f = started<EarthFixedFrame>(model);
    for (int k = 1; k <= 13; ++k) f.propagate(model, increment_at(k * 0.005, 0.005), {});
    const Matrix9 seen = f.local_covariance(model);
    estim::Transition phi;
    ASSERT_TRUE(f.propagate_covariance(model, phi));
    const Matrix9 then = f.local_covariance(model);
    EXPECT_LT((seen - then).norm(), 1e-13 * then.norm());
    EXPECT_GT((started<EarthFixedFrame>(model).local_covariance(model) - then).norm(), 1e-4 * then.norm());
}

}  // namespace
}  // namespace schuler::filter
