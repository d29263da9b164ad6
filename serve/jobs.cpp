#include "serve/jobs.h"

#include "schuler/core/error.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>

namespace schuler::serve {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::size_t largest_log = 1u << 20, largest_output = 64u << 20;
constexpr int cannot_start = 126;
constexpr std::size_t most_aside = 4;  // simultaneously; others wait for them

// Sanitizers reserve terabytes of address space.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool can_limit_memory = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool can_limit_memory = false;
#else
constexpr bool can_limit_memory = true;
#endif
#else
constexpr bool can_limit_memory = true;
#endif

void close_if_open(int& fd) {
    if (fd >= 0) close(fd);
    fd = -1;
}

bool ended(JobState s) { return s != JobState::Waiting && s != JobState::Running; }

}  // namespace

std::string_view name_of(JobState state) {
    switch (state) {
        case JobState::Waiting: return "waiting";
        case JobState::Running: return "running";
        case JobState::Done: return "done";
        case JobState::Failed: return "failed";
        case JobState::Cancelled: break;
    }
    return "cancelled";
}

struct Jobs::Child {
    JobOrder order;
    JobReport report;
    pid_t pid = -1;
    int out = -1, err = -1;
    std::string partial[2];  ///< incomplete lines of standard output and standard error
    bool cancelled = false, too_late = false;
    Clock::time_point begin{};

    [[nodiscard]] double spent_s() const {
        return report.state == JobState::Running ? std::chrono::duration<double>(Clock::now() - begin).count() : 0.0;
    }
};

Jobs::Jobs(std::size_t at_once, std::function<void(const JobReport&)> finished)
    : at_once_(at_once), finished_(std::move(finished)) {
    if (pipe2(wake_, O_CLOEXEC | O_NONBLOCK) != 0) throw computation_error("no pipe for the supervisor of runs");
    thread_ = std::thread([this] { supervise(); });
}

Jobs::~Jobs() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    wake();
    thread_.join();
    close_if_open(wake_[0]);
    close_if_open(wake_[1]);
}

void Jobs::wake() const {
    const char byte = 0;
    [[maybe_unused]] const auto written = write(wake_[1], &byte, 1);  // full: it is already awake
}

bool Jobs::start(JobOrder order) {
    const std::lock_guard lock(mutex_);
    for (auto it = children_.begin(); it != children_.end(); ++it) {
        if (it->order.id != order.id) continue;
        if (!ended(it->report.state)) return false;
        children_.erase(it);
        break;
    }
    Child& child = children_.emplace_back();
    child.report.id = order.id;
    child.order = std::move(order);
    child.cancelled = no_asides_ && child.order.aside;
    changed(child);
    wake();
    return true;
}

bool Jobs::cancel(const std::string& id) {
    const std::lock_guard lock(mutex_);
    for (Child& child : children_) {
        if (child.order.id != id || ended(child.report.state)) continue;
        child.cancelled = true;
        if (child.pid > 0) kill(-child.pid, SIGKILL);
        wake();
        return true;
    }
    return false;
}

void Jobs::cancel_asides() {
    const std::lock_guard lock(mutex_);
    no_asides_ = true;
    for (Child& child : children_) {
        if (!child.order.aside || ended(child.report.state)) continue;
        child.cancelled = true;
        if (child.pid > 0) kill(-child.pid, SIGKILL);
    }
    wake();
}

bool Jobs::forget(const std::string& id) {
    const std::lock_guard lock(mutex_);
    const auto it = std::ranges::find(children_, id, [](const Child& c) { return c.order.id; });
    if (it == children_.end()) return true;
    if (!ended(it->report.state)) return false;
    children_.erase(it);
    return true;
}

std::optional<JobReport> Jobs::report(const std::string& id) const {
    const std::lock_guard lock(mutex_);
    const auto it = std::ranges::find(children_, id, [](const Child& c) { return c.order.id; });
    if (it == children_.end()) return std::nullopt;
    JobReport out = it->report;
    out.spent_s = it->spent_s();
    return out;
}

bool Jobs::busy(const std::string& id) const {
    const auto now = report(id);
    return now && !ended(now->state);
}

