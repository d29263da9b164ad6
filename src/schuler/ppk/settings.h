// Settings of a carrier-phase solution.
#pragma once

#include "schuler/gnss/atmosphere.h"

#include <cstddef>
#include <optional>

namespace schuler::ppk {

struct ArcSettings {
    double phase_sigma = 0.003;   ///< m, at the zenith with a strong signal
    double doppler_sigma = 0.05;  ///< m/s, likewise
    double longest_gap = 10.0;    ///< s without phase that an arc may bridge; at least 1.5 intervals of the log
};

/// Models of the atmosphere over both receivers.
struct AirModel {
    std::optional<gnss::BroadcastIonosphere> ionosphere;  ///< empty: no correction
    bool troposphere = true;
    gnss::Mapping mapping = gnss::Mapping::Niell;
    double relative_humidity = 0.7;
};
struct BaseSettings {
    double longest_age = 30.0;   ///< s from the nearest epoch of the base, if there is none on the other side
    double longest_span = 60.0;  ///< s between two epochs of the base for interpolation
    double clock_walk =
        1.5e-3;  ///< m/sqrt(s), of a satellite's clock about its broadcast polynomial: 5e-12 of white frequency noise
};

/// Multipath correlates a satellite's measurement errors for a while. Of many, `apart` seconds from each other, with a first-order
/// Gauss-Markov error the first gives one unit of information about a constant and each further one (1 - rho) / (1 + rho) [Brown2012]:
/// the factor on a variance. 1 without a correlation time.
[[nodiscard]] double lasting(double apart, double correlation);

enum class Motion { Kinematic, Static };
enum class Direction { Forward, Backward, Combined };

/// Residual atmospheric errors between two receivers, one sigma.
struct AirLeft {
    double ionosphere_gradient = 1.5e-6;   ///< vertical delay on L1 per metre of baseline: quiet and moderate days
    double ionosphere_disturbed = 2.5e-6;  ///< likewise before it is estimated
    double ionosphere_time = 1800.0;       ///< s, correlation time of the estimated difference
    double ionosphere_states_from = 5e3;   ///< m of baseline from which it is estimated for each satellite
    double zenith_least = 5e-4;            ///< m, of the difference of zenith delays
    double zenith_gradient = 4e-7;         ///< per metre of baseline
    double zenith_height = 1e-5;           ///< per metre of height difference between the receivers
    double zenith_walk = 5e-5;             ///< m/sqrt(s) at ten kilometres, proportional to the baseline
};

struct IntegerSettings {
    bool use = true;
    double ratio = 3.0;                          ///< minimum ratio of second best to best squared distance
    double success = 0.999;                      ///< minimum probability of a correct fix, from the covariance
    double elevation_mask = 0.2617993877991494;  ///< rad: lower satellites remain real-valued
    double false_alarm = 1e-4;                   ///< of the test of agreement between float solution and integers
};

struct Settings {
    std::size_t frequencies = 2;
    double code_sigma = 0.5;          ///< m, at the zenith with a strong signal
    double phase_sigma = 0.003;       ///< m, likewise
    double code_correlation = 60.0;   ///< s: multipath correlation of successive codes
    double phase_correlation = 30.0;  ///< s: and of successive phases
    double phase_walk = 2e-4;         ///< m/sqrt(s), keeps real-valued ambiguities from becoming overconfident
    Motion motion = Motion::Kinematic;
    double acceleration = 10.0;  ///< m/s/sqrt(s), root of the power density of the vehicle's acceleration
    double false_alarm = 1e-6;   ///< of the test of an epoch's innovations
    Direction direction = Direction::Combined;
    bool ranges = false;  ///< Solution::ranges
    bool views = false;   ///< keep the status of each signal, EpochSolution::signals
    IntegerSettings integers;
    BaseSettings base;
    ArcSettings arcs;
    AirModel air;
    AirLeft left;
};

}  // namespace schuler::ppk
