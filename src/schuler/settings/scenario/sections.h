// Sections of scenario files that have a file of their own.
#pragma once

#include "schuler/settings/scenario/scenario.h"

namespace schuler::settings {

/// "trajectory.*".
void add_trajectory_options(OptionTable<ScenarioConfig>& table);

/// "trajectory.survey.*", "trajectory.drape.*" and "anomaly_field.*".
void add_survey_options(OptionTable<ScenarioConfig>& table);
/// Height over the ground; nothing where it is not set. speed: m/s. @throws Error(Input) where its file is unusable.
[[nodiscard]] std::optional<sim::Drape> drape_of(const ScenarioConfig& scenario, double speed);
/// The disturbance of gravity over the ground; empty: none. The path of the scenario is there already.
/// @throws Error(Input) where the grid is unusable or ends before the path, or the model is not installed.
[[nodiscard]] sim::GroundField field_of(const ScenarioConfig& scenario);

/// "gauges.*", "log.*" and "compass.*".
void add_aid_scenario_options(OptionTable<ScenarioConfig>& table);

/// The path that the settings mean. @throws Error(Input) with the key.
[[nodiscard]] sim::PathSettings path_of(const ScenarioConfig& scenario);
/// Lowest height (m) of such a path unless the scenario sets another.
[[nodiscard]] double ground_of(const ScenarioConfig& scenario);
[[nodiscard]] fusion::VehicleKind vehicle_of(TrajectoryType type);

/// "compare.*": what `run` compares.
void add_compare_options(OptionTable<ScenarioConfig>& table);

/// "montecarlo.*": runs and what varies.
void add_montecarlo_options(OptionTable<ScenarioConfig>& table);

/// "ranges.*".
void add_ranging_scenario_options(OptionTable<ScenarioConfig>& table);

/// What raw ranges and a simulated receiver share: the frame, and satellites, masks and errors with their ephemerides.
[[nodiscard]] sim::RangingScenario ranging_frame(const ScenarioConfig& scenario);
[[nodiscard]] sim::RangingSettings ranging_settings(const ScenarioConfig& scenario);

/// "receiver.*": a receiver at correlator level.
void add_receiver_scenario_options(OptionTable<ScenarioConfig>& table);
/// Its signals, with those ranging settings.
[[nodiscard]] sim::SignalSettings signal_settings(const ScenarioConfig& scenario, const sim::RangingSettings& ranging);
/// @throws Error(Input) with the key of what such a receiver cannot have.
void check_receiver(const ScenarioConfig& scenario);

/// "fault": what goes wrong with a sensor.
[[nodiscard]] Option<ScenarioConfig> fault_option();

}  // namespace schuler::settings
