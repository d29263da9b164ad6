// One epoch of a single-point solution looked at closely: what became of every satellite, what the geometry does to errors, and by how
// much a single fault that is not noticed may mislead.
#pragma once

#include "schuler/gnss/single_point.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace schuler::gnss {

/// Whether a satellite that was tracked took part, or why not.
enum class Fate : std::uint8_t {
    Used,
    SystemOff,    ///< of a system that is not asked for
    NoSignal,     ///< no pseudorange, or too weak (with the two-frequency combination: of two signals)
    NoEphemeris,  ///< none that is valid, or the satellite calls itself unhealthy
    BelowMask,
    Faulty,     ///< left out by the fault test
    NoSolution  ///< the epoch has no solution
};
inline constexpr std::size_t fate_count = 7;
[[nodiscard]] std::string_view name_of(Fate fate);

/// A satellite at an epoch. What is not known is NaN.
struct SatelliteView {
    SatelliteId satellite;
    Signal signal;
    Direction direction{not_given, not_given};
    double cn0 = not_given;  ///< dB-Hz
    Fate fate = Fate::NoSolution;
    double residual = not_given;       ///< m, pseudorange measured minus modelled
    double sigma = not_given;          ///< m, of the whole error of the pseudorange
    double rate_residual = not_given;  ///< m/s, likewise of the range rate from the Doppler
    double rate_sigma = not_given;     ///< m/s
};

/// Dilution of precision: the factor from a common sigma of the ranges to that of position and clock [Groves2013:9.4.3].
struct Dilution {
    double geometry = not_given, position = not_given, horizontal = not_given, vertical = not_given, time = not_given;
};

/// Bounds on the error of a position whose ranges passed the fault test although one of them is wrong, m. NaN where there is no redundancy.
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

/// A used range of a solved epoch, as geometry needs it.
struct UsedRange {
    Eigen::Vector3d line_of_sight{0, 0, 0};  ///< unit vector from the satellite to the receiver, north, east, down
    std::size_t clock = 0;                   ///< clock_of(system)
    double variance = 1.0;                   ///< m^2
};

/// Of the ranges with equal weights; `time` is that of the first clock there is. Nothing where the geometry does not determine a position.
[[nodiscard]] Dilution dilution_of(std::span<const UsedRange> ranges);

/// By weighted residuals [Walter1995]: the largest slope from a fault to the position times the threshold of the fault test, with the normal
/// errors on top. `false_alarm` is that of the test, `missed_detection` the share of faults of the worst size that it may miss, below one half.
[[nodiscard]] ProtectionLevels protection_of(std::span<const UsedRange> ranges, double false_alarm, double missed_detection);

/// Looks at epochs one after the other. `source`, `ionosphere` and `settings` as for SinglePoint.
class EpochViewer {
public:
    EpochViewer(const SatelliteSource& source, std::optional<BroadcastIonosphere> ionosphere, const SinglePointSettings& settings,
                double missed_detection);

    [[nodiscard]] EpochView view(std::span<const SignalObservation> observations, Time tag, const GlonassChannels& channels);
    /// From ranges whose transmitters are known.
    [[nodiscard]] EpochView view(std::vector<Range> ranges, Time tag);

private:
    const SatelliteSource& source_;
    std::optional<BroadcastIonosphere> ionosphere_;
    SinglePointSettings settings_;
    double missed_detection_;
    SinglePoint solver_;
};

}  // namespace schuler::gnss