JobReport Jobs::wait(const std::string& id) const {
    std::unique_lock lock(mutex_);
    for (;;) {
        const auto it = std::ranges::find(children_, id, [](const Child& c) { return c.order.id; });
        if (it == children_.end()) return {};
        if (ended(it->report.state) || stopping_) return it->report;
        change_.wait(lock);
    }
}

std::vector<JobReport> Jobs::changes(std::uint64_t& version) const {
    std::unique_lock lock(mutex_);
    change_.wait_for(lock, std::chrono::seconds(1), [&] { return stopping_ || version_ > version; });
    std::vector<JobReport> out;
    for (const Child& child : children_) {
        if (child.report.version <= version || child.order.aside) continue;
        JobReport& r = out.emplace_back();
        r.id = child.report.id;
        r.state = child.report.state;
        r.progress = child.report.progress;
        r.stage = child.report.stage;
        r.spent_s = child.spent_s();
        r.message = child.report.message;
    }
    version = version_;
    return out;
}

std::uint64_t Jobs::version() const {
    const std::lock_guard lock(mutex_);
    return version_;
}

void Jobs::changed(Child& child) {
    child.report.version = ++version_;
    change_.notify_all();
}

/// Only async-signal-safe operations between fork and exec: everything is prepared before.
void Jobs::launch(Child& child) {
    int out[2] = {-1, -1}, err[2] = {-1, -1};
    const Ruleset rules(child.order.confinement);
    std::vector<char*> arguments{const_cast<char*>(child.order.program.c_str())};
    for (std::string& a : child.order.arguments) arguments.push_back(a.data());
    arguments.push_back(nullptr);
    if (pipe2(out, O_CLOEXEC) == 0 && pipe2(err, O_CLOEXEC) == 0) child.pid = fork();
    if (child.pid == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);  // the supervising thread lives as long as the server
        setpgid(0, 0);
        const int nothing = open("/dev/null", O_RDONLY);
        const rlimit none{0, 0};
        setrlimit(RLIMIT_CORE, &none);
        const rlimit memory{child.order.limit_bytes, child.order.limit_bytes};
        if (can_limit_memory && child.order.limit_bytes > 0) setrlimit(RLIMIT_AS, &memory);
        if (dup2(nothing, 0) < 0 || dup2(out[1], 1) < 0 || dup2(err[1], 2) < 0 || !rules.enter()) _exit(cannot_start);
        execv(arguments.front(), arguments.data());
        _exit(cannot_start);
    }
    if (child.pid > 0) setpgid(child.pid, child.pid);
    close_if_open(out[1]);
    close_if_open(err[1]);
    if (child.pid < 0) {
        close_if_open(out[0]);
        close_if_open(err[0]);
        child.report.state = JobState::Failed;
        child.report.message = "the system gives no process for it";
        changed(child);
        return;
    }
    child.out = out[0];
    child.err = err[0];
    child.begin = Clock::now();
    child.report.state = JobState::Running;
    changed(child);
}

void Jobs::take_line(Child& child, const std::string& line) {
    constexpr std::string_view mark = "progress ", stage_mark = "stage ";
    JobReport& r = child.report;
    if (line.starts_with(mark)) {
        r.progress = std::clamp(std::strtod(line.c_str() + mark.size(), nullptr), 0.0, 1.0);
    } else if (line.starts_with(stage_mark) &&
               line.find_first_not_of("abcdefghijklmnopqrstuvwxyz", stage_mark.size()) == line.npos) {
        r.stage = line.substr(stage_mark.size());
    } else {
        r.log += line + "\n";
        if (r.log.size() > largest_log) r.log.erase(0, r.log.size() - largest_log / 2);
        if (line.starts_with("schuler: ")) r.message = line.substr(9);
    }
    changed(child);
}

