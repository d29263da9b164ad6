#include "schuler/analysis/outages.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::analysis {
namespace {

using Eigen::Vector3d;

const earth::Earth ellipsoidal;
const Geodetic field{0.9, 0.2, 100.0};

Time second(double s) { return Time::from_seconds(s); }

/// A solution that drifts east by 1 m/s^2 / 2 from 10 s on and is put right by the fix at 20 s; it goes 30 m/s north.
std::vector<SolutionRow> drifting(bool twice) {
    std::vector<SolutionRow> rows;
    for (int k = 0; k <= 300; ++k) {
        const double t = 0.1 * k, since = std::max(0.0, t - 10.0);
        const bool mended = t > 19.95;
        const bool right = t > 20.05 || (mended && !twice);
        const Vector3d off = right ? Vector3d(0, 0.01, 0) : Vector3d(0, 0.5 * since * since, 2.0 * since);
        SolutionRow row{second(t),
                        earth::moved_by_ned(ellipsoidal, field, Vector3d(30.0 * t, 0, 0) + off),
                        {30.0, t > 20.05 ? 0.0 : since, 0},
                        Vector3d::Zero(),
                        {5.0, 1.0 + since * since / 6.0, 1.0},
                        Vector3d::Ones(),
                        Vector3d::Ones()};
        rows.push_back(row);
        if (twice && k == 200) {
            row.position = earth::moved_by_ned(ellipsoidal, field, {600.0, 0.01, 0});
            rows.push_back(row);
        }
    }
    return rows;
}

std::vector<ReferenceSample> straight() {
    std::vector<ReferenceSample> reference;
    for (int k = 0; k <= 120; ++k) {
        ReferenceSample s;
        s.time = second(0.25 * k);
        s.position = earth::moved_by_ned(ellipsoidal, field, {7.5 * k, 0, 0});
        reference.push_back(s);
    }
    return reference;
}

TEST(Outage, EndIsBeforeTheUpdateWhereBothRowsAreGiven) {
    const OutageSpan span{second(10.0), Duration::from_seconds(10.0)};
    const auto errors = outage_errors(ellipsoidal, drifting(true), straight(), span, true);
    ASSERT_EQ(errors.size(), 40u);  // 10.25 ... 20.0
    EXPECT_EQ(errors.back().time, second(20.0));
    const OutageStatistics s = outage_statistics(span, errors);
    EXPECT_NEAR(s.end_horizontal, 50.0, 0.01);
    EXPECT_NEAR(s.max_horizontal, 50.0, 0.01);
    EXPECT_NEAR(s.end_vertical, 20.0, 1e-6);
    EXPECT_NEAR(s.max_3d, std::hypot(50.0, 20.0), 0.01);
    EXPECT_TRUE(s.inside_3sigma);  // 50 m against 3 x 17.7 m
}

TEST(Outage, EndIsCarriedOnWhereOnlyTheUpdatedRowIsGiven) {
    const OutageSpan span{second(10.0), Duration::from_seconds(10.0)};
    const auto errors = outage_errors(ellipsoidal, drifting(false), straight(), span, true);
    // From 19.9 s: 0.5 x 9.9^2 + 9.9 x 0.1.
    EXPECT_NEAR(outage_statistics(span, errors).end_horizontal, 49.995, 0.01);
    // A smoothed solution has no jump to avoid.
    EXPECT_NEAR(outage_statistics(span, outage_errors(ellipsoidal, drifting(false), straight(), span, false)).end_horizontal,
                0.01, 1e-4);
}

TEST(Outage, OneEpochOutsideThreeSigmaIsTold) {
    std::vector<OutageError> errors(5, {second(1.0), {1.0, 1.0, 50.0}, {1.0, 1.0, 1.0}});
    EXPECT_TRUE(outage_statistics({}, errors).inside_3sigma);  // the vertical does not count
    errors[2].error.y() = -3.01;
    EXPECT_FALSE(outage_statistics({}, errors).inside_3sigma);
    errors[2].error.y() = std::nan("");
    EXPECT_FALSE(outage_statistics({}, errors).inside_3sigma);
    const OutageStatistics none = outage_statistics({}, {});
    EXPECT_EQ(none.epochs, 0u);
    EXPECT_TRUE(std::isnan(none.max_horizontal));
    EXPECT_FALSE(none.inside_3sigma);
}

}  // namespace
}  // namespace schuler::analysis
