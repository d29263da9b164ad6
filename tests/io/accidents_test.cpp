// Single rows that cannot be: they cost themselves, counted and told, and nothing else.
#include "io/io_fixture.h"

#include "schuler/core/units.h"
#include "schuler/io/formats.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/fix_codes.h"
#include "schuler/io/text/repair_times.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

namespace schuler::io {
namespace {

constexpr const char* columns_of_imu = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";

/// A second at 100 Hz from `t0` on; `row(i)` may write a row of its own.
template <class Row>
std::string imu_log(double t0, Row row) {
    std::string text = columns_of_imu;
    for (int i = 0; i < 200; ++i) {
        const std::string own = row(i);
        text += own.empty() ? fmt::format("{:.2f},0.01,0.02,0.0{},0.1,0.2,-9.8\n", t0 + 0.01 * i, i % 9 + 1) : own;
    }
    return text;
}

class Accidents : public test::IoTest {
protected:
    ImuTable imu(const std::string& text) {
        log = WarningLog{};
        return read_imu_csv(TextInput::memory(text, "imu.csv"), {}, log);
    }
    GnssTable gnss(const std::string& text, const CsvOptions& options = {}) {
        log = WarningLog{};
        return read_gnss_csv(TextInput::memory(text, "gnss.csv"), options, log);
    }
    WarningLog log;
};

TEST_F(Accidents, AStampAnHourAheadCostsItsRow) {
    const ImuTable t = imu(
        imu_log(1000.0, [](int i) { return i == 90 ? std::string("4600.90,0.01,0.02,0.03,0.1,0.2,-9.8\n") : std::string(); }));
    EXPECT_EQ(t.samples.size(), 199u);
    EXPECT_EQ(t.rows.strays, 1u);
    EXPECT_EQ(t.rows.out_of_order, 0u);
    EXPECT_NEAR(t.samples.back().time.seconds(), 1001.99, 1e-9);
    EXPECT_EQ(log.count("imu.stray"), 1u);
    const ImuTable behind =
        imu(imu_log(1000.0, [](int i) { return i == 90 ? std::string("10.90,0.01,0.02,0.03,0.1,0.2,-9.8\n") : std::string(); }));
    EXPECT_EQ(behind.samples.size(), 199u);
    EXPECT_NEAR(behind.samples.front().time.seconds(), 1000.0, 1e-9);
}

TEST_F(Accidents, APauseIsNoAccident) {
    std::vector<std::int64_t> times;
    for (int i = 0; i < 100; ++i) times.push_back((i < 50 ? i : i + 100'000) * std::int64_t{10'000'000});
    const std::vector<std::int64_t> before = times;
    EXPECT_FALSE(repair_times(times).any());
    EXPECT_EQ(times, before);
}

// Stamps of a clock that is off for a while contradict the order of the rows when it steps back; sorted they would lie among others.
TEST_F(Accidents, AClockThatStepsAwayAndBackIsTakenBack) {
    constexpr std::int64_t step = 200'000'000, second = 1'000'000'000;
    std::vector<std::int64_t> right;
    for (int i = 0; i < 300; ++i)
        if (i != 115) right.push_back(i * step);  // one lost in between
    for (const std::int64_t off : {second, -second, 3600 * second, -7 * second / 10}) {
        std::vector<std::int64_t> times = right;
        for (std::size_t i = 100; i < 150; ++i) times[i] += off;
        const TimeRepair repair = repair_times(times);
        EXPECT_EQ(times, right) << off;
        EXPECT_EQ(repair.excursions, 1U) << off;
        EXPECT_EQ(repair.away, 50U) << off;
        EXPECT_EQ(repair.first_away, 100U) << off;
        EXPECT_EQ(repair.step, off) << off;
    }
    EXPECT_FALSE(repair_times(right).any());
}

TEST_F(Accidents, RowsThatAreLateOrTwiceAreNoStepOfTheClock) {
    std::vector<std::int64_t> right;
    for (int i = 0; i < 300; ++i) right.push_back(i * std::int64_t{10'000'000});
    const auto at = [](std::vector<std::int64_t>& rows, int i) { return rows.begin() + i; };
    std::vector<std::int64_t> late = right, twice = right, gap = right, swapped = right;
    std::rotate(at(late, 100), at(late, 150), at(late, 200));  // a block is written before the one before it
    twice.insert(at(twice, 200), at(right, 100), at(right, 200));
    gap.erase(at(gap, 100), at(gap, 150));  // a gap, and later a set clock: steps of different sizes
    for (std::size_t i = 150; i < gap.size(); ++i) gap[i] -= 300'000'000;
    for (std::size_t i = 10; i < 290; i += 10) std::swap(swapped[i], swapped[i + 1]);
    for (std::vector<std::int64_t>* times : {&late, &twice, &gap, &swapped}) {
        const std::vector<std::int64_t> before = *times;
        EXPECT_EQ(repair_times(*times).excursions, 0U);
        EXPECT_EQ(*times, before);
    }
}

TEST_F(Accidents, AReceiversClockOffForAWhileMovesItsRows) {
    std::string text = "time_s,lat_deg,lon_deg,height_m\n";
    for (int i = 0; i < 100; ++i)
        text += fmt::format("{:.1f},50.0{:02d},10.0,300\n", 1000.0 + 0.2 * i + (i >= 40 && i < 70 ? 1.0 : 0.0), i);
    const GnssTable t = gnss(text);
    ASSERT_EQ(t.fixes.size(), 100U);
    EXPECT_EQ(t.rows.out_of_order, 0U);
    EXPECT_EQ(t.rows.same_time, 0U);
    for (std::size_t i = 0; i < 100; ++i)
        EXPECT_NEAR(t.fixes[i].position.lat, (50.0 + 1e-3 * static_cast<double>(i)) * units::deg, 1e-12);
    EXPECT_EQ(log.count("gnss.clock_away"), 30U);
    EXPECT_NE(log.summary().front().find("line 42"), std::string::npos) << log.summary().front();
}

TEST_F(Accidents, CoarseStampsAreSpread) {
    // 4 Hz written in whole seconds, from within a second to within another, with a pause.
    std::vector<std::int64_t> times, right;
    for (std::int64_t q = 2; q < 83; ++q) {
        if (q >= 40 && q < 60) continue;
        right.push_back(q * 250'000'000);
        times.push_back(q / 4 * 1'000'000'000);
    }
    EXPECT_GT(spread_equal_times(times), 0U);
    EXPECT_EQ(times, right);
    EXPECT_EQ(spread_equal_times(right), 0U);
    // single repeated stamps are left as they are
    std::vector<std::int64_t> few;
    for (std::int64_t i = 0; i < 100; ++i) few.push_back((i - i % 10 / 9) * 10'000'000);
    EXPECT_EQ(spread_equal_times(few), 0U);
}

TEST_F(Accidents, CoarseStampsOfALogAreSpreadWithAWarning) {
    const ImuTable t =
        imu(imu_log(1000.0, [](int i) { return fmt::format("{},0.{:03},0.02,0.03,0.1,0.2,-9.8\n", 1000 + i / 20, i); }));
    ASSERT_EQ(t.samples.size(), 200u);
    EXPECT_NEAR((t.samples[30].time - t.samples[29].time).seconds(), 0.05, 1e-9);
    EXPECT_EQ(log.topics(), std::vector<std::string>{"imu.coarse_time"});
}

TEST_F(Accidents, SinglesFarBeyondAllOthersAreLeftOut) {
    const ImuTable t = imu(imu_log(1000.0, [](int i) {
        if (i == 50) return std::string("1000.50,0.01,0.02,0.03,9999,0.2,-9.8\n");
        return i == 120 ? std::string("1001.20,-300,0.02,0.03,0.1,0.2,-9.8\n") : std::string();
    }));
    EXPECT_EQ(t.samples.size(), 198u);
    EXPECT_EQ(t.rows.bad, 2u);
    // what lasts is motion
    EXPECT_EQ(imu(imu_log(1000.0,
                          [](int i) {
                              return i >= 50 && i < 53 ? fmt::format("1000.{},0.01,0.02,0.03,999,0.2,-9.8\n", i) : std::string();
                          }))
                  .samples.size(),
              200u);
}

TEST_F(Accidents, StepsOfDecadesOverflowNothing) {
    std::vector<std::int64_t> times{0, 1'156'780'994'000'000'000, 2'300'000'000'000'000'000, 4'600'000'000'000'000'000};
    const std::vector<std::int64_t> before = times;
    EXPECT_FALSE(repair_times(times).any());
    EXPECT_EQ(times, before);
}

TEST_F(Accidents, TheWeekBeginsAnew) {
    const ImuTable t = imu(imu_log(604799.0, [](int i) {
        return i < 100 ? std::string() : fmt::format("{:.2f},0.01,0.02,0.03,0.1,0.2,-9.8\n", 0.01 * (i - 100));
    }));
    EXPECT_EQ(t.samples.size(), 200u);
    EXPECT_EQ(t.rows.strays, 0u);
    EXPECT_NEAR(t.samples.front().time.seconds(), 604799.0, 1e-9);
    EXPECT_NEAR(t.samples.back().time.seconds(), 604800.99, 1e-9);
    EXPECT_EQ(log.count("imu.rollover"), 1u);
}

TEST_F(Accidents, AbsurdNumbersCostTheirRow) {
    for (const char* cell : {"1e300", "nan", "-1e18"}) {
        const ImuTable t = imu(imu_log(
            1000.0, [&](int i) { return i == 70 ? fmt::format("1000.70,0.01,{},0.03,0.1,0.2,-9.8\n", cell) : std::string(); }));
        EXPECT_EQ(t.samples.size(), 199u) << cell;
        EXPECT_EQ(t.rows.bad, 1u) << cell;
        EXPECT_EQ(log.count("imu.bad_rows"), 1u) << cell;
    }
    // many of them are another unit
    const std::string counts =
        imu_log(1000.0, [](int i) { return fmt::format("{:.2f},0.01,0.02,0.03,1,2,-98000\n", 1000.0 + 0.01 * i); });
    EXPECT_THROW((void)imu(counts), Error);
}

std::string fixes(const std::string& column, const std::vector<std::string>& codes) {
    std::string text = "time_s,lat_deg,lon_deg,height_m," + column + "\n";
    int i = 0;
    for (const std::string& code : codes) text += fmt::format("{},50.{:04d},10.0,300,{}\n", 100 + i, i, code), ++i;
    return text;
}

std::vector<std::string> some(std::initializer_list<std::pair<const char*, int>> runs) {
    std::vector<std::string> codes;
    for (const auto& [code, n] : runs) codes.insert(codes.end(), static_cast<std::size_t>(n), code);
    return codes;
}

TEST_F(Accidents, AFixStampedAheadCostsItself) {
    std::string text = "time_s,lat_deg,lon_deg,height_m\n";
    for (int i = 0; i < 60; ++i) text += fmt::format("{},50.0{:02d},10.0,300\n", i == 30 ? 1130.0 : 1000.0 + i, i);
    const GnssTable t = gnss(text);
    EXPECT_EQ(t.fixes.size(), 59u);
    EXPECT_EQ(t.rows.strays, 1u);
}

TEST_F(Accidents, TheSourceOfAStatusColumnDecides) {
    const struct {
        const char* column;
        std::vector<std::string> codes;
        std::size_t used;
        FixType last;
    } cases[] = {
        {"status", some({{"1", 20}, {"3", 30}}), 30, FixType::Autonomous},  // ArduPilot: 1 is no fix
        // clang-format off
        {"gps_status", some({{"0", 5}, {"2", 5}, {"6", 30}}), 35, FixType::RtkFixed},
        {"fix", some({{"1", 20}, {"3", 30}}), 30, FixType::Autonomous},             // 3 is not NMEA's
        {"fix", some({{"0", 5}, {"1", 30}}), 30, FixType::Autonomous},              // NMEA
        {"fix_type", some({{"1", 5}, {"4", 30}}), 30, FixType::Differential},       // PX4, MAVLink
        {"status", some({{"-1", 5}, {"0", 10}, {"1", 30}}), 40, FixType::Differential},   // ROS
        {"Q", some({{"5", 5}, {"1", 30}}), 35, FixType::RtkFixed},                  // RTKLIB
        {"fixType,carrSoln", some({{"3,0", 5}, {"1,0", 5}, {"3,2", 30}}), 35, FixType::RtkFixed},   // u-blox
        // clang-format on
    };
    for (const auto& c : cases) {
        const GnssTable t = gnss(fixes(c.column, c.codes));
        EXPECT_EQ(t.fixes.size(), c.used) << c.column << " " << t.fix_table;
        EXPECT_EQ(t.fixes.back().fix, c.last) << c.column << " " << t.fix_table;
    }
}

TEST_F(Accidents, CodesThatNobodyKnowsAreAskedFor) {
    EXPECT_EQ(gnss(fixes("fix", some({{"1", 60}, {"77", 1}}))).fixes.size(), 60u);
    EXPECT_EQ(log.count("gnss.fix.unknown"), 1u);
    for (const auto& [column, code] : {std::pair("fix", "77"), std::pair("status", "1")}) {
        try {
            (void)gnss(fixes(column, some({{code, 50}})));
            ADD_FAILURE() << column;
        } catch (const Error& e) {
            EXPECT_NE(std::string(e.what()).find("fix_codes"), std::string::npos) << e.what();
        }
        CsvOptions said;
        said.fix_codes = {{code, "autonomous"}};
        EXPECT_EQ(gnss(fixes(column, some({{code, 50}})), said).fixes.size(), 50u);
    }
}

TEST_F(Accidents, AHeightThatIsNoNumberIsNamed) {
    std::string text = "time_s,lat,lon,alt\n";
    for (int i = 0; i < 300; ++i) text += fmt::format("{},48.{:05d},11.5,1'521.{:02d}\n", i, 1000 + i, i % 100);
    test::expect_parts(test::message_of([&] { (void)gnss(text); }),
                       {"gnss.csv:2", "column 4", "alt", "'1'521.00' is not a number"});
    std::string some = "time_s,lat,lon,alt\n";
    for (int i = 0; i < 300; ++i)
        some +=
            i % 2 == 0 ? fmt::format("{},48.{:05d},11.5,521\n", i, 1000 + i) : fmt::format("{},48.{:05d},11.5,\n", i, 1000 + i);
    test::expect_parts(test::message_of([&] { (void)gnss(some); }), {"gnss.csv:3", "column 4", "(150 of 300 rows"});
}

TEST_F(Accidents, ACutOrDamagedMatFileIsTold) {
    std::vector<SolutionRow> rows(200);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].time = Time::from_seconds(static_cast<double>(i));
        rows[i].position = {0.84, 0.2, 500.0};
        rows[i].v_eb_n = {1.0, 2.0, 3.0};
        rows[i].rpy = {0.01, 0.02, 0.03 * static_cast<double>(i % 100)};
        rows[i].std_position = rows[i].std_velocity = rows[i].std_rpy = Eigen::Vector3d(0.1, 0.2, 0.3);
    }
    format_named("mat")->write(folder() / "whole.mat", rows, "");
    const std::string bytes = content_of(folder() / "whole.mat");
    const auto read = [&](const std::string& damaged) {
        log = WarningLog{};
        return format_named("mat")->read(TextInput(write("damaged.mat", damaged)), log).streams.front();
    };
    EXPECT_EQ(read(bytes).columns.size(), 18u);
    EXPECT_TRUE(log.empty());
    // one variable of 200 numbers has 1600 bytes, a header of 48 to 64, and the file 128
    for (const std::string& damaged :
         {bytes.substr(0, bytes.size() / 2), bytes.substr(0, bytes.size() - 1), std::string(bytes).erase(bytes.size() / 2, 777),
          std::string(bytes).erase(bytes.size() / 2, 1600)}) {
        const Stream s = read(damaged);
        EXPECT_LT(s.columns.size(), 18u);
        EXPECT_EQ(s.rows(), 200u);
        ASSERT_NE(s.find("vel_n_m_s"), nullptr);
        EXPECT_EQ(s.find("vel_n_m_s")->values, std::vector<double>(200, 1.0));
        ASSERT_EQ(log.summary().size(), 1u);
        test::expect_parts(log.summary().front(), {"damaged.mat", "byte", "copy"});
    }
    test::expect_parts(test::message_of([&] { (void)read(bytes.substr(0, 600)); }), {"damaged.mat", "cut"});
}

/// The libraries of these formats open files by name.
TEST_F(Accidents, CompressedContainersAreRead) {
    std::vector<SolutionRow> rows(50);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        rows[i].time = Time::from_seconds(static_cast<double>(i));
        rows[i].position = {0.84, 0.2, 500.0};
        rows[i].v_eb_n = {1.0, 2.0, 3.0};
        rows[i].rpy = {0.01, 0.02, 0.03};
    }
    for (const char* name : {"mat", "hdf5"}) {
        const auto plain = folder() / fmt::format("run.{}", name);
        format_named(name)->write(plain, rows, "");
        const auto packed = write_gz(fmt::format("run.{}.gz", name), content_of(plain));
        const Format* format = format_of(packed);
        ASSERT_NE(format, nullptr) << name;
        EXPECT_EQ(format->name, name);
        const StreamLog unpacked = format->read(TextInput(packed), log);
        EXPECT_EQ(unpacked.streams.at(0).rows(), 50U);
        EXPECT_EQ(unpacked.streams.at(0).find("vel_d_m_s")->values, std::vector<double>(50, 3.0));
        EXPECT_TRUE(log.empty());
        const auto cut = write(fmt::format("cut.{}.gz", name), content_of(packed).substr(0, 300));
        test::expect_parts(test::message_of([&] { (void)format->read(TextInput(cut), log); }),
                           {fmt::format("cut.{}.gz", name), "cut"});
    }
}

}  // namespace
}  // namespace schuler::io
