// From IMU samples to body increments, one sample at a time: shared by a log's timeline and a stream.
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

/// An increment longer than this multiple of the nominal one is a gap; coarse time stamps stay below it (2 and 3 ms for 2.5).
inline constexpr double hole_factor = 1.75;

/// The interval represented by each sample, by its kind and stamp, with the measured value held constant over it. Axes and
/// mounting are applied. Plain and copyable.
class IntervalMaker {
public:
    /// nominal: median interval of the log, s.
    IntervalMaker(const ImuSettings& settings, double nominal);

    /// The interval of the next sample in time order; empty if it repeats a time or goes backwards. `next`: time of the following
    /// sample, at which an interval stamped at its start or centre ends; if there is none the nominal interval is used.
    [[nodiscard]] std::optional<ImuIncrement> add(const ImuSample& sample, std::optional<Time> next);

    /// State kept from the previous samples.
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

/// True if an interval is so long that preceding samples are missing.
[[nodiscard]] bool is_hole(double dt, double nominal, const ImuSettings& settings);

/// Largest number of interpolated pieces that fill a gap.
inline constexpr std::int64_t most_pieces = 400;

/// Fills an interval that follows a gap: interpolated increments, then the measurement of the sample itself, over the last
/// nominal interval. `take(ImuIncrement, bool interpolated)` receives them in order.
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

/// Mean squares of the variation of rate and specific force, one axis: rad^2/s^2, m^2/s^4.
struct Agitation {
    double rate2 = 0.0, force2 = 0.0;
};

/// Noise over a gap of this many seconds, whose unknown motion is assumed correlated over half of it: variance of its integral =
/// s^2 gap^2 / 2. In steady motion the interpolation error is up to twice the variation `around` it; if the variation `elsewhere`
/// is larger, a turn may begin in the gap.
[[nodiscard]] BridgeNoise bridge_noise(double hole, Agitation around, Agitation elsewhere);

/// Variation of the motion, for gaps in a stream: about the mean over the last second, and its average. All memory is allocated
/// by the constructor.
class RecentMotion {
public:
    explicit RecentMotion(double nominal);
    void clear();
    void add(const ImuIncrement& interval);
    [[nodiscard]] Agitation recent() const;
    /// Mean over the elapsed time.
    [[nodiscard]] Agitation usual() const;

    struct Motion {
        Eigen::Vector3d rate, force;
    };
    struct Memory {
        std::vector<Motion> last;  ///< one second of them, a ring buffer
        std::size_t next = 0, filled = 0;
        Eigen::Vector3d rate = Eigen::Vector3d::Zero(), force = Eigen::Vector3d::Zero();  ///< sums over this turn of the ring
        double rate2 = 0.0, force2 = 0.0;                                                 ///< likewise for the squares
        Agitation sum;
        double seconds = 0.0;  ///< duration of `sum`
    };
    Memory memory;
};

/// Detects a frozen unit from its samples: rates or forces that repeat to the last digit for a tenth of a second, in a unit that
/// hardly ever repeats them otherwise. Samples within that tenth of a second have been used. Plain and copyable.
class HangWatch {
public:
    explicit HangWatch(double nominal) : least_(static_cast<int>(std::max(8.0, 0.1 / nominal))) {}
    [[nodiscard]] bool hangs(const ImuSample& sample);

    struct Memory {
        bool begun = false;
        Eigen::Vector3d gyro = Eigen::Vector3d::Zero(), accel = Eigen::Vector3d::Zero();
        int gyro_run = 0, accel_run = 0;      ///< consecutive samples equal to the previous one
        std::int64_t samples = 0, fresh = 0;  ///< all, and those without any repeated value
        std::int64_t repeats = 0;             ///< in runs too short for a freeze
    };
    Memory memory;

private:
    int least_;
};

}  // namespace schuler::filter
