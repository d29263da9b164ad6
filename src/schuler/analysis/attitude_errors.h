// Attitude errors as defined by the BROAD benchmark: total rotation, and its split into heading and inclination.
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

/// RMS over the epochs, rad. [Laidig2021]: of the error rotation q_estimate q_reference^-1 in the local level frame, the heading
/// error is the rotation about the vertical, the inclination error the shortest remaining rotation. A constant heading offset
/// (the circular mean) is removed first, because the optical frame and magnetic north differ by one; `raw_` values are the
/// benchmark's own, without removal. The inclination is the same in both.
struct BroadErrors {
    double total = std::numeric_limits<double>::quiet_NaN();
    double heading = std::numeric_limits<double>::quiet_NaN();
    double inclination = std::numeric_limits<double>::quiet_NaN();
    double raw_total = std::numeric_limits<double>::quiet_NaN();
    double raw_heading = std::numeric_limits<double>::quiet_NaN();
    double heading_offset = std::numeric_limits<double>::quiet_NaN();  ///< estimate minus reference, rad
    std::size_t epochs = 0;
    std::vector<double> headings, inclinations;  ///< by epoch; headings signed, offset removed
};
[[nodiscard]] BroadErrors broad_errors(std::span<const AttitudePair> pairs);

}  // namespace schuler::analysis
