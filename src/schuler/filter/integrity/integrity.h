// Can the receiver be trusted? Tests of one fix, and the memory of what they said.
#pragma once

#include "schuler/core/time.h"
#include "schuler/filter/result.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/states/inertial_filter.h"

#include <Eigen/Core>

#include <array>
#include <optional>

namespace schuler::filter {

/// A sub-vector of a fix, its position or its velocity, as the filter meets it; unused components are zero.
struct Examined {
    AidKind kind;  ///< GnssPosition or GnssVelocity
    Time time;
    Eigen::Vector3d innovation;  ///< m or m/s
    double trace = 0.0;          ///< of the innovation's covariance, sigma^2 of state and measurement together
};

/// What is remembered of one sub-vector; plain and copyable.
struct ChannelHealth {
    bool excluded = false;
    std::optional<Time> used;    ///< the last one that was used
    std::optional<Time> agrees;  ///< since then the excluded ones agree with the estimate
    int failed_run = 0;          ///< fixes in a row that failed a test or the gate
    int slow_run = 0;            ///< slow-ramp tests exceeded in a row
};

/// Tolerance check [PaperA:3.4, first approach]: against navigation extrapolated from the fix used last, with what the vehicle is
/// capable of: |innovation| <= a t (velocity) or a t^2 / 2 (position) + 5 sigma of the innovation: of the measurement and of the navigation, which in the
/// separate scheme is left to itself for a while. The mechanization that extrapolates is trusted to be no worse than not knowing the acceleration.
[[nodiscard]] bool within_tolerance(const Examined& e, const ChannelHealth& health, const IntegritySettings& settings);

/// Innovation test (3.4.7): trace of innovation innovation^T over the trace of its covariance, below delta.
[[nodiscard]] bool is_normal_innovation(const Examined& e, const IntegritySettings& settings);

/// The first of the two tests that fails.
[[nodiscard]] std::optional<IntegrityTest> failed_test(const Examined& e, const ChannelHealth& health,
                                                       const IntegritySettings& settings);

/// Follows an excluded channel: true once its fixes have agreed with the estimate (`agrees`: this one does) for long enough.
[[nodiscard]] bool readmits(ChannelHealth& health, bool agrees, Time time, const IntegritySettings& settings);

/// A copy of the filter that goes on without the receiver, restarted when `window` seconds old. Of two of them, one is at any time
/// at least half a window old: an error that grows too slowly to be seen in one innovation shows against it, and where it does, it is
/// the solution from before the error; docs/complex.md.
template <class Frame>
struct Shadow {
    InertialFilter<Frame> filter;
    Time since{};
    bool alive = false;
};

/// Limits of the slow-ramp test for 1, 2, 3 degrees of freedom.
[[nodiscard]] std::array<double, 4> slow_limits(const IntegritySettings& settings);

}  // namespace schuler::filter
