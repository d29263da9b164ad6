// Samples that would poison a filter: not finite, saturated, stuck. Left out and counted.
#pragma once

#include "schuler/ahrs/settings.h"

#include <Eigen/Core>

#include <cstddef>

namespace schuler::ahrs {

/// What one instrument delivered.
struct InstrumentCount {
    std::size_t samples = 0, not_finite = 0, saturated = 0, stuck = 0;

    [[nodiscard]] std::size_t rejected() const { return not_finite + saturated + stuck; }
};

struct Counters {
    InstrumentCount gyro, accel, field;
    std::size_t gaps = 0;              ///< steps longer than GuardSettings::longest_step
    std::size_t rest_blocks = 0;       ///< blocks at rest
    std::size_t disturbed_blocks = 0;  ///< blocks whose field was taken for disturbed
    std::size_t recoveries = 0;        ///< times the field was learnt anew
    std::size_t magnets = 0;           ///< times a magnet was found on the sensor, or gone from it
};

/// Judges the triples of one instrument in their order.
class InstrumentGuard {
public:
    /// `range`: of each axis.
    InstrumentGuard(const Eigen::Vector3d& range, int stuck_after) : range_(range), stuck_after_(stuck_after) {}

    /// Whether the triple can be used; counts it where not.
    [[nodiscard]] bool usable(const Eigen::Vector3d& v, InstrumentCount& count) {
        ++count.samples;
        if (!v.allFinite()) {
            ++count.not_finite;
            return false;
        }
        repeats_ = v == last_ ? repeats_ + 1 : 0;
        last_ = v;
        if (repeats_ >= stuck_after_) {
            ++count.stuck;
            return false;
        }
        if ((v.cwiseAbs().array() >= range_.array()).any()) {
            ++count.saturated;
            return false;
        }
        return true;
    }

private:
    Eigen::Vector3d range_;
    int stuck_after_;
    int repeats_ = 0;
    Eigen::Vector3d last_ = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

}  // namespace schuler::ahrs
