#include "schuler/filter/integrity/second_order.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d second_order_acceleration(const Matrix3d& S, const Vector3d& f) {
    const double s = S.trace();
    const Vector3d Sf = S * f, odd = s * Sf + 2.0 * (S * Sf);
    return 0.25 * (f.dot(Sf) * S + 2.0 * Sf * Sf.transpose() - odd * f.transpose() - f * odd.transpose() +
                   (s * s + 2.0 * S.squaredNorm()) * f * f.transpose());
}

template <class Frame>
double tilt_sigma(const InertialModel& model, const InertialFilter<Frame>& filter) {
    const Matrix9 P = filter.local_covariance(model);
    const Eigen::Matrix2d tilt = P.template block<2, 2>(Layout::attitude, Layout::attitude);
    return std::sqrt(tilt.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
}

void SecondOrder::propagate(const estim::Transition& phi, double span, const Matrix3d& S, const Vector3d& force) {
    if (!follows()) return;
    for (int k = 0; k < 3; ++k) errors_.col(k) = phi.times(errors_.col(k));
    const Eigen::SelfAdjointEigenSolver<Matrix3d> axes(second_order_acceleration(S, force));
    const Vector3d sigma = axes.eigenvalues().cwiseMax(0.0).cwiseSqrt();
    const Matrix3d root = axes.eigenvectors() * sigma.asDiagonal() * axes.eigenvectors().transpose();
    errors_.middleRows<3>(Layout::position) += 0.5 * span * span * root;
    errors_.middleRows<3>(Layout::velocity) += span * root;
}

void SecondOrder::correct(const Measurement& m, const Gains& gains) {
    if (!follows()) return;
    for (int i = 0; i < m.dof; ++i)
        for (int k = 0; k < 3; ++k) {
            const double seen = m.rows[static_cast<std::size_t>(i)].dot(errors_.col(k));
            errors_.col(k) -= seen * gains.col(i);
        }
}

Matrix3d SecondOrder::of_second_order(const Measurement& m) const {
    Matrix3d seen = Matrix3d::Zero();  // a row for each component
    if (!follows()) return seen;
    for (int i = 0; i < m.dof; ++i)
        for (int k = 0; k < 3; ++k) seen(i, k) = m.rows[static_cast<std::size_t>(i)].dot(errors_.col(k));
    return seen * seen.transpose();
}

template double tilt_sigma(const InertialModel&, const InertialFilter<GeographicFrame>&);
template double tilt_sigma(const InertialModel&, const InertialFilter<EarthFixedFrame>&);

}  // namespace schuler::filter
