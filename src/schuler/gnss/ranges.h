// From raw observations to ranges with known transmitters, the input of every solution with raw measurements.
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
    Dual,       ///< ionosphere-free combination of two signals; satellites with one signal are excluded
};
enum class TroposphereModel { None, Saastamoinen };

/// Selection, correction and weighting of raw measurements.
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

/// One satellite's measurement. Satellite clock, group delay and, for Dual, ionosphere have been removed from the pseudorange.
struct Range {
    SatelliteId satellite;
    Signal signal;
    Time transmit;
    double pseudorange = 0;         ///< m
    double range_rate = not_given;  ///< m/s from the Doppler, satellite clock rate removed
    double phase = not_given;       ///< m, carrier of `signal`, satellite clock removed; its number of cycles is unknown
    bool phase_lost = false;        ///< the receiver reports that the count of cycles was interrupted before this epoch
    bool half_cycle = false;        ///< it has not resolved half cycles yet
    double frequency = 0;           ///< Hz, for the ionosphere; 0: ionosphere-free
    double cn0 = not_given;         ///< dB-Hz
    double noise = 1;               ///< factor on the code's sigma from combining signals
    double sigma = not_given;       ///< m, of the white error of the pseudorange, if stated by the receiver
    double sigma_rate = not_given;  ///< m/s, of that of the range rate, likewise
    double slow = 0;                ///< m, sigma of its slow error, including the residuals of the atmosphere models; 0: unknown
    Ecef position;                  ///< of the satellite at `transmit`, in Earth-fixed axes of that instant
    Eigen::Vector3d velocity{0, 0, 0};
    double variance = 0;  ///< m^2, of orbit and clock
};

/// Ranges of one epoch: one for each satellite of the selected systems with a signal and a healthy ephemeris. The time of
/// transmission follows from the epoch's time tag and the pseudorange: t = tag - P/c - satellite clock, for any receiver clock error.
void prepare_ranges(std::span<const SignalObservation> observations, Time tag, const SatelliteSource& source,
                    const GlonassChannels& channels, const RangeSettings& settings, std::vector<Range>& out);

/// Predicted measurement of a receiver at a given position, without its clock error.
struct ModelledRange {
    double range = 0;                        ///< m, including the Earth's rotation during the light time and the atmosphere
    Eigen::Vector3d line_of_sight{0, 0, 0};  ///< unit vector from the satellite to the receiver, Earth-fixed
    Direction direction;
    double variance = 0;       ///< m^2, of the total pseudorange error
    double slow_variance = 0;  ///< m^2, of the part of it that varies slowly: orbit, clock, atmosphere
};
/// Atmospheric delay of one satellite's pseudorange and the variance of the models' residual error, m and m^2.
struct AtmosphericDelay {
    double delay = 0, variance = 0;
};
/// `frequency` in Hz, 0: ionosphere-free. `ionosphere` may be null: no ionosphere.
[[nodiscard]] AtmosphericDelay atmospheric_delay(Time transmit, System system, double frequency, const Geodetic& receiver,
                                                 Direction direction, const BroadcastIonosphere* ionosphere,
                                                 const RangeSettings& settings);

/// Factor on a sigma at the zenith with a strong signal: grows towards the horizon and for weak signals (2 at 6 dB below 45 dB-Hz).
[[nodiscard]] double noise_factor(double elevation, double cn0);

/// math.md 5.3. `ionosphere` may be null: no ionosphere.
[[nodiscard]] ModelledRange model_range(const Range& range, const Ecef& receiver, const Geodetic& geodetic,
                                        const BroadcastIonosphere* ionosphere, const RangeSettings& settings);

/// Range rate for a receiver velocity, m/s, without its clock drift: with the Earth's rotation, accurate to 5 mm/s at 300 m/s.
[[nodiscard]] double model_range_rate(const Range& range, const Ecef& receiver, const Eigen::Vector3d& velocity);

/// One sigma of a Doppler range rate, m/s: the stated value if given.
[[nodiscard]] double range_rate_sigma(const Range& range, double elevation, const RangeSettings& settings);

}  // namespace schuler::gnss
