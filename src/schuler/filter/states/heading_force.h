// The part of the computed horizontal force from which heading may be derived.
//
// Heading acts on the velocity error through the horizontal specific force alone. In straight motion the computed one consists of
// the filter's own errors (tilt, biases, noise), which the transition would take for known: each correction of the velocity then
// yields heading information that is not there, about one radian^-2 for each independent correction. What changes the velocity by no
// more than the velocity's own uncertainty is therefore withheld from the column of the heading, and the error of doing so is
// noise (the second-order term of Maybeck 1982, section 12.3). A real acceleration, however gentle, exceeds that bound in time.
//
// A lever arm has the same effect on a smaller scale: its computed turning consists of the errors of the gyros.
#pragma once

#include <Eigen/Core>

namespace schuler::filter {

/// The part of a vector that is perpendicular to the unit vector `down`.
[[nodiscard]] inline Eigen::Vector3d horizontal_part(const Eigen::Vector3d& v, const Eigen::Vector3d& down) {
    return v - down.dot(v) * down;
}

/// 0 where the heading is known (products of two errors have no weight in hours), 1 where it is unknown; `variance`: rad^2.
[[nodiscard]] double heading_unknown(double variance);

/// The part of a vector that is withheld: all of it up to `limit`.
[[nodiscard]] inline Eigen::Vector3d withheld_part(const Eigen::Vector3d& v, double limit) {
    const double size = v.norm();
    return size > limit ? Eigen::Vector3d(v * (limit / size)) : v;
}

/// What of a rate or a turn remains for the column of a lever arm. Each axis by itself: the yaw of a turn does not make the vibration
/// about the other axes better known.
[[nodiscard]] inline Eigen::Vector3d for_lever_arm(const Eigen::Vector3d& w, double limit) {
    return w - w.cwiseMax(-limit).cwiseMin(limit);
}

/// What remains for the column of the heading; `down`: unit vector.
[[nodiscard]] inline Eigen::Vector3d for_heading(const Eigen::Vector3d& v, const Eigen::Vector3d& down, double limit) {
    return v - withheld_part(horizontal_part(v, down), limit);
}

/// What has been withheld so far; in the axes of the frame.
struct Withheld {
    Eigen::Vector3d change = Eigen::Vector3d::Zero();  ///< of the horizontal velocity, m/s
    double limit = 0.0;                                ///< m/s, of its magnitude
    double covered = 0.0;  ///< m/s, the largest since the last correction: its error is part of the noise
    double noise = 0.0;    ///< m^2/s^2, variance added for it since then
    /// A correction of the velocity is no motion: what it adds beyond the limit is not brought up later.
    void correct(const Eigen::Vector3d& horizontal);
};

/// Over one interval. Vectors in the axes of the frame.
struct HeadingForce {
    Eigen::Vector3d down = Eigen::Vector3d::UnitZ();           ///< unit vector
    Eigen::Vector3d effective = Eigen::Vector3d::Zero();       ///< horizontal velocity change for the heading's column, m/s
    Withheld withheld;                                         ///< at the end of the interval
    Eigen::Matrix3d velocity_noise = Eigen::Matrix3d::Zero();  ///< covariance of the velocity error made by withholding, m^2/s^2
};

/// `change`: of the computed velocity over the interval (m/s); `before`: what was withheld before it; `velocity`: covariance of the
/// velocity error at its end, apart from the heading's (m^2/s^2); `heading_variance` (rad^2).
[[nodiscard]] HeadingForce heading_force(const Eigen::Vector3d& change, const Withheld& before, const Eigen::Vector3d& down,
                                         const Eigen::Matrix3d& velocity, double heading_variance);

}  // namespace schuler::filter
