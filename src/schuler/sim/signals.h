// Signals at the antenna along a truth path: motion and strength of every satellite's signal, with or without jamming. Input of a
// correlator-level receiver.
#pragma once

#include "schuler/sim/ranging.h"

#include <cstddef>
#include <vector>

namespace schuler::sim {

/// A noise transmitter in the receiver's band, at rest. Carrier, chip rate and minimum power are those of GPS: GLONASS signals
/// are assumed to be jammed in their own band as strongly as those of GPS.
struct Jammer {
    Geodetic position;
    double power = 1.0;                  ///< W, isotropic
    double spread = 2.22;                ///< Q: 1 a tone, 1.5 a GPS-like signal, 2.22 noise of the code bandwidth [Kaplan2017]
    double start = 0.0, duration = 1e9;  ///< s of the scenario
};

/// Carrier-to-noise density as a function of time, linear in dB between points and constant outside.
struct StrengthPoint {
    double time = 0.0;  ///< s of the scenario
    double cn0 = 45.0;  ///< dB-Hz
};

struct SignalSettings {
    RangingSettings ranging;             ///< satellites, masks, blocking and limits, slow errors, lever arm; its rate is not used
    double cn0 = 45.0;                   ///< dB-Hz, of every satellite without jamming
    std::vector<StrengthPoint> profile;  ///< instead of it; in time order
    std::vector<Jammer> jammers;
};

/// Throws Error(Input) that names the invalid setting; ground stations and multipath are not available at correlator level.
void check(const SignalSettings& settings);

/// Range of one signal less the receiver's clock, with derivatives.
struct SignalMotion {
    double range, rate, acceleration, jerk;  ///< m, m/s, m/s^2, m/s^3
};

/// Immutable. Between samples at 20 Hz ranges are cubics with fourth-order difference slopes: errors 2e-5 m and 1e-3 m/s if a
/// vehicle goes from zero to 20 g within a second. Slow errors are those of the measured ranges and rates: the signals themselves
/// are without them. A fault of a range whose rate is wrong with it is one of the transmitted signal, code and carrier together, as of
/// the satellite's clock; the part that its rate lacks delays the code alone.
class Signals {
public:
    Signals(const RangingScenario& scenario, const TruthPath& path, const SignalSettings& settings);

    [[nodiscard]] std::size_t size() const { return tracks_.size(); }  ///< satellites in view at some time
    [[nodiscard]] gnss::SatelliteId satellite(std::size_t i) const { return tracks_[i].satellite; }
    /// `t` in seconds of the scenario.
    [[nodiscard]] SignalMotion motion(std::size_t i, double t) const;
    /// Above the masks, so that an almanac predicts reception.
    [[nodiscard]] bool in_view(std::size_t i, double t) const;
    /// Hz, including jammers; 0 if blocked or out of view.
    [[nodiscard]] double cn0(std::size_t i, double t) const;
    /// Error of the code's delay beyond the signal's motion, m.
    [[nodiscard]] double code_delay(std::size_t i, double t) const;
    /// Slow error of the range rate, m/s.
    [[nodiscard]] double rate_error(std::size_t i, double t) const;
    /// Of all jammers together against one satellite, dB; minus infinity without any.
    [[nodiscard]] double jammer_to_signal(double t) const;

private:
    struct Track {
        gnss::SatelliteId satellite;
        std::vector<double> range;      ///< m, starting two samples before the start
        std::vector<float> delay;       ///< m
        std::vector<float> rate_error;  ///< m/s; empty: none
        std::vector<char> state;        ///< 0 out of view, 1 blocked, 2 received
        std::vector<RangeFault> faults;
    };
    [[nodiscard]] std::size_t index(double t, double& part) const;

    std::vector<Track> tracks_;
    std::vector<float> clean_, jammed_;  ///< C/N0 without and with jammers, dB-Hz
    std::vector<float> ratio_;           ///< J/S, dB
};

}  // namespace schuler::sim
