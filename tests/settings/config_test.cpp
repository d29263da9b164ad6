// What follows from other settings.
#include "schuler/settings/config/config.h"
#include "schuler/settings/facts.h"
#include "schuler/settings/toml_file.h"

#include <gtest/gtest.h>

#include <string>

namespace schuler::settings {
namespace {

SettingList read(const std::string& text) { return config_table().read(parse_toml(text, "dataset.toml"), "dataset.toml"); }
Config of(const std::string& text) { return config_from(read(text)); }

/// A misalignment of 5 arcsec is nothing beside the noise of a MEMS unit, and ten times the noise of a navigation-grade one.
TEST(Config, GainsAreStatesWhereTheyExceedTheNoise) {
    const Config navigation = of("[imu]\ngrade = \"navigation\"\n");
    EXPECT_TRUE(navigation.filter.scale_factors);
    EXPECT_TRUE(navigation.filter.misalignments);
    const Config noisy = of("[imu]\ngrade = \"navigation\"\ngyro_noise_deg_sqrt_h = 0.02\naccel_noise_m_s_sqrt_h = 0.1\n");
    EXPECT_FALSE(noisy.filter.scale_factors);
    EXPECT_FALSE(noisy.filter.misalignments);
    EXPECT_FALSE(of("[imu]\ngrade = \"perfect\"\n").filter.scale_factors);
    EXPECT_FALSE(of("[imu]\ngrade = \"mems\"\n").filter.misalignments);
    EXPECT_FALSE(of("[imu]\ngrade = \"navigation\"\n[filter]\nmisalignments = false\n").filter.misalignments);
}

TEST(Config, ColumnsAndScalesReachTheAnalysisWithoutAFile) {
    const SettingList given =
        read("[imu]\nscale = { accel_m_s2 = -1 }\n[gnss]\ncolumns = { time_s = \"utc\" }\nfix_codes = { 9 = \"rtk_fixed\" }\n");
    const inspect::Given g = given_of(config_from(given), given, {});
    EXPECT_TRUE(g.imu.path.empty());
    EXPECT_EQ(g.imu.scale.at("accel_m_s2"), -1.0);
    EXPECT_EQ(g.gnss.columns.at("time_s"), "utc");
    EXPECT_EQ(g.fix_codes.at("9"), "rtk_fixed");
}

TEST(Config, FixesAreLookedForUnlessTheStartHasAPlace) {
    const auto finds = [](const std::string& text) {
        const SettingList given = read(text);
        return given_of(config_from(given), given, {}).find_gnss;
    };
    EXPECT_TRUE(finds("[imu]\nfile = \"imu.csv\"\n"));
    EXPECT_TRUE(finds("[imu]\nfile = \"imu.csv\"\n[initial]\nheading_deg = 10\n"));
    EXPECT_FALSE(finds("[imu]\nfile = \"imu.csv\"\n[initial]\nlat_deg = 50\nlon_deg = 30\nheight_m = 100\n"));
    EXPECT_FALSE(finds("[gnss]\nfile = \"gnss.csv\"\n"));
}

}  // namespace
}  // namespace schuler::settings
