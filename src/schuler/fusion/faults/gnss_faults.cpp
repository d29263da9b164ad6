#include "schuler/fusion/faults/gnss_faults.h"

#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::fusion {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::size_t least_fixes = 3;
constexpr double least_span = 2.0;      // s
constexpr double least_way = 5.0;       // m
constexpr double velocity_error = 0.3;  // m/s, persistent error of a stated velocity
constexpr double digits = 3.0, sigmas = 5.0;
constexpr std::size_t most_runs = 20;

bool has_position(const GnssFix& f) {
    return f.fix != FixType::None && std::isfinite(f.position.lat) && std::isfinite(f.position.lon);
}

/// Exactly equal, or both absent.
bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
bool same_position(const GnssFix& a, const GnssFix& b) {
    return a.position.lat == b.position.lat && a.position.lon == b.position.lon && same(a.position.h, b.position.h);
}
bool same_velocity(const GnssFix& a, const GnssFix& b) {
    return a.velocity_n.head<2>().allFinite() && a.velocity_n.head<2>() == b.velocity_n.head<2>() &&
           same(a.velocity_n.z(), b.velocity_n.z());
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
                if (s > 1e-4) least = std::min(least, s);  // below: rounding of degrees
        }
        if (std::isfinite(least)) digit_ = least;
    }

    [[nodiscard]] std::size_t size() const { return index_.size(); }
    [[nodiscard]] std::size_t index(std::size_t k) const { return index_[k]; }
    [[nodiscard]] const GnssFix& fix(std::size_t k) const { return fixes_[index_[k]]; }
    [[nodiscard]] double seconds(std::size_t from, std::size_t to) const { return (fix(to).time - fix(from).time).seconds(); }
    /// Displacement north, east, m.
    [[nodiscard]] Vector2d way(std::size_t from, std::size_t to) const {
        return earth::ned_difference(earth_, fix(to).position, fix(from).position).head<2>();
    }
    /// Displacement down, m.
    [[nodiscard]] double descent(std::size_t from, std::size_t to) const {
        return earth::ned_difference(earth_, fix(to).position, fix(from).position).z();
    }
    /// Displacement from the stated velocities; missing ones count as zero.
    [[nodiscard]] Vector2d way_by_velocities(std::size_t from, std::size_t to) const {
        Vector2d sum = Vector2d::Zero();
        for (std::size_t k = from + 1; k <= to; ++k) {
            const Vector2d v = fix(k).velocity_n.head<2>();
            if (v.allFinite()) sum += v * seconds(k - 1, k);
        }
        return sum;
    }
    /// m: possible difference of two positions, plus that of a velocity in `span` seconds, without contradiction.
    [[nodiscard]] double allowed(std::size_t k, double span) const {
        const double stated = fix(k).std_position.head<2>().norm();
        const double sigma = std::isfinite(stated) ? std::clamp(stated, 0.5, 10.0) : 3.0;  // m; absurd values are not used
        return std::max({least_way, sigmas * sigma, digits * digit_}) + velocity_error * span;
    }

private:
    const std::vector<GnssFix>& fixes_;
    const earth::Earth& earth_;
    std::vector<std::size_t> index_;
    double digit_ = 0.0;  // m, the smallest step of the log
};

/// `run(first, last)` for every run of fixes equal to the previous one; first is the repeated one.
template <class Same, class Run>
void for_each_run(const Track& track, Same&& same_as, Run&& run) {
    for (std::size_t first = 0, k = 1; k <= track.size(); ++k) {
        if (k < track.size() && same_as(track.fix(k - 1), track.fix(k))) continue;
        const std::size_t last = k - 1;
        if (last - first + 1 >= least_fixes && track.seconds(first, last) >= least_span) run(first, last);
        first = k;
    }
}

