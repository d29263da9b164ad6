// A start from a fix: the antenna is where the fix says, the unit is a lever arm away, in a direction as uncertain as the attitude.
#include "schuler/filter/measurement/gnss.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/filter/states/model.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <class Frame>
void check_start(math::Random& random) {
    Settings settings;
    settings.gnss.lever_arm_b = 3.0 * random.normal3();
    settings.estimate_lever_arm = random.uniform() < 0.5;
    const Recording recording;
    const InertialModel model = make_model(settings, make_layout(settings, recording));
    Start start;
    start.nav.position = {random.uniform() - 0.5, 3.0 * random.uniform(), 100.0};
    start.nav.v_eb_n.setZero();
    start.nav.q_nb = math::quaternion_from_rpy({0.1 * random.normal(), 0.1 * random.normal(), 6.0 * random.uniform()});
    start.std_position = Vector3d(0.02, 0.03, 0.05);
    start.std_velocity = Vector3d::Constant(0.1);
    start.std_rpy = Vector3d(0.02, 0.02, 1.5 * random.uniform());
    start.std_gyro_bias = start.std_accel_bias = Vector3d::Constant(1e-3);
    start.at_antenna = true;
    start.position_of_fix.setOnes();
    FilterRun<Frame> run;
    set_out(run, model, settings, start, not_given);
    const InertialFilter<Frame>& f = run.filter;
    const Measurement m =
        gnss_position(f.estimate(model), start.nav.position, Vector3d::Constant(1e-4), settings.gnss.lever_arm_b, {});
    // the fix is met, and its sigma is that of the antenna, whatever the attitude
    RC_ASSERT(m.innovation.norm() < 1e-6);
    const Matrix3d S = f.innovation_covariance(f.to_own(model, m));
    for (int i = 0; i < 3; ++i) RC_ASSERT(std::abs(std::sqrt(S(i, i) - 1e-4) / start.std_position(i) - 1.0) < 1e-3);
    // the unit's is not
    const Matrix9 P = f.local_covariance(model);
    const double arm = (start.nav.q_nb * settings.gnss.lever_arm_b).template head<2>().norm() * start.std_rpy.z();
    RC_ASSERT((P(0, 0) + P(1, 1)) > 0.9 * arm * arm);
    if (settings.estimate_lever_arm) RC_ASSERT(P(0, 0) > 1.0);  // m^2, of the lever arm itself
}

RC_GTEST_PROP(StartAtTheAntenna, KnowsTheAntennaAndNotTheUnit, ()) {
    math::Random random(*rc::gen::arbitrary<std::uint32_t>(), "start");
    check_start<GeographicFrame>(random);
    check_start<EarthFixedFrame>(random);
}

}  // namespace
}  // namespace schuler::filter
