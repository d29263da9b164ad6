#include "schuler/analysis/separation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::analysis {
namespace {

using Eigen::Vector3d;

SolutionRow row(double t, double north, double heading, double sigma) {
    SolutionRow r;
    r.time = Time::from_seconds(t);
    r.position = earth::moved_by_ned({}, {0.8, 0.3, 100.0}, {north, 2.0 * north, -3.0 * north});
    r.v_eb_n = Vector3d(north, 0.0, 0.0);
    r.rpy = {0.0, 0.0, heading};
    r.std_position = r.std_velocity = r.std_rpy = Vector3d::Constant(sigma);
    return r;
}

TEST(Separation, IsForwardMinusBackwardAtCommonTimesWithBothVariances) {
    const std::vector<SolutionRow> forward{row(0, 1.0, 0.01, 3.0), row(1, 2.0, 0.01, 3.0), row(2, 3.0, 0.01, 3.0),
                                           row(3, 9.0, 0.01, 3.0)};
    const std::vector<SolutionRow> backward{row(-1, 0.0, 0.0, 4.0), row(1, 0.5, 2.0 * std::numbers::pi - 0.01, 4.0),
                                            row(1.5, 0.0, 0.0, 4.0), row(3, 1.0, 0.0, 0.1)};
    const std::vector<SeparationRow> rows = separation({}, forward, backward);
    ASSERT_EQ(rows.size(), 2u);
    EXPECT_EQ(rows[0].time, Time::from_seconds(1));
    EXPECT_LT((rows[0].position - Vector3d(1.5, 3.0, -4.5)).norm(), 1e-4);
    EXPECT_NEAR(rows[0].velocity.x(), 1.5, 1e-12);
    EXPECT_NEAR(rows[0].rpy.z(), 0.02, 1e-12);
    EXPECT_NEAR(rows[0].std_position.y(), 5.0, 1e-12);
    EXPECT_NEAR(rows[0].std_rpy.z(), 5.0, 1e-12);

    const SeparationSummary s = summarise(rows, Time::from_seconds(0), Time::from_seconds(10));
    EXPECT_EQ(s.epochs, 2u);
    EXPECT_NEAR(s.north.rms, std::sqrt((1.5 * 1.5 + 8.0 * 8.0) / 2.0), 1e-4);
    EXPECT_EQ(s.north.inside_3sigma, 1.0);
    EXPECT_EQ(s.east.inside_3sigma, 0.5);  // 16 m at sigma 3
    EXPECT_EQ(summarise(rows, Time::from_seconds(2), Time::from_seconds(10)).epochs, 1u);
    EXPECT_TRUE(std::isnan(summarise(rows, Time::from_seconds(5), Time::from_seconds(10)).up.rms));
}

}  // namespace
}  // namespace schuler::analysis
