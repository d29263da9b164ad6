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
    bool raim = true;           ///< test the residuals and leave out what does not fit
    double false_alarm = 1e-4;  ///< probability of an alarm in an epoch without faults, were the sigmas exact
    double largest_pdop = 30.0;
};

enum class SinglePointStatus {
    Solved,
    TooFew,        ///< fewer satellites than unknowns
    WeakGeometry,  ///< PDOP beyond the limit, or no convergence
    Inconsistent,  ///< residuals too large and no exclusion mends it
};
[[nodiscard]] std::string_view name_of(SinglePointStatus status);

/// What became of one satellite.
struct SatelliteUse {
    SatelliteId satellite;
    Signal signal;
    Direction direction;
    double residual = 0;  ///< m, measured minus modelled
    bool used = false;
    bool excluded = false;          ///< by the fault test; otherwise unused ones are below the mask
    Eigen::Vector3d gain{0, 0, 0};  ///< Earth-fixed: the position's error for a metre of this range's; 0 where it is not used
    double slow_variance = 0;       ///< m^2, ModelledRange::slow_variance
};

struct SinglePointSolution {
    SinglePointStatus status = SinglePointStatus::TooFew;
    Time time;  ///< GPS time of the measurement: the tag less the receiver's clock error
    Ecef position;
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();       ///< m^2, Earth-fixed, of the whole error
    Eigen::Matrix3d slow_covariance = Eigen::Matrix3d::Zero();  ///< m^2, of its part from the slow errors of the ranges
    std::array<double, clock_count> clock{not_given, not_given, not_given, not_given, not_given};  ///< m, of each system's clock
    Eigen::Vector3d velocity = not_given3();  ///< m/s, Earth-fixed; NaN where there is no Doppler
    Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Zero();
    double drift = not_given;  ///< m/s, of the receiver's clock
    double statistic = 0;      ///< weighted sum of squared residuals
    int redundancy = 0;        ///< satellites less unknowns
    double pdop = not_given;
    std::vector<SatelliteUse> satellites;

    [[nodiscard]] int used() const;
    [[nodiscard]] int excluded() const;
    /// Inter-system bias, m: the receiver's clock against that system less the one against GPS (or the first system there is).
    [[nodiscard]] double intersystem_bias(std::size_t clock) const;
};

/// Weighted least squares on the ranges of one epoch, iterated to 0.1 mm. It needs no first position: it starts at the Earth's
/// centre with weights that let a minority of gross errors do no harm. Then the weighted residuals are tested against chi-square
/// [Parkinson1988]; while they fail, the satellite without which they are smallest is left out.
class SinglePoint {
public:
    SinglePoint(const SatelliteSource& source, std::optional<BroadcastIonosphere> ionosphere,
                const SinglePointSettings& settings);

    /// `tag` is the epoch's time by the receiver's clock; observations of one satellite stand side by side.
    [[nodiscard]] SinglePointSolution solve(std::span<const SignalObservation> observations, Time tag,
                                            const GlonassChannels& channels);

    /// The same from ranges whose transmitters are known.
    [[nodiscard]] SinglePointSolution solve(std::vector<Range> ranges, Time tag);

private:
    [[nodiscard]] SinglePointSolution solve_prepared(Time tag);

    const SatelliteSource& source_;
    std::optional<BroadcastIonosphere> ionosphere_;
    SinglePointSettings settings_;
    std::vector<Range> ranges_;
};

/// Klobuchar's coefficients of GPS, else those of QZSS or NavIC, which have the same form.
[[nodiscard]] std::optional<KlobucharCoefficients> klobuchar_of(const Navigation& navigation);

}  // namespace schuler::gnss
