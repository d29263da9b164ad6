#include "schuler/estim/classical.h"

#include "schuler/core/error.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

namespace schuler::estim {

namespace {

/// Whitened by R = L L^T: L^-1 A, L^-1 y.
void whiten(Eigen::MatrixXd& A, Eigen::VectorXd& y, const Eigen::MatrixXd& R) {
    const Eigen::LLT<Eigen::MatrixXd> factor(R);
    if (R.rows() != A.rows() || factor.info() != Eigen::Success)
        throw input_error("the noise covariance is not positive definite", {}, "give one row and column a measurement");
    A = factor.matrixL().solve(A);
    y = factor.matrixL().solve(y);
}

/// x with the smallest |A x - y| and (A^T A)^-1, by orthogonal factorisation: normal equations would square the condition number.
Estimate solved(const Eigen::MatrixXd& A, const Eigen::VectorXd& y) {
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(A);
    if (A.rows() != y.size() || qr.rank() < A.cols())
        throw input_error("the measurements do not determine every unknown", {}, "add measurements, or estimate fewer unknowns");
    const Eigen::Index n = A.cols();
    const Eigen::MatrixXd inverse =
        qr.matrixR().topLeftCorner(n, n).triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(n, n));
    const Eigen::MatrixXd root = qr.colsPermutation() * inverse;
    return {qr.solve(y), root * root.transpose()};
}

}  // namespace

Estimate least_squares(const Eigen::MatrixXd& A, const Eigen::VectorXd& y) {
    Estimate e = solved(A, y);
    const auto spare = static_cast<double>(A.rows() - A.cols());
    e.P *= spare > 0.0 ? (y - A * e.x).squaredNorm() / spare : 0.0;
    return e;
}

Estimate maximum_likelihood(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, const Eigen::MatrixXd& R) {
    Eigen::MatrixXd white_A = A;
    Eigen::VectorXd white_y = y;
    whiten(white_A, white_y, R);
    return solved(white_A, white_y);
}

Estimate maximum_a_posteriori(const Eigen::MatrixXd& A, const Eigen::VectorXd& y, const Eigen::MatrixXd& R,
                              const Estimate& prior) {
    const Eigen::Index m = A.rows(), n = A.cols();
    Eigen::MatrixXd all_A(m + n, n), all_R = Eigen::MatrixXd::Zero(m + n, m + n);
    Eigen::VectorXd all_y(m + n);
    all_A << A, Eigen::MatrixXd::Identity(n, n);
    all_y << y, prior.x;
    all_R.topLeftCorner(m, m) = R;
    all_R.bottomRightCorner(n, n) = prior.P;
    return maximum_likelihood(all_A, all_y, all_R);
}

double ScalarKalman::update(double y) {
    const double k = P / (P + r);
    x += k * (y - x);
    P = (1.0 - k) * (1.0 - k) * P + k * k * r;
    return k;
}

}  // namespace schuler::estim
