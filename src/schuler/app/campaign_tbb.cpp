#include "schuler/app/campaign.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <mutex>
#include <optional>

namespace schuler::app {

void for_each_run(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                  const std::function<void(double)>& progress) {
    std::mutex mutex;
    std::size_t done = 0;
    // the arena alone could not have more threads than the processor has cores
    std::optional<tbb::global_control> limit;
    if (jobs > 0) limit.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(jobs));
    tbb::task_arena arena(jobs > 0 ? jobs : tbb::task_arena::automatic);
    arena.execute([&] {
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, count, 1),
            [&](const tbb::blocked_range<std::size_t>& range) {
                for (std::size_t k = range.begin(); k < range.end(); ++k) {
                    work(k);
                    const std::lock_guard<std::mutex> lock(mutex);
                    ++done;
                    if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
                }
            },
            tbb::simple_partitioner());
    });
}

}  // namespace schuler::app
