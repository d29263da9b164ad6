// Integrity monitoring of the receiver: tests of a single fix, and the history of their results.
#pragma once

#include "schuler/core/time.h"
#include "schuler/filter/result.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/states/inertial_filter.h"

#include <Eigen/Core>

#include <array>
#include <optional>

namespace schuler::filter {

/// The position or velocity part of a fix, as compared with the filter; unused components are zero.
struct Examined {
    AidKind kind;  ///< GnssPosition or GnssVelocity
    Time time;
    Eigen::Vector3d innovation;  ///< m or m/s
    double trace = 0.0;          ///< of the innovation covariance, state and measurement together
};

/// History of one sub-vector; plain and copyable.
struct ChannelHealth {
    bool excluded = false;
    bool together = false;       ///< with the other sub-vector, by a test of both
    std::optional<Time> used;    ///< the last one used
    std::optional<Time> agrees;  ///< start of the agreement of excluded fixes with the estimate
    std::optional<Time> seen;    ///< the last excluded one
    int failed_run = 0;          ///< consecutive fixes that failed a test or the gate
    int slow_run = 0;            ///< consecutive slow-ramp tests exceeded
};

/// Tolerance check [PaperA:3.4, first approach] against the navigation extrapolated from the last used fix, with the vehicle's capability:
/// |innovation| <= a t (velocity) or a t^2 / 2 (position) + 5 sigma of the innovation, that is, of the measurement and of the navigation,
/// which runs unaided for a while in the separate scheme. The extrapolation is assumed to be no worse than with unknown acceleration.
[[nodiscard]] bool within_tolerance(const Examined& e, const ChannelHealth& health, const IntegritySettings& settings);

/// Innovation test (3.4.7): ratio of the traces of innovation innovation^T and of its covariance, below delta.
[[nodiscard]] bool is_normal_innovation(const Examined& e, const IntegritySettings& settings);

/// The first of the two tests that fails.
[[nodiscard]] std::optional<IntegrityTest> failed_test(const Examined& e, const ChannelHealth& health,
                                                       const IntegritySettings& settings);

/// Monitors an excluded channel: true once its fixes have agreed with the estimate for long enough (`agrees`: this one does). A position
/// that was excluded together with its velocity (null otherwise) waits until that agrees too, as long as there are velocities: one that
/// drifts slowly would otherwise be readmitted while the velocity contradicts the estimate, and take it along.
[[nodiscard]] bool readmits(ChannelHealth& health, const ChannelHealth* velocity, bool agrees, Time time,
                            const IntegritySettings& settings);

/// A copy of the filter that continues without the receiver and is restarted when `window` seconds old. Of two such copies, one
/// is always at least half a window old. An error growing too slowly to be detected in one innovation shows against it; it then
/// provides the solution from before the error; docs/complex.md.
template <class Frame>
struct Shadow {
    InertialFilter<Frame> filter;
    Time since{};
    bool alive = false;
};

/// Limits of the slow-ramp test for 1, 2, 3 degrees of freedom.
[[nodiscard]] std::array<double, 4> slow_limits(const IntegritySettings& settings);

}  // namespace schuler::filter
