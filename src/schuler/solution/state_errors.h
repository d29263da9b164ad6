// Errors of a filter's states relative to a simulated truth, by block, normalised by the filter's own covariances.
#pragma once

#include "schuler/analysis/errors.h"
#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"
#include "schuler/sim/simulate.h"

#include <Eigen/Core>

#include <array>
#include <string_view>
#include <vector>

namespace schuler::solution {

/// Truth not contained in any file of a data set: sensor errors in body axes, slow errors of receiver and barometer.
struct HiddenTruth {
    std::vector<sim::SensorTruth> sensors;
    std::vector<sim::GnssTruth> gnss;
    std::vector<sim::BaroTruth> baro;
};

/// For simulated data; the biases are rotated from sensor to body axes.
[[nodiscard]] HiddenTruth hidden_truth(const sim::SimulatedData& data, const fusion::ImuSettings& imu);

/// Blocks in the order of StateErrors.
struct StateBlockName {
    std::string_view name;  ///< in files: "position", "gyro_bias", ...
    std::array<std::string_view, 3> axis;
    std::string_view unit;  ///< of tables and files
    double si;              ///< size of that unit in SI
    int dof;
};
inline constexpr std::size_t state_blocks = 8;
[[nodiscard]] const std::array<StateBlockName, state_blocks>& state_block_names();

/// Estimate minus truth at one instant. Position, velocity, attitude (phi of the local level) and the receiver's errors: east,
/// north, up; sensor biases: body x, y, z; the barometer's bias in the first component. NaN if there is no such state or no
/// truth.
struct StateErrors {
    Time time;
    std::array<Eigen::Vector3d, state_blocks> error;  ///< SI
    std::array<double, state_blocks> nees;            ///< normalised squared by the block's covariance
};

/// One row for each state row whose time is also a time of the reference.
[[nodiscard]] std::vector<StateErrors> state_errors(const std::vector<fusion::StateRow>& rows, const earth::Earth& earth,
                                                    const std::vector<ReferenceSample>& reference, const HiddenTruth& truth);

/// Those of a trajectory without state rows (a smoothed one, the receiver's own), from its errors, parameters and sigmas: normalised
/// component by component, because it has no covariances. One row for each row of parameters at the time of an error, or for each
/// error if there are no parameters. `blocks`: Result::states.
[[nodiscard]] std::vector<StateErrors> state_errors_by_sigmas(const fusion::Trajectory& trajectory,
                                                              const std::vector<fusion::LayoutBlock>& blocks,
                                                              const std::vector<analysis::ErrorRow>& errors,
                                                              const std::vector<ReferenceSample>& reference,
                                                              const HiddenTruth& truth);

}  // namespace schuler::solution
