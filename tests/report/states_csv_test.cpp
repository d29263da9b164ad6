// states.csv has every state beyond position, velocity and attitude, under a name with its unit.
#include "schuler/report/states_csv.h"

#include <gtest/gtest.h>

#include <array>

namespace {

using namespace schuler;

TEST(StatesCsv, ColumnsAreNamedByBlockComponentAndUnit) {
    const std::array<filter::LayoutBlock, 4> states{
        filter::LayoutBlock{"attitude", "rad", 6, 3}, filter::LayoutBlock{"accel_bias", "m/s^2", 9, 2},
        filter::LayoutBlock{"baro_bias", "m", 11, 1}, filter::LayoutBlock{"odometer_scale", "1", 12, 1}};
    const std::array<filter::ParameterRow, 2> rows{
        filter::ParameterRow{Time::from_seconds(1.5), {1e-3, -2.0, 3.25, 0.01}, {0.1, 0.2, 0.3, 1e-4}, {}},
        filter::ParameterRow{Time::from_seconds(2.5), {2e-3, -2.0, 3.5, 0.02}, {0.1, 0.2, 0.25, 1e-5}, {}}};
    EXPECT_EQ(
        report::states_csv(states, rows),
        "time_s,accel_bias_1_m_s2,std_accel_bias_1_m_s2,accel_bias_2_m_s2,std_accel_bias_2_m_s2,baro_bias_m,std_baro_bias_m,"
        "odometer_scale,std_odometer_scale\n"
        "1.500000000,0.001,0.1,-2,0.2,3.25,0.3,0.01,0.0001\n"
        "2.500000000,0.002,0.1,-2,0.2,3.5,0.25,0.02,1e-05\n");
}

}  // namespace
