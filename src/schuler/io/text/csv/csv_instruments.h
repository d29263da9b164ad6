// Instruments with one table each: gauges.csv, log.csv and compass.csv of a survey, odometer.csv, heading.csv.
#pragma once

#include "schuler/core/instrument_logs.h"
#include "schuler/io/text/text_input.h"

#include <string>
#include <vector>

namespace schuler::io {

/// time_s, height_1_m [, height_2_m, height_3_m]; time_s, vel_x_m_s, vel_y_m_s, vel_z_m_s (forward, right, down); time_s,
/// heading_deg [, std_deg]; time_s, speed_m_s [, std_m_s]. Columns in any order, others ignored. @throws Error(Input) with the
/// line: a field that is not a number, a time that does not increase; with the column: a missing one.
[[nodiscard]] std::vector<GaugeSample> read_gauges_csv(const TextInput& input);
[[nodiscard]] std::vector<BodyVelocitySample> read_dvl_csv(const TextInput& input);
[[nodiscard]] std::vector<HeadingSample> read_compass_csv(const TextInput& input);
[[nodiscard]] std::vector<OdometerSample> read_odometer_csv(const TextInput& input);

}  // namespace schuler::io
