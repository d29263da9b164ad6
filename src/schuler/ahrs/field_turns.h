// Changes of the field in the body, against those that the gyro's rotation explains: axes, hard iron and clock of a magnetometer
// are judged by what remains. Constant fields cancel, so the Earth's field need not be known.
#pragma once

#include "schuler/core/samples.h"

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace schuler::ahrs {

/// Rotation of the body between any two times of a log, by its gyro alone.
class Turning {
public:
    /// `imu` must outlive the object.
    explicit Turning(std::span<const ImuSample> imu);

    /// C_b(b)b(a); nothing outside of the log, or over samples that are missing.
    [[nodiscard]] std::optional<Eigen::Matrix3d> between(Time a, Time b) const;

private:
    [[nodiscard]] std::size_t before(Time t) const;
    [[nodiscard]] Eigen::Quaterniond at(std::size_t i, Time t) const;

    std::span<const ImuSample> imu_;
    std::vector<Eigen::Quaterniond> q_;  ///< since the first sample
    std::vector<int> broken_;            ///< number of intervals so far without a usable rate
};

/// Two readings 0.2 to 0.5 s apart.
struct ReadingPair {
    const MagSample *first, *second;
};
/// One after the other; if there are more than `enough`, those are spread over the log. `mag` must outlive them.
[[nodiscard]] std::vector<ReadingPair> reading_pairs(std::span<const MagSample> mag,
                                                     std::size_t enough = std::numeric_limits<std::size_t>::max());

class FieldTurns {
public:
    struct Unexplained {
        double left = 0.0;                                      ///< sum of the squared residuals, T^2
        Eigen::Vector3d hard_iron_b = Eigen::Vector3d::Zero();  ///< T
        double std = 0.0;                                       ///< T, one sigma of its least known component
    };

    /// `delay`: s, age of a reading at its time.
    FieldTurns(const Turning& turning, std::span<const ReadingPair> readings, double delay = 0.0);

    [[nodiscard]] std::size_t size() const { return pairs_.size(); }

    /// The field turned enough for a judgement.
    [[nodiscard]] bool enough() const;
    /// Sum of the squared changes, with the largest limited as in unexplained(); T^2.
    [[nodiscard]] double changes() const { return capped_; }
    /// Part of the changes that the rotation does not explain, if C maps the reading to the body and the best hard iron is taken
    /// off. Robust: the residuals of a disturbed field are limited.
    [[nodiscard]] Unexplained unexplained(const Eigen::Matrix3d& C) const;
    /// Two hypotheses that leave these sums, or fractions, differ beyond doubt: in size, and in likelihood.
    [[nodiscard]] bool clearly_worse(double worse, double better) const;

private:
    struct Pair {
        Eigen::Vector3d first, change;
        Eigen::Matrix3d turn;  // C_b2b1 - I: change of a field fixed in space
    };
    std::vector<Pair> pairs_;
    double sizes_ = 0.0, changes_ = 0.0, bound_ = 0.0, capped_ = 0.0;
};

/// One of each pair of opposite signs: 24 of the 48 signed permutations of three axes.
[[nodiscard]] std::vector<Eigen::Matrix3d> axes_candidates();

/// Factor between the sums of hypotheses below which they count as equal.
inline constexpr double equal_within = 1.3;
/// A hypothesis that leaves more than this part of the changes unexplained is none.
inline constexpr double unconvincing = 0.5;

}  // namespace schuler::ahrs
