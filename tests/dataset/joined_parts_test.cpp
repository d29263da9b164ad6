// Parts of one log that are named in a description, read into one recording.
#include "schuler/core/error.h"
#include "schuler/dataset/read_files.h"
#include "schuler/io/log_parts.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

class JoinedPartsTest : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("schuler_parts_") + testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
    }
    void TearDown() override { fs::remove_all(folder_); }

    /// Samples of a unit at rest, a hundred a second; columns of rates or of increments.
    void imu(const std::string& name, int first, int last, bool increments = false) const {
        std::ofstream out(folder_ / name);
        out << (increments ? "time_s,dtheta_x_rad,dtheta_y_rad,dtheta_z_rad,dv_x_m_s,dv_y_m_s,dv_z_m_s\n"
                           : "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n");
        for (int i = first; i < last; ++i) out << fmt::format("{:.2f},{},0,0,0,0,-9.8\n", 0.01 * i, 1e-4 * i);
    }
    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

    fs::path folder_;
    Description description_;
    WarningLog warnings_;
};

TEST_F(JoinedPartsTest, InOrderOfTimeWithoutWhatTheyShare) {
    imu("b.csv", 0, 300);
    imu("a.csv", 280, 600);
    imu("c.csv", 700, 900);
    description_.imu.file = "a.csv";
    description_.imu.parts = {"c.csv", "b.csv"};
    const std::vector<ImuSample> samples = read_files(folder_, description_, {}, warnings_).recording.imu;
    ASSERT_EQ(samples.size(), 800u);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const double expected = static_cast<double>(i < 600 ? i : i + 100);
        ASSERT_NEAR(samples[i].gyro.x(), 1e-4 * expected, 1e-9) << i;
        ASSERT_NEAR(samples[i].time.seconds(), 0.01 * expected, 1e-6) << i;
    }
    ASSERT_EQ(warnings_.summary().size(), 1u);
    EXPECT_NE(warnings_.summary().front().find("a.csv: rows that are in the part before it too: left out"), std::string::npos);
}

TEST_F(JoinedPartsTest, OfAnotherKindAreRefused) {
    imu("a.csv", 0, 300);
    imu("b.csv", 300, 600, true);
    description_.imu.file = "a.csv";
    description_.imu.parts = {"b.csv"};
    try {
        (void)read_files(folder_, description_, {}, warnings_);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.place().key, "imu.parts") << e.what();
    }
}

TEST_F(JoinedPartsTest, OfFixesWithAnotherTimeScaleAreRefused) {
    imu("imu.csv", 0, 300);
    write("fixes.csv", "time_s,lat_deg,lon_deg,height_m\n1.0,50,30,100\n2.0,50,30,100\n");
    write("more.pos",
          "%  GPST latitude(deg) longitude(deg) height(m) Q ns sdn(m) sde(m) sdu(m)\n2200 100.000 50 30 100 1 12 0.1 0.1 0.2\n");
    description_.imu.file = "imu.csv";
    description_.gnss.file = "fixes.csv";
    description_.gnss.parts = {"more.pos"};
    try {
        (void)read_files(folder_, description_, {}, warnings_);
        FAIL();
    } catch (const Error& e) {
        EXPECT_EQ(e.place().key, "gnss.parts") << e.what();
    }
}

TEST_F(JoinedPartsTest, WithoutAFirstOneAreRefused) {
    description_.imu.parts = {"b.csv"};
    Reading reading;
    reading.imu = false;
    EXPECT_THROW((void)read_files(folder_, description_, reading, warnings_), Error);
}

TEST(LogParts, AreThoseThatFollowEachOther) {
    // a second unit beside the third part, one after a long pause, one inside another
    const std::array<io::FileSpan, 7> files{{{200, 300}, {0, 100}, {95, 200}, {201, 299}, {2000, 2100}, {120, 150}, {890, 1000}}};
    const auto chain = [&](std::size_t chosen) { return io::chain_of_parts(files, chosen); };
    EXPECT_EQ(chain(0), (std::vector<std::size_t>{1, 2, 0, 6}));
    EXPECT_EQ(chain(1), (std::vector<std::size_t>{1, 2, 0, 6}));
    EXPECT_EQ(chain(4), (std::vector<std::size_t>{4}));
}

}  // namespace
}  // namespace schuler::dataset
