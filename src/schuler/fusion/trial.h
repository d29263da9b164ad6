// What the trials have in common by which start, mounting and noise are found: a filter with the states that matter to them, over a part of
// the data.
#pragma once

#include "schuler/fusion/run_pass.h"

#include <cstddef>

namespace schuler::fusion {

/// Fifteen states and those of the instruments, closed loop, loose; no vehicle constraints, no integrity control, no smoother.
[[nodiscard]] Settings plain_settings(const Settings& settings);
/// Likewise with GNSS and standing still only, whose errors are white and whose times are known.
[[nodiscard]] Settings trial_settings(const Settings& settings);
/// The data without the events that such a trial has no states for.
[[nodiscard]] RunData gnss_only(const RunData& all);
/// Index of the increment that holds a time.
[[nodiscard]] std::size_t increment_at(const RunData& data, Time t);

}  // namespace schuler::fusion
