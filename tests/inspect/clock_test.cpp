// IMU and GNSS on clocks that differ: found by the motion of a synthetic car.
#include "schuler/inspect/detail/motion/clock.h"
#include "schuler/inspect/inspect.h"

#include "report_queries.h"
#include "synthetic_car.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <random>
#include <string>

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
