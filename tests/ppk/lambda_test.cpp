// Integer least squares against exhaustive search, and what its success rate promises against draws.
#include "schuler/ppk/lambda.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace schuler::ppk {
namespace {

/// Ambiguities of a short observation span: three unknowns of position known by ranges only, phases a hundred times better. Correlated as
/// those of real double differences are.
Eigen::MatrixXd covariance_of(Eigen::Index n, math::Random& random, double code, double phase) {
    Eigen::MatrixXd geometry(n, 3);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index k = 0; k < 3; ++k) geometry(i, k) = random.normal();
    const Eigen::Matrix3d position = code * code * (geometry.transpose() * geometry).inverse();
    constexpr double wavelength = 0.19;
    const Eigen::MatrixXd shared =
        Eigen::MatrixXd::Identity(n, n) + Eigen::MatrixXd::Ones(n, n);  // the reference satellite's part
    return (geometry * position * geometry.transpose() + phase * phase * shared) / (wavelength * wavelength);
}

double distance(const Eigen::VectorXd& apart, const Eigen::MatrixXd& covariance) {
    return apart.dot(covariance.ldlt().solve(apart));
}

/// All integers within `reach` cycles of the real values.
std::vector<IntegerCandidate> exhaustive(const Eigen::VectorXd& a, const Eigen::MatrixXd& covariance, int reach) {
    const Eigen::Index n = a.size();
    std::vector<IntegerCandidate> all;
    Eigen::VectorXd z(n);
    const Eigen::MatrixXd inverse = covariance.inverse();
    const int width = 2 * reach + 1;
    const auto total = static_cast<long>(std::pow(width, n) + 0.5);
    for (long code = 0; code < total; ++code) {
        long rest = code;
        for (Eigen::Index i = 0; i < n; ++i, rest /= width) z[i] = std::round(a[i]) + static_cast<double>(rest % width - reach);
        all.push_back({z, (a - z).dot(inverse * (a - z))});
    }
    std::ranges::partial_sort(all, all.begin() + 3, {}, &IntegerCandidate::distance);
    all.resize(3);
    return all;
}

TEST(Lambda, DecorrelationIsAnIntegerTransformationOfTheCovariance) {
    math::Random random(1, "ambiguities");
    for (Eigen::Index n = 5; n <= 29; n += 4) {
        const Eigen::MatrixXd q = covariance_of(n, random, 0.5, 0.003);
        const auto found = decorrelate(q);
        ASSERT_TRUE(found);
        EXPECT_EQ((found->Z.array() - found->Z.array().round()).abs().maxCoeff(), 0.0);
        EXPECT_NEAR(std::abs(found->Z.determinant()), 1.0, 1e-6);
        const Eigen::MatrixXd rebuilt = found->L.transpose() * found->d.asDiagonal() * found->L,
                              transformed = found->Z.transpose() * q * found->Z;
        EXPECT_LT((rebuilt - transformed).norm(), 1e-6 * transformed.norm()) << n;
        // decorrelated: no variance above what its neighbour could have by exchange, and all far below the ambiguities' own
        EXPECT_LT(found->d.maxCoeff(), 0.2 * q.diagonal().minCoeff()) << n;
        for (Eigen::Index i = 1; i < n; ++i) EXPECT_LE(found->L.row(i).head(i).cwiseAbs().maxCoeff(), 0.5 + 1e-9);
        const Eigen::VectorXd a = Eigen::VectorXd::LinSpaced(n, -7.0, 12.0).array().round();
        EXPECT_LT((found->back(found->Z.transpose() * a) - a).norm(), 1e-6);
    }
    EXPECT_FALSE(decorrelate(-Eigen::Matrix2d::Identity()));
    EXPECT_FALSE(decorrelate(Eigen::Matrix2d::Ones()));
}

