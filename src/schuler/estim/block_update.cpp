#include "schuler/estim/block_update.h"

#include <cmath>

namespace schuler::estim {

BlockUpdate::BlockUpdate(const Eigen::MatrixXd& P, const Eigen::MatrixXd& H, const Eigen::VectorXd& z, const Eigen::MatrixXd& R) {
    gain_root_.noalias() = H * P;
    Eigen::MatrixXd S = R;
    S.noalias() += gain_root_ * H.transpose();
    root_.compute(S);
    valid_ = root_.info() == Eigen::Success;
    if (!valid_) return;
    root_.matrixL().solveInPlace(gain_root_);
    whitened_ = root_.matrixL().solve(z);
    valid_ = whitened_.allFinite();
}

double BlockUpdate::standardised(const Eigen::VectorXd& c) const {
    const Eigen::VectorXd white = root_.matrixL().solve(c);
    return white.dot(whitened_) / white.norm();
}

void BlockUpdate::apply(Eigen::MatrixXd& P) const {
    P.selfadjointView<Eigen::Lower>().rankUpdate(gain_root_.transpose(), -1.0);
    P.triangularView<Eigen::StrictlyUpper>() = P.transpose();
}

}  // namespace schuler::estim
