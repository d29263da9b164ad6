// Logs whose columns are not what they seem: values that are never written, stamps and sentinels of poor loggers.
#include "inspect/report_queries.h"
#include "inspect/synthetic_car.h"
#include "schuler/core/units.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <string>

namespace schuler::inspect::test {
namespace {

using units::deg;

/// Rewrites the rows of a log below its header.
void change_rows(const std::filesystem::path& path, const std::function<std::string(int, const std::string&)>& change) {
    std::ifstream in(path);
    std::string text, line;
    std::getline(in, line);
    text = line + "\n";
    for (int i = 0; std::getline(in, line); ++i) text += change(i, line) + "\n";
    in.close();
    write_file(path, text);
}

TEST(FaultyColumns, GyrosInThousandthsOfADegree) {
    const auto folder = fresh_folder("mdps");
    CarLog car;
    car.imu_header = "time_ms,gx,gy,gz,ax,ay,az";
    car.gyro_factor = 1000.0 / deg;
    write_car(folder, car);
    change_rows(folder / car.imu_name,
                [](int i, const std::string& line) { return std::to_string(1'000'000 + 10 * i) + line.substr(line.find(',')); });
    const InspectReport r = inspect(folder);
    EXPECT_NEAR(number_of(r, "imu.scale.gyro_rad_s"), 1e-3 * deg, 1e-12);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
    EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
}

TEST(FaultyColumns, OddGyroUnitIsNotSure) {
    const auto folder = fresh_folder("half");
    CarLog car;
    car.imu_header = "time_s,gx,gy,gz,ax,ay,az";
    car.gyro_factor = 0.4;
    write_car(folder, car);
    const InspectReport r = inspect(folder);
    const Finding* unit = finding(r, "imu.scale.gyro_rad_s");
    EXPECT_TRUE(unit == nullptr || unit->confidence < 0.9);
}

/// A field of 48 uT that turns, written in a unit.
InspectReport field_written(const std::string& header, double factor) {
    const auto folder = fresh_folder("field_unit");
    write_car(folder, {});
    std::string text = header + "\n";
    for (int i = 0; i < 2000; ++i) {
        const double t = 0.05 * i, x = 20.0 * std::cos(0.1 * t), y = -20.0 * std::sin(0.1 * t);
        text += fmt::format("{:.3f},{:.8g},{:.8g},{:.8g}\n", 1000.0 + t, factor * x, factor * y, factor * 43.6);
    }
    write_file(folder / "mag.csv", text);
    return inspect(folder);
}

TEST(FaultyColumns, AFieldInAnotherUnitThanItsNameIsRescaledAndTold) {
    for (const double factor : {1000.0, 10.0, 0.01, 1e-6, 1.0 / 47.97}) {  // nT, mG, G, T, by its own norm
        const InspectReport r = field_written("time_s,mag_x_ut,mag_y_ut,mag_z_ut", factor);
        EXPECT_TRUE(has_problem(r, Level::Warning, "magnetometer columns state a unit that cannot be")) << factor;
        EXPECT_NEAR(number_of(r, "mag.norm"), 46.0, 3.0) << factor;
    }
    EXPECT_FALSE(has_problem(field_written("time_s,mag_x_ut,mag_y_ut,mag_z_ut", 1.0), Level::Warning, "magnetometer columns"));
    EXPECT_NEAR(number_of(field_written("time_s,mag_x,mag_y,mag_z", 1.0 / 47.97), "mag.norm"), 45.0, 0.1);
}

TEST(FaultyColumns, VelocitiesThatAreAlwaysZeroAreMissing) {
    const auto folder = fresh_folder("zero_velocity");
    CarLog car;
    write_car(folder, car);
    change_rows(folder / car.gnss_name, [](int, const std::string& line) {
        std::size_t at = 0;
        for (int column = 0; column < 4; ++column) at = line.find(',', at) + 1;
        return line.substr(0, at) + "0,0,0";
    });
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(has_problem(r, Level::Warning, "velocities are always zero"));
    EXPECT_TRUE(sets(r, "gnss.use_velocity = false")) << r.dataset_toml;
    EXPECT_EQ(value_of(r, "vehicle.kind"), "car");
    ASSERT_FALSE(r.doubts.empty());
}

TEST(FaultyColumns, CoarseStampsAreSpread) {
    const auto folder = fresh_folder("coarse");
    CarLog car;
    car.gnss_rate = 4.0;
    write_car(folder, car);
    change_rows(folder / car.gnss_name,
                [](int, const std::string& line) { return line.substr(0, 4) + line.substr(line.find(',')); });
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(has_problem(r, Level::Warning, "rows have the time of another row"));
    EXPECT_NEAR(file_named(r, "gnss.csv")->rate_hz, 4.0, 1e-6);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
}

TEST(FaultyColumns, SentinelsAreLeftOut) {
    const auto folder = fresh_folder("sentinels");
    CarLog car;
    write_car(folder, car);
    change_rows(folder / car.imu_name, [](int i, const std::string& line) {
        if (i % 1000 == 500) return line.substr(0, line.rfind(',')) + ",9999";
        const std::size_t first = line.find(',') + 1;
        return i % 1000 == 700 ? line.substr(0, first) + "-300" + line.substr(line.find(',', first)) : line;
    });
    const InspectReport r = inspect(folder);
    EXPECT_TRUE(has_problem(r, Level::Warning, "24 single samples are far beyond all others"));
    EXPECT_EQ(file_named(r, "imu.csv")->rows, 11976U);
    EXPECT_EQ(value_of(r, "imu.axes"), "frd");
}

}  // namespace
}  // namespace schuler::inspect::test
