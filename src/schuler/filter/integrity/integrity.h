// Integrity monitoring of the receiver: tests of a single fix, and the history of their results.
#pragma once

#include "schuler/core/time.h"
#include "schuler/filter/integrity/second_order.h"
#include "schuler/filter/result.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/states/inertial_filter.h"

#include <Eigen/Core>

#include <array>
#include <optional>

namespace schuler::filter {

/// The position or velocity part of a fix, as compared with the filter; unused components are zero.
struct Examined {
    MeasurementKind kind;  ///< GnssPosition or GnssVelocity
    Time time;
    Eigen::Vector3d innovation;                          ///< estimate minus measured, m or m/s
    double trace = 0.0;                                  ///< of the innovation covariance, state and measurement together
    Eigen::Vector3d of_state = Eigen::Vector3d::Zero();  ///< its diagonal: part of the estimate,
    Eigen::Vector3d of_noise = Eigen::Vector3d::Zero();  ///< ... and of the measurement; both zero: unused component
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
    /// Of a velocity found faulty: its innovation then, which remains as long as the fault does, and the time; kept when readmitted.
    Eigen::Vector3d fault = Eigen::Vector3d::Zero();
    std::optional<Time> faulty{};
    bool returned = false;                          ///< ends_a_fault() was true once
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();  ///< of the innovations since `agrees`
    int count = 0;                                  ///< ... their number
};

/// Tolerance check [PaperA:3.4, first approach] against the navigation extrapolated from the last used fix, with the vehicle's capability:
/// |innovation| <= a t (velocity) or a t^2 / 2 (position) + 5 sigma of the innovation, that is, of the measurement and of the navigation,
/// which runs unaided for a while in the uncoupled scheme. The extrapolation is assumed to be no worse than with unknown acceleration.
[[nodiscard]] bool within_tolerance(const Examined& e, const ChannelHealth& health, const IntegritySettings& settings);

/// Innovation test (3.4.7): ratio of the traces of innovation innovation^T and of its covariance, below delta.
[[nodiscard]] bool is_normal_innovation(const Examined& e, const IntegritySettings& settings);

/// The first of the two tests that fails.
[[nodiscard]] std::optional<IntegrityTest> failed_test(const Examined& e, const ChannelHealth& health,
                                                       const IntegritySettings& settings);

/// Monitors an excluded channel: true once its fixes have agreed with the estimate for long enough (`agrees`: this one does), and their
/// mean agrees too. The mean of a velocity must in addition not look as it did when it was excluded: the unaided estimate becomes so
/// uncertain that a slow fault is within its sigma, but then the fault is what remains and its absence what would be new. A position
/// that was excluded together with its velocity (null otherwise) waits until that is readmitted, as long as there are velocities: one that
/// drifts slowly would otherwise be readmitted while the velocity contradicts the estimate, and take it along.
[[nodiscard]] bool readmits(ChannelHealth& health, const ChannelHealth* velocity, const Examined& fix, bool agrees,
                            const IntegritySettings& settings);

/// Whether fixes that fail now end a fault instead of beginning one: the velocity was found faulty in the last minutes, and what
/// disagrees is opposite to that and no larger, of a position no larger than what the velocity added up to. The estimate, or that
/// of the slow error of the fixes, has followed the receiver, which has now recovered.
[[nodiscard]] bool ends_a_fault(const ChannelHealth& health, const ChannelHealth& velocity, const Examined& fix);

/// A copy of the filter that continues without the receiver and is restarted when `window` seconds old. Of two such copies, one
/// is always at least half a window old. An error growing too slowly to be detected in one innovation shows against it; it then
/// provides the solution from before the error; docs/complex.md.
template <class Frame>
struct Shadow {
    InertialFilter<Frame> filter;
    SecondOrder second_order;
    Time since{};
    bool alive = false;

    /// Propagates the covariance to the time of the nominal state.
    void propagate_covariance(const InertialModel& model);
};

/// Covariance of an innovation for the tests of a fix: the filter's own, and the errors of the second order of a tilted solution.
template <class Frame>
[[nodiscard]] Eigen::Matrix3d examined_covariance(const InertialFilter<Frame>& filter, const SecondOrder& second_order,
                                                  const Measurement& m) {
    const Eigen::Matrix3d S = filter.innovation_covariance(m);
    return second_order.follows() ? Eigen::Matrix3d(S + second_order.of_second_order(m)) : S;
}

/// Propagates a filter's covariance together with its errors of the second order; `phi` is the transition. False if it is already at the
/// time of the nominal state.
template <class Frame>
bool propagate_covariance(const InertialModel& model, InertialFilter<Frame>& filter, SecondOrder& second_order,
                          estim::Transition& phi) {
    const double span = filter.gathered.time;
    if (!filter.propagate_covariance(model, phi)) return false;
    second_order.propagate(phi, span, filter.covariance_of(Layout::attitude, Layout::attitude), filter.mean_force);
    return true;
}

template <class Frame>
void Shadow<Frame>::propagate_covariance(const InertialModel& model) {
    estim::Transition phi;
    (void)filter::propagate_covariance(model, filter, second_order, phi);
}

/// Limits of the slow-ramp test for 1, 2, 3 degrees of freedom.
[[nodiscard]] std::array<double, 4> slow_limits(const IntegritySettings& settings);

}  // namespace schuler::filter
