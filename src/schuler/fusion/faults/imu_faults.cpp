#include "schuler/fusion/faults/imu_faults.h"

#include "schuler/math/quantile.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::fusion {

using Eigen::Vector3d;
using filter::Bridge;
using filter::ImuTimeline;

namespace {

/// Runs of samples equal to the previous one, starting with the second of them; empty if repetition is normal.
template <class Same>
void find_stuck(std::size_t n, std::size_t least, double usual, std::size_t most_runs, Same&& same, std::vector<bool>& stuck) {
    std::vector<std::pair<std::size_t, std::size_t>> runs;
    std::size_t repeats = 0, first = 0;
    for (std::size_t i = 1; i <= n; ++i) {
        if (i < n && same(i)) {
            if (first == 0) first = i;
            continue;
        }
        if (first != 0 && i - first >= 2) repeats += i - first < least ? i - first : 0;
        if (first != 0 && i - first >= least) runs.emplace_back(first, i - 1);
        first = 0;
    }
    if (static_cast<double>(repeats) > usual * static_cast<double>(n) || runs.size() > most_runs) return;
    for (const auto& [from, to] : runs)
        for (std::size_t i = from; i <= to; ++i) stuck[i] = true;
}

}  // namespace

std::vector<bool> stuck_samples(const std::vector<ImuSample>& samples, double median_dt, std::size_t& count) {
    std::vector<bool> stuck(samples.size(), false);
    const auto rows = [&](double s, double least) { return static_cast<std::size_t>(std::max(least, s / median_dt)); };
    for (Vector3d ImuSample::*value : {&ImuSample::gyro, &ImuSample::accel}) {
        find_stuck(
            samples.size(), rows(0.1, 8.0), 0.05, samples.size(),
            [&](std::size_t i) { return samples[i].*value == samples[i - 1].*value; }, stuck);
        for (int axis = 0; axis < 3; ++axis)
            find_stuck(
                samples.size(), rows(0.3, 20.0), 0.01, 10,
                [&](std::size_t i) { return (samples[i].*value)(axis) == (samples[i - 1].*value)(axis); }, stuck);
    }
    count = static_cast<std::size_t>(std::ranges::count(stuck, true));
    if (2 * count > samples.size()) {  // a simulated noise-free unit at rest; or a missing axis
        stuck.assign(samples.size(), false);
        count = 0;
    }
    return stuck;
}

namespace {

/// The examined values of an increment: rate or specific force.
struct Quantity {
    Vector3d ImuIncrement::*integral;
    double filter::BridgeNoise::*psd;
    double least;                                     ///< rad, m/s: smaller errors of the integral are ignored
    Eigen::Matrix3d C = Eigen::Matrix3d::Identity();  ///< body axes to those in which the values are examined
    [[nodiscard]] Vector3d of(const ImuIncrement& i) const { return C * (i.*integral / i.dt); }
};

struct Block {
    std::size_t first, end;
};

/// Magnitude of the second differences of a block's values.
struct Roughness {
    double variance = 0.0;  ///< their mean square over six: the variance of the non-smooth part, however steep the motion
    double robust = 0.0;    ///< the same from the smaller third of each axis, unaffected by outliers up to one sample in five
};

Roughness roughness(const std::vector<ImuIncrement>& increments, const Block& b, const Quantity& q,
                    std::array<std::vector<double>, 3>& differences) {
    constexpr double share = 0.3, of_normal = 0.385;  // of a normal distribution's sigmas, two-sided
    const std::size_t first = std::max<std::size_t>(b.first, 2);
    if (b.end <= first) return {};
    const std::size_t n = b.end - first;
    for (auto& axis : differences) axis.resize(n);
    double sum = 0.0;
    Vector3d before = q.of(increments[first - 2]), last = q.of(increments[first - 1]);
    for (std::size_t i = 0; i < n; ++i) {
        const Vector3d now = q.of(increments[first + i]), difference = now - 2.0 * last + before;
        sum += difference.squaredNorm();
        for (int axis = 0; axis < 3; ++axis) differences[static_cast<std::size_t>(axis)][i] = std::abs(difference(axis));
        before = last;
        last = now;
    }
    double robust = 0.0;
    for (auto& axis : differences) {
        const auto at = axis.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(n));
        std::nth_element(axis.begin(), at, axis.end());
        robust += *at * *at / (of_normal * of_normal);
    }
    return {sum / (6.0 * static_cast<double>(n)), robust / 6.0};
}

