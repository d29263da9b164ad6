// From samples of an inertial unit to body increments, one sample at a time: what a log's timeline and a stream have in common.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/states/inertial_filter.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

namespace schuler::filter {

/// A step of increments longer than this times the nominal one is a hole; coarse time stamps stay below it (2 and 3 ms for 2.5).
inline constexpr double hole_factor = 1.75;

/// The interval that each sample stands for, by its kind and stamp, as if what was measured had lasted all of it. Axes and mounting
/// applied. Plain and copyable.
class IntervalMaker {
public:
    /// nominal: median step of the log, s.
    IntervalMaker(const ImuSettings& settings, double nominal);

    /// The interval of the next sample in order of time; nothing where it repeats a time or goes backwards. `next`: time of the sample
    /// behind it, which stamps at the start or centre of an interval end by; where there is none the interval is nominal.
    [[nodiscard]] std::optional<ImuIncrement> add(const ImuSample& sample, std::optional<Time> next);

    /// What it remembers.
    struct Memory {
        bool begun = false;
        Time sample{INT64_MIN}, end{};  ///< of the last one
    };
    Memory memory;

private:
    Eigen::Matrix3d C_;  // sensor to body
    ImuKind kind_;
    ImuStamp stamp_;
    double nominal_;
    Duration nominal_duration_;
};

/// Whether an interval is so long that samples before it are missing.
[[nodiscard]] bool is_hole(double dt, double nominal, const ImuSettings& settings);

/// Interpolated pieces that a hole is filled with at most.
inline constexpr std::int64_t most_pieces = 400;

/// Fills the time of an interval after a hole: interpolated increments, then what the sample itself measured, the last nominal interval.
/// `take(ImuIncrement, bool interpolated)` gets them in order.
template <class Take>
void fill_hole(const ImuIncrement& before, const ImuIncrement& interval, double nominal, Take&& take) {
    const Eigen::Vector3d rate0 = before.dtheta / before.dt, rate1 = interval.dtheta / interval.dt;
    const Eigen::Vector3d force0 = before.dv / before.dt, force1 = interval.dv / interval.dt;
    const double missing = interval.dt - nominal;
    const double step = std::max(nominal, missing / static_cast<double>(most_pieces));
    const auto pieces = std::max<std::int64_t>(1, std::llround(missing / step));
    const std::int64_t missing_ns = Duration::from_seconds(missing).ns;
    Time at = before.time;
    for (std::int64_t k = 1; k <= pieces; ++k) {
        const Time end{before.time.ns + missing_ns * k / pieces};
        const double dt = (end - at).seconds();
        const double x = (static_cast<double>(k) - 0.5) / static_cast<double>(pieces);
        take(ImuIncrement{end, dt, ((1.0 - x) * rate0 + x * rate1) * dt, ((1.0 - x) * force0 + x * force1) * dt}, true);
        at = end;
    }
    const double own = (interval.time - at).seconds();
    take(ImuIncrement{interval.time, own, rate1 * own, force1 * own}, false);
}

/// Mean squares of what rate and specific force vary by, one axis: rad^2/s^2, m^2/s^4.
struct Agitation {
    double rate2 = 0.0, force2 = 0.0;
};

/// Noise over a hole of so many seconds, whose unknown part is taken as correlated over half of it: variance of its integral =
/// s^2 hole^2 / 2. In steady motion interpolation is off by up to twice what varies `around` it; where it is worse `elsewhere`, a
/// turn may begin in it.
[[nodiscard]] BridgeNoise bridge_noise(double hole, Agitation around, Agitation elsewhere);

/// How lively the motion is, for holes of a stream: about the mean over the last second, and that on average. All memory is taken by
/// the constructor.
class RecentMotion {
public:
    explicit RecentMotion(double nominal);
    void clear();
    void add(const ImuIncrement& interval);
    [[nodiscard]] Agitation recent() const;
    /// Mean of the seconds so far.
    [[nodiscard]] Agitation usual() const;

    struct Motion {
        Eigen::Vector3d rate, force;
    };
    struct Memory {
        std::vector<Motion> last;  ///< a second of them, a ring
        std::size_t next = 0, filled = 0;
        Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();  ///< sums over this turn of the ring
        double rate2 = 0.0, force2 = 0.0;                                                 ///< likewise of the squares
        Agitation sum;
        double seconds = 0.0;  ///< that `sum` is of
    };
    Memory memory;
};

/// Finds samples of a unit that hangs, as they come: rates or forces that repeat to the last digit for a tenth of a second, in a unit
/// that hardly ever repeats them otherwise. What came before the tenth of a second was over has been used. Plain and copyable.
class HangWatch {
public:
    explicit HangWatch(double nominal) : least_(static_cast<int>(std::max(8.0, 0.1 / nominal))) {}
    [[nodiscard]] bool hangs(const ImuSample& sample);

    struct Memory {
        bool begun = false;
        Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
        int gyro_run = 0, accel_run = 0;      ///< samples in a row that repeat the one before
        std::int64_t samples = 0, fresh = 0;  ///< all, and those of which nothing repeats
        std::int64_t repeats = 0;             ///< in runs that were too short for a hang
    };
    Memory memory;

private:
    int least_;
};

}  // namespace schuler::filter
