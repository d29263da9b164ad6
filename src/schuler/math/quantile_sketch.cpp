#include "schuler/math/quantile_sketch.h"

#include "schuler/math/quantile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace schuler::math {
namespace {

constexpr double smallest = 0x1p-100;  ///< smaller magnitudes count as zero

/// The leading bits of a number's representation increase monotonically with the number.
std::int32_t bin_of(double x, unsigned bits) {
    if (std::abs(x) < smallest) return 0;
    const auto leading = static_cast<std::int32_t>(std::bit_cast<std::uint64_t>(std::abs(x)) >> (52U - bits));
    return x < 0.0 ? -leading : leading;
}

double edge_of(std::int32_t leading, unsigned bits) {
    return std::bit_cast<double>(static_cast<std::uint64_t>(leading) << (52U - bits));
}

}  // namespace

void QuantileSketch::count_in(std::int32_t bin, std::uint64_t times) {
    const auto it = std::ranges::lower_bound(bins_, bin, {}, &std::pair<std::int32_t, std::uint64_t>::first);
    if (it != bins_.end() && it->first == bin) {
        it->second += times;
    } else {
        bins_.insert(it, {bin, times});
    }
}

void QuantileSketch::to_histogram() {
    for (const double x : values_) count_in(bin_of(x, bits_), 1);
    values_.clear();
    values_.shrink_to_fit();
}

void QuantileSketch::add(double x) {
    if (!std::isfinite(x)) return;
    low_ = count_ == 0 ? x : std::min(low_, x);
    high_ = count_ == 0 ? x : std::max(high_, x);
    ++count_;
    if (count_ <= bound_) {
        values_.push_back(x);
        return;
    }
    to_histogram();
    count_in(bin_of(x, bits_), 1);
}

void QuantileSketch::merge(const QuantileSketch& other) {
    if (other.count_ == 0) return;
    low_ = count_ == 0 ? other.low_ : std::min(low_, other.low_);
    high_ = count_ == 0 ? other.high_ : std::max(high_, other.high_);
    count_ += other.count_;
    values_.insert(values_.end(), other.values_.begin(), other.values_.end());
    for (const auto& [bin, times] : other.bins_) count_in(bin, times);
    if (count_ > bound_) to_histogram();
}

double QuantileSketch::quantile(double p) const {
    if (count_ == 0) return std::numeric_limits<double>::quiet_NaN();
    if (exact()) {
        std::vector<double> sorted = values_;
        std::ranges::sort(sorted);
        return quantile_of_sorted(sorted, p);
    }
    const double rank = p * static_cast<double>(count_ - 1);
    if (rank <= 0.0) return low_;
    if (rank >= static_cast<double>(count_ - 1)) return high_;
    double below = 0.0;
    for (const auto& [bin, times] : bins_) {
        const auto n = static_cast<double>(times);
        if (rank < below + n) {
            const double part = (rank - below + 0.5) / n;
            const double inner = bin == 0 ? 0.0 : edge_of(std::abs(bin), bits_),
                         outer = bin == 0 ? 0.0 : edge_of(std::abs(bin) + 1, bits_);
            const double x = bin < 0 ? -outer + part * (outer - inner) : inner + part * (outer - inner);
            return std::clamp(x, low_, high_);
        }
        below += n;
    }
    return high_;
}

QuantileSketch::Content QuantileSketch::content() const {
    Content out{values_, bins_, low_, high_};
    std::ranges::sort(out.values);
    return out;
}

void QuantileSketch::restore(Content content) {
    values_ = std::move(content.values);
    bins_ = std::move(content.bins);
    low_ = content.low;
    high_ = content.high;
    count_ = values_.size();
    for (const auto& bin : bins_) count_ += bin.second;
}

}  // namespace schuler::math
