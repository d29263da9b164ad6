// Common basis of the trials that determine start, mounting and noise: a filter with the states relevant to them, over a part of
// the data.
#pragma once

#include "schuler/fusion/run_pass.h"

#include <cstddef>

namespace schuler::fusion {

/// Fifteen states and those of the instruments, closed loop, loose; no vehicle constraints, integrity control or smoother.
[[nodiscard]] Settings plain_settings(const Settings& settings);
/// The same with GNSS and zero-velocity updates only, with white errors and known latencies.
[[nodiscard]] Settings trial_settings(const Settings& settings);
/// The data without the events for which such a trial has no states.
[[nodiscard]] RunData gnss_only(const RunData& all);
/// Index of the increment that contains a given time.
[[nodiscard]] std::size_t increment_at(const RunData& data, Time t);

}  // namespace schuler::fusion
