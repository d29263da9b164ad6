// Many independent pieces of work over the processor's cores.
#pragma once

#include <cstddef>
#include <functional>

namespace schuler {

/// Threads that run at once on this machine, at least one.
[[nodiscard]] int hardware_jobs();

/// Calls work(k) for k = 0 .. count - 1, at most `jobs` at once (0: one a core). Each call must touch only what is its own, so
/// that the result does not depend on `jobs`. progress(share done) is called by one thread at a time; it may be empty.
void for_each_run(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                  const std::function<void(double)>& progress);

}  // namespace schuler
