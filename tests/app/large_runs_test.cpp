// What takes long is said before it begins, whichever option makes it long; what does not is not spoken of.
#include "schuler/app/large_runs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <ostream>
#include <string>

namespace schuler::app {
namespace {

using ::testing::HasSubstr;

struct Large {
    const char* set;   ///< an option in its range
    const char* said;  ///< part of the sentence
};
void PrintTo(const Large& l, std::ostream* out) { *out << l.set; }

/// The notice about two hours at rest with one setting more.
std::string notice(const std::string& set) {
    const std::filesystem::path file =
        std::filesystem::temp_directory_path() / ("schuler-large-" + std::to_string(getpid()) + ".toml");
    std::map<std::string, std::string> keys{{"duration_s", "7200"}, {"imu.rate_hz", "100"}, {"gnss.rate_hz", "1"}};
    if (const std::size_t equal = set.find('='); equal != std::string::npos) keys[set.substr(0, equal)] = set.substr(equal + 1);
    {
        std::ofstream out(file);
        out << "trajectory.type = \"static\"\ntrajectory.start = { lat_deg = 50, lon_deg = 30, height_m = 100 }\n";
        for (const auto& [key, value] : keys) out << key << " = " << value << '\n';
    }
    const settings::SettingList given{{"scenario", {file.string()}, {}}};
    std::string text = notice_of_size(given);
    std::filesystem::remove(file);
    return text;
}

class LargeRuns : public ::testing::TestWithParam<Large> {};

TEST_P(LargeRuns, SayHowLargeTheyAre) { EXPECT_THAT(notice(GetParam().set), HasSubstr(GetParam().said)); }

INSTANTIATE_TEST_SUITE_P(Options, LargeRuns,
                         ::testing::Values(Large{"duration_s=1e6", "1e+08 IMU samples"},
                                           Large{"imu.rate_hz=1e5", "7.2e+08 IMU samples"},
                                           Large{"gnss.rate_hz=1000", "7.2e+06 fixes"},
                                           Large{"baro.rate_hz=1000", "7.2e+06 samples of other instruments"},
                                           Large{"mag.rate_hz=1000", "7.2e+06 samples of other instruments"},
                                           Large{"gauges.rate_hz=1000", "7.2e+06 samples of other instruments"},
                                           Large{"log.rate_hz=1000", "7.2e+06 samples of other instruments"},
                                           Large{"compass.rate_hz=1000", "7.2e+06 samples of other instruments"},
                                           Large{"reference_rate_hz=1e5", "7.2e+08 epochs of the truth"},
                                           Large{"ranges.rate_hz=1000", "1.7e+08 ranges"},
                                           Large{"receiver.rate_hz=50", "8.6e+06 ranges"}));

TEST(LargeRunsNotice, IsSilentAboutUsualOnes) {
    EXPECT_EQ(notice(""), "");
    EXPECT_EQ(notice("imu.rate_hz=200"), "");
    EXPECT_EQ(notice("baro.rate_hz=50"), "");
    EXPECT_EQ(notice("nonsense=1"), "") << "the command itself says what is wrong";
}

}  // namespace
}  // namespace schuler::app
