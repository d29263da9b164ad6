// Which of several receivers is the one to be located.
#include "schuler/dataset/raw_observations.h"
#include "schuler/core/error.h"
#include "schuler/dataset/recognise.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

std::string header_line(const std::string& text, const std::string& label) {
    std::string line = text;
    line.resize(60, ' ');
    return line + label + "\n";
}

class RawObservationsTest : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("schuler_raw_") + testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        std::ofstream(folder_ / "day.nav") << header_line("     3.04           N: GNSS NAV DATA    G: GPS",
                                                          "RINEX VERSION / TYPE");
    }
    void TearDown() override { fs::remove_all(folder_); }

    void observations(const std::string& name, const std::string& marker_type = {}) const {
        std::ofstream out(folder_ / name);
        out << header_line("     3.04           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE");
        if (!marker_type.empty()) out << header_line(marker_type, "MARKER TYPE");
        out << header_line("", "END OF HEADER");
    }
    /// One satellite every ten seconds of an hour, from minute to minute.
    void epochs(const std::string& name, int from, int to) const {
        std::ofstream out(folder_ / name);
        out << header_line("     3.04           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE")
            << header_line("G    1 C1C", "SYS / # / OBS TYPES") << header_line("", "END OF HEADER");
        for (int second = 60 * from; second < 60 * to; second += 10)
            out << fmt::format("> 2024 05 01 12 {:02} {:02}.0000000  0  1\nG05  22000000.000\n", second / 60, second % 60);
    }
    [[nodiscard]] std::string taken() const {
        const RawObservations raw = raw_observations(folder_);
        const auto it = std::ranges::find(raw.facts, "gnss.observations", &Fact::key);
        return it == raw.facts.end() ? "(none)" : to_text(it->value);
    }

    fs::path folder_;
};

TEST_F(RawObservationsTest, TheHeaderSaysWhichOneMoves) {
    observations("a.obs", "GEODETIC");
    observations("b.obs", "AIRBORNE");
    EXPECT_EQ(taken(), "\"b.obs\"");
}

TEST_F(RawObservationsTest, PartsOfOneLogAreTakenTogether) {
    epochs("day_2.obs", 0, 10);
    epochs("day_1.obs", 10, 20);
    epochs("day_10.obs", 20, 30);
    epochs("other.obs", 30, 40);
    EXPECT_EQ(taken(), "[\"day_2.obs\", \"day_1.obs\", \"day_10.obs\"]") << "in order of time";
    EXPECT_EQ(raw_observations(folder_).files.observations.size(), 3U);
    epochs("day_1.obs", 0, 10);
    fs::remove(folder_ / "day_10.obs");
    EXPECT_EQ(taken(), "\"day_1.obs\"") << "two receivers at the same time";
}

TEST_F(RawObservationsTest, ElseTheNameDoes) {
    observations("base.obs");
    observations("rover.obs");
    EXPECT_EQ(taken(), "\"rover.obs\"");
}

TEST_F(RawObservationsTest, ElseTheFirstIsTakenAndTheOthersAreNamed) {
    observations("0759.obs");
    observations("3040.obs");
    EXPECT_EQ(taken(), "\"0759.obs\"");
    EXPECT_NE(raw_observations(folder_).dataset_toml.find("# or observations = \"3040.obs\""), std::string::npos);
    EXPECT_NE(raw_observations(folder_).dataset_toml.find("# [base]\n# observations = \"3040.obs\""), std::string::npos);
}

TEST_F(RawObservationsTest, NothingWithoutEphemerides) {
    fs::remove(folder_ / "day.nav");
    observations("rover.obs");
    EXPECT_EQ(taken(), "(none)");
}

