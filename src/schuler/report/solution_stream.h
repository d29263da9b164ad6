// solution.csv written beside the running filter, so that a long log at every epoch costs neither memory nor waiting.
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

/// One thread of its own formats and writes; the file appears at finish(), and without finish() nothing is left behind.
class SolutionStream {
public:
    /// Throws Error(Input) where the file cannot be made. The folder must exist.
    explicit SolutionStream(const std::filesystem::path& file);
    ~SolutionStream();
    SolutionStream(const SolutionStream&) = delete;
    SolutionStream& operator=(const SolutionStream&) = delete;

    /// Copies the rows; waits only where the writer is far behind. Throws what the writer met (a full disk).
    void append(std::span<const SolutionRow> rows);
    /// Waits for the rest and gives the file its name. Throws as append() does.
    void finish();

private:
    void write_all();
    void close();
    void rethrow();

    io::SolutionCsvWriter writer_;
    std::mutex mutex_;
    std::condition_variable filled_, emptied_;
    std::vector<SolutionRow> waiting_;  ///< handed over, not yet taken; guarded, as all below
    bool closed_ = false;
    std::exception_ptr failure_;
    std::thread thread_;
};

}  // namespace schuler::report
