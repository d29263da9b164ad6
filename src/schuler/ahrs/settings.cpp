#include "schuler/ahrs/settings.h"

#include "schuler/core/fail.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::ahrs {

void check_positive(std::initializer_list<std::pair<const char*, double>> settings) {
    for (const auto& [name, value] : settings) {
        if (!(value > 0.0) || !std::isfinite(value))
            fail(input_error(fmt::format("{} must be positive", name), {{}, 0, 0, name}, "give a positive number"));
    }
}

void MekfSettings::check() const {
    check_positive({{"block", block},
                    {"tilt.gyro_noise", tilt.gyro_noise},
                    {"tilt.bias_std", tilt.bias_std},
                    {"tilt.accel_bias_std", tilt.accel_bias_std},
                    {"tilt.velocity_std", tilt.velocity_std},
                    {"tilt.velocity_time", tilt.velocity_time},
                    {"tilt.rest_rate_std", tilt.rest_rate_std},
                    {"tilt.rest_velocity_std", tilt.rest_velocity_std},
                    {"tilt.gravity", tilt.gravity},
                    {"heading.field_noise", heading.field_noise},
                    {"heading.field_time", heading.field_time},
                    {"heading.place_time", heading.place_time},
                    {"rest.after", rest.after},
                    {"guard.longest_step", guard.longest_step},
                    {"guard.gap_factor", guard.gap_factor}});
}

}  // namespace schuler::ahrs
