// The acceleration of a satellite against the change of its velocity.
#include "schuler/gnss/acceleration.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/gnss/constellation.h"
#include "schuler/gnss/satellite_source.h"

#include <gtest/gtest.h>

namespace schuler::gnss {
namespace {

TEST(Acceleration, IsTheChangeOfTheVelocityRelativeToTheEarth) {
    const Time begin = Time::from_gps(2300, 0.0);
    const Navigation navigation = nominal_gps(begin, begin + Duration::from_seconds(3600.0));
    constexpr double step = 1.0;  // s; the third derivative adds 1e-8 m/s^2
    for (const KeplerEphemeris& e : navigation.kepler) {
        const Time t = begin + Duration::from_seconds(1800.0);
        const Eigen::Vector3d before = satellite_state(e, t + Duration::from_seconds(-step)).velocity;
        const Eigen::Vector3d after = satellite_state(e, t + Duration::from_seconds(step)).velocity;
        const Eigen::Vector3d a = point_mass_acceleration(satellite_state(e, t), earth::wgs84);
        EXPECT_LT((a - (after - before) / (2.0 * step)).norm(), 1e-5);  // a Keplerian orbit has no flattening to miss
        EXPECT_GT(a.norm(), 0.1);
    }
    EXPECT_GE(navigation.kepler.size(), 24u);
}

}  // namespace
}  // namespace schuler::gnss