void Jobs::read_from(Child& child, int which) {
    int& fd = which == 0 ? child.out : child.err;
    char buffer[16384];
    const ssize_t n = read(fd, buffer, sizeof buffer);
    if (n < 0 && (errno == EINTR || errno == EAGAIN)) return;
    const std::lock_guard lock(mutex_);
    if (n <= 0) {
        if (!child.partial[which].empty()) take_line(child, child.partial[which]);
        close_if_open(fd);
        return;
    }
    if (which == 0 && child.order.keep_output) {
        if (child.report.output.size() < largest_output) child.report.output.append(buffer, static_cast<std::size_t>(n));
        return;
    }
    for (const char c : std::string_view(buffer, static_cast<std::size_t>(n))) {
        if (c == '\n' || child.partial[which].size() > 4000) {
            take_line(child, child.partial[which]);
            child.partial[which].clear();
        }
        if (c != '\n') child.partial[which] += c;
    }
}

namespace {

/// The program also ends with status 1 where its complete result is not to be used: that is a verdict to be read, not a failure.
bool has_result(const JobOrder& order, const JobReport& report) {
    constexpr int not_to_be_used = 1;
    if (report.exit_status != not_to_be_used || order.aside) return false;
    std::error_code ec;
    return order.result.empty() ? !report.output.empty() : std::filesystem::is_regular_file(order.result, ec);
}

}  // namespace

void Jobs::reap(Child& child) {
    int status = 0;
    while (waitpid(child.pid, &status, 0) < 0 && errno == EINTR) {}
    JobReport r = child.report;  // both streams are closed: there is no more writer
    if (WIFEXITED(status)) r.exit_status = WEXITSTATUS(status);
    const bool done = r.exit_status == 0 || has_result(child.order, r);
    r.state = child.cancelled ? JobState::Cancelled : done ? JobState::Done : JobState::Failed;
    if (r.state == JobState::Done) r.progress = 1.0;
    if (child.cancelled) r.message = "cancelled";
    else if (child.too_late) r.message = "took too long and was ended";
    else if (WIFSIGNALED(status)) r.message = std::string("ended by the signal ") + strsignal(WTERMSIG(status));
    else if (r.exit_status == cannot_start) r.message = "the program could not be started";
    if (finished_ && !child.order.aside) finished_(r);
    const std::lock_guard lock(mutex_);
    child.pid = -1;
    child.report = std::move(r);
    changed(child);
}

void Jobs::supervise() {
    for (;;) {
        std::vector<pollfd> polled{{wake_[0], POLLIN, 0}};
        std::vector<std::pair<Child*, int>> owners{{nullptr, 0}};
        std::vector<Child*> working;
        {
            const std::lock_guard lock(mutex_);
            std::size_t running = 0, aside = 0;
            for (Child& c : children_)
                if (c.report.state == JobState::Running) ++(c.order.aside ? aside : running);
            for (Child& c : children_) {
                if (c.report.state == JobState::Waiting && (c.cancelled || stopping_)) {
                    c.report.state = JobState::Cancelled;
                    changed(c);
                } else if (c.report.state == JobState::Waiting && (c.order.aside ? aside < most_aside : running < at_once_)) {
                    launch(c);
                    ++(c.order.aside ? aside : running);
                }
                if (c.report.state != JobState::Running) continue;
                if (c.order.limit_s > 0.0 && std::chrono::duration<double>(Clock::now() - c.begin).count() > c.order.limit_s)
                    c.too_late = true;
                if (stopping_ || c.too_late || c.cancelled) kill(-c.pid, SIGKILL);
                working.push_back(&c);
            }
            if (stopping_ && working.empty()) {
                change_.notify_all();
                return;
            }
        }
        for (Child* c : working) {
            if (c->out >= 0) polled.push_back({c->out, POLLIN, 0}), owners.emplace_back(c, 0);
            if (c->err >= 0) polled.push_back({c->err, POLLIN, 0}), owners.emplace_back(c, 1);
        }
        poll(polled.data(), polled.size(), 1000);
        char drain[64];
        while (read(wake_[0], drain, sizeof drain) > 0) {}
        for (std::size_t i = 1; i < polled.size(); ++i)
            if (polled[i].revents != 0) read_from(*owners[i].first, owners[i].second);
        for (Child* c : working)
            if (c->out < 0 && c->err < 0) reap(*c);
    }
}

}  // namespace schuler::serve
