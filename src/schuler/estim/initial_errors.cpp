#include "schuler/estim/initial_errors.h"

namespace schuler::estim {

InitialErrors::InitialErrors(const StateMatrix& start, std::size_t groups)
    : start_(start.cast<double>()),
      current_(start_),
      gained_(groups, Eigen::MatrixXd::Zero(start.rows(), start.cols())),
      seen_(start.cols()) {}

void InitialErrors::step(const Transition& phi) {
    for (Eigen::Index j = 0; j < current_.cols(); ++j) current_.col(j) = phi.times(current_.col(j));
}

void InitialErrors::scalar(const RowUpdate& u, std::size_t group) {
    for (Eigen::Index j = 0; j < current_.cols(); ++j) seen_(j) = u.h.dot(current_.col(j));
    current_.noalias() -= u.k * seen_.transpose();
    gained_[group].noalias() += seen_ * seen_.transpose() / u.s;
}

Eigen::MatrixXd InitialErrors::covariance() const {
    Eigen::MatrixXd left = start_;
    for (const Eigen::MatrixXd& g : gained_) left -= g;
    return left;
}

}  // namespace schuler::estim
