// Several processes that share the work of one campaign.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace schuler {

/// A span of work: `count` pieces from `first` on; none left where count is 0.
struct WorkSpan {
    std::size_t first = 0, count = 0;
};

/// The processes of one job, numbered from 0. Process 0 hands out the work, whoever asks first. The door of the program makes one where it was
/// started as several processes.
class Team {
public:
    Team() = default;
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;
    virtual ~Team() = default;

    [[nodiscard]] virtual int rank() const = 0;
    [[nodiscard]] virtual int size() const = 0;
    /// Process 0 only: answers the others out of `source` until each has been told that nothing is left. `source` must bear calls from several threads.
    virtual void serve(const std::function<WorkSpan()>& source) = 0;
    /// The others: asks process 0. One thread at a time.
    [[nodiscard]] virtual WorkSpan ask() = 0;
    /// The texts of all processes, combined in pairs; complete in process 0, empty elsewhere.
    [[nodiscard]] virtual std::string combined(std::string mine,
                                               const std::function<std::string(std::string, std::string)>& combine) = 0;
    /// Waits until all are here.
    virtual void wait() = 0;
};

}  // namespace schuler
