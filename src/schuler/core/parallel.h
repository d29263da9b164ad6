// Independent tasks distributed over the processor's cores.
#pragma once

#include <cstddef>
#include <functional>

namespace schuler {

/// Number of hardware threads, at least one.
[[nodiscard]] int hardware_jobs();

/// Calls work(k) for k = 0 .. count - 1, at most `jobs` at once (0: one per core). Each call must touch only its own data, so
/// that the result does not depend on `jobs`. progress(fraction done) is called by one thread at a time; it may be empty.
void for_each_run(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                  const std::function<void(double)>& progress);

}  // namespace schuler
