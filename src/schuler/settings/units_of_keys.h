// The unit that ends a key: "imu.gyro_noise_deg_sqrt_h" is in deg/sqrt(h).
#pragma once

#include <string_view>

namespace schuler::settings {

struct KeyUnit {
    std::string_view ending;
    std::string_view plain;   ///< of files, ASCII: "deg/sqrt(h)"
    std::string_view symbol;  ///< of forms and help: "°/√h"
};

/// Empty members where the key names no unit.
[[nodiscard]] KeyUnit unit_of_key(std::string_view key);

}  // namespace schuler::settings
