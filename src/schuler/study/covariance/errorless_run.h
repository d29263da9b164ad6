// A scenario flown without errors, ready for a filter that assumes them: the common part of linear analyses along a path.
#pragma once

#include "schuler/filter/states/model.h"
#include "schuler/filter/update/timeline.h"
#include "schuler/fusion/start.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/value.h"
#include "schuler/sim/exact_flight.h"
#include "schuler/solution/bundle.h"

#include <memory>

namespace schuler::study {

constexpr double slow_reference = 0.1;  // Hz: only its first epoch is used, for the initial state

/// Neither copied nor moved: `data` refers to the recording of the bundle.
struct ErrorlessRun {
    /// At an IMU rate of at most `rate` Hz. `flown`: see sim::simulate. @throws Error
    ErrorlessRun(const settings::ScenarioConfig& scenario, const settings::SettingList& over, double rate,
                 const sim::ExactFlight* flown = nullptr);
    ErrorlessRun(const ErrorlessRun&) = delete;
    ErrorlessRun& operator=(const ErrorlessRun&) = delete;

    /// Timeline and start; separate, so that settings can be refused before. Output rows once per second. @throws Error
    void prepare();
    [[nodiscard]] filter::InertialModel model() const;

    solution::ResultBundle bundle;
    fusion::Settings settings;  ///< nothing is estimated before the run
    filter::RunData data;
    filter::Start start;
};

/// What a linear analysis along a path cannot follow.
[[nodiscard]] Error unfollowed(const std::string& why);

}  // namespace schuler::study
