#include "sensor/named_models.h"

#include "schuler/sensor/receivers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace schuler::sensor {
namespace {

/// Sigma of each horizontal axis.
double horizontal(const GnssReceiver& r) {
    EXPECT_EQ(r.white_position.x(), r.white_position.y());
    EXPECT_EQ(r.errors.correlated_position.x(), r.errors.correlated_position.y());
    return std::hypot(r.white_position.x(), r.errors.correlated_position.x());
}

// The radii of the data sheets: half of the fixes are inside sigma sqrt(2 ln 2), the root mean square is sigma sqrt(2).
TEST(Receivers, HaveTheRadiiOfTheirDataSheets) {
    const double cep = std::sqrt(2.0 * std::log(2.0)), rms = std::sqrt(2.0);
    EXPECT_NEAR(cep * horizontal(gnss_receiver("neo-m8")), 2.5, 0.02);
    EXPECT_NEAR(cep * horizontal(gnss_receiver("ZED-F9P")), 1.5, 0.02);
    EXPECT_NEAR(cep * horizontal(gnss_receiver("zed_f9p_rtk")), 0.010, 0.0005);
    EXPECT_NEAR(rms * horizontal(gnss_receiver("oem7")), 1.2, 0.02);
    EXPECT_NEAR(rms * horizontal(gnss_receiver("oem7-rtk")), 0.010, 0.0005);
    EXPECT_NEAR(rms * horizontal(gnss_receiver("um980")), 1.5, 0.02);
    EXPECT_NEAR(rms * horizontal(gnss_receiver("um980-rtk")), 0.008, 0.0006);
    const GnssReceiver um980 = gnss_receiver("um980");
    EXPECT_NEAR(std::hypot(um980.white_position.z(), um980.errors.correlated_position.z()), 2.5, 0.02);
    EXPECT_NEAR(rms * gnss_receiver("oem7").white_velocity.x(), 0.03, 0.001);
    EXPECT_EQ(gnss_receiver("oem7-rtk").fix, FixType::RtkFixed);
    EXPECT_EQ(gnss_receiver("oem7").fix, FixType::Autonomous);
}

TEST(Receivers, DuoStarIsTheOneOfPaperA) {
    const GnssReceiver r = gnss_receiver("DuoStar-1000");
    EXPECT_EQ(r.rate, 10.0);  // table 1.2.1
    EXPECT_EQ(r.errors.correlated_distance, 250e3);
    EXPECT_EQ(r.errors.change_correlated_position.z(), 3.0);
}

TEST(Receivers, UnknownNameListsTheKnownOnes) { testing::expect_names(gnss_receiver_names(), "gp-1", gnss_receiver); }

}  // namespace
}  // namespace schuler::sensor
