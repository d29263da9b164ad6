// Position, velocity and time of one epoch from ranges alone, with detection and exclusion of faulty satellites.
#pragma once

#include "schuler/gnss/ranges.h"

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace schuler::gnss {

struct SinglePointSettings {
    RangeSettings ranges;
    bool raim = true;           ///< test the residuals and exclude outliers
    double false_alarm = 1e-4;  ///< probability of an alarm in a fault-free epoch, if the sigmas are exact
    double largest_pdop = 30.0;
};

enum class SinglePointStatus {
    Solved,
    TooFew,        ///< fewer satellites than unknowns
    WeakGeometry,  ///< PDOP beyond the limit, or no convergence
    Inconsistent,  ///< residuals too large, not resolved by any exclusion
};
[[nodiscard]] std::string_view name_of(SinglePointStatus status);

/// Status of one satellite.
struct SatelliteUse {
    SatelliteId satellite;
    Signal signal;
    Direction direction;
    double residual = 0;  ///< m, measured minus modelled
    bool used = false;
    bool excluded = false;          ///< by the fault test; other unused satellites are below the mask
    Eigen::Vector3d gain{0, 0, 0};  ///< Earth-fixed: position error per metre of range error; 0 if not used
    double slow_variance = 0;       ///< m^2, ModelledRange::slow_variance
};

struct SinglePointSolution {
    SinglePointStatus status = SinglePointStatus::TooFew;
    Time time;  ///< GPS time of the measurement: the tag minus the receiver's clock error
    Ecef position;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();       ///< m^2, Earth-fixed, of the total error
    Eigen::Matrix3d slow_covariance = Eigen::Matrix3d::Zero();  ///< m^2, of its part from the slow errors of the ranges
    std::array<double, clock_count> clock{not_given, not_given, not_given, not_given, not_given};  ///< m, of each system's clock
    Eigen::Vector3d velocity = not_given3();  ///< m/s, Earth-fixed; NaN without Doppler
    Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
    double drift = not_given;  ///< m/s, of the receiver's clock
    double statistic = 0;      ///< weighted sum of squared residuals
    int redundancy = 0;        ///< satellites minus unknowns
    double pdop = not_given;
    std::vector<SatelliteUse> satellites;

    [[nodiscard]] int used() const;
    [[nodiscard]] int excluded() const;
    /// Inter-system bias, m: the receiver's clock against that system minus that against GPS (or the first system present).
    [[nodiscard]] double intersystem_bias(std::size_t clock) const;
};

/// Weighted least squares on the ranges of one epoch, iterated to 0.1 mm. No initial position is needed: it starts at the Earth's
/// centre with weights that are robust to a minority of gross errors. Then the weighted residuals are tested against chi-square
/// [Parkinson1988]; while they fail, the satellite whose removal reduces them most is excluded.
class SinglePoint {
public:
    SinglePoint(const SatelliteSource& source, std::optional<BroadcastIonosphere> ionosphere,
                const SinglePointSettings& settings);

    /// `tag` is the epoch's time by the receiver's clock; observations of one satellite are contiguous.
    [[nodiscard]] SinglePointSolution solve(std::span<const SignalObservation> observations, Time tag,
                                            const GlonassChannels& channels);

    /// The same for ranges with known transmitters.
    [[nodiscard]] SinglePointSolution solve(std::vector<Range> ranges, Time tag);

private:
    [[nodiscard]] SinglePointSolution solve_prepared(Time tag);

    const SatelliteSource& source_;
    std::optional<BroadcastIonosphere> ionosphere_;
    SinglePointSettings settings_;
    std::vector<Range> ranges_;
};

/// Klobuchar coefficients of GPS, else those of QZSS or NavIC, which use the same form.
[[nodiscard]] std::optional<KlobucharCoefficients> klobuchar_of(const Navigation& navigation);

}  // namespace schuler::gnss
