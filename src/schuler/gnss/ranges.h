// From raw observations to ranges whose transmitter is known: what every solution with raw measurements starts from.
#pragma once

#include "schuler/core/position.h"
#include "schuler/gnss/atmosphere.h"
#include "schuler/gnss/observation.h"
#include "schuler/gnss/satellite_source.h"

#include <array>
#include <optional>
#include <span>
#include <vector>

namespace schuler::gnss {

enum class IonosphereModel {
    None,
    Broadcast,  ///< the model of each system (ionospheric_delay), scaled to each signal's frequency
    Dual,       ///< ionosphere-free combination of two signals; satellites with one signal are left out
};
enum class TroposphereModel { None, Saastamoinen };

/// How raw measurements are chosen, corrected and weighted.
struct RangeSettings {
    std::array<bool, system_count> systems{true, true, true, true, true, false, false};  ///< GRECJ
    double elevation_mask = 0.17453292519943295;                                         ///< rad
    double least_cn0 = 0;                                                                ///< dB-Hz
    IonosphereModel ionosphere = IonosphereModel::Broadcast;
    TroposphereModel troposphere = TroposphereModel::Saastamoinen;
    Mapping mapping = Mapping::Niell;
    double relative_humidity = 0.7;
    double code_sigma = 0.5;      ///< m, one sigma at the zenith with a strong signal
    double doppler_sigma = 0.05;  ///< m/s, likewise
};

/// Systems that share a clock: 0 GPS with QZSS and SBAS, 1 GLONASS, 2 Galileo, 3 BeiDou, 4 NavIC.
inline constexpr std::size_t clock_count = 5;
[[nodiscard]] std::size_t clock_of(System system);

/// One satellite's measurement. The pseudorange is free of satellite clock, group delay and, for Dual, ionosphere.
struct Range {
    SatelliteId satellite;
    Signal signal;
    Time transmit;
    double pseudorange = 0;         ///< m
    double range_rate = not_given;  ///< m/s from the Doppler, satellite clock rate removed
    double frequency = 0;           ///< Hz, for the ionosphere; 0: ionosphere-free
    double cn0 = not_given;         ///< dB-Hz
    double noise = 1;               ///< factor on the code's sigma from combining signals
    double sigma = not_given;       ///< m, of the white error of the pseudorange, where the receiver states it
    double sigma_rate = not_given;  ///< m/s, of that of the range rate, likewise
    double slow = 0;                ///< m, sigma of its slow error, what the atmosphere's models leave included; 0: not known
    Ecef position;                  ///< of the satellite at `transmit`, in Earth-fixed axes of that instant
    Eigen::Vector3d velocity{0, 0, 0};
    double variance = 0;  ///< m^2, of orbit and clock
};

/// Ranges of one epoch: one for each satellite of the systems asked for that has a signal and a healthy ephemeris. The time of
/// transmission follows from the epoch's time tag and the pseudorange: t = tag - P/c - satellite clock, whatever the receiver's clock.
void prepare_ranges(std::span<const SignalObservation> observations, Time tag, const SatelliteSource& source,
                    const GlonassChannels& channels, const RangeSettings& settings, std::vector<Range>& out);

/// What a receiver at a place should have measured, less its own clock.
struct ModelledRange {
    double range = 0;                        ///< m, with the Earth's rotation during the flight and the atmosphere
    Eigen::Vector3d line_of_sight{0, 0, 0};  ///< unit vector from the satellite to the receiver, Earth-fixed
    Direction direction;
    double variance = 0;       ///< m^2, of the whole pseudorange error
    double slow_variance = 0;  ///< m^2, of the part of it that varies slowly: orbit, clock, atmosphere
};
/// What the atmosphere adds to one satellite's pseudorange, with the variance of what the models leave, m and m^2.
struct AtmosphericDelay {
    double delay = 0, variance = 0;
};
/// `frequency` in Hz, 0: free of the ionosphere. `ionosphere` may be null: there is none.
[[nodiscard]] AtmosphericDelay atmospheric_delay(Time transmit, System system, double frequency, const Geodetic& receiver,
                                                 Direction direction, const BroadcastIonosphere* ionosphere,
                                                 const RangeSettings& settings);

/// Factor on a sigma at the zenith with a strong signal: grows towards the horizon, and with weak signals (twice for 6 dB below 45 dB-Hz).
[[nodiscard]] double noise_factor(double elevation, double cn0);

/// math.md 5.3. `ionosphere` may be null: there is none.
[[nodiscard]] ModelledRange model_range(const Range& range, const Ecef& receiver, const Geodetic& geodetic,
                                        const BroadcastIonosphere* ionosphere, const RangeSettings& settings);

/// Range rate of a receiver with a velocity, m/s, less its clock drift: with the Earth's rotation, accurate to 5 mm/s at 300 m/s.
[[nodiscard]] double model_range_rate(const Range& range, const Ecef& receiver, const Eigen::Vector3d& velocity);

/// One sigma of a Doppler range rate, m/s: the stated one where there is one.
[[nodiscard]] double range_rate_sigma(const Range& range, double elevation, const RangeSettings& settings);

}  // namespace schuler::gnss