class RawBesideImu : public RawObservationsTest {
protected:
    void imu(const std::string& name) const {
        std::ofstream out(folder_ / name);
        out << "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";
        for (int i = 0; i < 3000; ++i)
            out << 408640.0 + 0.01 * i << ',' << 1e-3 * ((i * 7) % 11 - 5) << ",0.001,0.002,0.0" << i % 10 << ",0.02,-9.81\n";
    }
    static std::string value_of(const std::vector<Fact>& facts, std::string_view key) {
        const auto it = std::ranges::find(facts, key, &Fact::key);
        return it == facts.end() ? "(none)" : to_text(it->value);
    }
};

TEST_F(RawBesideImu, TakesThePlaceOfFixes) {
    observations("rover.obs");
    imu("imu.csv");
    const Recognised r = recognise(folder_, Needs::ImuAndGnss, {});
    EXPECT_EQ(value_of(r.facts, "imu.file"), "\"imu.csv\"");
    EXPECT_EQ(value_of(r.facts, "gnss.observations"), "\"rover.obs\"");
    EXPECT_EQ(value_of(r.facts, "filter.scheme"), "(none)") << "with an IMU the positions of epochs are not all";
    EXPECT_NE(r.dataset_toml.find("observations = \"rover.obs\""), std::string::npos) << r.dataset_toml;
    ASSERT_EQ(r.doubts.size(), 1U) << "which way is forward, nothing shows";
    EXPECT_NE(r.doubts[0].find("imu.axes"), std::string::npos);
    EXPECT_EQ(value_of(recognise(folder_, Needs::ImuAndStart, {}).facts, "gnss.observations"), "\"rover.obs\"");
    EXPECT_EQ(value_of(recognise(folder_, Needs::Imu, {}).facts, "gnss.observations"), "(none)");
}

TEST_F(RawBesideImu, IsNotTakenForFixesThatAreBrokenOrOfAStation) {
    observations("base.obs");
    imu("imu.csv");
    EXPECT_THROW((void)recognise(folder_, Needs::ImuAndGnss, {}), Error) << "a station does not move";
    observations("rover.obs");
    EXPECT_NO_THROW((void)recognise(folder_, Needs::ImuAndGnss, {}));
    std::ofstream(folder_ / "gnss.csv") << "time_s,lat_deg,height_m\n408640,52,80\n408641,52,80\n";
    EXPECT_THROW((void)recognise(folder_, Needs::ImuAndGnss, {}), Error) << "gnss.csv was passed over";
}

TEST_F(RawBesideImu, OrIsNamedWithoutTheImu) {
    observations("rover.obs");
    imu("xsens.csv");
    inspect::Given given;
    given.keys = {"gnss.observations"};
    given.find_logs = false;  // one is named
    EXPECT_EQ(value_of(recognise(folder_, Needs::ImuAndGnss, given).facts, "imu.file"), "\"xsens.csv\"");
    given.find_imu = false;
    EXPECT_EQ(value_of(recognise(folder_, Needs::ImuAndGnss, given).facts, "imu.file"), "(none)");
}

/// The satellites alone are not what a folder with an IMU's log was meant for.
TEST_F(RawObservationsTest, AnUnrecognisedImuLogBesideThemIsTold) {
    observations("rover.obs");
    EXPECT_TRUE(recognise(folder_, Needs::ImuAndGnss, {}).doubts.empty());
    std::ofstream imu(folder_ / "imu.csv");
    imu << "time_s,rollspeed,pitchspeed,yawspeed,acc_forward,acc_right,acc_down\n";
    for (int i = 0; i < 50; ++i) imu << 0.01 * i << ",0,0,0.1,0,0.2,-9.8\n";
    imu.close();
    std::ofstream(folder_ / "notes.csv") << "name,value\nsite,3\nday,4\n";
    const Recognised r = recognise(folder_, Needs::ImuAndGnss, {});
    ASSERT_EQ(r.doubts.size(), 1U);
    EXPECT_NE(r.doubts.front().find("the solution is that of the satellites alone; imu.csv is not used"), std::string::npos)
        << r.doubts.front();
}

}  // namespace
}  // namespace schuler::dataset
