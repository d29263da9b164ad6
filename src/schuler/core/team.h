// Several processes that share the work of one campaign.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace schuler {

/// A span of work: `count` items starting at `first`; no work is left if count is 0.
struct WorkSpan {
    std::size_t first = 0, count = 0;
};

/// The processes of one job, numbered from 0. Process 0 distributes the work in order of request. The program's main function creates
/// a team if it was started as several processes.
class Team {
public:
    Team() = default;
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;
    virtual ~Team() = default;

    [[nodiscard]] virtual int rank() const = 0;
    [[nodiscard]] virtual int size() const = 0;
    /// Process 0 only: answers the requests of the others from `source` until all have been notified of the end. `source` must be thread-safe.
    virtual void serve(const std::function<WorkSpan()>& source) = 0;
    /// The other processes: requests work from process 0. One thread at a time.
    [[nodiscard]] virtual WorkSpan ask() = 0;
    /// The texts of all processes, combined pairwise; complete in process 0, empty elsewhere.
    [[nodiscard]] virtual std::string combined(std::string mine,
                                               const std::function<std::string(std::string, std::string)>& combine) = 0;
    /// Barrier: waits until all processes have arrived.
    virtual void wait() = 0;
};

}  // namespace schuler
