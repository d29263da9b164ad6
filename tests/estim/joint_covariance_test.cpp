// The covariance of one source of errors, its steps and corrections gathered, against the dense products one by one.
#include "schuler/estim/joint_covariance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace schuler::estim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct CorrelatedSystem {
    std::mt19937_64 generator{11};
    std::normal_distribution<double> normal;
    int n = 20, m = 5;

    MatrixXd random(Eigen::Index rows, Eigen::Index columns, double scale) {
        MatrixXd x(rows, columns);
        for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = scale * normal(generator);
        return x;
    }
    Transition transition(int shears) {
        Transition phi;
        phi.driven = 16;
        phi.rows.topLeftCorner(16, 9) = random(16, 9, 0.1);
        phi.rows.topLeftCorner(9, 9) += MatrixXd::Identity(9, 9);
        phi.diagonal = StateVector::Constant(n, 0.9);
        phi.diagonal.head<9>().setConstant(1e30);  // no part of it
        for (int i = 0; i < shears; ++i) phi.shears[static_cast<std::size_t>(i)] = {17 + i, 18 + i, 0.3};
        phi.shear_count = shears;
        return phi;
    }
    [[nodiscard]] MatrixXd dense(const Transition& phi, const JointCovariance::Drive& drive, const VectorXd& decay) const {
        MatrixXd all = MatrixXd::Zero(n + m, n + m);
        for (Eigen::Index i = 0; i < n; ++i) {
            StateVector unit = StateVector::Zero(n);
            unit(i) = 1.0;
            all.col(i).head(n) = phi.times(unit);
        }
        if (drive.cols() > 0) all.topRightCorner(9, m) = drive;
        all.diagonal().tail(m) = decay;
        return all;
    }
};

/// Some steps, corrections, steps and corrections, by both; `drives`, `noises`: the source has such effects.
void expect_dense_result(bool drives, bool noises, int shears) {
    CorrelatedSystem s;
    const MatrixXd root = s.random(9, 9, 1.0);
    const JointCovariance::Matrix9 start = root * root.transpose();
    const VectorXd variance = s.random(s.m, 1, 1.0).cwiseAbs2();
    JointCovariance joint(s.n, start, variance);
    GatheredTransition gathered(s.n);
    MatrixXd S = MatrixXd::Zero(s.n + s.m, s.n + s.m);
    S.topLeftCorner<9, 9>() = start;
    S.diagonal().tail(s.m) = variance;
    for (int epoch = 0; epoch < 4; ++epoch) {
        for (int step = 0; step < 3; ++step) {
            const Transition phi = s.transition(shears);
            JointCovariance::Drive drive(9, 0);
            if (drives) drive = s.random(9, s.m, 0.2);
            const VectorXd decay = s.random(s.m, 1, 0.05).array() + 0.9;
            const VectorXd noise = noises ? VectorXd(s.random(s.m, 1, 0.1).cwiseAbs2()) : VectorXd(VectorXd::Zero(s.m));
            const MatrixXd half = s.random(9, 2, 0.1);
            const JointCovariance::Matrix9 white = half * half.transpose();
            const MatrixXd all = s.dense(phi, drive, decay);
            S = all * S * all.transpose();
            S.diagonal().tail(s.m) += noise;
            if (noises) S.topLeftCorner<9, 9>() += white;
            if (shears > 0) {
                joint.step_with_shears(phi, drive, decay, noise, noises ? &white : nullptr);
            } else {
                gathered.add(phi);
                joint.step(phi, drive, decay, noise, noises ? &white : nullptr);
            }
        }
        joint.settle(gathered);
        gathered.reset();
        for (int scalar = 0; scalar < 19; ++scalar) {  // more than are kept at once
            Row h;
            h.head = s.random(9, 1, 0.2);
            h.add(9 + scalar % 11, 0.7);
            const StateVector k = s.random(s.n, 1, 0.1);
            const int process = scalar % 3 == 0 ? scalar % s.m : -1;
            const double seen = -0.5, r = 0.3;
            joint.correct(h, k, process, seen, r);
            VectorXd row = VectorXd::Zero(s.n + s.m), gain = row;
            row.head(s.n) = h.whole(s.n);
            if (process >= 0) row(s.n + process) = seen;
            gain.head(s.n) = k;
            const MatrixXd kept = MatrixXd::Identity(s.n + s.m, s.n + s.m) - gain * row.transpose();
            S = (kept * S * kept.transpose() + r * gain * gain.transpose()).eval();
        }
        const VectorXd expected = S.diagonal().head<9>(), actual = joint.variances();
        for (Eigen::Index i = 0; i < 9; ++i)
            EXPECT_NEAR(actual(i), expected(i), 1e-11 * expected.maxCoeff()) << epoch << " " << i;
    }
}

