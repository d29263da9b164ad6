#include "schuler/report/solution_stream.h"

#include <utility>

namespace schuler::report {
namespace {

/// Rows that may be queued, a few megabytes: enough for a temporarily slow disk.
constexpr std::size_t most_waiting = 16'384;
/// Minimum number of rows for waking the writer.
constexpr std::size_t worth_waking = 2'048;

}  // namespace

SolutionStream::SolutionStream(const std::filesystem::path& file) : writer_(file) {
    waiting_.reserve(most_waiting);
    thread_ = std::thread([this] { write_all(); });
}

SolutionStream::~SolutionStream() { close(); }

void SolutionStream::append(std::span<const SolutionRow> rows) {
    std::unique_lock lock(mutex_);
    emptied_.wait(lock, [&] { return waiting_.size() < most_waiting || failure_; });
    rethrow();
    waiting_.insert(waiting_.end(), rows.begin(), rows.end());
    const bool wake = waiting_.size() >= worth_waking;
    lock.unlock();
    if (wake) filled_.notify_one();
}

void SolutionStream::finish() {
    close();
    rethrow();
    writer_.commit();
}

void SolutionStream::close() {
    {
        const std::lock_guard lock(mutex_);
        closed_ = true;
    }
    filled_.notify_one();
    if (thread_.joinable()) thread_.join();
}

void SolutionStream::rethrow() {
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

void SolutionStream::write_all() {
    std::vector<SolutionRow> taken;
    taken.reserve(most_waiting);
    std::unique_lock lock(mutex_);
    for (;;) {
        filled_.wait(lock, [&] { return waiting_.size() >= worth_waking || closed_; });
        if (waiting_.empty()) return;
        std::swap(taken, waiting_);
        lock.unlock();
        emptied_.notify_one();
        std::exception_ptr failure;
        try {
            writer_.append(taken);
        } catch (...) {
            failure = std::current_exception();
        }
        taken.clear();
        lock.lock();
        if (!failure) continue;
        failure_ = std::move(failure);  // no second owner: the exception is released in the caller's thread
        waiting_.clear();
        lock.unlock();
        emptied_.notify_one();
        return;
    }
}

}  // namespace schuler::report
