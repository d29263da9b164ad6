// The attitude integrators compared in paper A (section 1.3), with misprints corrected: for reference and comparison, not
// for the filter. Each is a pure function of one step. Axes in this file are the paper's: local level north-up-east ("NHE"), body
// forward-up-right, psi counter-clockwise about up (heading = -psi); earth/axes.h converts.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace schuler::ins::paper_a {

/// rad. B (1.3.8) is about_up(psi) about_right(pitch) about_forward(roll).
struct Angles {
    double psi, pitch, roll;
};

/// Body to local level, (1.3.8) (math.md E2.19).
[[nodiscard]] Eigen::Matrix3d matrix_from(const Angles& angles);
/// Initial quaternion, body to local level (math.md 2.5, E2.18: the printed one is for a different order of rotations).
[[nodiscard]] Eigen::Quaterniond quaternion_from(const Angles& angles);

/// Time derivatives of the angles, (1.3.7), rad/s. w: rate of the body relative to local level in body axes, (1.3.6).
/// Singular at |pitch| = 90 deg.
[[nodiscard]] Angles angle_rates(const Angles& angles, const Eigen::Vector3d& w);
/// One midpoint step of the angles over dt (s) with constant w: error of the third order a step.
[[nodiscard]] Angles step_angles(const Angles& angles, const Eigen::Vector3d& w, double dt);

/// Whether a step restores the norm (quaternion) or orthogonality (matrix) afterwards. The paper claims "guaranteed
/// orthogonality" without it; this is false: see the growth rates below.
enum class Normalise { No, Yes };

/// Poisson's equation dB/dt = B [w_body x] - [w_level x] B to second order: beta (body) and zeta (local level) are integrals
/// of absolute rates over the step in their own axes, rad. Without normalising, B^T B - I grows by about |beta|^4/4 a step.
[[nodiscard]] Eigen::Matrix3d step_poisson(const Eigen::Matrix3d& B, const Eigen::Vector3d& beta, const Eigen::Vector3d& zeta,
                                           Normalise normalise);

/// (1.3.4) solved exactly for a constant rate: q Exp(beta).
[[nodiscard]] Eigen::Quaterniond step_quaternion(const Eigen::Quaterniond& q, const Eigen::Vector3d& beta);

/// (1.3.5), Picard's second approximation (math.md 2.5, E2.17): q (1 - |beta|^2/8, beta/2). Error |beta|^3/48 a step; without
/// normalising the norm grows by |beta|^4/128 a step.
[[nodiscard]] Eigen::Quaterniond step_picard_second(const Eigen::Quaterniond& q, const Eigen::Vector3d& beta,
                                                    Normalise normalise);
/// First approximation, which the paper uses for the local level: q (1, zeta/2). The norm grows by |zeta|^2/8 a step.
[[nodiscard]] Eigen::Quaterniond step_picard_first(const Eigen::Quaterniond& q, const Eigen::Vector3d& zeta, Normalise normalise);

/// The paper's pair: lambda takes body to inertial, mu local level to inertial axes; B = C^T A, A and C their matrices.
struct QuaternionPair {
    Eigen::Quaterniond lambda, mu;
};
/// lambda by the second approximation, mu by the first. beta, zeta as in step_poisson.
[[nodiscard]] QuaternionPair step_pair(const QuaternionPair& pair, const Eigen::Vector3d& beta, const Eigen::Vector3d& zeta,
                                       Normalise normalise);
/// B from the pair by the paper's formula 1 - 2 (l2^2 + l3^2), ...: not orthogonal unless the norms are 1.
[[nodiscard]] Eigen::Matrix3d matrix_from(const QuaternionPair& pair);

}  // namespace schuler::ins::paper_a
