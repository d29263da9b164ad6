#include "schuler/fusion/imu_faults.h"

#include "schuler/math/quantile.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::fusion {

using Eigen::Vector3d;
using filter::Bridge;
using filter::ImuTimeline;

namespace {

/// Runs of samples, from the second of equal ones on, that repeat the one before; empty where repeating is usual.
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
        find_stuck(samples.size(), rows(0.1, 8.0), 0.05, samples.size(),
                   [&](std::size_t i) { return samples[i].*value == samples[i - 1].*value; }, stuck);
        for (int axis = 0; axis < 3; ++axis)
            find_stuck(samples.size(), rows(0.3, 20.0), 0.01, 10,
                       [&](std::size_t i) { return (samples[i].*value)(axis) == (samples[i - 1].*value)(axis); }, stuck);
    }
    count = static_cast<std::size_t>(std::ranges::count(stuck, true));
    if (2 * count > samples.size()) {   // a simulated unit at rest, noise-free; or an axis that is not there
        stuck.assign(samples.size(), false);
        count = 0;
    }
    return stuck;
}

namespace {

/// Which values of an increment are looked at: rate or specific force.
struct Quantity {
    Vector3d ImuIncrement::*integral;
    double filter::BridgeNoise::*psd;
    double least;   ///< rad, m/s: an integral wrong by less is not worth a doubt
    [[nodiscard]] Vector3d of(const ImuIncrement& i) const { return i.*integral / i.dt; }
};

struct Block {
    std::size_t first, end;
};

/// Mean square of second differences, over six: the variance of what is not smooth, however steep the motion.
double roughness(const std::vector<ImuIncrement>& increments, const Block& b, const Quantity& q) {
    double sum = 0.0;
    const std::size_t first = std::max<std::size_t>(b.first, 2);
    if (b.end <= first) return 0.0;
    Vector3d before = q.of(increments[first - 2]), last = q.of(increments[first - 1]);
    for (std::size_t i = first; i < b.end; ++i) {
        const Vector3d now = q.of(increments[i]);
        sum += (now - 2.0 * last + before).squaredNorm();
        before = last;
        last = now;
    }
    return sum / (6.0 * static_cast<double>(b.end - first));
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

/// Variance, of its worst axis, of the integral over a block of what lies outside the medians of it and its neighbours: departures of
/// one sign in a row are one error. A manoeuvre that begins or ends lies between them. Nothing where the departures are far larger than
/// what is rough: that is motion too, however steep.
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

/// Adds the noise of samples that stay at the largest value that the axis ever shows, three in a row or more, where that is rare and far
/// from what the axis usually shows.
void add_saturation(const std::vector<ImuIncrement>& increments, const Quantity& q, const std::vector<Block>& blocks,
                    std::vector<filter::BridgeNoise>& noise) {
    for (int axis = 0; axis < 3; ++axis) {
        double mean = 0.0, usual = 0.0;
        for (const auto& i : increments) mean += q.of(i)(axis) / static_cast<double>(increments.size());
        for (const auto& i : increments) usual += std::abs(q.of(i)(axis) - mean) / static_cast<double>(increments.size());
        for (const double sign : {1.0, -1.0}) {
            double limit = 0.0;   // of the departure from the mean
            for (const auto& i : increments) limit = std::max(limit, sign * (q.of(i)(axis) - mean));
            if (!(limit > 4.0 * usual && limit > 1e-6 * (1.0 + std::abs(mean)))) continue;   // an axis without noise
            const double edge = limit - 1e-9 * (limit + std::abs(mean));   // what is saturated repeats to the last digit
            std::size_t block = 0, run = 0;
            double time = 0.0;
            for (std::size_t k = 0; k <= increments.size(); ++k) {
                if (k < increments.size() && sign * (q.of(increments[k])(axis) - mean) >= edge) {
                    ++run;
                    time += increments[k].dt;
                    continue;
                }
                if (run >= 3) {
                    while (block + 1 < blocks.size() && blocks[block].end <= k - 1) ++block;
                    const double error = limit * time;
                    noise[block].*q.psd += error * error / duration(increments, blocks[block]);
                }
                run = 0;
                time = 0.0;
            }
        }
    }
}

}  // namespace

std::vector<Bridge> doubtful_stretches(const ImuTimeline& timeline) {
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
    if (blocks.size() < 40) return {};   // nothing to compare with
    std::vector<filter::BridgeNoise> noise(blocks.size());
    for (const Quantity& q : {Quantity{&ImuIncrement::dtheta, &filter::BridgeNoise::gyro_psd, 1e-3},
                              Quantity{&ImuIncrement::dv, &filter::BridgeNoise::accel_psd, 0.05}}) {
        std::vector<double> rough(blocks.size());
        for (std::size_t k = 0; k < blocks.size(); ++k) rough[k] = roughness(increments, blocks[k], q);
        std::vector<double> sorted = rough;
        const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(sorted.size()));
        std::nth_element(sorted.begin(), at, sorted.end());
        const double bulk = *at;
        for (std::size_t k = 0; k < blocks.size(); ++k) {
            if (!(rough[k] > 36.0 * bulk)) continue;
            const double variance = departure(increments, blocks, k, q, rough[k]);
            if (variance > q.least * q.least) noise[k].*q.psd += variance / duration(increments, blocks[k]);
        }
        add_saturation(increments, q, blocks, noise);
    }
    std::vector<Bridge> out;
    for (std::size_t k = 0; k < blocks.size(); ++k)
        if (noise[k].gyro_psd > 0.0 || noise[k].accel_psd > 0.0) out.push_back({blocks[k].first, blocks[k].end - 1, noise[k]});
    return out;
}

}  // namespace schuler::fusion