/// True if positions that repeat from `first` to `last` end with a jump inconsistent with the subsequent track.
bool ends_with_leap(const Track& track, std::size_t first, std::size_t last) {
    if (last + 2 >= track.size()) return false;
    const double step = track.seconds(last, last + 1), next = track.seconds(last + 1, last + 2);
    if (!(step > 0.0 && next > 0.0) || step > 0.5 * track.seconds(first, last))
        return false;  // an outage: it may have moved since then
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
    /// Number of marked fixes, none if holding values is normal in this log.
    std::size_t settle(std::size_t fixes) {
        const auto count = static_cast<std::size_t>(std::ranges::count(marked, true));
        if (3 * count <= fixes && runs <= most_runs) return count;
        std::fill(marked.begin(), marked.end(), false);
        return 0;
    }
};

}  // namespace

FrozenFixes frozen_fixes(const std::vector<GnssFix>& fixes, const earth::Earth& earth) {
    FrozenFixes out;
    const Track track(fixes, earth);
    Marks positions{std::vector<bool>(fixes.size(), false)}, velocities = positions;
    for_each_run(track, same_position, [&](std::size_t first, std::size_t last) {
        const bool led_away = track.way_by_velocities(first, last).norm() > track.allowed(first, track.seconds(first, last));
        if (led_away || ends_with_leap(track, first, last)) positions.mark(track, first, last);
    });
    for_each_run(track, same_velocity, [&](std::size_t first, std::size_t last) {
        bool along = true;  // together with frozen positions
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

bool has_idle_heights(const std::vector<GnssFix>& fixes, const earth::Earth& earth) {
    constexpr std::size_t enough = 50;
    constexpr double travelled = 50.0, moved = 0.1;  // m, m/s
    const Track track(fixes, earth);
    if (track.size() < enough || !std::isfinite(track.fix(0).position.h)) return false;
    double squares = 0.0, farthest = 0.0;
    std::size_t velocities = 0;
    for (std::size_t k = 0; k < track.size(); ++k) {
        if (track.fix(k).position.h != track.fix(0).position.h) return false;
        farthest = std::max(farthest, track.way(0, k).norm());
        const double down = track.fix(k).velocity_n.z();
        if (!std::isfinite(down)) continue;
        squares += down * down;
        ++velocities;
    }
    return farthest > travelled && 2 * velocities > track.size() && squares > moved * moved * static_cast<double>(velocities);
}

namespace {

enum class Direction { Horizontal, Vertical };

/// Positions minus the path from the stated velocities, north and east, or down. Constant if both are correct.
class Misclosure {
public:
    Misclosure(const std::vector<GnssFix>& fixes, const earth::Earth& earth, Direction direction)
        : vertical_(direction == Direction::Vertical), track_(fixes, earth) {
        const std::size_t n = track_.size();
        off_.assign(n, Vector2d::Zero());
        broken_.assign(n, false);
        std::vector<double> steps, drifts;
        for (std::size_t k = 1; k < n; ++k) {
            const double dt = track_.seconds(k - 1, k);
            const Vector2d way = vertical_ ? Vector2d(track_.descent(k - 1, k), 0.0) : track_.way(k - 1, k);
            broken_[k] =
                !(dt > 0.0 && dt < longest_step && way.allFinite() && velocity(k - 1).allFinite() && velocity(k).allFinite());
            if (broken_[k]) continue;
            off_[k] = off_[k - 1] + way - 0.5 * dt * (velocity(k - 1) + velocity(k));
            steps.push_back((off_[k] - off_[k - 1]).norm());
        }
        for (std::size_t from = 0, k = 1; k < n; ++k) {
            if (broken_[k]) from = k;
            if (track_.seconds(from, k) < drift_span) continue;
            drifts.push_back((off_[k] - off_[from]).norm() / track_.seconds(from, k));
            from = k;
        }
        if (!steps.empty()) scatter_ = math::median(std::move(steps));
        if (!drifts.empty()) drift_ = std::clamp(2.0 * math::median(std::move(drifts)), 0.01, 0.1);
    }

    [[nodiscard]] const Track& track() const { return track_; }
    /// True if the step to k is a jump of the positions.
    [[nodiscard]] bool leaps(std::size_t k) const {
        if (broken_[k]) return false;
        const double late = latency * (velocity(k) - velocity(k - 1)).norm();
        return (off_[k] - off_[k - 1]).norm() > std::max(3.0, sigmas * std::sqrt(2.0) * noise(k)) + late;
    }
    /// The last fix before `back` that agrees with the track after `back`; if none within two minutes: `back` itself.
    [[nodiscard]] std::size_t left(std::size_t back) const {
        if (back + around > track_.size()) return back;
        Vector2d level;
        for (int axis = 0; axis < 2; ++axis) {
            std::vector<double> values;
            for (std::size_t k = back; k < back + around; ++k) values.push_back(off_[k](axis));
            level(axis) = math::median(std::move(values));
        }
        const auto at_level = [&](std::size_t k) { return (off_[k] - level).norm() <= agreed(back, k); };
        if (!held(back, at_level)) return back;
        for (std::size_t k = back; k-- > around && !broken_[k + 1] && track_.seconds(k, back) < longest;)
            if (k + 1 < back && at_level(k) && held(k + 1 - around, at_level)) return onset(k, back, level);
        return back;
    }

    /// True if the positions of an interval are not merely at another level, which would be a jump and its reversal.
    [[nodiscard]] bool wanders(std::size_t first, std::size_t last) const {
        return (off_[last] - off_[first]).norm() > agreed(first, last);
    }

private:
    static constexpr double longest_step = 3.0, longest = 120.0, drift_span = 30.0;  // s
    static constexpr double latency = 0.5;                                           // s, of position relative to velocity
    static constexpr std::size_t around = 5;

    [[nodiscard]] Vector2d velocity(std::size_t k) const {
        const Vector3d& v = track_.fix(k).velocity_n;
        return vertical_ ? Vector2d(v.z(), 0.0) : Vector2d(v.head<2>());
    }
    [[nodiscard]] double noise(std::size_t k) const {
        const Vector3d& sigma = track_.fix(k).std_position;
        const double stated = vertical_ ? sigma.z() : sigma.head<2>().norm();
        return std::max(scatter_, std::isfinite(stated) ? std::min(stated, 10.0) : 0.0);
    }
    [[nodiscard]] double agreed(std::size_t back, std::size_t k) const {
        return std::max(1.0, 0.5 * sigmas * noise(back)) + drift_ * std::abs(track_.seconds(k, back));
    }
    template <class At>
    [[nodiscard]] bool held(std::size_t first, At&& at_level) const {
        std::size_t n = 0;
        for (std::size_t k = first; k < first + around; ++k) n += at_level(k) ? 1 : 0;
        return n + 1 >= around;
    }
    /// Gradual departure starts before it was detected: traces the path back to its start.
    [[nodiscard]] std::size_t onset(std::size_t k, std::size_t back, const Vector2d& level) const {
        const double span = track_.seconds(k, back - 1), way = (off_[back - 1] - level).norm();
        if (!(span > 0.0) || (off_[k + 1] - level).norm() > 2.0 * agreed(back, k)) return k;
        const double earlier = std::min(0.5 * span, agreed(back, k) * span / std::max(way, 1.0));
        std::size_t first = k;
        while (first > 0 && !broken_[first] && track_.seconds(first - 1, k) < earlier) --first;
        return first;
    }

    bool vertical_;  // the second components are zero
    Track track_;
    std::vector<Vector2d> off_;
    std::vector<bool> broken_;  // displacement to this fix unknown
    double scatter_ = 0.0;      // m, between neighbouring fixes
    double drift_ = 0.1;        // m/s, of the misclosure in this log
};

/// Fixes of intervals that end with a leap back to the track before them and are `meant(first, last)`.
template <class Meant>
std::vector<bool> departed(const Misclosure& misclosure, std::size_t fixes, Meant&& meant) {
    const Track& track = misclosure.track();
    Marks out{std::vector<bool>(fixes, false)};
    for (std::size_t k = 1; k < track.size(); ++k) {
        if (!misclosure.leaps(k)) continue;
        const std::size_t left = misclosure.left(k);
        if (left + 1 < k && meant(left + 1, k - 1)) out.mark(track, left, k - 1);
    }
    out.settle(track.size());
    return out.marked;
}

}  // namespace

std::vector<bool> strayed_positions(const std::vector<GnssFix>& fixes, const earth::Earth& earth) {
    const Misclosure misclosure(fixes, earth, Direction::Horizontal);
    return departed(misclosure, fixes.size(),
                    [&](std::size_t first, std::size_t last) { return misclosure.wanders(first, last); });
}

std::vector<bool> displaced_positions(const std::vector<GnssFix>& fixes, const earth::Earth& earth) {
    std::vector<bool> out(fixes.size(), false);
    for (const Direction direction : {Direction::Horizontal, Direction::Vertical}) {
        const Misclosure misclosure(fixes, earth, direction);
        const auto long_enough = [&](std::size_t first, std::size_t last) {
            return last + 1 - first >= least_fixes && misclosure.track().seconds(first, last + 1) >= least_span;
        };
        const std::vector<bool> there = departed(misclosure, fixes.size(), long_enough);
        for (std::size_t i = 0; i < fixes.size(); ++i) out[i] = out[i] || there[i];
    }
    return out;
}

GnssFix FixScreen::without(const GnssFix& fix, std::size_t index) const {
    GnssFix out = fix;
    if (!position.empty() && position[index]) out.position = {not_given, not_given, not_given};
    if (!velocity.empty() && velocity[index]) out.velocity_n.setConstant(not_given);
    if (!height.empty() && height[index]) out.position.h = out.velocity_n.z() = not_given;
    if (no_heights) out.position.h = not_given;
    return out;
}

FixScreen screen_fixes(const std::vector<GnssFix>& fixes, const Settings& settings, Time origin, WarningLog& warnings) {
    std::vector<GnssFix> seen = fixes;
    if (!settings.gnss.use_velocity)
        for (GnssFix& fix : seen) fix.velocity_n.setConstant(not_given);
    const FrozenFixes frozen = frozen_fixes(seen, settings.earth);
    FixScreen screen{frozen.position, frozen.velocity, {}, has_idle_heights(seen, settings.earth)};
    if (screen.no_heights)
        warnings.add("gnss.idle_height",
                     "the height of all fixes is one and the same number, although the vertical velocities differ from zero: the "
                     "fixes count as without height");
    if (frozen.any())
        warnings.add(
            "gnss.frozen",
            fmt::format("the receiver hung: {} positions and {} velocities, the first {:.1f} s after the first fix, repeat the "
                        "ones before to the last digit while it moved; they were left out",
                        frozen.positions, frozen.velocities, (*frozen.first - origin).seconds()));
    if (settings.integrity.use || settings.constraints.gate_probability <= 0.0) return screen;
    for (std::size_t i = 0; frozen.any() && i < seen.size(); ++i) seen[i] = screen.without(seen[i], i);
    const std::vector<bool> strayed = strayed_positions(seen, settings.earth);
    const auto first = std::ranges::find(strayed, true);
    if (first == strayed.end()) return screen;
    warnings.add(
        "gnss.strayed",
        fmt::format("{} positions, the first {:.1f} s after the first fix, left the way of the receiver's own velocities "
                    "and leapt back to it later; they were left out",
                    std::ranges::count(strayed, true),
                    (fixes[static_cast<std::size_t>(first - strayed.begin())].time - origin).seconds()));
    screen.position.resize(fixes.size(), false);
    for (std::size_t i = 0; i < fixes.size(); ++i) screen.position[i] = screen.position[i] || strayed[i];
    return screen;
}

}  // namespace schuler::fusion
