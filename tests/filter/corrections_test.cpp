// Corrections of velocity and latency: what is known of the position that a late fix gives is not changed by them, nor is the estimate.
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/outputs.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/filter/states/model.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double interval = 1e-5;  // s: the latency wanders by 11 us meanwhile, the position of a fix by 1 mm

/// In level flight to the north at 100 m/s, started from a late fix; every block of states that may stand before the latency or behind it.
template <class Frame>
struct Flight {
    Settings settings;
    InertialModel model;
    Start start;
    FilterRun<Frame> run;

    Flight(bool gains, bool lever_arm, bool wheels, bool gravity, Loop loop)
        : settings(settings_of(gains, lever_arm, wheels, gravity)),
          model(make_model(settings, make_layout(settings, Recording{}))) {
        model.loop = loop;
        start.nav.position = {0.8, 0.5, 300.0};
        start.nav.v_eb_n = {100.0, 0.0, 0.0};
        start.nav.q_nb = math::quaternion_from_rpy(Vector3d::Zero());
        start.std_position.setConstant(0.02);
        start.std_velocity.setConstant(0.5);
        start.std_rpy.setConstant(0.01);
        start.std_gyro_bias = start.std_accel_bias = Vector3d::Constant(1e-4);
        start.at_antenna = true;
        start.position_of_fix.setOnes();
        start.position_rate = start.nav.v_eb_n;
        set_out(run, model, settings, start, not_given);
    }
    static Settings settings_of(bool gains, bool lever_arm, bool wheels, bool gravity) {
        Settings s;
        s.gnss.latency_std = 0.15;
        s.scale_factors = s.misalignments = gains;
        s.estimate_lever_arm = lever_arm;
        s.constraints.nonholonomic = wheels;
        s.disturbance.estimate = gravity;
        s.disturbance.prior_n.setConstant(1e-4);
        return s;
    }
    /// Innovation covariance of the next fix.
    [[nodiscard]] Matrix3d of_fix() const {
        const InertialFilter<Frame>& f = run.filter;
        return f.innovation_covariance(f.to_own(model, gnss_position(f.estimate(model), start.nav.position,
                                                                     Vector3d::Constant(1e-4), settings.gnss.lever_arm_b, {})));
    }
    /// A correction alone, and an interval so short that nothing else happens.
    void correct() {
        InertialFilter<Frame>& f = run.filter;
        estim::StateVector dx = estim::StateVector::Zero(f.P.rows());
        dx.template segment<3>(Layout::velocity) = Vector3d(0.5, -0.4, 0.2);
        dx(model.layout.gnss_latency) = 0.05;
        f.apply(model, dx);
    }
    void step() {
        InertialFilter<Frame>& f = run.filter;
        f.propagate(
            model,
            {f.time() + Duration::from_seconds(interval), interval, Vector3d::Zero(), Vector3d(0.0, 0.0, -9.81 * interval)}, {});
        estim::Transition phi;
        ASSERT_TRUE(f.propagate_covariance(model, phi));
    }
};

template <class Frame>
void check(bool gains, bool lever_arm, bool wheels, bool gravity, Loop loop) {
    Flight<Frame> flight(gains, lever_arm, wheels, gravity, loop);
    const Matrix3d before = flight.of_fix();
    flight.correct();
    const NavState corrected = flight.run.filter.geographic(flight.model);
    flight.step();
    const Matrix3d after = flight.of_fix();
    // 0.02 m, and not half a metre per second times 0.15 s
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(std::sqrt(after(i, i)), std::sqrt(before(i, i)), 1e-4) << i;
    const NavState then = flight.run.filter.geographic(flight.model);
    const Vector3d moved = earth::ned_difference(flight.model.earth, then.position, corrected.position);
    EXPECT_LT((moved - interval * corrected.v_eb_n).norm(), 1e-4);  // half a metre per second times 0.05 s is 25 mm
}

TEST(Corrections, OfLateFixesAreNoMotionWhateverTheOtherStates) {
    for (const Loop loop : {Loop::Closed, Loop::Open})
        for (int k = 0; k < 8; ++k) {
            SCOPED_TRACE(testing::Message() << k << (loop == Loop::Open ? ", open" : ""));
            check<GeographicFrame>((k & 1) != 0, (k & 2) != 0, (k & 4) != 0, false, loop);
            check<EarthFixedFrame>((k & 1) != 0, (k & 2) != 0, (k & 4) != 0, true, loop);
        }
}

}  // namespace
}  // namespace schuler::filter
