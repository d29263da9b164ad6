// Errors of the second order of a solution whose attitude nobody corrects (uncoupled scheme), for the tests of the receiver's fixes.
//
// The estimated attitude turns the measured specific force f into the axes of the frame wrongly by the attitude error phi:
//     (C_est - C) f_b = (I - exp([phi x])) f = -phi x f - 1/2 phi x (phi x f) - ...,      f = C_est f_b.
// The covariance has the first term. The second one, as an acceleration in m/s^2,
//     q = 1/2 (phi^2 f - phi (phi . f)),
// is vertical for the most part, as f is: 1/2 g tilt^2, at a tilt of 0.2 rad 0.2 m/s^2. In that direction the first term is of the same
// size, the horizontal part of f times the tilt, or nothing where f is vertical. With phi ~ N(0, S), s = tr S and the fourth moments of
// a Gaussian vector, E[a b c d] = E[ab] E[cd] + E[ac] E[bd] + E[ad] E[bc],
//     4 E[q q^T] = S (f.Sf) + 2 Sf Sf^T - (s Sf + 2 SSf) f^T - f (s Sf + 2 SSf)^T + (s^2 + 2 tr SS) f f^T.
// phi is not noise but an error that grows over minutes, and so is q: it accumulates in velocity and position in proportion to time,
// not to its root. Its effect is therefore kept as three columns of errors, one for each axis of the root of E[q q^T]; they pass through
// the transitions and corrections of the filter, and their product with their transpose adds to the covariance of an innovation.
//
// The next term, 1/6 phi^3 f, is a third of phi against this one: beyond a tilt of 1 rad the series does not converge fast enough.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/filter/update/separate.h"

#include <Eigen/Core>

namespace schuler::filter {

/// E[q q^T] for attitude errors of covariance S (rad^2) and a specific force f (m/s^2), both in the same axes: m^2/s^4.
[[nodiscard]] Eigen::Matrix3d second_order_acceleration(const Eigen::Matrix3d& S, const Eigen::Vector3d& f);

/// rad, one sigma of the tilt beyond which no fix can be judged.
inline constexpr double most_tilt_judged = 1.0;

/// One sigma of the tilt about its worst horizontal axis, rad.
template <class Frame>
[[nodiscard]] double tilt_sigma(const InertialModel& model, const InertialFilter<Frame>& filter);

/// Second-order errors of one filter. Plain and copyable; without states (the default) there are none.
class SecondOrder {
public:
    SecondOrder() = default;
    explicit SecondOrder(Eigen::Index states) : errors_(Columns::Zero(states, 3)) {}
    [[nodiscard]] bool follows() const { return errors_.rows() > 0; }

    /// After the propagation of the filter's covariance by `phi` over `span` seconds, with its attitude covariance S (rad^2) and mean
    /// specific force (m/s^2) in the filter's axes.
    void propagate(const estim::Transition& phi, double span, const Eigen::Matrix3d& S, const Eigen::Vector3d& force);
    /// A correction with gain columns for the components of a measurement, all in the filter's own errors.
    void correct(const Measurement& m, const Gains& gains);
    /// What these errors add to the covariance of the innovation of a measurement (own errors): dof x dof used, the rest zero.
    [[nodiscard]] Eigen::Matrix3d of_second_order(const Measurement& m) const;

    /// Passes its parts to `a(...)`, to be written or read.
    template <class Archive>
    void archive(Archive& a) {
        a(errors_);
    }

private:
    using Columns = Gains;
    Columns errors_;
};

}  // namespace schuler::filter