double duration(const std::vector<ImuIncrement>& increments, const Block& b) {
    double sum = 0.0;
    for (std::size_t i = b.first; i < b.end; ++i) sum += increments[i].dt;
    return sum;
}

double median_of(const std::vector<ImuIncrement>& increments, const Block& b, const Quantity& q, int axis) {
    std::vector<double> values(b.end - b.first);
    for (std::size_t i = b.first; i < b.end; ++i) values[i - b.first] = q.of(increments[i])(axis);
    return math::median(std::move(values));
}

/// Variance, for its worst axis, of the integral over a block of the values outside the medians of it and its neighbours:
/// successive departures of one sign are one error. The start or end of a manoeuvre lies between the medians. Empty if the
/// departures are far larger than the roughness, because that is steep motion.
double departure(const std::vector<ImuIncrement>& increments, const std::vector<Block>& blocks, std::size_t k, const Quantity& q,
                 double rough) {
    const Block& b = blocks[k];
    double worst = 0.0, square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        double low = median_of(increments, b, q, axis), high = low;
        for (const std::size_t other : {k > 0 ? k - 1 : k, k + 1 < blocks.size() ? k + 1 : k}) {
            const double middle = median_of(increments, blocks[other], q, axis);
            low = std::min(low, middle);
            high = std::max(high, middle);
        }
        double variance = 0.0, run = 0.0;
        for (std::size_t i = b.first; i < b.end; ++i) {
            const double x = q.of(increments[i])(axis), outside = x - std::clamp(x, low, high), e = outside * increments[i].dt;
            square += outside * outside / static_cast<double>(b.end - b.first);
            if (e * run <= 0.0) {
                variance += run * run;
                run = 0.0;
            }
            run += e;
        }
        worst = std::max(worst, variance + run * run);
    }
    return rough > 0.05 * square ? worst : 0.0;
}

/// Mean and extremes of the values of each axis over the log.
struct Range {
    Vector3d mean = Vector3d::Zero(), usual = Vector3d::Zero();  ///< usual: mean magnitude of the departure from the mean
    Vector3d most = Vector3d::Zero(), least = Vector3d::Zero();  ///< of the departure from the mean
};

Range range_of(const std::vector<ImuIncrement>& increments, const Quantity& q) {
    Range r;
    const double size = static_cast<double>(increments.size());
    for (const auto& i : increments) r.mean += q.of(i);
    r.mean /= size;
    for (const auto& i : increments) {
        const Vector3d departure = q.of(i) - r.mean;
        r.usual += departure.cwiseAbs();
        r.most = r.most.cwiseMax(departure);
        r.least = r.least.cwiseMin(departure);
    }
    r.usual /= size;
    return r;
}

/// The range limit of an axis in one direction, if visible in the log.
struct End {
    int axis = 0;
    double sign = 1.0, mean = 0.0;
    double limit = 0.0;  ///< of the departure from the mean
    double size = 0.0;   ///< possible error of a saturated value
    bool reached = false;

    /// Smallest departure that equals `value`: a saturated value repeats to the last digit.
    [[nodiscard]] double close(double value) const { return value - 1e-9 * (limit + std::abs(mean)); }
};

/// An end of an axis of which all samples decide: how many are at it, and how many at the next smaller value.
struct CountedEnd {
    std::size_t place;  ///< in the list of ends
    double next;
    std::size_t there = 0, below = 0;
};

/// Of an axis without noise, or with one value in most of the log: the constant value of an accelerometer axis is its limit if the
/// three together do not show gravity.
void judge_constant(End& end, const std::vector<ImuIncrement>& increments, const Quantity& q) {
    constexpr double gravity = 9.81, without_doubt = 0.3, beyond = 0.3;  // m/s^2, m/s^2, fraction of the range
    double size = 0.0;
    for (const auto& i : increments) size += q.of(i).norm() / static_cast<double>(increments.size());
    end.reached = size < gravity - without_doubt;
    end.size = beyond * std::abs(end.mean);
}

