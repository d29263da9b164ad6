// Detailed view of one epoch of a single-point solution: the status of every satellite, the effect of the geometry on errors, and the
// position error that a single undetected fault may cause.
#pragma once

#include "schuler/gnss/single_point.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace schuler::gnss {

/// Whether a tracked satellite was used, or why not.
enum class Fate : std::uint8_t {
    Used,
    SystemOff,    ///< its system is not selected
    NoSignal,     ///< no pseudorange, or too weak (with the two-frequency combination: of two signals)
    NoEphemeris,  ///< no valid ephemeris, or the satellite is marked unhealthy
    BelowMask,
    Faulty,     ///< excluded by the fault test
    NoSolution  ///< the epoch has no solution
};
inline constexpr std::size_t fate_count = 7;
[[nodiscard]] std::string_view name_of(Fate fate);

/// A satellite at an epoch. Unknown values are NaN.
struct SatelliteView {
    SatelliteId satellite;
    Signal signal;
    Direction direction{not_given, not_given};
    double cn0 = not_given;  ///< dB-Hz
    Fate fate = Fate::NoSolution;
    double residual = not_given;       ///< m, pseudorange measured minus modelled
    double sigma = not_given;          ///< m, of the total error of the pseudorange
    double rate_residual = not_given;  ///< m/s, likewise of the range rate from the Doppler
    double rate_sigma = not_given;     ///< m/s
};

/// Dilution of precision: the ratio of the position and clock sigma to a common range sigma [Groves2013:9.4.3].
struct Dilution {
    double geometry = not_given, position = not_given, horizontal = not_given, vertical = not_given, time = not_given;
};

/// Bounds of the position error if one of the ranges is faulty but passed the fault test, m. NaN without redundancy.
struct ProtectionLevels {
    double horizontal = not_given, vertical = not_given;
};

struct EpochView {
    Time tag;  ///< by the receiver's clock
    SinglePointSolution solution;
    std::vector<SatelliteView> satellites;
    Dilution dilution;
    ProtectionLevels protection;
};

/// A used range of a solved epoch, as required for geometry.
struct UsedRange {
    Eigen::Vector3d line_of_sight{0, 0, 0};  ///< unit vector from the satellite to the receiver, north, east, down
    std::size_t clock = 0;                   ///< clock_of(system)
    double variance = 1.0;                   ///< m^2
};

/// For equally weighted ranges; `time` is that of the first clock present. Undefined (NaN) if the geometry does not determine a position.
[[nodiscard]] Dilution dilution_of(std::span<const UsedRange> ranges);

/// By weighted residuals [Walter1995]: the largest slope from a fault to the position times the threshold of the fault test, plus the normal
/// errors. `false_alarm` is that of the test, `missed_detection` the probability of missing a fault of the worst size, below one half.
[[nodiscard]] ProtectionLevels protection_of(std::span<const UsedRange> ranges, double false_alarm, double missed_detection);

/// Examines consecutive epochs. `source`, `ionosphere` and `settings` as for SinglePoint.
class EpochViewer {
public:
    EpochViewer(const SatelliteSource& source, std::optional<BroadcastIonosphere> ionosphere, const SinglePointSettings& settings,
                double missed_detection);

    [[nodiscard]] EpochView view(std::span<const SignalObservation> observations, Time tag, const GlonassChannels& channels);
    /// From ranges with known transmitters.
    [[nodiscard]] EpochView view(std::vector<Range> ranges, Time tag);

private:
    const SatelliteSource& source_;
    std::optional<BroadcastIonosphere> ionosphere_;
    SinglePointSettings settings_;
    double missed_detection_;
    SinglePoint solver_;
};

}  // namespace schuler::gnss
