// What is said of the files that a run takes.
#include "schuler/dataset/recognise.h"

#include "schuler/core/error.h"

#include "io/log_bytes.h"
#include "support/temporary_folder.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace schuler::dataset {
namespace {

TEST(Doubts, AdviceIsNotWhatTheRunTakes) {
    const schuler::test::TemporaryFolder folder("Doubts_Advice");
    std::ofstream imu(folder.path() / "imu.csv");
    imu << "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";
    for (int i = 0; i < 3000; ++i)
        imu << fmt::format("{:.2f},0,0,{:.6f},0,0,{:.3f}\n", 100.0 + 0.01 * i, 1e-4 * (i % 7), -9.8 - 1e-3 * (i % 5));
    imu.close();
    std::ofstream(folder.path() / "gnss.csv") << "time_s,lat_deg,lon_deg,height_m\n110,48,11,500\n";
    const Recognised r = recognise(folder.path(), Needs::ImuAndGnss, {});
    const auto only =
        std::ranges::find_if(r.doubts, [](const std::string& d) { return d.find("only 1 usable row") != std::string::npos; });
    ASSERT_NE(only, r.doubts.end());
    EXPECT_EQ(*only, "gnss.csv: only 1 usable row; check that the log was copied completely");
}

/// The solution of an integrated system is a trajectory like any other.
TEST(Missing, ASolutionIsNoLogOfAnImu) {
    const schuler::test::TemporaryFolder folder("Missing_Solution");
    std::ofstream out(folder.path() / "ins.csv");
    out << "time_s,lat_deg,lon_deg,height_m,vel_n_m_s,vel_e_m_s,vel_d_m_s,roll_deg,pitch_deg,heading_deg\n";
    for (int i = 0; i < 100; ++i) out << fmt::format("{},48.{:06d},11.5,500,1,0,0,0,0,{}\n", i, 100000 + i, i);
    out.close();
    for (const std::filesystem::path& path : {folder.path(), folder.path() / "ins.csv"}) {
        try {
            (void)recognise(path, Needs::ImuAndGnss, {});
            ADD_FAILURE() << "no Error was thrown";
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("ins.csv: is a trajectory (attitude and position), no log of an IMU"),
                      std::string::npos)
                << e.what();
        }
    }
}

/// A log whose inertial unit is not named: the reader's reason is said, not that its solution is none.
TEST(Missing, WhyTheRawImuOfALogIsNotUsedIsSaid) {
    const schuler::test::TemporaryFolder folder("Missing_RawImu");
    const auto log = [](const std::string& name, double tow, const std::string& content) {
        const std::string text =
            fmt::format("{},COM1,0,83.5,FINESTEERING,2244,{:.3f},02000000,cdba,16809;{}", name, tow, content);
        return fmt::format("#{}*{:08x}\r\n", text, io::test::novatel_crc(text));
    };
    std::ofstream out(folder.path() / "span.gps");
    for (int i = 0; i < 100; ++i)
        out << log("RAWIMUA", 100.0 + i, fmt::format("2244,{}.005,00000077,98067,0,0,0,0,0", 100 + i))
            << log("INSPVAA", 100.0 + i,
                   fmt::format("2244,{}.0,51.1,-114.0,1000.0,0.1,0.2,0.0,0.5,1.5,{}.0,INS_SOLUTION_GOOD", 100 + i, i));
    out.close();
    try {
        (void)recognise(folder.path(), Needs::ImuAndGnss, {});
        ADD_FAILURE() << "no Error was thrown";
    } catch (const Error& e) {
        EXPECT_NE(std::string(e.what()).find("RAWIMU does not state the type of its IMU"), std::string::npos) << e.what();
    }
}

}  // namespace
}  // namespace schuler::dataset
