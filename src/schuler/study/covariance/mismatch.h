// Linear covariance of a filter's errors where the true errors are not those that it assumes: its gains, their statistics.
#pragma once

#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/value.h"

#include <Eigen/Core>

#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

using Variances = Eigen::Matrix<double, 9, 1>;  ///< position, velocity (north, east, down; m, m/s), attitude (rad)

/// At one time.
struct MismatchRow {
    double time_s = 0.0;             ///< after the first fix
    Variances filter;                ///< what the filter states
    std::vector<Variances> sources;  ///< what each true source of errors makes of it
    [[nodiscard]] Variances all() const;
};

struct SourceName {
    std::string key, title;
};

struct Mismatch {
    std::string name;
    std::vector<SourceName> sources;
    std::vector<MismatchRow> rows;         ///< once a second
    std::vector<MismatchRow> outage_ends;  ///< before the first fix after it is used
    double settled_s = 0.0;                ///< of the rows, those from here on count
    std::vector<std::string> left_out;     ///< true errors that the analysis does not have
};

/// Flies the scenario without errors, at `rate` Hz of the inertial unit at most, through the filter that assumes what the scenario says it assumes,
/// and follows the covariance of each source of true errors through the filter's transitions and gains. @throws Error
[[nodiscard]] Mismatch mismatch(const settings::ScenarioConfig& scenario, const settings::SettingList& over, double rate);

}  // namespace schuler::study
