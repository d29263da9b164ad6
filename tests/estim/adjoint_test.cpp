// The adjoint smoother against Rauch-Tung-Striebel.
#include "random_systems.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

namespace schuler::estim {
namespace {

using namespace testing;

/// A random linear system: two of the sixteen states are unused (no variance, no noise), as padding in the filters is.
struct System {
    static constexpr int used = 14;
    static constexpr int steps = 40;
    struct Scalar {
        Vector h;
        double z, r;
    };
    struct Step {
        Transition phi;
        Vector q;
        std::vector<Scalar> scalars;  ///< measured after the step
    };
    Vector mean;
    Matrix P = Matrix::Zero(N, N);
    std::vector<Step> step;

    explicit System(std::uint64_t seed) {
        Numbers numbers(seed);
        mean = numbers.vector();
        mean.tail(N - used).setZero();
        P.topLeftCorner<used, used>() = numbers.covariance(Vector::Constant(N, 2.0)).topLeftCorner<used, used>();
        Vector truth = mean;
        truth.head<used>() += 2.0 * numbers.vector().head<used>();
        for (int k = 0; k < steps; ++k) {
            Step s;
            s.phi.driven = N;
            s.phi.diagonal = Vector::Ones(N);
            s.q = Vector::Zero(N);
            for (int row = 0; row < 9; ++row) {
                for (int column = 0; column < used; ++column) s.phi.rows(column, row) = 0.15 * numbers.normal();
                s.phi.rows(row, row) += 0.9;
            }
            for (int i = 9; i < used; ++i) s.phi.diagonal(i) = numbers.uniform(0.8, 1.0);
            for (int i = 0; i < used; ++i) s.q(i) = i % 4 == 3 ? 0.0 : numbers.uniform(0.001, 0.05);
            truth = s.phi.times(truth) + s.q.cwiseSqrt().cwiseProduct(numbers.vector());
            for (int m = 0; m < k % 4; ++m) {
                Scalar scalar;
                scalar.h = numbers.vector();
                if (k % 3 == 0) scalar.h.tail(10).setZero();
                scalar.r = numbers.uniform(0.01, 1.0);
                scalar.z = scalar.h.head<used>().dot(truth.head<used>()) + std::sqrt(scalar.r) * numbers.normal();
                s.scalars.push_back(scalar);
            }
            step.push_back(s);
        }
    }
};

struct Estimate {
    LongVector mean;
    LongMatrix P;
};

/// Textbook: batch updates by the inverse of S, then Rauch, Tung and Striebel (1965), dense, extended precision, used states.
std::vector<Estimate> rauch_tung_striebel(const System& system) {
    constexpr int n = System::used;
    LongVector x = system.mean.head<n>().cast<long double>();
    LongMatrix P = system.P.topLeftCorner<n, n>().cast<long double>();
    std::vector<Estimate> filtered{{x, P}}, predicted{{x, P}};
    std::vector<LongMatrix> phis{LongMatrix()};
    for (const System::Step& s : system.step) {
        LongMatrix phi = LongMatrix::Zero(n, n);
        phi.topRows(9) = s.phi.rows.transpose().leftCols(n).cast<long double>();
        for (int i = 9; i < n; ++i) phi(i, i) = static_cast<long double>(s.phi.diagonal(i));
        x = (phi * x).eval();
        P = (phi * P * phi.transpose()).eval();
        P.diagonal() += s.q.head<n>().cast<long double>();
        predicted.push_back({x, P});
        phis.push_back(phi);
        const auto m = static_cast<Eigen::Index>(s.scalars.size());
        if (m > 0) {
            LongMatrix H(m, n), R = LongMatrix::Zero(m, m);
            LongVector z(m);
            for (Eigen::Index i = 0; i < m; ++i) {
                const System::Scalar& scalar = s.scalars[static_cast<std::size_t>(i)];
                H.row(i) = scalar.h.head<n>().cast<long double>().transpose();
                R(i, i) = static_cast<long double>(scalar.r);
                z(i) = static_cast<long double>(scalar.z);
            }
            const LongMatrix S = H * P * H.transpose() + R;
            const LongMatrix K = P * H.transpose() * inverse(S);
            x = (x + K * (z - H * x)).eval();
            P = (P - K * S * K.transpose()).eval();
        }
        filtered.push_back({x, P});
    }
    std::vector<Estimate> smoothed = filtered;
    for (std::size_t k = smoothed.size() - 1; k-- > 0;) {
        const LongMatrix G = filtered[k].P * phis[k + 1].transpose() * inverse(predicted[k + 1].P);
        smoothed[k].mean = filtered[k].mean + G * (smoothed[k + 1].mean - predicted[k + 1].mean);
        smoothed[k].P = filtered[k].P + G * (smoothed[k + 1].P - predicted[k + 1].P) * G.transpose();
    }
    return smoothed;
}

TEST(Adjoint, EqualsRauchTungStriebel) {
    for (const std::uint64_t seed : {21u, 22u, 23u}) {
        const System system(seed);
        const std::vector<Estimate> expected = rauch_tung_striebel(system);

        // Forward in closed loop: the mean is corrected by minus the estimated error, as the navigation filter does.
        Vector mean = system.mean;
        Matrix P = system.P;
        std::vector<Vector> means{mean};
        std::vector<Matrix> covariances{P};
        std::vector<std::vector<RowUpdate>> updates{{}};
        for (const System::Step& s : system.step) {
            mean = s.phi.times(mean);
            propagate(P, s.phi, N);
            P.diagonal() += s.q;
            Vector dx = Vector::Zero(N);
            std::vector<RowUpdate> done;
            for (const System::Scalar& scalar : s.scalars)
                done.push_back(update(dx, P, row_of(scalar.h), scalar.h.dot(mean) - scalar.z, scalar.r, N));
            mean -= dx;
            means.push_back(mean);
            covariances.push_back(P);
            updates.push_back(done);
        }

        StateAdjoint adjoint(N);
        for (std::size_t k = means.size(); k-- > 0;) {
            const Vector smoothed = means[k] + covariances[k] * adjoint.lambda;
            const Matrix cov = covariances[k] - covariances[k] * adjoint.Lambda * covariances[k];
            const Estimate& e = expected[k];
            for (int i = 0; i < System::used; ++i) {
                const long double si = std::sqrt(e.P(i, i));
                ASSERT_LT(std::abs(static_cast<long double>(smoothed(i)) - e.mean(i)), 1e-9L * (si + std::abs(e.mean(i))))
                    << "seed " << seed << ", step " << k << ", state " << i;
                for (int j = 0; j < System::used; ++j)
                    ASSERT_LT(std::abs(static_cast<long double>(cov(i, j)) - e.P(i, j)), 1e-9L * si * std::sqrt(e.P(j, j)))
                        << "seed " << seed << ", step " << k << ", entry (" << i << ", " << j << ")";
            }
            EXPECT_EQ(Vector(smoothed.tail(N - System::used)), Vector(system.mean.tail(N - System::used)));
            EXPECT_LT((adjoint.Lambda - adjoint.Lambda.transpose()).norm(), 1e-11 * (1.0 + adjoint.Lambda.norm()));
            if (k == 0) break;
            for (std::size_t m = updates[k].size(); m-- > 0;) adjoint.undo(updates[k][m], N);
            adjoint.lambda = system.step[k - 1].phi.transpose_times(adjoint.lambda);
            propagate_adjoint(adjoint.Lambda, system.step[k - 1].phi, N);
        }
    }
}

/// Three states that become combinations of the others: P and its adjoint as by the whole matrix of that map.
TEST(Clone, IsTheLinearMapAndItsAdjoint) {
    Numbers numbers(7);
    constexpr int first = 10;
    std::array<Row, 3> rows;
    Matrix map = Matrix::Identity(N, N);
    for (int k = 0; k < 3; ++k) {
        Vector row = numbers.vector();
        row.segment<3>(first).setZero();
        rows[static_cast<std::size_t>(k)] = row_of(row);
        map.row(first + k) = row.transpose();
    }
    const Matrix before = numbers.covariance(Vector::Constant(N, 2.0));
    Matrix P = before;
    clone(P, rows, first, N);
    const Matrix expected = map * before * map.transpose();
    EXPECT_LT((P - expected).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_TRUE(P == P.transpose());

    StateAdjoint adjoint(N);
    adjoint.lambda = numbers.vector();
    adjoint.Lambda = numbers.covariance(Vector::Constant(N, 0.5));
    const Vector lambda = map.transpose() * adjoint.lambda;
    const Matrix Lambda = map.transpose() * adjoint.Lambda * map;
    adjoint.undo_clone(rows, first);
    EXPECT_LT((adjoint.lambda - lambda).norm(), 1e-12);
    EXPECT_LT((adjoint.Lambda - Lambda).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace schuler::estim
