// IMU and GNSS on clocks that differ: found by the motion of a synthetic car.
#include "schuler/inspect/detail/motion/clock.h"
#include "schuler/inspect/inspect.h"

#include "io/log_bytes.h"
#include "report_queries.h"
#include "synthetic_car.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

namespace schuler::inspect::test {
namespace {

double offset_of(const InspectReport& r) {
    const Fact* offset = fact(r, "imu.time_offset_s");
    return offset == nullptr ? 0.0 : std::get<double>(offset->value);
}

InspectReport report_with(double gnss_minus_imu, CarLog car, const Given& given = {}) {
    const auto folder = fresh_folder("clock");
    car.gnss_start = car.imu_start + gnss_minus_imu;
    write_car(folder, car);
    return inspect(folder, given);
}

/// Differences that clocks make are found exactly, beside a latency of the receiver, whatever the units and axes.
TEST(Clock, KnownDifferencesAreFoundBesideALatency) {
    CarLog car;
    car.position_latency = car.velocity_latency = 0.15;
    car.gyro_factor = 57.295779513;
    car.imu_header = "time_s,gyro_x,gyro_y,gyro_z,accel_x,accel_y,accel_z";
    car.imu_start = 1.7e9;
    for (const double shift : {18.0, -18.0, 3600.0, -7218.0, -315964782.0, 86400.0}) {
        const InspectReport r = report_with(shift, car);
        EXPECT_EQ(offset_of(r), shift);
        EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.15, 0.04) << shift;
        EXPECT_EQ(r.doubts.size(), 1u);
        EXPECT_FALSE(has_problem(r, Level::Error, "no time in common"));
    }
}

TEST(Clock, AnyOtherDifferenceIsFoundWithItsSigma) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> far(-90.0, 90.0);
    for (int i = 0; i < 6; ++i) {
        const double shift = far(random);
        if (std::abs(shift) < 3.0) continue;
        const InspectReport r = report_with(shift, CarLog{});
        const Fact* found = fact(r, "imu.time_offset_s");
        ASSERT_NE(found, nullptr) << shift;
        EXPECT_NEAR(offset_of(r), shift, std::max(3.0 * found->sigma, 0.06));
    }
}

/// Positions are never of the future: a shift that fits older velocities would make them so.
TEST(Clock, AnUnknownDifferenceIsThatOfThePositions) {
    CarLog car;
    car.velocity_latency = 0.15;
    const InspectReport r = report_with(-12.3, car);
    EXPECT_NEAR(offset_of(r), -12.3, 0.03);
    EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.0, 0.03);
    EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.15, 0.04);
}

TEST(Clock, OneClockIsLeftAlone) {
    for (const double latency : {0.0, 0.3, 0.9}) {
        CarLog car;
        car.position_latency = car.velocity_latency = latency;
        const InspectReport r = report_with(0.0, car);
        EXPECT_EQ(fact(r, "imu.time_offset_s"), nullptr) << latency;
        EXPECT_TRUE(r.doubts.empty());
    }
}

std::vector<std::array<double, 7>> rows_of(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::string line;
    std::getline(in, line);
    std::vector<std::array<double, 7>> rows;
    while (std::getline(in, line)) {
        std::istringstream cells(line);
        std::array<double, 7>& row = rows.emplace_back();
        for (double& value : row) {
            std::string cell;
            std::getline(cells, cell, ',');
            value = std::stod(cell);
        }
    }
    return rows;
}

template <class T>
void put_at(std::string& payload, std::size_t where, double value) {
    const T number = static_cast<T>(std::llround(value));
    std::memcpy(payload.data() + where, &number, sizeof number);
}

