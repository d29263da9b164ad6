// Linear covariance analysis of a filter whose assumptions differ from the true errors: its gains, their statistics.
#pragma once

#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/value.h"
#include "schuler/sim/exact_flight.h"

#include <Eigen/Core>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

using Variances = Eigen::Matrix<double, 9, 1>;  ///< position, velocity (north, east, down; m, m/s), attitude (rad)

/// Values at one instant.
struct MismatchRow {
    double time_s = 0.0;             ///< after the first fix
    Variances filter;                ///< stated by the filter
    std::vector<Variances> sources;  ///< contribution of each true error source
    [[nodiscard]] Variances all() const;
};

struct SourceName {
    std::string key, title;
};

struct Mismatch {
    std::string name;
    std::vector<SourceName> sources;
    std::vector<MismatchRow> rows;         ///< once per second
    std::vector<MismatchRow> outage_ends;  ///< before the use of the first fix after it
    double settled_s = 0.0;                ///< rows from here on are evaluated
    std::vector<std::string> left_out;     ///< true errors not included in the analysis
};

/// Runs the scenario without errors, at an IMU rate of at most `rate` Hz, through the filter with the scenario's assumptions, and
/// propagates the covariance of each true error source with the filter's transitions and gains. `flown`: see sim::simulate. @throws Error
[[nodiscard]] Mismatch mismatch(const settings::ScenarioConfig& scenario, const settings::SettingList& over, double rate,
                                const sim::ExactFlight* flown = nullptr);
/// The flight of such a run, for several with the same path; may be null.
[[nodiscard]] std::shared_ptr<const sim::ExactFlight> flight_of_mismatch(const settings::ScenarioConfig& scenario, double rate);

}  // namespace schuler::study
