// Attitude errors the way the BROAD benchmark counts them: total rotation, and its split into heading and inclination.
#pragma once

#include <Eigen/Geometry>

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace schuler::analysis {

/// Estimate and reference at one epoch, body to north-east-down.
struct AttitudePair {
    Eigen::Quaterniond q_estimate, q_reference;
};

/// RMS over the epochs, rad. [Laidig2021]: of the error rotation q_estimate q_reference^-1, which lives in the local level frame,
/// the heading error is the rotation about the vertical, the inclination error the shortest rotation that remains. A constant
/// heading offset (the circular mean) is taken off first, since the optical frame and magnetic north are apart by one; `raw_` are the
/// benchmark's own, nothing taken off. The inclination is the same in both.
struct BroadErrors {
    double total = std::numeric_limits<double>::quiet_NaN();
    double heading = std::numeric_limits<double>::quiet_NaN();
    double inclination = std::numeric_limits<double>::quiet_NaN();
    double raw_total = std::numeric_limits<double>::quiet_NaN();
    double raw_heading = std::numeric_limits<double>::quiet_NaN();
    double heading_offset = std::numeric_limits<double>::quiet_NaN();  ///< estimate minus reference, rad
    std::size_t epochs = 0;
    std::vector<double> headings, inclinations;  ///< epoch by epoch; headings signed, offset taken off
};
[[nodiscard]] BroadErrors broad_errors(std::span<const AttitudePair> pairs);

}  // namespace schuler::analysis
