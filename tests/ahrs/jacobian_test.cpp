// The channels' derivatives against differences: the tilt's of a strapdown written out here, the heading's of its own model, which is
// held against a magnetometer and a gyro that are wrong in every way it knows.
#include "schuler/ahrs/heading_model.h"
#include "schuler/ahrs/tilt_channel.h"
#include "schuler/math/rotation.h"
#include "support/perturbation.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace schuler::ahrs {
namespace {

using Eigen::Vector3d;
using schuler::test::LinearModel;

constexpr double gravity = 9.81, duration = 0.05;
constexpr int steps = 500;

/// The channel's errors (estimate minus truth) after a block that begins with errors dx, the last three an accelerometer bias; the
/// sensor turns at `rate_b` in place.
Eigen::VectorXd after_block(const Eigen::Quaterniond& q_wb, const Vector3d& rate_b, const Eigen::VectorXd& dx) {
    const double dt = duration / steps;
    Eigen::Quaterniond truth = q_wb, estimate = math::quaternion_from_rotation_vector({-dx(0), -dx(1), 0.0}) * q_wb;
    Vector3d velocity(dx(TiltState::velocity), dx(TiltState::velocity + 1), 0.0);
    const Vector3d bias = dx.segment<3>(TiltState::gyro_bias), accel = dx.tail<3>(), force_w(0.0, 0.0, -gravity);
    for (int i = 0; i < steps; ++i) {
        const auto step = [&](const Vector3d& rate) { return math::quaternion_from_rotation_vector(rate * (0.5 * dt)); };
        truth = truth * step(rate_b);
        estimate = estimate * step(rate_b - bias);
        velocity += (estimate * (truth.conjugate() * force_w + accel) - force_w) * dt;
        truth = truth * step(rate_b);
        estimate = estimate * step(rate_b - bias);
    }
    const Vector3d phi = -math::rotation_vector_from_quaternion(estimate * truth.conjugate());
    Eigen::VectorXd out(tilt_states);
    out << phi.head<2>(), velocity.head<2>(), bias;
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
    const TiltTransition phi(block, gravity);
    Eigen::MatrixXd analytic = Eigen::MatrixXd::Zero(tilt_states, tilt_states + 3);
    analytic << phi.matrix(), Eigen::MatrixXd::Zero(tilt_states, 3);
    analytic.topRightCorner<TiltState::changing, 3>() = phi.from_accel_bias;
    LinearModel m;
    m.where = where;
    m.analytic = analytic;
    m.output = [=](const Eigen::VectorXd& dx) { return after_block(q_wb, rate_b, dx); };
    m.step = Eigen::VectorXd::Constant(tilt_states + 3, 1e-3);
    Eigen::VectorXd row(tilt_states), column(tilt_states + 3);
    row << 1e-3, 1e-3, 1e-3, 1e-3, 1e-9, 1e-9, 1e-9;
    column << 1.0, 1.0, 1.0, 1.0, Eigen::VectorXd::Constant(6, duration);
    m.tolerance = schuler::test::tolerance_of(m.analytic, relative, relative * row, column);
    return m;
}

SCHULER_JACOBIAN(tilt_transition, "ahrs.TiltTransition") {
    return {model("at rest", {0.3, -0.5, 1.0}, Vector3d::Zero(), 1e-3),
            // the transition takes the attitude for its mean over the block: off by the angle turned in it, 0.035 rad
            model("upside down, turning", {2.9, 0.2, -2.0}, {0.4, -0.3, 0.5}, 0.05)};
}

TEST(TiltTransition, FilterAndSmootherUseTheMatrix) {
    Block block;
    block.duration = duration;
    block.C_wb = math::quaternion_from_rpy({0.3, -0.5, 1.0}).toRotationMatrix();
    const TiltMatrix root =
        TiltMatrix::Identity() + 0.3 * TiltMatrix::NullaryExpr([](auto r, auto c) { return std::sin(r + 3.0 * c); });
    const TiltMatrix P = root * root.transpose();
    const AccelBiasEffect effect = root.leftCols<3>();
    for (const bool levelled : {false, true}) {
        block.levelled = levelled;
        const TiltTransition phi(block, gravity);
        const TiltMatrix F = phi.matrix();
        TiltMatrix after = P;
        AccelBiasEffect moved = effect, expected = F * effect;
        phi.propagate(after, moved);
        EXPECT_LT((after - F * P * F.transpose()).norm(), 1e-13);
        expected.topRows<TiltState::changing>() += phi.from_accel_bias;
        EXPECT_LT((moved - expected).norm(), 1e-13);
        estim::Adjoint<tilt_states> adjoint;
        adjoint.lambda = root.col(0);
        adjoint.Lambda = P;
        phi.propagate_back(adjoint);
        EXPECT_LT((adjoint.lambda - F.transpose() * root.col(0)).norm(), 1e-13);
        EXPECT_LT((adjoint.Lambda - F.transpose() * P * F).norm(), 1e-13);
    }
}

HeadingEstimate some_estimate() {
    HeadingEstimate e;
    e.level_field = 18e-6 * Eigen::Vector2d(std::cos(0.7), -std::sin(0.7));
    e.place = Eigen::Vector2d(1.5e-6, -1e-6);
    e.bias = Vector3d(0.01, -0.02, 0.015);
    e.gyro_matrix << 4e-3, 1e-3, -2e-3, 3e-3, -5e-3, 1e-3, -1e-3, 2e-3, 6e-3;
    e.hard_iron = Vector3d(3e-6, -4e-6, 2e-6);
    e.soft_iron << 0.02, 0.01, -0.01, -0.02, 0.03, 0.01, 0.005, -0.01, -0.02;
    e.vertical = 42e-6;
    e.delay = 0.012;
    return e;
}

Block some_block() {
    Block b;
    b.duration = duration;
    b.C_wb = math::quaternion_from_rpy({0.4, -0.6, 1.1}).toRotationMatrix();
    b.rate_b = Vector3d(0.9, -1.7, 1.2);
    b.bias_used = Vector3d(0.005, 0.004, -0.002);
    return b;
}

/// What a magnetometer and a gyro with these errors measure over some attitudes, in means.
FieldMeans measured_with(const HeadingEstimate& truth) {
    FieldMeans means;
    const Eigen::Matrix3d C_nw = math::dcm_from_rpy({0.0, 0.0, truth.heading()});
    const Vector3d field_n =
        C_nw * Vector3d(truth.level_field.x() + truth.place.x(), truth.level_field.y() + truth.place.y(), truth.vertical);
    constexpr int samples = 5;
    for (int i = 0; i < samples; ++i) {
        const Eigen::Matrix3d C_wb =
            math::quaternion_from_rpy({0.3 + 0.02 * i, -0.5 - 0.03 * i, 1.0 + 0.05 * i}).toRotationMatrix();
        const Vector3d rate(0.8, -1.1 + 0.1 * i, 0.5), field_b = (C_nw * C_wb).transpose() * field_n;
        const Vector3d older = field_b + truth.delay * rate.cross(field_b);  // a field fixed in space turns by -rate x field in b
        means.add(C_wb, rate, older + truth.soft_iron * older + truth.hard_iron);
    }
    means.scale(1.0 / samples);
    return means;
}

/// Steps of the errors' own size.
Eigen::VectorXd heading_steps() {
    Eigen::VectorXd sizes(heading_states);
    // clang-format off
    sizes << 1e-6, 1e-6, 1e-6, 1e-6, Eigen::VectorXd::Constant(3, 1e-3), Eigen::VectorXd::Constant(9, 1e-3), Eigen::VectorXd::Constant(3, 1e-6),
        Eigen::VectorXd::Constant(9, 1e-3), 1e-6, 1e-3;
    // clang-format on
    return sizes;
}

HeadingEstimate with_error(HeadingEstimate e, const Eigen::VectorXd& dx) {
    e.correct(-HeadingVector(dx));
    return e;
}

SCHULER_JACOBIAN(field_measurement, "ahrs.field_measurement") {
    const HeadingEstimate e = some_estimate();
    const FieldMeans means = measured_with(e);
    LinearModel m;
    m.where = "turning, with every error";
    m.analytic = field_measurement(e, means).H;
    m.output = [=](const Eigen::VectorXd& dx) { return Eigen::VectorXd(field_measurement(with_error(e, dx), means).innovation); };
    m.step = heading_steps();
    m.tolerance = schuler::test::tolerance_of(m.analytic, 1e-7, Vector3d::Constant(1e-15), m.step.cwiseInverse());
    return {m};
}

SCHULER_JACOBIAN(heading_turn, "ahrs.heading_turn") {
    const HeadingEstimate e = some_estimate();
    const Block block = some_block();
    LinearModel m;
    m.where = "turning, with every error";
    m.analytic = heading_turn(e, block).row.transpose();
    m.output = [=](const Eigen::VectorXd& dx) {
        return Eigen::VectorXd::Constant(1, heading_turn(with_error(e, dx), block).angle).eval();
    };
    m.step = heading_steps();
    m.tolerance = schuler::test::tolerance_of(m.analytic, 1e-7, Eigen::VectorXd::Constant(1, 1e-13), m.step.cwiseInverse());
    return {m};
}

TEST(HeadingModel, ExplainsAnInstrumentThatIsWrongInEveryWayItKnows) {
    const HeadingEstimate e = some_estimate();
    const FieldMeasurement m = field_measurement(e, measured_with(e));
    // products of two errors are left: a soft iron of 4 % of a hard one of 5 uT, and of 4 % and 1 deg of the field
    EXPECT_LT(m.innovation.norm(), 0.3e-6);
    EXPECT_GT(field_measurement(HeadingEstimate{}, measured_with(e)).innovation.norm(), 10e-6);
}

TEST(HeadingModel, TurnIsWhatTheStrapdownTurnedTooMuch) {
    // a strapdown with the rates as measured less the bias used, against one with the true rates; only the turn about the vertical
    const HeadingEstimate e = some_estimate();
    Block block = some_block();
    const Vector3d rate = (Eigen::Matrix3d::Identity() + e.gyro_matrix).inverse() * (block.rate_b - e.bias);
    const Eigen::Quaterniond start = math::quaternion_from_rpy({0.4, -0.6, 1.1});
    Eigen::Quaterniond truth = start, used = start;
    block.C_wb.setZero();
    for (int i = 0; i < steps; ++i) {
        truth = truth * math::quaternion_from_rotation_vector(rate * (duration / steps));
        used = used * math::quaternion_from_rotation_vector((block.rate_b - block.bias_used) * (duration / steps));
        block.C_wb += used.toRotationMatrix() / steps;
    }
    const double about_vertical = math::rotation_vector_from_quaternion(truth * used.conjugate()).z();
    EXPECT_NEAR(heading_turn(e, block).angle, about_vertical, 1e-2 * std::abs(about_vertical));
}

}  // namespace
}  // namespace schuler::ahrs
