#include "schuler/theory/decomposition.h"

#include "schuler/core/error.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace schuler::theory {

Decomposition decomposed(const Eigen::MatrixXd& F, const Eigen::VectorXd& x, const Eigen::VectorXd& d) {
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(F);
    const Eigen::MatrixXcd V = solver.eigenvectors();
    const Eigen::FullPivLU<Eigen::MatrixXcd> lu(V);
    Decomposition out{solver.eigenvalues(), V, V, -F.fullPivLu().solve(d)};
    if (!lu.isInvertible()) throw computation_error("the modes are not distinct", "change the loop's time constant slightly");
    const Eigen::VectorXcd share = lu.solve((x - out.constant).cast<std::complex<double>>());
    for (Eigen::Index i = 0; i < share.size(); ++i) out.part.col(i) *= share(i);
    return out;
}

}  // namespace schuler::theory
