// Signal parameters required by a tracking loop: carrier, code and symbol duration.
#pragma once

#include "schuler/gnss/satellite.h"

#include <numbers>

namespace schuler::receiver {

inline constexpr double turn = 2.0 * std::numbers::pi;  ///< rad, one cycle of the carrier

/// A code-division or frequency-division signal with a binary code of one period per millisecond.
struct SignalStructure {
    double carrier_frequency;  ///< Hz
    double chip_rate;          ///< chips/s
    int code_length;           ///< chips
    double symbol_duration;    ///< s over which the navigation message has constant sign

    [[nodiscard]] double wavelength() const { return gnss::speed_of_light / carrier_frequency; }  ///< m
    [[nodiscard]] double chip_length() const { return gnss::speed_of_light / chip_rate; }         ///< m
    [[nodiscard]] double code_period() const { return code_length / chip_rate; }                  ///< s
    /// Code Doppler in chips/s per hertz of carrier Doppler.
    [[nodiscard]] double chips_per_cycle() const { return chip_rate / carrier_frequency; }
};

/// GPS L1 C/A: 1023 chips, 50 bit/s [ISGPS200:3.3.2.3].
[[nodiscard]] SignalStructure gps_l1_ca();

/// GLONASS L1 standard accuracy, frequency number -7 to 6: 511 chips; 50 bit/s on a 100 Hz meander, so a sign lasts 10 ms
/// [GLONASSICD:3.3]. Throws Error(Input) for another number.
[[nodiscard]] SignalStructure glonass_l1_of(int channel);

/// Carrier-to-noise density from dB-Hz to Hz, and back.
[[nodiscard]] double cn0_from_db(double db_hz);
[[nodiscard]] double db_from_cn0(double cn0);

/// Signal motion relative to the receiver, clocks included, as pseudorange and its derivatives: m, m/s, m/s^2, m/s^3.
struct LineOfSight {
    double range = 0.0, rate = 0.0, acceleration = 0.0, jerk = 0.0;

    /// The same motion after `dt` s with constant jerk.
    [[nodiscard]] LineOfSight after(double dt) const;
};

}  // namespace schuler::receiver
