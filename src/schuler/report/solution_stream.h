// solution.csv written while the filter runs, so that a long log at every epoch requires neither memory nor waiting.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/io/solution/solution_csv.h"

#include <condition_variable>
#include <exception>
#include <filesystem>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

namespace schuler::report {

/// A separate thread formats and writes; the file appears at finish(), and without finish() nothing remains.
class SolutionStream {
public:
    /// Throws Error(Input) if the file cannot be created. The folder must exist.
    explicit SolutionStream(const std::filesystem::path& file);
    ~SolutionStream();
    SolutionStream(const SolutionStream&) = delete;
    SolutionStream& operator=(const SolutionStream&) = delete;

    /// Copies the rows; waits only if the writer is far behind. Throws the writer's error (a full disk).
    void append(std::span<const SolutionRow> rows);
    /// Waits for the remaining rows and renames the file. Throws as append() does.
    void finish();

private:
    void write_all();
    void close();
    void rethrow();

    io::SolutionCsvWriter writer_;
    std::mutex mutex_;
    std::condition_variable filled_, emptied_;
    std::vector<SolutionRow> waiting_;  ///< passed on, not yet taken; guarded, as all below
    bool closed_ = false;
    std::exception_ptr failure_;
    std::thread thread_;
};

}  // namespace schuler::report