TEST(JointCovariance, IsThatOfTheDenseProducts) {
    for (const bool drives : {false, true})
        for (const bool noises : {false, true}) {
            SCOPED_TRACE(::testing::Message() << drives << noises);
            expect_dense_result(drives, noises, 0);
        }
}

/// Half an hour of a filter that observes position and velocity: one large initial error, which it reduces a thousandfold. Rounding must not be
/// what is left: the reference has 64 bits of mantissa.
TEST(JointCovariance, StaysExactOverHalfAnHour) {
    using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
    constexpr int n = 16;
    JointCovariance::Matrix9 start = JointCovariance::Matrix9::Zero();
    start(8, 8) = 3e-6;  // heading
    JointCovariance joint(n, start, VectorXd(0));
    LongMatrix S = LongMatrix::Zero(n, n);
    S.topLeftCorner<9, 9>() = start.cast<long double>();
    StateMatrix P = StateMatrix::Zero(n, n);
    P.diagonal() << StateVector::Constant(3, 100.0), StateVector::Constant(3, 0.01), StateVector::Constant(2, 1e-6), 3e-6,
        StateVector::Constant(6, 1e-8), 0.0;
    for (int second = 0; second < 1800; ++second) {
        Transition phi;
        phi.driven = 16;
        phi.rows.topLeftCorner(9, 9).setIdentity();
        const double turn = 0.02 * second, north = 3.0 * std::cos(turn), east = 3.0 * std::sin(turn);
        for (int i = 0; i < 3; ++i) phi.rows(3 + i, i) = 1.0;
        phi.rows(8, 3) = east;  // velocity by heading and level
        phi.rows(8, 4) = -north;
        phi.rows(6, 4) = phi.rows(9, 6) = phi.rows(10, 7) = phi.rows(11, 8) = 9.8;
        phi.rows(7, 3) = -9.8;
        for (int i = 9; i < 12; ++i) phi.rows(i, i - 3) = 1.0;
        for (int i = 12; i < 15; ++i) phi.rows(i, i - 9) = 1.0;
        phi.diagonal = StateVector::Ones(n);
        propagate(P, phi, n);
        P.diagonal().segment<3>(3).array() += 1e-6;
        P.diagonal().segment<3>(6).array() += 1e-12;
        GatheredTransition once(n);
        once.add(phi);
        joint.step(phi, JointCovariance::Drive(9, 0), VectorXd(0), VectorXd(0), nullptr);
        joint.settle(once);
        LongMatrix F = LongMatrix::Identity(n, n);
        F.topRows(9) = phi.rows.topRows(n).transpose().cast<long double>();
        S = (F * S * F.transpose()).eval();
        for (int axis = 0; axis < 6; ++axis) {
            Row h;
            h.head(axis) = 1.0;
            StateVector dx = StateVector::Zero(n);
            const RowUpdate u = update(dx, P, h, 0.0, axis < 3 ? 4.0 : 1e-3, n);
            joint.correct(h, u.k, -1, 0.0, 0.0);
            LongMatrix kept = LongMatrix::Identity(n, n);
            kept.col(axis) -= u.k.cast<long double>();
            S = (kept * S * kept.transpose()).eval();
        }
        if (second % 600 != 599) continue;
        const auto actual = joint.variances();
        for (Eigen::Index i = 0; i < 9; ++i)
            EXPECT_NEAR(actual(i), static_cast<double>(S(i, i)), 1e-6 * static_cast<double>(S(i, i))) << second << " " << i;
    }
}

TEST(JointCovariance, WithShearsToo) { expect_dense_result(true, true, 2); }

}  // namespace
}  // namespace schuler::estim
