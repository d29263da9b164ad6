// Azimuth, elevation and fate of ranges, for places where they are plain.
#include "schuler/report/sky.h"
#include "schuler/core/units.h"
#include "schuler/solution/bundle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace schuler::report {
namespace {

/// At rest on the equator's zero meridian for 1000 s: x is up, y east, z north. Epoch k asks a satellite in direction k degrees.
solution::ResultBundle on_the_equator() {
    solution::ResultBundle b;
    RangingLog& log = b.data.recording.ranges;
    const double radius = b.data.config.filter.earth.ellipsoid.a;
    const auto up = log.source("G01", false), east = log.source("G02", false), south = log.source("BASE", true);
    for (int i = 0; i < 1000; ++i) {
        SolutionRow row{};
        row.time = Time::from_seconds(i);
        b.result.forward.rows.push_back(row);
        log.epochs.push_back({row.time, log.samples.size(), 3});
        const double slope = 30.0 * units::deg;
        for (const auto& [source, line] :
             {std::pair{up, Eigen::Vector3d(1, 0, 0)}, std::pair{east, Eigen::Vector3d(std::sin(slope), std::cos(slope), 0)},
              std::pair{south, Eigen::Vector3d(0, 0, -1)}}) {
            RangeSample m;
            m.source = source;
            m.tx.r = Eigen::Vector3d(radius, 0, 0) + 2e7 * line;
            log.samples.push_back(m);
        }
        // the filter uses the first, rejects the second's pseudorange but not its rate, and is not asked about the station
        for (const auto& [source, kind, status] :
             {std::tuple{up, fusion::MeasurementKind::Pseudorange, fusion::MeasurementStatus::Accepted},
              std::tuple{east, fusion::MeasurementKind::Pseudorange, fusion::MeasurementStatus::Rejected},
              std::tuple{east, fusion::MeasurementKind::RangeRate, fusion::MeasurementStatus::Accepted}}) {
            fusion::MeasurementRecord r{};
            r.stamp = r.time = row.time;
            r.kind = kind;
            r.status = status;
            r.source = source;
            r.innovation.x() = 10.0 * source + i;
            r.sigma.x() = 2.0;
            b.result.measurements.push_back(r);
        }
    }
    return b;
}

TEST(Sky, DirectionsAndFates) {
    const solution::ResultBundle b = on_the_equator();
    const std::vector<SkyRow> rows = sky_rows(b);
    ASSERT_EQ(rows.size(), 750u);  // every fourth epoch of a thousand: at most 300
    const SkyRow &up = rows[3], &east = rows[4], &south = rows[5];
    EXPECT_EQ(up.time, Time::from_seconds(4));
    EXPECT_NEAR(up.elevation, 90.0 * units::deg, 1e-6);
    EXPECT_EQ(up.use, RangeUse::Used);
    EXPECT_EQ(up.residual, 4.0);
    EXPECT_NEAR(east.elevation, 30.0 * units::deg, 1e-9);
    EXPECT_NEAR(east.azimuth, 90.0 * units::deg, 1e-9);
    EXPECT_EQ(east.use, RangeUse::Rejected);
    EXPECT_EQ(east.residual, 14.0);
    EXPECT_EQ(east.sigma, 2.0);
    EXPECT_NEAR(south.azimuth, 180.0 * units::deg, 1e-9);
    EXPECT_NEAR(south.elevation, 0.0, 1e-9);
    EXPECT_TRUE(south.station && !east.station);
    EXPECT_EQ(south.use, RangeUse::NotAsked);
    EXPECT_TRUE(std::isnan(south.residual));
    EXPECT_TRUE(sky_rows(solution::ResultBundle{}).empty());
}

}  // namespace
}  // namespace schuler::report