/// The ends that are reached. Values that stay at the largest one ever shown by the axis are its limit if that is rare and far from the
/// usual values, or if they are far more frequent than the next smaller value close below: a range permanently exceeded by the motion.
std::vector<End> reached_ends(const std::vector<ImuIncrement>& increments, const Quantity& q) {
    constexpr double mostly = 0.1, beyond = 0.3;  // fraction of all samples; of the range
    const Range range = range_of(increments, q);
    std::vector<End> ends;
    std::vector<CountedEnd> counted;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double sign : {1.0, -1.0}) {
            End& end = ends.emplace_back(End{axis, sign, range.mean(axis), sign > 0.0 ? range.most(axis) : -range.least(axis)});
            if (!(end.limit > 1e-6 * (1.0 + std::abs(end.mean)))) {
                if (q.integral == &ImuIncrement::dv && sign * end.mean > 0.0) judge_constant(end, increments, q);
                continue;
            }
            end.reached = end.limit > 4.0 * range.usual(axis);
            end.size = end.limit;
            if (!end.reached) counted.push_back({ends.size() - 1, -end.limit});
        }
    }
    // The samples are visited for all ends together: most of the time is the division by their intervals.
    const auto visit = [&](const auto& of_end) {
        if (counted.empty()) return;
        for (const auto& i : increments) {
            const Vector3d value = q.of(i);
            for (CountedEnd& c : counted) {
                const End& end = ends[c.place];
                of_end(c, end, end.sign * (value(end.axis) - end.mean));
            }
        }
    };
    visit([](CountedEnd& c, const End& end, double x) {
        if (x < end.close(end.limit)) c.next = std::max(c.next, x);
    });
    visit([](CountedEnd& c, const End& end, double x) {
        if (x >= end.close(end.limit)) ++c.there;
        else if (x >= end.close(c.next)) ++c.below;
    });
    for (const CountedEnd& c : counted) {
        End& end = ends[c.place];
        const bool continuous = end.limit - c.next < 0.1 * end.limit;  // the two levels of a coarse axis do not count
        end.reached = continuous && c.there >= 30 && c.there > 10 * c.below;
        // An axis that is mostly at its limit hardly departs from its mean.
        if (static_cast<double>(c.there) > mostly * static_cast<double>(increments.size()))
            end.size = std::max(end.size, beyond * std::abs(end.mean + end.sign * end.limit));
        // Nearly always at its limit, its mean is the limit, and the departure from it no measure of how near the next value is.
        const bool almost_constant = 2 * c.there > increments.size() && end.sign * end.mean > 0.0;
        if (!end.reached && almost_constant && q.integral == &ImuIncrement::dv) judge_constant(end, increments, q);
    }
    std::erase_if(ends, [](const End& end) { return !end.reached; });
    return ends;
}

/// Runs of three samples or more at each of the ends.
std::vector<std::vector<Block>> runs_at(const std::vector<ImuIncrement>& increments, const Quantity& q,
                                        const std::vector<End>& ends) {
    std::vector<std::vector<Block>> runs(ends.size());
    std::vector<std::size_t> first(ends.size(), 0);
    for (std::size_t k = 0; k <= increments.size(); ++k) {
        const Vector3d value = k < increments.size() ? q.of(increments[k]) : Vector3d::Zero();
        for (std::size_t e = 0; e < ends.size(); ++e) {
            const End& end = ends[e];
            if (k < increments.size() && end.sign * (value(end.axis) - end.mean) >= end.close(end.limit)) continue;
            if (k >= first[e] + 3) runs[e].push_back({first[e], k});
            first[e] = k + 1;
        }
    }
    return runs;
}

