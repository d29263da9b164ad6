// A log in reversed time, for a filter that runs backward: a second solution which uses the fixes still ahead of the forward one.
//
// With tau = -t a body obeys the same equations: position, attitude and specific force are unchanged, velocity and angular rate
// change sign, and so does the Earth rate (centrifugal and Coriolis terms are even in both together). The increments are
// processed in reverse order with reversed angles; gyro biases, clock drift, latency and slopes along the track change sign as
// states, accelerometer biases, scale factors, misalignments and lever arms do not. Stationary and random-walk processes are
// unchanged. The same filter therefore runs over the reversed data (the backward filter of [Fraser1969]).
#pragma once

#include "schuler/filter/settings.h"
#include "schuler/filter/states/layout.h"
#include "schuler/filter/update/timeline.h"

#include <cstddef>
#include <memory>

namespace schuler::filter {

[[nodiscard]] constexpr Time reversed(Time t) { return Time{-t.ns}; }

/// The Earth and the outages in reversed time, without smoother and further outputs.
[[nodiscard]] Settings reversed(Settings settings);

/// Data of a run in reversed time, with the recording they refer to.
struct ReversedData {
    std::unique_ptr<const Recording> recording;
    RunData data;  ///< without instants
};
/// Of the increments from `first` to `last`; all measurements.
[[nodiscard]] ReversedData reversed(const RunData& data, std::size_t first, std::size_t last);

/// 1 for each state whose error is the same in reversed time, -1 if it changes sign.
[[nodiscard]] estim::StateVector signs_in_reversed_time(const Layout& layout);

}  // namespace schuler::filter
