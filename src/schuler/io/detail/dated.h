// Which times of a solution have a date, and how formats that count from 1970 write them.
#pragma once

#include "schuler/core/time.h"

#include <cstdint>

namespace schuler::io::detail {

/// True for GPS time; below 1983, which no log is of, times count from the start of an undated one.
[[nodiscard]] constexpr bool is_dated(Time t) { return t > Time{100'000'000'000'000'000}; }

/// Nanoseconds since 1970 UTC of a dated time; any other time as it is.
[[nodiscard]] inline std::int64_t ns_since_1970(Time t) { return is_dated(t) ? unix_from_gps(t).ns : t.ns; }

}  // namespace schuler::io::detail