/// Adds the noise of samples that stay at the limit of their axis, three in a row or more: error as large again over all of that
/// time. `saturated`: those samples.
void add_saturation(const std::vector<ImuIncrement>& increments, const Quantity& q, const std::vector<Block>& blocks,
                    std::vector<filter::BridgeNoise>& noise, std::vector<bool>& saturated) {
    const std::vector<End> ends = reached_ends(increments, q);
    if (ends.empty()) return;
    const std::vector<std::vector<Block>> runs = runs_at(increments, q, ends);
    for (std::size_t e = 0; e < ends.size(); ++e) {
        std::size_t block = 0;
        for (const Block& run : runs[e]) {
            const double time = duration(increments, run);
            while (block + 1 < blocks.size() && blocks[block].end <= run.first) ++block;
            for (std::size_t b = block; b < blocks.size() && blocks[b].first < run.end; ++b) {
                const Block both{std::max(run.first, blocks[b].first), std::min(run.end, blocks[b].end)};
                if (both.end <= both.first) continue;
                noise[b].*q.psd +=
                    ends[e].size * ends[e].size * time * duration(increments, both) / duration(increments, blocks[b]);
            }
            for (std::size_t i = run.first; i < run.end; ++i) saturated[i] = true;
        }
    }
}

}  // namespace

Doubts doubtful_stretches(const ImuTimeline& timeline, const Eigen::Matrix3d& C_bs) {
    const auto& increments = timeline.increments;
    const auto length = static_cast<std::size_t>(std::max(4.0, std::round(0.5 / timeline.median_dt)));
    std::vector<Block> blocks;
    std::size_t bridge = 0;
    for (std::size_t i = 0; i < increments.size();) {
        std::size_t end = std::min(increments.size(), i + length);
        while (bridge < timeline.bridges.size() && timeline.bridges[bridge].last < i) ++bridge;
        if (bridge < timeline.bridges.size() && timeline.bridges[bridge].first < end) {
            if (timeline.bridges[bridge].first <= i) {
                i = timeline.bridges[bridge].last + 1;
                continue;
            }
            end = timeline.bridges[bridge].first;
        }
        blocks.push_back({i, end});
        i = end;
    }
    if (blocks.size() < 40) return {};  // nothing to compare with
    std::vector<filter::BridgeNoise> noise(blocks.size());
    std::vector<bool> saturated(increments.size(), false);
    std::array<std::vector<double>, 3> differences;  // of one block, kept for its memory
    for (const Quantity& q : {Quantity{&ImuIncrement::dtheta, &filter::BridgeNoise::gyro_psd, 1e-3},
                              Quantity{&ImuIncrement::dv, &filter::BridgeNoise::accel_psd, 0.05}}) {
        std::vector<double> rough(blocks.size()), robust(blocks.size());
        for (std::size_t k = 0; k < blocks.size(); ++k) {
            const Roughness r = roughness(increments, blocks[k], q, differences);
            rough[k] = r.variance;
            robust[k] = r.robust;
        }
        // More than a twentieth of the log may contain outliers; the bulk of its values must not.
        constexpr double heavy_tails = 10.0;
        const double by_values = math::quantile(std::move(robust), 0.95), by_blocks = math::quantile(rough, 0.95);
        const double bulk = by_values > 0.0 ? std::min(by_blocks, heavy_tails * by_values) : by_blocks;
        for (std::size_t k = 0; k < blocks.size(); ++k) {
            if (!(rough[k] > 36.0 * bulk)) continue;
            const double variance = departure(increments, blocks, k, q, rough[k]);
            if (variance > q.least * q.least) noise[k].*q.psd += variance / duration(increments, blocks[k]);
        }
        // The range is that of a sensor: about axes turned by a mounting its end is not one value.
        Quantity of_sensor = q;
        of_sensor.C = C_bs.transpose();
        add_saturation(increments, of_sensor, blocks, noise, saturated);
    }
    Doubts out;
    for (std::size_t k = 0; k < blocks.size(); ++k)
        if (noise[k].gyro_psd > 0.0 || noise[k].accel_psd > 0.0)
            out.stretches.push_back({blocks[k].first, blocks[k].end - 1, noise[k]});
    out.saturated = static_cast<double>(std::ranges::count(saturated, true)) / static_cast<double>(increments.size());
    return out;
}

}  // namespace schuler::fusion
