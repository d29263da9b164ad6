// Pending samples of one instrument in time order, in storage of fixed size.
#pragma once

#include "schuler/core/time.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace schuler::filter::detail {

/// Indices of samples remain valid until released. The storage belongs to the caller: the filter reads it by index.
template <class Sample>
class SamplePool {
public:
    explicit SamplePool(std::size_t capacity) {
        memory.uses.resize(capacity, 0);
        memory.order.reserve(2 * capacity);
        memory.free.reserve(capacity);
        clear();
    }
    SamplePool(SamplePool&&) = default;  // move only, since a copy would not keep the capacity
    SamplePool& operator=(SamplePool&&) = default;

    void clear() {
        memory.order.clear();
        memory.first = 0;
        memory.free.clear();
        std::ranges::fill(memory.uses, std::uint8_t{0});
        for (std::size_t i = memory.uses.size(); i-- > 0;) memory.free.push_back(static_cast<std::uint32_t>(i));
    }

    [[nodiscard]] bool empty() const { return waiting() == 0; }
    [[nodiscard]] bool full() const { return memory.free.empty(); }
    [[nodiscard]] std::size_t waiting() const { return memory.order.size() - memory.first; }
    /// Index of the k-th pending sample in time order.
    [[nodiscard]] std::size_t index(std::size_t k) const { return memory.order[memory.first + k]; }

    /// True if a sample of this time is pending.
    [[nodiscard]] bool has(const std::vector<Sample>& store, Time time) const {
        if (empty() || store[memory.order.back()].time < time) return false;
        const auto at = place(store, time, false);
        return at != memory.order.end() && store[*at].time == time;
    }
    /// Inserts a sample after those of equal time and before later ones; must not be full. False if later ones are pending.
    bool insert(std::vector<Sample>& store, const Sample& sample) {
        const std::uint32_t at = memory.free.back();
        memory.free.pop_back();
        store[at] = sample;
        const bool last = empty() || store[memory.order.back()].time <= sample.time;
        if (last) memory.order.push_back(at);
        else memory.order.insert(place(store, sample.time, true), at);
        return last;
    }
    /// Removes the first pending sample. It keeps its place in the storage until released as often as it is `held`.
    std::size_t take() {
        const std::size_t at = memory.order[memory.first++];
        if (memory.first == memory.uses.size() || empty()) {  // occasional compaction
            memory.order.erase(memory.order.begin(), memory.order.begin() + static_cast<std::ptrdiff_t>(memory.first));
            memory.first = 0;
        }
        return at;
    }
    void hold(std::size_t index) { ++memory.uses[index]; }
    /// Ends one use; the last one frees the place.
    void let_go(std::size_t index) {
        if (memory.uses[index] > 0 && --memory.uses[index] > 0) return;
        memory.free.push_back(static_cast<std::uint32_t>(index));
    }

    struct Memory {
        std::vector<std::uint32_t> order, free;
        std::vector<std::uint8_t> uses;
        std::size_t first = 0;  ///< of the pending samples in `order`
    };
    Memory memory;

private:
    [[nodiscard]] std::vector<std::uint32_t>::const_iterator place(const std::vector<Sample>& store, Time time,
                                                                   bool behind) const {
        const auto begin = memory.order.begin() + static_cast<std::ptrdiff_t>(memory.first);
        return behind
                   ? std::upper_bound(begin, memory.order.end(), time, [&](Time t, std::uint32_t i) { return t < store[i].time; })
                   : std::lower_bound(begin, memory.order.end(), time,
                                      [&](std::uint32_t i, Time t) { return store[i].time < t; });
    }
};

}  // namespace schuler::filter::detail
