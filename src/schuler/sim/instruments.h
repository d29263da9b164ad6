// Height gauges, a body-axis velocity log and a compass along a truth path.
#pragma once

#include "schuler/core/instrument_logs.h"
#include "schuler/sim/path.h"

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace schuler::sim {

/// Rates in Hz, 0: none. Constant errors are drawn once per run, one sigma; white ones at every sample.
struct GaugeErrors {
    double rate = 0.0;
    double white = 0.05, bias = 0.0;                                     ///< m; a separate bias for each gauge
    std::vector<Eigen::Vector3d> lever_arms_b{Eigen::Vector3d::Zero()};  ///< IMU to gauge, one to three, m
};
/// The log measures (1 + scale) (v + misalignment x v), misaligned about the right and down axes.
struct LogErrors {
    double rate = 0.0;
    double white = 0.01;                                    ///< m/s
    double scale = 0.0, misalignment = 0.0;                 ///< misalignment in rad
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< IMU to log, m
};
struct CompassErrors {
    double rate = 0.0;
    double white = 0.01, bias = 0.0;  ///< rad
};
struct InstrumentErrors {
    GaugeErrors gauges;
    LogErrors log;
    CompassErrors compass;
};

/// The samples from time zero on. @throws Error(Input) that names the invalid setting.
[[nodiscard]] InstrumentLogs simulate_instruments(const InstrumentErrors& errors, const earth::Earth& earth,
                                                  const TruthPath& path, double duration, Time origin, std::uint64_t seed);

}  // namespace schuler::sim
