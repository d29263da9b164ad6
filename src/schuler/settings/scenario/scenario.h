// Scenario files: the simulation, and the filter's assumptions about it.
#pragma once

#include "schuler/receiver/bank.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/option_table.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/sim/instruments.h"
#include "schuler/sim/ranging.h"
#include "schuler/sim/signals.h"
#include "schuler/sim/simulate.h"
#include "schuler/sim/survey_route.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::settings {

enum class TrajectoryType {
    Static,
    GreatCircle,
    PaperA,
    Car,
    Waypoints,
    Takeoff,
    Racetrack,
    Approach,
    Figure8,
    Ship,
    Table,
    File,
    Weave,
    Survey
};

/// Errors of the initial state given to the filter, one sigma; NaN: automatic start-up.
struct InitialError {
    double level = not_given;    ///< rad
    double heading = not_given;  ///< rad
    double velocity = 0.1;       ///< m/s, each component
    double position = 1.0;       ///< m, each component
    [[nodiscard]] bool given() const { return level == level && heading == heading; }
};

/// A setting that varies between the runs of a Monte Carlo campaign.
struct Variation {
    enum class Kind { Uniform, Normal, List, Sweep };
    std::string key;
    Kind kind = Kind::Uniform;
    double first = 0.0, second = 0.0;  ///< from first to second, or mean and sigma; in the key's unit
    bool whole = false;                ///< drawn numbers are rounded to integers
    std::vector<Value> values;         ///< list: one of them at random; sweep: each in turn
};

/// Number of grid points of all sweeps; 1 if there are none.
[[nodiscard]] std::size_t grid_points(const std::vector<Variation>& vary);

/// Raw ranges of a scenario.
struct RangingScenarioConfig {
    double rate = 0.0;          ///< Hz; 0: none
    std::string systems = "G";  ///< nominal constellations
    std::string navigation;     ///< a file of ephemerides instead
    int week = 2300;            ///< GPS week of the start
    double second = 0.0;
    bool rinex = false;             ///< also write files of a receiver
    sim::RangingSettings settings;  ///< its rate, lever arm and navigation are filled in
};

/// A receiver at correlator level, whose ranges are those it tracks.
struct ReceiverScenarioConfig {
    double rate = 0.0;  ///< Hz of its ranges; 0: no such receiver
    double cn0 = 45.0;  ///< dB-Hz
    std::vector<sim::StrengthPoint> profile;
    std::vector<sim::Jammer> jammers;
    receiver::BankSettings bank;  ///< guidance and oscillator are filled in
    bool aided = false;           ///< loops follow the solution in loose and tight coupling too
    double clock_flicker = 0.0;   ///< h_-1 of the oscillator, in addition to ranges.clock
    double clock_per_g = 0.0;     ///< its fractional frequency change per g, on each axis
    /// Error budgets: the measurements are without the channels' errors, without the receiver's clock. Its tracking is not changed.
    bool exact_channels = false, exact_clock = false;
};

/// The ground for a path at constant height above it; clearance not given: none.
struct SurveyGround {
    double clearance = not_given;  ///< m
    double climb = 0.05;           ///< steepest, rad
    double smoothing = not_given;  ///< m; not given: the distance travelled in ten seconds
    std::string file;              ///< grid of heights; empty: the hills below
    double height = 0.0;           ///< m, mean
    double amplitude = 0.0;        ///< m
    double wavelength = 10e3;      ///< m
};

/// Gravity disturbance over the ground: a grid or a model; both empty: none.
struct AnomalyFieldConfig {
    std::string file, model, folder;
};

struct ScenarioConfig {
    std::string name = "scenario";
    sim::Scenario sim;  ///< path is filled from the members below
    TrajectoryType type = TrajectoryType::Car;
    Geodetic start{0.0, 0.0, 0.0};
    bool start_given = false, standstill_given = false;
    Eigen::Vector3d attitude = Eigen::Vector3d::Zero();  ///< static: roll, pitch, heading, rad
    sim::GreatCirclePath great_circle;
    sim::PaperAPath paper_a;
    Eigen::Vector3d periods{600.0, 600.0, 600.0};
    sim::RoutePath route;          ///< waypoints; for a car only the coefficients
    double heading = 0.0;          ///< rad, initial
    std::optional<double> speed;   ///< m/s; not given: from the trajectory
    std::optional<double> ground;  ///< m; not given: derived from the trajectory
    sim::FlightPhase phase;
    sim::FigureEightPath figure8;
    sim::ShipPath ship;
    sim::TablePath table;
    sim::SurveyPattern survey;
    SurveyGround survey_ground;
    AnomalyFieldConfig field;
    sim::InstrumentErrors instruments;
    RangingScenarioConfig ranging;
    ReceiverScenarioConfig receiver_channels;
    sim::RecordedPath recorded;    ///< smoothing of a recording
    std::string file;              ///< of that recording
    std::filesystem::path folder;  ///< of the scenario file
    std::string grade = "perfect";
    std::string receiver;
    std::vector<OutageSpan> outages;             ///< of GNSS, relative to the start of the scenario
    std::optional<fusion::VehicleKind> vehicle;  ///< not given: derived from the trajectory
    InitialError initial_error;
    std::optional<int> montecarlo_runs;
    std::vector<Variation> vary;
    Published published;
    std::vector<std::string> compared;  ///< schemes compared by `run` on this scenario
    std::vector<std::size_t>
        compared_satellites;  ///< numbers of satellites to compare, applied from the first limit of the ranges; empty: unchanged
    std::vector<CompareWindow> windows;  ///< ... compared in these windows
    WindowRules window_rules;
    std::set<std::string> given;  ///< keys of the settings it was created from
    SettingList assumed;          ///< imu.* settings assumed by the filter instead of the simulated ones
    Config processing;            ///< its [filter] section
};

[[nodiscard]] const OptionTable<ScenarioConfig>& scenario_table();

/// @throws Error(Input) with the place of the setting.
[[nodiscard]] ScenarioConfig scenario_from(const SettingList& settings);
[[nodiscard]] SettingList scenario_settings(const std::filesystem::path& file, std::optional<std::uint64_t> seed);
[[nodiscard]] ScenarioConfig read_scenario(const std::filesystem::path& file, std::optional<std::uint64_t> seed);

/// Keys of a scenario and the settings above it that apply to the filter, not to the simulator.
[[nodiscard]] std::set<std::string> keys_of_processing(const ScenarioConfig& scenario, const SettingList& above);

/// Built-in scenarios by name ("demo", ...), TOML text as in examples/. Empty for an unknown name.
[[nodiscard]] std::string_view built_in_scenario(std::string_view name);

}  // namespace schuler::settings
