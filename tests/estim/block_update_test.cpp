// Many rows at once with correlated noise, against the information form.
#include "schuler/estim/block_update.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

namespace schuler::estim {
namespace {

Eigen::MatrixXd random_matrix(math::Random& random, Eigen::Index rows, Eigen::Index columns) {
    Eigen::MatrixXd m(rows, columns);
    for (Eigen::Index i = 0; i < rows; ++i)
        for (Eigen::Index j = 0; j < columns; ++j) m(i, j) = random.normal();
    return m;
}

TEST(BlockUpdate, IsTheUpdateInInformationForm) {
    math::Random random(1, "block");
    const Eigen::MatrixXd a = random_matrix(random, 7, 7), b = random_matrix(random, 4, 4), H = random_matrix(random, 4, 7);
    const Eigen::MatrixXd P = a * a.transpose(), R = b * b.transpose() + Eigen::MatrixXd::Identity(4, 4);
    const Eigen::VectorXd z = random_matrix(random, 4, 1);
    const BlockUpdate update(P, H, z, R);
    ASSERT_TRUE(update.valid());
    Eigen::MatrixXd after = P;
    update.apply(after);
    const Eigen::MatrixXd expected = (P.inverse() + H.transpose() * R.inverse() * H).inverse();
    EXPECT_LT((after - expected).norm(), 1e-8 * P.norm());
    EXPECT_LT((update.error() - expected * H.transpose() * R.inverse() * z).norm(), 1e-8 * P.norm());
    EXPECT_EQ((after - after.transpose()).norm(), 0.0);
    const Eigen::MatrixXd S = H * P * H.transpose() + R;
    EXPECT_NEAR(update.statistic(), z.dot(S.inverse() * z), 1e-9);
    // a bias of one row is as large as its share of the innovation's inverse covariance says
    const Eigen::VectorXd c = Eigen::VectorXd::Unit(4, 2);
    EXPECT_NEAR(update.standardised(c), (S.inverse() * z)[2] / std::sqrt(S.inverse()(2, 2)), 1e-9);
    EXPECT_FALSE(BlockUpdate(-P, H, z, -R).valid());
}

}  // namespace
}  // namespace schuler::estim
