#include "schuler/fusion/gnss_faults.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::fusion {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t least_fixes = 3;
constexpr double least_span = 2.0;       // s
constexpr double least_way = 5.0;        // m
constexpr double velocity_error = 0.3;   // m/s, lasting one of a stated velocity
constexpr double digits = 3.0, sigmas = 5.0;
constexpr std::size_t most_runs = 20;

bool has_position(const GnssFix& f) { return f.fix != FixType::None && std::isfinite(f.position.lat) && std::isfinite(f.position.lon); }

/// Exactly equal, or both absent.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
bool same_position(const GnssFix& a, const GnssFix& b) {
    return a.position.lat == b.position.lat && a.position.lon == b.position.lon && same(a.position.h, b.position.h);
}
bool same_velocity(const GnssFix& a, const GnssFix& b) {
    return a.velocity_n.head<2>().allFinite() && a.velocity_n.head<2>() == b.velocity_n.head<2>() && same(a.velocity_n.z(), b.velocity_n.z());
}

/// A log's fixes that have a position.
class Track {
public:
    Track(const std::vector<GnssFix>& fixes, const earth::Earth& earth) : fixes_(fixes), earth_(earth) {
        for (std::size_t i = 0; i < fixes.size(); ++i)
            if (has_position(fixes[i])) index_.push_back(i);
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = 1; k < size(); ++k) {
            const Vector2d step = way(k - 1, k).cwiseAbs();
            for (const double s : step)
                if (s > 1e-4) least = std::min(least, s);   // below: rounding of degrees
        }
        if (std::isfinite(least)) digit_ = least;
    }

    [[nodiscard]] std::size_t size() const { return index_.size(); }
    [[nodiscard]] std::size_t index(std::size_t k) const { return index_[k]; }
    [[nodiscard]] const GnssFix& fix(std::size_t k) const { return fixes_[index_[k]]; }
    [[nodiscard]] double seconds(std::size_t from, std::size_t to) const { return (fix(to).time - fix(from).time).seconds(); }
    /// North, east, m.
    [[nodiscard]] Vector2d way(std::size_t from, std::size_t to) const {
        return earth::ned_difference(earth_, fix(to).position, fix(from).position).head<2>();
    }
    /// The way by the stated velocities; those that are absent count as none.
    [[nodiscard]] Vector2d way_by_velocities(std::size_t from, std::size_t to) const {
        Vector2d sum = Vector2d::Zero();
        for (std::size_t k = from + 1; k <= to; ++k) {
            const Vector2d v = fix(k).velocity_n.head<2>();
            if (v.allFinite()) sum += v * seconds(k - 1, k);
        }
        return sum;
    }
    /// m: what two positions may differ by, and a velocity add to it in `span` seconds, without contradiction.
    [[nodiscard]] double allowed(std::size_t k, double span) const {
        const double stated = fix(k).std_position.head<2>().norm();
        const double sigma = std::isfinite(stated) ? std::clamp(stated, 0.5, 10.0) : 3.0;   // m; absurd ones are no measure
        return std::max({least_way, sigmas * sigma, digits * digit_}) + velocity_error * span;
    }

private:
    const std::vector<GnssFix>& fixes_;
    const earth::Earth& earth_;
    std::vector<std::size_t> index_;
    double digit_ = 0.0;   // m, the smallest step of the log
};

/// `run(first, last)` for every run of fixes that equal the one before; first is the one that is repeated.
template <class Same, class Run>
void for_each_run(const Track& track, Same&& same_as, Run&& run) {
    for (std::size_t first = 0, k = 1; k <= track.size(); ++k) {
        if (k < track.size() && same_as(track.fix(k - 1), track.fix(k))) continue;
        const std::size_t last = k - 1;
        if (last - first + 1 >= least_fixes && track.seconds(first, last) >= least_span) run(first, last);
        first = k;
    }
}

/// Whether positions that repeat from `first` to `last` end with a leap beyond what the track does afterwards.
bool ends_with_leap(const Track& track, std::size_t first, std::size_t last) {
    if (last + 2 >= track.size()) return false;
    const double step = track.seconds(last, last + 1), next = track.seconds(last + 1, last + 2);
    if (!(step > 0.0 && next > 0.0) || step > 0.5 * track.seconds(first, last)) return false;   // an outage: it may have moved since
    const double usual = track.way(last + 1, last + 2).norm() * step / next;
    return track.way(last, last + 1).norm() > 2.0 * track.allowed(last, step) + 3.0 * usual;
}

struct Marks {
    std::vector<bool> marked;
    std::size_t runs = 0;
    void mark(const Track& track, std::size_t first, std::size_t last) {
        for (std::size_t k = first + 1; k <= last; ++k) marked[track.index(k)] = true;
        ++runs;
    }
    /// Number of the marked, none where to hold values is the custom of this log.
    std::size_t settle(std::size_t fixes) {
        const auto count = static_cast<std::size_t>(std::ranges::count(marked, true));
        if (3 * count <= fixes && runs <= most_runs) return count;
        std::fill(marked.begin(), marked.end(), false);
        return 0;
    }
};

}  // namespace

GnssFix FrozenFixes::without(const GnssFix& fix, std::size_t index) const {
    GnssFix out = fix;
    if (!any()) return out;
    constexpr double absent = std::numeric_limits<double>::quiet_NaN();
    if (position[index]) out.position = {absent, absent, absent};
    if (velocity[index]) out.velocity_n.setConstant(absent);
    return out;
}

FrozenFixes frozen_fixes(const std::vector<GnssFix>& fixes, const earth::Earth& earth) {
    FrozenFixes out;
    const Track track(fixes, earth);
    Marks positions{std::vector<bool>(fixes.size(), false)}, velocities = positions;
    for_each_run(track, same_position, [&](std::size_t first, std::size_t last) {
        const bool led_away = track.way_by_velocities(first, last).norm() > track.allowed(first, track.seconds(first, last));
        if (led_away || ends_with_leap(track, first, last)) positions.mark(track, first, last);
    });
    for_each_run(track, same_velocity, [&](std::size_t first, std::size_t last) {
        bool along = true;   // with positions that hang
        for (std::size_t k = first + 1; k <= last; ++k) along &= positions.marked[track.index(k)];
        const Vector2d off = track.way(first, last) - track.way_by_velocities(first, last);
        if (along || off.norm() > track.allowed(first, track.seconds(first, last))) velocities.mark(track, first, last);
    });
    out.positions = positions.settle(track.size());
    out.velocities = velocities.settle(track.size());
    for (std::size_t i = 0; i < fixes.size() && !out.first; ++i)
        if (positions.marked[i] || velocities.marked[i]) out.first = fixes[i].time;
    if (!out.first) return out;
    out.position = std::move(positions.marked);
    out.velocity = std::move(velocities.marked);
    return out;
}

}  // namespace schuler::fusion
