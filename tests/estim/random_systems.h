// Random vectors and covariances of sixteen states, and matrices of higher precision to judge by.
#pragma once

#include "schuler/estim/transition.h"
#include "schuler/estim/update.h"

#include <Eigen/Cholesky>

#include <random>

namespace schuler::estim::testing {

constexpr int N = 16;
using Vector = StateVector;
using Matrix = StateMatrix;
using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

class Numbers {
public:
    explicit Numbers(std::uint64_t seed) : generator_(seed) {}
    double normal() { return normal_(generator_); }
    double uniform(double a, double b) { return a + (b - a) * std::generate_canonical<double, 53>(generator_); }
    Vector vector() {
        Vector v(N);
        for (int i = 0; i < N; ++i) v(i) = normal();
        return v;
    }
    /// Symmetric and positive definite with the given sigmas and random correlations.
    Matrix covariance(const Vector& sigma) {
        Matrix root(N, N);
        for (int i = 0; i < N; ++i) root.col(i) = vector();
        Matrix C = root * root.transpose() + Matrix::Identity(N, N);
        const Vector scale = sigma.cwiseQuotient(C.diagonal().cwiseSqrt());
        C = (scale.asDiagonal() * C * scale.asDiagonal()).eval();
        return 0.5 * (C + C.transpose());
    }

private:
    std::mt19937_64 generator_;
    std::normal_distribution<double> normal_;
};

inline LongMatrix inverse(const LongMatrix& A) { return A.llt().solve(LongMatrix::Identity(A.rows(), A.cols())); }

/// A row with every entry of h.
inline Row row_of(const Vector& h) {
    Row row;
    row.head = h.head<9>();
    for (int i = 9; i < N; ++i) row.add(i, h(i));
    return row;
}

}  // namespace schuler::estim::testing
