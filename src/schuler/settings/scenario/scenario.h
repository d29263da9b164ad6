// Scenario files: what is simulated, and what the filter assumes about it.
#pragma once

#include "schuler/receiver/bank.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/option_table.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/settings/scenario/published.h"
#include "schuler/sim/aids.h"
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

/// Errors of the initial state given to the filter, one sigma; NaN: the filter starts by itself.
struct InitialError {
    double level = not_given;    ///< rad
    double heading = not_given;  ///< rad
    double velocity = 0.1;       ///< m/s, each component
    double position = 1.0;       ///< m, each component
    [[nodiscard]] bool given() const { return level == level && heading == heading; }
};

/// A setting that differs from run to run of a Monte Carlo campaign.
struct Variation {
    enum class Kind { Uniform, Normal, List, Sweep };
    std::string key;
    Kind kind = Kind::Uniform;
    double first = 0.0, second = 0.0;  ///< from first to second, or mean and sigma; in the key's unit
    bool whole = false;                ///< drawn numbers are rounded to whole ones
    std::vector<Value> values;         ///< list: one of them at random; sweep: each in turn
};

/// Points of the grid of all sweeps; 1 where there is none.
[[nodiscard]] std::size_t grid_points(const std::vector<Variation>& vary);

/// Raw ranges of a scenario.
struct RangingScenarioConfig {
    double rate = 0.0;          ///< Hz; 0: none
    std::string systems = "G";  ///< nominal constellations
    std::string navigation;     ///< a file of ephemerides instead
    int week = 2300;            ///< GPS time of the start
    double second = 0.0;
    bool rinex = false;             ///< files of a receiver too
    sim::RangingSettings settings;  ///< its rate, lever arm and navigation are filled in
};

/// A receiver at correlator level, whose ranges are what it tracks.
struct ReceiverScenarioConfig {
    double rate = 0.0;  ///< Hz of its ranges; 0: no such receiver
    double cn0 = 45.0;  ///< dB-Hz
    std::vector<sim::StrengthPoint> profile;
    std::vector<sim::Jammer> jammers;
    receiver::BankSettings bank;  ///< guidance and oscillator are filled in
    double clock_flicker = 0.0;   ///< h_-1 of the oscillator, beside ranges.clock
    double clock_per_g = 0.0;     ///< its fractional frequency a g, on each axis
};

/// The ground that a path keeps its height over; not given clearance: none.
struct SurveyGround {
    double clearance = not_given;  ///< m
    double climb = 0.05;           ///< steepest, rad
    double smoothing = not_given;  ///< m; not given: ten seconds' way
    std::string file;              ///< grid of heights; empty: the hills below
    double height = 0.0;           ///< m, mean
    double amplitude = 0.0;        ///< m
    double wavelength = 10e3;      ///< m
};

/// Disturbance of gravity over the ground: a grid or a model; both empty: none.
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
    sim::RoutePath route;          ///< waypoints; of a car the coefficients only
    double heading = 0.0;          ///< rad, at the start
    std::optional<double> speed;   ///< m/s; not given: as the trajectory has it
    std::optional<double> ground;  ///< m; not given: as the trajectory suggests
    sim::FlightPhase phase;
    sim::FigureEightPath figure8;
    sim::ShipPath ship;
    sim::TablePath table;
    sim::SurveyPattern survey;
    SurveyGround survey_ground;
    AnomalyFieldConfig field;
    sim::AidErrors aids;
    RangingScenarioConfig ranging;
    ReceiverScenarioConfig receiver_channels;
    sim::RecordedPath recorded;    ///< how a recording is smoothed
    std::string file;              ///< of that recording
    std::filesystem::path folder;  ///< of the scenario file
    std::string grade = "perfect";
    std::string receiver;
    std::vector<OutageSpan> outages;             ///< of GNSS, relative to the start of the scenario
    std::optional<fusion::VehicleKind> vehicle;  ///< not given: as the trajectory suggests
    InitialError initial_error;
    std::optional<int> montecarlo_runs;
    std::vector<Variation> vary;
    Published published;
    std::vector<std::string> compared;  ///< schemes that `run` compares on this scenario
    std::vector<std::size_t>
        compared_satellites;  ///< numbers of satellites to compare with, from the first limit of the ranges on; empty: as it is
    std::vector<CompareWindow> windows;  ///< ... compared in these windows
    WindowRules window_rules;
    std::set<std::string> given;  ///< keys of the settings it was made of
    SettingList assumed;          ///< imu.* settings that the filter assumes instead of the simulated ones
    Config processing;            ///< its [filter] section
};

[[nodiscard]] const OptionTable<ScenarioConfig>& scenario_table();

/// @throws Error(Input) naming the setting's place.
[[nodiscard]] ScenarioConfig scenario_from(const SettingList& settings);
[[nodiscard]] SettingList scenario_settings(const std::filesystem::path& file, std::optional<std::uint64_t> seed);
[[nodiscard]] ScenarioConfig read_scenario(const std::filesystem::path& file, std::optional<std::uint64_t> seed);

/// Keys of what a scenario and the settings above it say to the filter, not to the simulator.
[[nodiscard]] std::set<std::string> keys_of_processing(const ScenarioConfig& scenario, const SettingList& above);

/// Built-in scenarios by name ("demo", ...), TOML text as in examples/. Empty for an unknown name.
[[nodiscard]] std::string_view built_in_scenario(std::string_view name);

}  // namespace schuler::settings
