// The unit at the end of a key, or of the name of a column: "imu.gyro_noise_deg_sqrt_h" is in deg/sqrt(h).
#pragma once

#include <string_view>

namespace schuler::settings {

struct KeyUnit {
    std::string_view ending;
    std::string_view plain;   ///< for files, ASCII: "deg/sqrt(h)"
    std::string_view symbol;  ///< for forms and help: "°/√h"
};

/// Empty members if the key has no unit.
[[nodiscard]] KeyUnit unit_of_key(std::string_view key);

}  // namespace schuler::settings
