// Errors of a solution against a reference, and their statistics.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace schuler::analysis {

/// Estimate minus reference at an epoch of the reference. NaN components: not in the reference.
struct ErrorRow {
    Time time;
    Eigen::Vector3d position;      ///< east, north, up, m
    Eigen::Vector3d velocity;      ///< east, north, up, m/s
    Eigen::Vector3d rpy;           ///< roll, pitch, heading, each in (-pi, pi], rad
    Eigen::Vector3d std_position;  ///< one sigma stated by the solution, east, north, up, m
    Eigen::Vector3d std_velocity;  ///< m/s
    Eigen::Vector3d std_rpy;       ///< rad
};

struct ErrorOptions {
    Duration max_gap = Duration::from_seconds(2.0);         ///< no interpolation between rows further apart
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();  ///< point of the reference position, body axes from the IMU, m;
                                                            ///< with a lever arm the velocity is not compared
};

/// The solution at a time between its rows (sorted by time): position by the cubic of both positions and velocities, velocity and
/// sigmas linear, attitude along the shortest rotation. If rows share a time the last of them is used. Empty outside the rows and
/// in gaps.
[[nodiscard]] std::optional<SolutionRow> solution_at(const earth::Earth& earth, std::span<const SolutionRow> rows, Time time,
                                                     Duration max_gap);

/// Estimate minus reference for two states at the same time.
[[nodiscard]] ErrorRow error_between(const earth::Earth& earth, const SolutionRow& estimate, const ReferenceSample& reference,
                                     const Eigen::Vector3d& lever_arm_b);

/// Errors at every reference epoch covered by the solution, in order.
[[nodiscard]] std::vector<ErrorRow> errors_against(const earth::Earth& earth, std::span<const SolutionRow> rows,
                                                   std::span<const ReferenceSample> reference, const ErrorOptions& options = {});

/// Statistics of a scalar error over a run: NaN if there are no values.
struct Spread {
    double rms = std::numeric_limits<double>::quiet_NaN();
    double p95 = std::numeric_limits<double>::quiet_NaN();  ///< of the absolute value, interpolated between ranks
    double max = std::numeric_limits<double>::quiet_NaN();  ///< of the absolute value
};

/// Spread of the values (NaN are omitted).
[[nodiscard]] Spread spread_of(std::vector<double> values);

/// The `errors` of summary.json in SI units.
struct ErrorSummary {
    std::size_t epochs = 0;                       ///< counted rows
    Spread east, north, up, horizontal, three_d;  ///< m
    Spread v_east, v_north, v_up;                 ///< m/s
    Spread roll, pitch, heading;                  ///< rad
};

/// Statistics of the rows from `settled` on.
[[nodiscard]] ErrorSummary summarise(std::span<const ErrorRow> rows, Time settled);

}  // namespace schuler::analysis
