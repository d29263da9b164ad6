#include "sensor/named_models.h"

#include "schuler/sensor/grades.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>

namespace schuler::sensor {
namespace {

// Honeywell's figures in paper A, tables 1.4.2 and 1.4.3, converted by hand.
TEST(Grades, Hg9900IsItsDataSheetInSi) {
    const ImuErrorModel m = imu_grade("HG-9900");
    EXPECT_NEAR(m.gyro_initial_bias(), 1.454441e-8, 1e-14);  // 0.003 deg/h
    EXPECT_NEAR(m.gyro_noise, 5.817764e-7, 1e-13);           // 0.002 deg/sqrt(h)
    EXPECT_DOUBLE_EQ(m.gyro_scale, 5e-6);
    EXPECT_NEAR(m.accel_initial_bias(), 2.4516625e-4, 1e-12);  // 25 ug
    EXPECT_DOUBLE_EQ(m.accel_scale, 1e-4);
    EXPECT_NEAR(m.gyro_misalignment, 5.0 / 206264.806, 1e-12);
}

TEST(Grades, Adis16405HasItsLargeTurnOnBias) {
    const ImuErrorModel m = imu_grade("adis16405");
    EXPECT_NEAR(m.gyro_turn_on_bias, 3.0 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_NEAR(m.gyro_initial_bias(), std::hypot(m.gyro_turn_on_bias, m.gyro_bias), 1e-15);
    EXPECT_NEAR(m.accel_turn_on_bias, 0.490333, 1e-6);
}

TEST(Grades, Stim300IsItsDataSheetInSi) {
    const ImuErrorModel m = imu_grade("STIM300");
    EXPECT_NEAR(m.gyro_noise, 4.3633e-5, 1e-9);         // 0.15 deg/sqrt(h)
    EXPECT_NEAR(m.accel_noise, 1.16667e-3, 1e-8);       // 0.07 m/s/sqrt(h)
    EXPECT_NEAR(m.accel_turn_on_bias, 7.355e-3, 1e-6);  // 0.75 mg
    EXPECT_NEAR(m.gyro_misalignment, 1e-3, 2e-6);
}

TEST(Grades, BetterGradesAreBetterInEveryNumber) {
    const char* order[] = {"consumer", "mems", "tactical", "navigation", "perfect"};
    for (int i = 0; i + 1 < 5; ++i) {
        const ImuErrorModel a = imu_grade(order[i]), b = imu_grade(order[i + 1]);
        EXPECT_GT(a.gyro_noise, b.gyro_noise) << order[i];
        EXPECT_GT(a.gyro_bias, b.gyro_bias) << order[i];
        EXPECT_GT(a.gyro_initial_bias(), b.gyro_initial_bias()) << order[i];
        EXPECT_GT(a.gyro_scale, b.gyro_scale) << order[i];
        EXPECT_GT(a.accel_noise, b.accel_noise) << order[i];
        EXPECT_GT(a.accel_bias, b.accel_bias) << order[i];
        EXPECT_GT(a.accel_initial_bias(), b.accel_initial_bias()) << order[i];
        EXPECT_GT(a.accel_misalignment, b.accel_misalignment) << order[i];
        EXPECT_GT(b.gyro_bias_time, 0.0);
    }
}

TEST(Grades, UnknownNameListsTheKnownOnes) { testing::expect_names(imu_grade_names(), "hg1700", imu_grade); }

}  // namespace
}  // namespace schuler::sensor
