// Observability of a filter's states along the path of a scenario.
#pragma once

#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/value.h"

#include <Eigen/Core>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::study {

/// What the vehicle did between two measurements: the last of these that occurred.
enum class Manoeuvre : unsigned char { Rest, Straight, Climb, SpeedChange, Turn };
inline constexpr std::size_t manoeuvre_count = 5;
/// "at rest", "straight and level", "climb or descent", "change of speed", "turn".
[[nodiscard]] std::string_view name_of(Manoeuvre manoeuvre);
/// From velocity (north, east, down; m/s), its derivative (m/s^2) and the angular rate (rad/s).
[[nodiscard]] Manoeuvre manoeuvre_of(const Eigen::Vector3d& velocity, const Eigen::Vector3d& acceleration, double rate);

/// A linear combination of the initial errors, a state alone or several.
struct Observed {
    std::vector<double> weights;                   ///< of all states, in their sigmas at the start; squares add up to one
    double left = 1.0;                             ///< sigma given all measurements, relative to the one at the start
    std::array<double, manoeuvre_count> shares{};  ///< of the reduction of its variance: which measurements brought it
    double half_s = 0.0;                           ///< s after the first fix: half of the reduction is reached

    /// The one with the largest share.
    [[nodiscard]] Manoeuvre manoeuvre() const;
};

struct StateName {
    std::string name, unit;  ///< "gyro_bias_x", "rad/s"
};

struct PathObservability {
    std::string name;
    std::string scheme;  ///< the one that is followed, if it is not that of the settings
    std::vector<StateName> names;
    Eigen::VectorXd start, end;          ///< sigma of each state stated by the filter, SI
    std::vector<Observed> states;        ///< each alone
    std::vector<Observed> combinations;  ///< uncorrelated ones, the best observed first
    double duration_s = 0.0;
    std::vector<std::string> set_aside;  ///< keys that are in force and do not change what is observable
    std::size_t refused = 0;             ///< measurements: the rate of the inertial unit is too low for the path
};

/// Flies the scenario without errors through the filter that assumes them, and follows the information of each measurement about the initial
/// errors. Observability is a property of motion, states and measurements: schemes without the gains of a Kalman filter are replaced by
/// the loose or the tight one, which takes the same measurements. Slots of satellites are not among the states. @throws Error
[[nodiscard]] PathObservability path_observability(const settings::ScenarioConfig& scenario, const settings::SettingList& over,
                                                   double rate);

}  // namespace schuler::study
