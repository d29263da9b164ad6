// Samples of one instrument that wait for their turn, in order of time, in a store of fixed size.
#pragma once

#include "schuler/core/time.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace schuler::filter::detail {

/// Indices of samples stay valid until they are let go. The store is another's: what the filter reads by index.
template <class Sample>
class SamplePool {
public:
    explicit SamplePool(std::size_t capacity) {
        memory.uses.resize(capacity, 0);
        memory.order.reserve(2 * capacity);
        memory.free.reserve(capacity);
        clear();
    }
    SamplePool(SamplePool&&) = default;  // a copy would have no room
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
    /// The k-th that waits, in order of time.
    [[nodiscard]] std::size_t index(std::size_t k) const { return memory.order[memory.first + k]; }

    /// Whether one of this time waits.
    [[nodiscard]] bool has(const std::vector<Sample>& store, Time time) const {
        if (empty() || store[memory.order.back()].time < time) return false;
        const auto at = place(store, time, false);
        return at != memory.order.end() && store[*at].time == time;
    }
    /// Puts a sample behind those of its time and before later ones; not full. False where later ones wait already.
    bool insert(std::vector<Sample>& store, const Sample& sample) {
        const std::uint32_t at = memory.free.back();
        memory.free.pop_back();
        store[at] = sample;
        const bool last = empty() || store[memory.order.back()].time <= sample.time;
        if (last) memory.order.push_back(at);
        else memory.order.insert(place(store, sample.time, true), at);
        return last;
    }
    /// Takes the first from those that wait. It keeps its place in the store until it is let go as often as it is `held`.
    std::size_t take() {
        const std::size_t at = memory.order[memory.first++];
        if (memory.first == memory.uses.size() || empty()) {  // moved together now and then
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
        std::size_t first = 0;  ///< of those in `order` that wait
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
