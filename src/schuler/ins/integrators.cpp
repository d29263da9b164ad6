#include "schuler/ins/integrators.h"

#include "schuler/math/rotation.h"

#include <cmath>

namespace schuler::ins::paper_a {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d matrix_from(const Angles& a) {
    const double sp = std::sin(a.psi), cp = std::cos(a.psi);
    const double st = std::sin(a.pitch), ct = std::cos(a.pitch);
    const double sg = std::sin(a.roll), cg = std::cos(a.roll);
    Matrix3d B;
    // clang-format off
    B << cp * ct, sp * sg - cp * st * cg, sp * cg + cp * st * sg,
         st, ct * cg, -ct * sg,
         -sp * ct, cp * sg + sp * st * cg, cp * cg - sp * st * sg;
    // clang-format on
    return B;
}

Quaterniond quaternion_from(const Angles& a) {
    const double sp = std::sin(0.5 * a.psi), cp = std::cos(0.5 * a.psi);
    const double st = std::sin(0.5 * a.pitch), ct = std::cos(0.5 * a.pitch);
    const double sg = std::sin(0.5 * a.roll), cg = std::cos(0.5 * a.roll);
    return {cp * ct * cg - sp * st * sg, cp * ct * sg + sp * st * cg, sp * ct * cg + cp * st * sg, cp * st * cg - sp * ct * sg};
}

Angles angle_rates(const Angles& a, const Vector3d& w) {
    const double sg = std::sin(a.roll), cg = std::cos(a.roll);
    const double about_up = w.y() * cg - w.z() * sg;
    return {about_up / std::cos(a.pitch), w.y() * sg + w.z() * cg, w.x() - std::tan(a.pitch) * about_up};
}

Angles step_angles(const Angles& a, const Vector3d& w, double dt) {
    const Angles start = angle_rates(a, w);
    const Angles middle{a.psi + 0.5 * dt * start.psi, a.pitch + 0.5 * dt * start.pitch, a.roll + 0.5 * dt * start.roll};
    const Angles rate = angle_rates(middle, w);
    return {a.psi + dt * rate.psi, a.pitch + dt * rate.pitch, a.roll + dt * rate.roll};
}

Matrix3d step_poisson(const Matrix3d& B, const Vector3d& beta, const Vector3d& zeta, Normalise normalise) {
    const Matrix3d body = math::skew(beta), level = math::skew(zeta);
    const Matrix3d change = B * body - level * B;
    const Matrix3d second = 0.5 * (change * body - level * change);
    const Matrix3d next = B + change + second;
    return normalise == Normalise::Yes ? math::orthonormalised(next) : next;
}

Quaterniond step_quaternion(const Quaterniond& q, const Vector3d& beta) {
    return q * math::quaternion_from_rotation_vector(beta);
}

namespace {
Quaterniond finished(const Quaterniond& q, Normalise normalise) { return normalise == Normalise::Yes ? q.normalized() : q; }
}  // namespace

Quaterniond step_picard_second(const Quaterniond& q, const Vector3d& beta, Normalise normalise) {
    const Quaterniond turn(1.0 - 0.125 * beta.squaredNorm(), 0.5 * beta.x(), 0.5 * beta.y(), 0.5 * beta.z());
    return finished(q * turn, normalise);
}

Quaterniond step_picard_first(const Quaterniond& q, const Vector3d& zeta, Normalise normalise) {
    return finished(q * Quaterniond(1.0, 0.5 * zeta.x(), 0.5 * zeta.y(), 0.5 * zeta.z()), normalise);
}

QuaternionPair step_pair(const QuaternionPair& pair, const Vector3d& beta, const Vector3d& zeta, Normalise normalise) {
    return {step_picard_second(pair.lambda, beta, normalise), step_picard_first(pair.mu, zeta, normalise)};
}

Matrix3d matrix_from(const QuaternionPair& pair) {
    // Eigen's conversion equals the paper's formula: it does not divide by the norm.
    return pair.mu.toRotationMatrix().transpose() * pair.lambda.toRotationMatrix();
}

}  // namespace schuler::ins::paper_a
