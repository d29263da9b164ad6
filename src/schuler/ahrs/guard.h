// Samples that would corrupt a filter: not finite, saturated, frozen. Excluded and counted.
#pragma once

#include "schuler/ahrs/settings.h"

#include <Eigen/Core>

#include <cstddef>

namespace schuler::ahrs {

/// Sample statistics of one instrument.
struct InstrumentCount {
    std::size_t samples = 0, not_finite = 0, saturated = 0, stuck = 0;

    [[nodiscard]] std::size_t rejected() const { return not_finite + saturated + stuck; }
};

struct Counters {
    InstrumentCount gyro, accel, field;
    std::size_t gaps = 0;              ///< intervals longer than GuardSettings::gap_factor and longest_step allow
    std::size_t rest_blocks = 0;       ///< blocks at rest
    std::size_t disturbed_blocks = 0;  ///< blocks with a disturbed field
    std::size_t recoveries = 0;        ///< number of times the field was relearnt
    std::size_t magnets = 0;           ///< number of times a magnet was detected on the sensor, or its removal
};

/// The usual interval between samples, learnt as they come: their mean weighted by their length, over some twenty of them, so that stamps
/// in bursts and odd first ones do not count. Gaps have no part in it.
class UsualStep {
public:
    /// True if an interval is more than `factor` usual ones; never for the first ten. Where the rate has changed for good, its interval
    /// becomes usual soon.
    [[nodiscard]] bool exceeded_by(double dt, double factor) {
        constexpr int first = 10;
        constexpr double memory = 20.0, growth = 1.1;
        const bool exceeded = count_ >= first && dt > factor * usual_;
        if (count_ < first) ++count_;
        usual_ = exceeded ? growth * usual_ : usual_ + dt / (memory * usual_ + dt) * (dt - usual_);
        return exceeded;
    }

private:
    double usual_ = 0.0;  // s
    int count_ = 0;
};

/// Checks the samples of one instrument in order.
class InstrumentGuard {
public:
    /// `range`: of each axis.
    InstrumentGuard(const Eigen::Vector3d& range, int stuck_after) : range_(range), stuck_after_(stuck_after) {}

    /// True if the sample can be used; counts it otherwise.
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