TEST(Lambda, NearestIntegersAreThoseOfExhaustiveSearch) {
    math::Random random(2, "ambiguities");
    int differs_from_rounding = 0;
    for (int trial = 0; trial < 60; ++trial) {
        const Eigen::Index n = 3 + trial % 4;
        // reach of the exhaustive search covers three sigma of every ambiguity
        const Eigen::MatrixXd q = covariance_of(n, random, 0.12, 0.02);
        const Eigen::MatrixXd root = q.llt().matrixL();
        Eigen::VectorXd noise(n);
        for (Eigen::Index i = 0; i < n; ++i) noise[i] = random.normal();
        const Eigen::VectorXd a = Eigen::VectorXd::Constant(n, 1000.0) + root * noise;
        const auto decorrelated = decorrelate(q);
        ASSERT_TRUE(decorrelated);
        const auto found = nearest_integers(*decorrelated, decorrelated->Z.transpose() * a, n, 3);
        ASSERT_EQ(found.size(), 3U);
        const auto expected = exhaustive(a, q, n < 6 ? 4 : 3);
        for (std::size_t i = 0; i < 3; ++i) {
            const Eigen::VectorXd integers = decorrelated->back(found[i].z).array().round();
            EXPECT_NEAR(found[i].distance, distance(a - integers, q), 1e-6 * (1.0 + found[i].distance));
            EXPECT_LE(found[i].distance, expected[i].distance * (1.0 + 1e-9)) << "trial " << trial << ", place " << i;
        }
        if (found[0].distance > expected[0].distance * (1.0 - 1e-9)) {
            EXPECT_EQ((decorrelated->back(found[0].z).array().round().matrix() - expected[0].z).norm(), 0.0);
        }
        differs_from_rounding += (expected[0].z - a.array().round().matrix()).norm() > 0.0 ? 1 : 0;
    }
    EXPECT_GT(differs_from_rounding, 10);  // otherwise rounding alone would pass
}

TEST(Lambda, TheLastOfThemAreSolvedAsAProblemOfTheirOwn) {
    math::Random random(3, "ambiguities");
    const Eigen::MatrixXd q = covariance_of(8, random, 0.6, 0.01);
    const auto all = decorrelate(q);
    ASSERT_TRUE(all);
    const Eigen::VectorXd z = all->Z.transpose() * Eigen::VectorXd::LinSpaced(8, 3.1, 40.7);
    const Eigen::MatrixXd of_z = all->L.transpose() * all->d.asDiagonal() * all->L;
    const auto found = nearest_integers(*all, z, 3, 2);
    ASSERT_EQ(found.size(), 2U);
    const auto expected = exhaustive(z.tail(3), of_z.bottomRightCorner(3, 3), 4);
    EXPECT_EQ((found[0].z - expected[0].z).norm(), 0.0);
    EXPECT_NEAR(found[1].distance, expected[1].distance, 1e-9 * expected[1].distance);
}

TEST(Lambda, SuccessRateIsThatOfDraws) {
    math::Random random(4, "ambiguities");
    const Eigen::Index n = 6;
    const Eigen::MatrixXd q = covariance_of(n, random, 0.3, 0.012);
    const auto found = decorrelate(q);
    ASSERT_TRUE(found);
    const double promised = success_rate(*found, n);
    ASSERT_GT(promised, 0.3);
    ASSERT_LT(promised, 0.98);
    const Eigen::MatrixXd root = q.llt().matrixL();
    int right = 0;
    constexpr int draws = 4000;
    for (int k = 0; k < draws; ++k) {
        Eigen::VectorXd noise(n);
        for (Eigen::Index i = 0; i < n; ++i) noise[i] = random.normal();
        const auto best = nearest_integers(*found, found->Z.transpose() * (root * noise), n, 1);
        right += best.front().z.isZero() ? 1 : 0;
    }
    // a lower bound, tight after decorrelation
    const double rate = static_cast<double>(right) / draws, sigma = std::sqrt(promised * (1.0 - promised) / draws);
    EXPECT_GT(rate, promised - 4.0 * sigma);
    EXPECT_LT(rate, promised + 0.05);
    for (const double least : {0.999, 0.9, 0.5}) {
        const Eigen::Index count = count_with_success(*found, least);
        EXPECT_GE(success_rate(*found, count), least);
        if (count < n) {
            EXPECT_LT(success_rate(*found, count + 1), least);
        }
    }
}

}  // namespace
}  // namespace schuler::ppk
