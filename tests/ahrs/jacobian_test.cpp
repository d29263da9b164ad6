// The tilt channel's error transition against differences of a strapdown written out here.
#include "schuler/ahrs/tilt_channel.h"
#include "schuler/math/rotation.h"
#include "support/perturbation.h"

#include <Eigen/Geometry>

namespace schuler::ahrs {
namespace {

using Eigen::Vector3d;
using schuler::test::LinearModel;

constexpr double gravity = 9.81, duration = 0.05;
constexpr int steps = 500;

/// The channel's errors (estimate minus truth) after a block that begins with errors dx; the sensor turns at `rate_b` in place.
Eigen::VectorXd after_block(const Eigen::Quaterniond& q_wb, const Vector3d& rate_b, const Eigen::VectorXd& dx) {
    const double dt = duration / steps;
    Eigen::Quaterniond truth = q_wb, estimate = math::quaternion_from_rotation_vector({-dx(0), -dx(1), 0.0}) * q_wb;
    Vector3d velocity(dx(5), dx(6), 0.0);
    const Vector3d bias = dx.segment<3>(2), force_w(0.0, 0.0, -gravity);
    for (int i = 0; i < steps; ++i) {
        const auto step = [&](const Vector3d& rate) { return math::quaternion_from_rotation_vector(rate * (0.5 * dt)); };
        truth = truth * step(rate_b);
        estimate = estimate * step(rate_b - bias);
        velocity += (estimate * (truth.conjugate() * force_w) - force_w) * dt;
        truth = truth * step(rate_b);
        estimate = estimate * step(rate_b - bias);
    }
    const Vector3d phi = -math::rotation_vector_from_quaternion(estimate * truth.conjugate());
    Eigen::VectorXd out(tilt_states);
    out << phi.head<2>(), bias, velocity.head<2>();
    return out;
}

LinearModel model(const char* where, const Vector3d& rpy, const Vector3d& rate_b, double relative) {
    const Eigen::Quaterniond q_wb = math::quaternion_from_rpy(rpy);
    Block block;
    block.duration = duration;
    for (int i = 0; i < steps; ++i) {
        const Vector3d turned = rate_b * ((i + 0.5) * duration / steps);
        block.C_wb += (q_wb * math::quaternion_from_rotation_vector(turned)).toRotationMatrix() / steps;
    }
    LinearModel m;
    m.where = where;
    m.analytic = TiltTransition(block, gravity).matrix();
    m.output = [=](const Eigen::VectorXd& dx) { return after_block(q_wb, rate_b, dx); };
    m.step = Eigen::VectorXd::Constant(tilt_states, 1e-3);
    Eigen::VectorXd row(tilt_states), column(tilt_states);
    row << 1e-3, 1e-3, 1e-9, 1e-9, 1e-9, 1e-3, 1e-3;
    column << 1.0, 1.0, duration, duration, duration, 1.0, 1.0;
    m.tolerance = schuler::test::tolerance_of(m.analytic, relative, relative * row, column);
    return m;
}

SCHULER_JACOBIAN(tilt_transition, "ahrs.TiltTransition") {
    return {model("at rest", {0.3, -0.5, 1.0}, Vector3d::Zero(), 1e-3),
            // the transition takes the attitude for its mean over the block: off by the angle turned in it, 0.035 rad
            model("upside down, turning", {2.9, 0.2, -2.0}, {0.4, -0.3, 0.5}, 0.05)};
}

TEST(TiltTransition, AdjointIsTheTranspose) {
    Block block;
    block.duration = duration;
    block.C_wb = math::quaternion_from_rpy({0.3, -0.5, 1.0}).toRotationMatrix();
    const TiltTransition phi(block, gravity);
    const TiltVector lambda = (TiltVector() << 1.0, -2.0, 0.5, 3.0, -1.0, 0.7, -0.4).finished();
    EXPECT_LT((phi.transpose_times(lambda) - phi.matrix().transpose() * lambda).norm(), 1e-14);
}

}  // namespace
}  // namespace schuler::ahrs
