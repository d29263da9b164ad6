// Completed runs of a campaign.
#pragma once

#include <cstdint>
#include <iterator>
#include <map>

namespace schuler::study {

/// A set of run numbers, stored as contiguous spans.
class RunSet {
public:
    void add(std::uint64_t run) { add(run, run + 1); }
    /// first <= run < end
    void add(std::uint64_t first, std::uint64_t end) {
        if (first >= end) return;
        auto it = spans_.upper_bound(first);
        if (it != spans_.begin() && std::prev(it)->second >= first) --it;
        while (it != spans_.end() && it->first <= end) {
            first = first < it->first ? first : it->first;
            end = end > it->second ? end : it->second;
            it = spans_.erase(it);
        }
        spans_.emplace(first, end);
    }
    [[nodiscard]] bool contains(std::uint64_t run) const {
        const auto it = spans_.upper_bound(run);
        return it != spans_.begin() && std::prev(it)->second > run;
    }
    /// The first run, starting at `run`, that is not in the set.
    [[nodiscard]] std::uint64_t first_missing(std::uint64_t run) const {
        const auto it = spans_.upper_bound(run);
        return it != spans_.begin() && std::prev(it)->second > run ? std::prev(it)->second : run;
    }
    /// The first run after `run` that is in the set, or `otherwise`.
    [[nodiscard]] std::uint64_t next_present(std::uint64_t run, std::uint64_t otherwise) const {
        const auto it = spans_.upper_bound(run);
        return it != spans_.end() && it->first < otherwise ? it->first : otherwise;
    }
    [[nodiscard]] std::uint64_t count() const {
        std::uint64_t n = 0;
        for (const auto& [first, end] : spans_) n += end - first;
        return n;
    }
    [[nodiscard]] bool overlaps(const RunSet& other) const {
        for (const auto& [first, end] : other.spans_)
            if (contains(first) || next_present(first, end) < end) return true;
        return false;
    }
    [[nodiscard]] const std::map<std::uint64_t, std::uint64_t>& spans() const { return spans_; }  ///< first run, end

private:
    std::map<std::uint64_t, std::uint64_t> spans_;
};

}  // namespace schuler::study
