// Dilution of precision of a geometry known in closed form, and protection levels against faults put in.
#include "schuler/gnss/epoch_view.h"
#include "schuler/math/chi_square.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::gnss {
namespace {

UsedRange in_direction(double azimuth, double elevation, double variance = 1.0) {
    return {
        -Eigen::Vector3d(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth), -std::sin(elevation)),
        0, variance};
}

TEST(EpochView, DilutionOfARegularTetrahedron) {
    // one satellite in the zenith, three in the directions of the other corners: sums of squares are known
    std::vector<UsedRange> ranges{in_direction(0.0, 1.5707963267948966)};
    const double below = std::asin(-1.0 / 3.0);
    for (int k = 0; k < 3; ++k) ranges.push_back(in_direction(2.0 * 3.141592653589793 * k / 3.0, below));
    const Dilution d = dilution_of(ranges);
    EXPECT_NEAR(d.position, 1.5, 1e-12);
    EXPECT_NEAR(d.time, 0.5, 1e-12);
    EXPECT_NEAR(d.geometry, std::sqrt(2.5), 1e-12);
    EXPECT_NEAR(d.horizontal, std::sqrt(1.5), 1e-12);
    EXPECT_NEAR(d.vertical, std::sqrt(0.75), 1e-12);
    EXPECT_FALSE(std::isfinite(protection_of(ranges, 1e-4, 1e-3).horizontal)) << "nothing is redundant";
    ranges.pop_back();
    EXPECT_FALSE(std::isfinite(dilution_of(ranges).position));
}

TEST(EpochView, AFaultThatJustPassesTheTestIsWithinTheProtectionLevel) {
    std::vector<UsedRange> ranges;
    for (int k = 0; k < 7; ++k) ranges.push_back(in_direction(0.9 * k, 0.25 + 0.17 * k, 0.5 + 0.4 * k));
    ranges[2].clock = ranges[5].clock = 2;  // of another system
    constexpr double false_alarm = 1e-4, missed = 0.05;
    const ProtectionLevels levels = protection_of(ranges, false_alarm, missed);
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(7, 5);
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(7, 7);
    for (int i = 0; i < 7; ++i) {
        G.row(i).head<3>() = ranges[static_cast<std::size_t>(i)].line_of_sight.transpose();
        G(i, i == 2 || i == 5 ? 4 : 3) = 1.0;
        W(i, i) = 1.0 / ranges[static_cast<std::size_t>(i)].variance;
    }
    const Eigen::MatrixXd covariance = (G.transpose() * W * G).inverse(), K = covariance * G.transpose() * W;
    const double threshold = math::chi_square_quantile(1.0 - false_alarm, 2.0);
    double horizontal = 0.0, vertical = 0.0;
    for (int i = 0; i < 7; ++i) {
        Eigen::VectorXd fault = Eigen::VectorXd::Unit(7, i);
        const Eigen::VectorXd rest = fault - G * (K * fault);
        fault *= std::sqrt(threshold / rest.dot(W * rest));  // the statistic of this fault alone is the threshold
        const Eigen::VectorXd error = K * fault;
        horizontal = std::max(horizontal, error.head<2>().norm());
        vertical = std::max(vertical, std::abs(error[2]));
    }
    constexpr double one_sided = 1.6448536269514722;  // normal, 5 %
    EXPECT_NEAR(levels.vertical, vertical + one_sided * std::sqrt(covariance(2, 2)), 1e-9);
    const Eigen::Matrix2d level = covariance.topLeftCorner<2, 2>();
    const double axis = std::sqrt(level.eigenvalues().real().maxCoeff());
    EXPECT_NEAR(levels.horizontal, horizontal + one_sided * axis, 1e-9);
}

}  // namespace
}  // namespace schuler::gnss
