// Quantiles of any number of values in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace schuler::math {

/// Keeps up to `bound` values exactly; beyond that, the counts of a fixed histogram: each binary order of magnitude, of either sign, in
/// 2^bits equal parts. The bins depend on the value only: the same values in any order and partition give the same sketch.
class QuantileSketch {
public:
    QuantileSketch() = default;
    QuantileSketch(std::size_t bound, unsigned bits) : bound_(bound), bits_(bits) {}

    /// Values that are not finite are ignored.
    void add(double x);
    /// The other must have the same bound and bits.
    void merge(const QuantileSketch& other);

    [[nodiscard]] std::uint64_t count() const { return count_; }
    /// True while the values are kept exactly.
    [[nodiscard]] bool exact() const { return bins_.empty(); }
    /// The p-quantile (0 to 1), linear between ranks (in the histogram: within a bin); NaN if there is no value.
    [[nodiscard]] double quantile(double p) const;

    /// The stored content, in a form independent of the order of the values.
    struct Content {
        std::vector<double> values;                                ///< ascending
        std::vector<std::pair<std::int32_t, std::uint64_t>> bins;  ///< number of the bin, count
        double low = 0.0, high = 0.0;                              ///< smallest and largest value
        [[nodiscard]] bool operator==(const Content&) const = default;
    };
    [[nodiscard]] Content content() const;
    void restore(Content content);

private:
    void count_in(std::int32_t bin, std::uint64_t times);
    void to_histogram();

    std::size_t bound_ = 1024;
    unsigned bits_ = 5;
    std::uint64_t count_ = 0;
    double low_ = 0.0, high_ = 0.0;
    std::vector<double> values_;
    std::vector<std::pair<std::int32_t, std::uint64_t>> bins_;  ///< ascending
};

}  // namespace schuler::math