/// NAV-PVT of a row of fixes; seconds below 100 after noon.
std::string nav_pvt(const std::array<double, 7>& fix, double seconds) {
    std::string p(92, '\0');
    put_at<std::uint32_t>(p, 0, 1000.0 * (302'400.0 + seconds));
    put_at<std::uint16_t>(p, 4, 2024.0);
    p[6] = 5;
    p[7] = 1;
    p[8] = 12;
    const double minutes = std::floor(seconds / 60.0), second = std::floor(seconds - 60.0 * minutes);
    p[9] = static_cast<char>(minutes);
    p[10] = static_cast<char>(second);
    p[11] = 7;
    put_at<std::int32_t>(p, 16, 1e9 * (seconds - 60.0 * minutes - second));
    p[20] = 3;
    p[21] = 1;
    p[23] = 12;
    put_at<std::int32_t>(p, 24, 1e7 * fix[2]);
    put_at<std::int32_t>(p, 28, 1e7 * fix[1]);
    put_at<std::int32_t>(p, 32, 1e3 * fix[3]);
    put_at<std::int32_t>(p, 36, 1e3 * fix[3]);
    put_at<std::uint32_t>(p, 40, 50.0);
    put_at<std::uint32_t>(p, 44, 80.0);
    for (std::size_t i = 0; i < 3; ++i) put_at<std::int32_t>(p, 48 + 4 * i, 1e3 * fix[4 + i]);
    put_at<std::uint32_t>(p, 68, 30.0);
    return io::test::ubx(0x01, 0x07, p);
}

/// ESF-MEAS of a row of the IMU.
std::string esf_meas(const std::array<double, 7>& imu, double seconds) {
    std::string p(8 + 6 * 4, '\0');
    put_at<std::uint32_t>(p, 0, 1000.0 * seconds);
    put_at<std::uint16_t>(p, 4, 6 << 11);
    constexpr std::array<std::uint32_t, 6> type{14, 13, 5, 16, 17, 18};
    for (std::size_t i = 0; i < 6; ++i) {
        const double unit = i < 3 ? 4096.0 * 180.0 / std::numbers::pi : 1024.0;
        const auto value = static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(unit * imu[i + 1]))) & 0xFFFFFFU;
        put_at<std::uint32_t>(p, 8 + 4 * i, static_cast<double>(type[i] << 24U | value));
    }
    return io::test::ubx(0x10, 0x02, p);
}

/// What a receiver with sensors writes: each fix some time after the instant that it is of, and the sensors' own ticks.
TEST(Clock, SensorsDatedByTheFixesBesideThemHaveTheDelayOfTheReceiver) {
    for (const double delay : {0.0, 0.12}) {
        const auto folder = fresh_folder("clock_arrival"), logs = fresh_folder("clock_arrival_log");
        const CarLog car;
        write_car(folder, car);
        const auto imu = rows_of(folder / car.imu_name), gnss = rows_of(folder / car.gnss_name);
        std::string log;
        auto fix = gnss.begin();
        for (const auto& row : imu) {
            for (; fix != gnss.end() && (*fix)[0] + delay < row[0] - 1e-6; ++fix)
                log += nav_pvt(*fix, (*fix)[0] - car.gnss_start);
            log += esf_meas(row, row[0] - 777.0);
        }
        write_file(logs / "drive.ubx", log);
        const InspectReport r = inspect(logs);
        if (delay == 0.0) EXPECT_EQ(fact(r, "imu.time_offset_s"), nullptr);
        else EXPECT_NEAR(offset_of(r), delay, 0.03);
        EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.0, 0.03) << delay;
        EXPECT_NEAR(number_of(r, "gnss.velocity_latency_s"), 0.0, 0.03) << delay;
    }
}

/// The rows of a CSV log from `from` on (s) later by `step`; those from there to `lost` s after it are left out.
void later_from(const std::filesystem::path& file, double from, double step, double lost = 0.0) {
    std::ifstream in(file);
    std::string text, line;
    std::getline(in, line);
    text = line + '\n';
    while (std::getline(in, line)) {
        const std::size_t comma = line.find(',');
        const double t = std::stod(line.substr(0, comma));
        if (t >= from && t < from + lost) continue;
        text += fmt::format("{:.6f}{}\n", t + (t >= from ? step : 0.0), line.substr(comma));
    }
    in.close();
    write_file(file, text);
}

