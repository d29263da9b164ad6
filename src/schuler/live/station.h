// The sources of a live run: connections with their decoders, which deliver samples in the form used by the filter.
#pragma once

#include "schuler/live/decoder.h"
#include "schuler/live/input.h"
#include "schuler/live/settings.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace schuler::live {

/// One connection.
struct Station {
    Input input;
    std::unique_ptr<Decoder> decoder;
    std::array<bool, instrument_count> of{};  ///< instruments of this source
    std::array<bool, instrument_count> arrival{};
    double last_bytes = 0.0;  ///< s
    std::size_t garbage_told = 0, warnings_told = 0;
    std::size_t connections = 0;  ///< known to the decoder
};

/// One per distinct source. @throws Error(Input) if instruments share a source whose format supports a single instrument only
[[nodiscard]] std::vector<Station> stations_of(const LiveSettings& settings, const std::function<void(const std::string&)>& tell);

/// Converts samples to the filter's axes: time offsets, arrival times, magnetometer axes, pressures and heights.
class Preparation {
public:
    explicit Preparation(const LiveSettings& settings);
    void operator()(Sample& sample, const Station& station, Time arrival) const;

private:
    std::array<Duration, instrument_count> offset_{};
    Eigen::Matrix3d C_imu_mag_;  ///< axes of the magnetometer to those of the inertial unit, which the filter mounts
    double sea_level_pressure_, undulation_;
};

}  // namespace schuler::live
