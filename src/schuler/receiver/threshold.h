// Loss-of-lock threshold of a channel: a study over seeds, slow by nature.
#pragma once

#include "schuler/receiver/tracker.h"

#include <limits>

namespace schuler::receiver {

struct ThresholdStudy {
    SignalStructure signal = gps_l1_ca();
    TrackingSettings tracking;
    double bandwidth = std::numeric_limits<double>::infinity();  ///< Hz, front end
    double duration = 10.0;                                      ///< s at the C/N0 under test
    int seeds = 100;
    double resolution = 0.5;      ///< dB
    double jerk_amplitude = 0.0;  ///< m/s^3 along the line of sight, a sine of 1 Hz
    bool aided = false;           ///< by the true rate with
    double aid_noise = 0.0;       ///< m/s, constant error in each run, one sigma

    /// Throws Error(Input) that names the setting.
    void check() const;
};

/// Fraction of the runs that lost the carrier (its phase error exceeded half a cycle) and the code (more than half a chip) by the
/// end. Runs start locked at 45 dB-Hz.
struct LossShares {
    double carrier = 0.0, code = 0.0;
};
[[nodiscard]] LossShares loss_shares(const ThresholdStudy& study, double db_hz);

/// C/N0 in dB-Hz at which half of the seeds lose the carrier, and the code: by bisection between 5 and 45, to the resolution.
struct LossThresholds {
    double carrier_db = 0.0, code_db = 0.0;
};
[[nodiscard]] LossThresholds loss_thresholds(const ThresholdStudy& study);

}  // namespace schuler::receiver
