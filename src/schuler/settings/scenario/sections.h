// Sections of scenario files with a separate source file.
#pragma once

#include "schuler/settings/scenario/scenario.h"

namespace schuler::settings {

/// "trajectory.*".
void add_trajectory_options(OptionTable<ScenarioConfig>& table);

/// "trajectory.survey.*", "trajectory.drape.*" and "anomaly_field.*".
void add_survey_options(OptionTable<ScenarioConfig>& table);
/// Height over the ground; empty if not set. speed: m/s. @throws Error(Input) if its file is invalid.
[[nodiscard]] std::optional<sim::Drape> drape_of(const ScenarioConfig& scenario, double speed);
/// The gravity disturbance over the ground; empty: none. The path of the scenario must already be set.
/// @throws Error(Input) if the grid is invalid or ends before the path, or the model is not installed.
[[nodiscard]] sim::GroundField field_of(const ScenarioConfig& scenario);

/// "gauges.*", "log.*" and "compass.*".
void add_instrument_scenario_options(OptionTable<ScenarioConfig>& table);

/// The path defined by the settings. @throws Error(Input) with the key.
[[nodiscard]] sim::PathSettings path_of(const ScenarioConfig& scenario);
/// Lowest height (m) of such a path if not set by the scenario.
[[nodiscard]] double ground_of(const ScenarioConfig& scenario);
[[nodiscard]] fusion::VehicleKind vehicle_of(TrajectoryType type);

/// The condition for an option of [trajectory] to have an effect, "trajectory.type: car, waypoints"; empty: always. Forms show the options of
/// the kind that is chosen by it.
[[nodiscard]] std::string_view condition_in_scenario(std::string_view key);

/// "compare.*": the comparison made by `run`.
void add_compare_options(OptionTable<ScenarioConfig>& table);

/// "montecarlo.*": runs and variations.
void add_montecarlo_options(OptionTable<ScenarioConfig>& table);

/// "ranges.*".
void add_ranging_scenario_options(OptionTable<ScenarioConfig>& table);

/// Common part of raw ranges and a simulated receiver: the frame, and satellites, masks and errors with their ephemerides.
[[nodiscard]] sim::RangingScenario ranging_frame(const ScenarioConfig& scenario);
[[nodiscard]] sim::RangingSettings ranging_settings(const ScenarioConfig& scenario);

/// "receiver.*": a receiver at correlator level.
void add_receiver_scenario_options(OptionTable<ScenarioConfig>& table);
/// Its signals, with those ranging settings.
[[nodiscard]] sim::SignalSettings signal_settings(const ScenarioConfig& scenario, const sim::RangingSettings& ranging);
/// @throws Error(Input) with the key of a setting not available for such a receiver.
void check_receiver(const ScenarioConfig& scenario);

/// "fault": sensor faults.
[[nodiscard]] Option<ScenarioConfig> fault_option();

}  // namespace schuler::settings
