// Child processes: each run is a separate process, so that the server survives any failure of it.
#pragma once

#include "serve/confine.h"

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace schuler::serve {

enum class JobState { Waiting, Running, Done, Failed, Cancelled };
[[nodiscard]] std::string_view name_of(JobState state);

struct JobOrder {
    std::string id;  ///< unique among the known jobs
    std::filesystem::path program;
    std::vector<std::string> arguments;
    Confinement confinement;
    bool keep_output = false;      ///< standard output is the result and is not added to the log
    bool aside = false;            ///< does not wait for runs and is not reported to watchers
    std::filesystem::path result;  ///< a file that exists once the result is complete; if empty, the standard output that is kept
    double limit_s = 0.0;          ///< terminated after this time; 0: never
    std::size_t limit_bytes = 0;   ///< memory limit; 0: none
};

struct JobReport {
    std::string id;
    JobState state = JobState::Waiting;
    double progress = 0.0;  ///< 0 to 1, from lines "progress 0.5" on the child's standard error
    std::string stage;      ///< what it is doing, from lines "stage reading"
    double spent_s = 0.0;   ///< since it was started
    int exit_status = -1;   ///< of the program; -1: none
    std::string message;    ///< the last line of its error output, or how it ended
    std::string output, log;
    std::uint64_t version = 0;  ///< incremented at every change of any job
};

class Jobs {
public:
    /// `finished` is called from the supervising thread when a job has ended.
    explicit Jobs(std::size_t at_once, std::function<void(const JobReport&)> finished = {});
    ~Jobs();  ///< terminates all children
    Jobs(const Jobs&) = delete;
    Jobs& operator=(const Jobs&) = delete;

    /// Queues a job. False if one with that id is still active.
    bool start(JobOrder order);
    /// False if there is nothing to cancel.
    bool cancel(const std::string& id);
    /// Cancels all jobs aside, and those that are still started: nobody waits for an answer any more.
    void cancel_asides();
    /// Removes a job that has ended. False while it is active.
    bool forget(const std::string& id);
    [[nodiscard]] std::optional<JobReport> report(const std::string& id) const;
    [[nodiscard]] bool busy(const std::string& id) const;
    /// Waits until the job has ended and returns its report.
    [[nodiscard]] JobReport wait(const std::string& id) const;
    /// Reports (without output and log) of the jobs changed after `version`, which becomes that of the last change, also of jobs aside
    /// and of forgotten ones; waits for changes for at most a second.
    [[nodiscard]] std::vector<JobReport> changes(std::uint64_t& version) const;
    /// The current version.
    [[nodiscard]] std::uint64_t version() const;

private:
    struct Child;
    void supervise();
    void launch(Child& child);
    void read_from(Child& child, int which);
    void take_line(Child& child, const std::string& line);
    void reap(Child& child);
    void changed(Child& child);
    void wake() const;

    const std::size_t at_once_;
    const std::function<void(const JobReport&)> finished_;
    mutable std::mutex mutex_;
    mutable std::condition_variable change_;
    std::uint64_t version_ = 0;
    bool stopping_ = false, no_asides_ = false;
    int wake_[2] = {-1, -1};
    std::list<Child> children_;
    std::thread thread_;
};

}  // namespace schuler::serve
