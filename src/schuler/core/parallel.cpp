#include "schuler/core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace schuler {

int hardware_jobs() { return static_cast<int>(std::max(1U, std::thread::hardware_concurrency())); }

void for_each_run(std::size_t count, int jobs, const std::function<void(std::size_t)>& work,
                  const std::function<void(double)>& progress) {
    // Runs take seconds each, so a counter distributes them as well as any scheduler.
    std::atomic<std::size_t> next{0};
    std::mutex mutex;
    std::size_t done = 0;
    std::exception_ptr failure;
    const auto worker = [&] {
        try {
            for (std::size_t k = next++; k < count; k = next++) {
                work(k);
                const std::lock_guard<std::mutex> lock(mutex);
                ++done;
                if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
            }
        } catch (...) {
            next = count;  // the others finish their current run
            const std::lock_guard<std::mutex> lock(mutex);
            if (!failure) failure = std::current_exception();
        }
    };
    const std::size_t wanted = jobs > 0 ? static_cast<std::size_t>(jobs) : static_cast<std::size_t>(hardware_jobs());
    {
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < std::min(wanted, count); ++i) others.emplace_back(worker);
        worker();
    }
    if (failure) std::rethrow_exception(failure);
}

}  // namespace schuler