/// A second is what a receiver loses with a fix, and a logger with a full buffer; the motion tells it from a clock that was set.
TEST(Clock, AStepWithinALogIsToldFromAHole) {
    CarLog car;
    car.duration = 300.0;
    car.gnss_rate = 1.0;
    car.position_latency = car.velocity_latency = 0.1;
    for (const bool imu : {true, false}) {
        const std::string file = imu ? car.imu_name : car.gnss_name;
        for (const double step : {0.6, 1.0, 3600.0}) {
            const auto folder = fresh_folder("clock_step");
            write_car(folder, car);
            later_from(folder / file, car.imu_start + 150.0, step);
            const InspectReport r = inspect(folder);
            ASSERT_EQ(r.clock_steps.size(), 1u) << file << step;
            EXPECT_EQ(r.clock_steps[0].imu, imu);
            EXPECT_NEAR(r.clock_steps[0].seconds, step, 0.011);
            EXPECT_NEAR(r.clock_steps[0].after, 150.0, 1.01);
            EXPECT_NEAR(number_of(r, "gnss.latency_s"), 0.1, 0.04);
            EXPECT_EQ(fact(r, "imu.time_offset_s"), nullptr);
        }
        for (const double lost : {1.0, 10.0}) {
            const auto folder = fresh_folder("clock_hole");
            write_car(folder, car);
            later_from(folder / file, car.imu_start + 150.0, 0.0, lost);
            EXPECT_TRUE(inspect(folder).clock_steps.empty()) << file << lost;
        }
    }
}

TEST(Clock, AnOffsetThatIsGivenAndContradictedIsRefusedWithTheBestOne) {
    Given given;
    given.keys = {"imu.time_offset_s"};
    given.imu.time_offset = 18.0;  // of the folder's log, which is not named
    EXPECT_FALSE(report_with(18.0, CarLog{}, given).refusal);
    given.imu.time_offset = 3.0;
    const InspectReport r = report_with(18.0, CarLog{}, given);
    ASSERT_TRUE(r.refusal);
    EXPECT_EQ(r.refusal->key, "imu.time_offset_s");
    EXPECT_NE(r.refusal->text.find("+15 s"), std::string::npos) << r.refusal->text;
    EXPECT_NE(r.refusal->hint.find("give 18"), std::string::npos) << r.refusal->hint;
    EXPECT_EQ(fact(r, "imu.time_offset_s"), nullptr);
}

TEST(Clock, KnownShiftsHaveNames) {
    using detail::known_shift;
    EXPECT_EQ(known_shift(18.1, 18.0)->shift, 18.0);
    EXPECT_EQ(known_shift(-315964781.6, 18.0)->shift, -315964782.0);
    EXPECT_NE(known_shift(-315964781.6, 18.0)->name.find("1970"), std::string::npos);
    EXPECT_NE(known_shift(604800.0, 18.0)->name.find("1 week"), std::string::npos);
    EXPECT_NE(known_shift(-7200.0, 18.0)->name.find("2 h"), std::string::npos);
    EXPECT_FALSE(known_shift(1234.0, 18.0));
    EXPECT_FALSE(known_shift(-1.0, 18.0));
}

/// Parabolas whose vertices lie on a line: its slope comes out, and noise alone is no drift.
TEST(Clock, DriftIsTheSlopeOfTheLags) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0.0, 0.01);
    for (const double ppm : {-120.0, -40.0, 0.0, 75.0}) {
        std::vector<detail::LagCurve> curves;
        for (int w = 0; w < 60; ++w) {
            detail::LagCurve c{15.0 * w, {}};
            const double lag = 0.2 - ppm * 1e-6 * (c.t - 450.0) + noise(random);
            for (int i = 0; i < detail::lag_count; ++i)
                c.horizontal.push_back(10.0 + 400.0 * std::pow(detail::first_lag + detail::lag_step * i - lag, 2));
            curves.push_back(std::move(c));
        }
        const detail::ClockDrift drift = detail::drift_of(curves);
        ASSERT_TRUE(drift.found);
        EXPECT_NEAR(drift.ppm, ppm, 4.0 * drift.sigma) << drift.sigma;
        EXPECT_LT(drift.sigma, 12.0);
    }
}

}  // namespace
}  // namespace schuler::inspect::test
