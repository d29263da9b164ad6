// Initial errors given the measurements, against the batch solution of the whole: covariance of all states of all times at once.
#include "schuler/estim/initial_errors.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <random>
#include <vector>

namespace schuler::estim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A filter of twelve states with noise, and beside it the joint covariance of the initial errors and the current ones.
struct Watched {
    static constexpr int n = 12;
    std::mt19937_64 generator{5};
    std::normal_distribution<double> normal;
    StateMatrix P = StateMatrix::Identity(n, n);
    MatrixXd joint;  ///< initial, current
    InitialErrors initial;

    Watched() : initial((P.diagonal() << random(n, 1).cwiseAbs().array() + 0.1).finished().asDiagonal(), 2) {
        P = initial.start();
        joint = MatrixXd::Zero(2 * n, 2 * n);
        joint << P, P, P, P;
    }
    MatrixXd random(Eigen::Index rows, Eigen::Index columns) {
        MatrixXd x(rows, columns);
        for (Eigen::Index i = 0; i < x.size(); ++i) x(i) = normal(generator);
        return x;
    }
    void step() {
        Transition phi;
        phi.driven = n;
        phi.rows.topLeftCorner(n, 9) = 0.1 * random(n, 9);
        phi.rows.topLeftCorner(9, 9) += MatrixXd::Identity(9, 9);
        phi.diagonal = StateVector::Constant(n, 0.95);
        phi.shears[0] = {9, 10, 0.2};
        phi.shear_count = 1;
        MatrixXd whole = MatrixXd::Identity(2 * n, 2 * n);
        for (int i = 0; i < n; ++i) whole.col(n + i).tail(n) = phi.times(StateVector::Unit(n, i));
        joint = whole * joint * whole.transpose();
        joint.diagonal().tail(n).array() += 0.01;
        P = joint.bottomRightCorner(n, n);
        initial.step(phi);
    }
    void measure(std::size_t group) {
        Row h;
        h.head = random(9, 1);
        h.add(10, normal(generator));
        constexpr double r = 0.3;
        StateVector dx = StateVector::Zero(n);
        const RowUpdate u = update(dx, P, h, 0.0, r, n);
        VectorXd whole = VectorXd::Zero(2 * n);
        whole.tail(n) = h.whole(n);
        const VectorXd Ph = joint * whole;
        joint -= Ph * Ph.transpose() / (whole.dot(Ph) + r);
        initial.scalar(u, group);
    }
};

TEST(InitialErrors, AreThoseOfTheJointCovariance) {
    Watched w;
    for (int i = 0; i < 20; ++i) {
        w.step();
        w.measure(i < 10 ? 0 : 1);
    }
    EXPECT_LT((w.initial.covariance() - w.joint.topLeftCorner(Watched::n, Watched::n)).norm(), 1e-10);
    EXPECT_LT(w.initial.covariance().trace(), 0.8 * w.initial.start().trace());
    const MatrixXd sum = w.initial.covariance() + w.initial.gained(0) + w.initial.gained(1);
    EXPECT_LT((sum - w.initial.start()).norm(), 1e-12);
    EXPECT_GT(w.initial.gained(1).trace(), 0.0);
}

TEST(InitialErrors, AreNotSeenInARenewedState) {
    Watched w;
    for (int i = 0; i < Watched::n; ++i) w.initial.renewed(i);
    w.measure(0);
    EXPECT_EQ(w.initial.gained(0).norm(), 0.0);
}

}  // namespace
}  // namespace schuler::estim
