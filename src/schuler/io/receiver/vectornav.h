// Binary messages of VectorNav units (VN-100 to VN-310): framing, and the content that is used [VectorNavVN300].
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace schuler::io {

inline constexpr std::size_t vectornav_incomplete = SIZE_MAX;

/// Size of the message at the beginning of `bytes`, checksum included; 0 if there is none, vectornav_incomplete if its end is missing.
[[nodiscard]] std::size_t vectornav_size(std::string_view bytes);

/// Content of a message. The axes are forward-right-down unless the unit is configured for another reference frame.
struct VectorNavMessage {
    /// Where the inertial data come from, the preferred source first.
    enum class Inertial : std::uint8_t {
        Uncompensated,  ///< calibrated, without the biases estimated by the unit
        Compensated,    ///< less the biases estimated by the unit
        Increments,     ///< divided by their interval
        None
    };

    std::optional<std::int64_t> startup_ns;  ///< since power was applied
    std::optional<std::int64_t> gps_ns;      ///< GPS time
    bool awaits_gps = false;                 ///< there is a field of GPS time without a time
    Inertial inertial = Inertial::None;
    Eigen::Vector3d rate = not_given3();   ///< rad/s
    Eigen::Vector3d force = not_given3();  ///< m/s^2
    Eigen::Vector3d field = not_given3();  ///< T
    double pressure = not_given;           ///< Pa
    std::optional<GnssFix> fix;            ///< of the first receiver; its time is 0 if the message has no time of the receiver
    std::optional<NavState> solution;      ///< of the unit's own filter; without time
};

/// `message`: complete, of the size returned by vectornav_size.
[[nodiscard]] VectorNavMessage parse_vectornav(std::string_view message);

/// True if a message repeats the fix of the previous one: the unit does so until the receiver has a new one.
[[nodiscard]] bool repeats(const GnssFix& fix, const GnssFix& previous);

}  // namespace schuler::io
