#include "schuler/inspect/detail/motion/clock_steps.h"

#include "schuler/inspect/detail/motion/motion_fit.h"
#include "schuler/inspect/detail/motion/mounting.h"
#include "schuler/inspect/detail/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace schuler::inspect::detail {
namespace {

constexpr double least_step = 0.25;            // s: smaller is jitter of a logger, or a latency
constexpr std::size_t most_holes = 16;         // of each log, the longest: for logs with many lost samples
constexpr double reach = 240.0, far = 1200.0;  // s of each log compared on either side

struct Hole {
    bool imu = true;
    double from = 0.0, to = 0.0;  // s, the samples around it
    double step = 0.0;            // s longer than usual
};

template <class Series>
std::vector<Hole> holes_of(const Series& log, bool imu) {
    std::vector<Hole> holes;
    for (std::size_t i = 1; i < log.size(); ++i) {
        const double step = log.t[i] - log.t[i - 1] - log.step;
        if (step > std::max(least_step, 0.5 * log.step)) holes.push_back({imu, log.t[i - 1], log.t[i], step});
    }
    if (holes.size() > most_holes) {
        std::ranges::stable_sort(holes, std::ranges::greater(), &Hole::step);
        holes.resize(most_holes);
    }
    return holes;
}

/// The samples from `from` to `to`, shifted earlier by `by`.
ImuSeries part_of(const ImuSeries& log, double from, double to, double by) {
    ImuSeries part;
    part.step = log.step;
    for (std::size_t i = 0; i < log.size(); ++i) {
        if (log.t[i] < from || log.t[i] > to) continue;
        part.t.push_back(log.t[i] - by);
        part.w.push_back(log.w[i]);
        part.f.push_back(log.f[i]);
    }
    return part;
}

GnssSeries part_of(const GnssSeries& log, double from, double to, double by) {
    GnssSeries part = log;
    part.t.clear();
    part.p.clear();
    part.v.clear();
    for (std::size_t i = 0; i < log.size(); ++i) {
        if (log.t[i] < from || log.t[i] > to) continue;
        part.t.push_back(log.t[i] - by);
        part.p.push_back(log.p[i]);
        if (log.has_velocity()) part.v.push_back(log.v[i]);
    }
    return part;
}

/// Agreement of two logs, with the gyros in the unit determined from the course.
struct Sides {
    const ImuSeries& imu;
    const GnssSeries& gnss;
    double gravity, unit, window;

    [[nodiscard]] MotionFit fit(double imu_from, double imu_to, double imu_by, double gnss_from, double gnss_to,
                                double gnss_by) const {
        ImuSeries a = part_of(imu, imu_from, imu_to, imu_by);
        for (Eigen::Vector3d& w : a.w) w *= unit;
        const GnssSeries b = part_of(gnss, gnss_from, gnss_to, gnss_by);
        if (a.size() < 100 || b.size() < 8) return {};
        return fit_motion(a, b, b.has_velocity() ? FitSource::Velocity : FitSource::Displacement, Eigen::Vector3d::Zero(), false,
                          gravity, window);
    }
};

double unit_of(const ImuSeries& imu, const GnssSeries& gnss) {
    Eigen::Vector3d f = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < imu.size(); ++i) {
        f += imu.f[i];
        w += imu.w[i] / static_cast<double>(imu.size());
    }
    return gyro_unit_of(course_slope(imu, gnss, -f.normalized(), w)).value_or(GyroUnit{}).factor;
}

/// True if a lag is accurate enough to detect a step: the windows agree, or smooth motion shows it less sharply, but far better than the step.
bool tells(const MotionFit& fit, double step) {
    return shows_lag(fit) || (fit.windows >= 4 && fit.horizontal.found && fit.horizontal.sigma <= std::min(0.12, 0.12 * step));
}

/// Increase of the misfit at a lag relative to the best one, in variances of its residuals; 0 outside the tested lags.
double worse_at(const MotionFit& fit, double lag) {
    const auto index = [](double at) { return static_cast<long>(std::lround((at - first_lag) / lag_step)); };
    const long best = index(fit.horizontal.at), other = index(lag);
    if (other < 0 || other >= lag_count || best < 0 || best >= lag_count) return 0.0;
    double sum = 0.0;
    for (const LagCurve& c : fit.curves)
        sum += c.horizontal[static_cast<std::size_t>(other)] - c.horizontal[static_cast<std::size_t>(best)];
    return sum;
}

/// The evidence for a step; empty if the gap is real, or undecided.
std::optional<std::string> evidence_of(const Sides& sides, const Hole& hole, double span) {
    constexpr double margin = 2.0;  // s around the compared part, for the lags
    const double imu_before = hole.imu ? hole.from : hole.from + margin, gnss_before = hole.imu ? hole.from + margin : hole.from;
    const MotionFit before = sides.fit(hole.from - span - margin, imu_before, 0.0, hole.from - span, gnss_before, 0.0);
    if (!tells(before, hole.step)) return std::nullopt;
    // The part after it as stamped, and earlier; the other log then continues from the start of the gap.
    const double end = hole.to + span, imu_by = hole.imu ? hole.step : 0.0, gnss_by = hole.step - imu_by;
    const double imu_start = hole.imu ? hole.to : hole.from - margin, gnss_start = hole.imu ? hole.from - margin : hole.to;
    const MotionFit moved = sides.fit(imu_start, end + margin, imu_by, gnss_start, end, gnss_by);
    if (!tells(moved, hole.step)) return std::nullopt;
    const double tolerance = std::max(0.1, 4.0 * std::hypot(before.horizontal.sigma, moved.horizontal.sigma));
    if (std::abs(moved.horizontal.at - before.horizontal.at) > std::min(tolerance, 0.4 * hole.step)) return std::nullopt;
    const MotionFit stated = sides.fit(imu_start, end + margin, 0.0, gnss_start, end, 0.0);
    const double other = stated.horizontal.at - before.horizontal.at;
    const bool late = tells(stated, hole.step) &&
                      std::abs(other - (hole.imu ? -hole.step : hole.step)) < std::min(tolerance + 0.1, 0.4 * hole.step);
    const bool worse = stated.windows == 0 || stated.rms > 1.5 * moved.rms;
    constexpr double beyond_chance = 30.0;
    const bool earlier = hole.imu && worse_at(moved, before.horizontal.at + hole.step) > beyond_chance;
    if (!late && !worse && !earlier) return std::nullopt;
    return fmt::format(
        "put back, the lag between the logs is {:.2f} s as it was before ({:.2f} s); as stamped {}", moved.horizontal.at,
        before.horizontal.at,
        late ? fmt::format("it would be {:.2f} s", stated.horizontal.at) : std::string("turns and accelerations do not agree"));
}

template <class Series>
void put_back(Series& log, const Hole& hole) {
    for (double& t : log.t)
        if (t >= hole.to) t -= hole.step;
}

}  // namespace

std::vector<ClockStep> take_out_clock_steps(ImuSeries& imu, GnssSeries& gnss, double gravity) {
    std::vector<ClockStep> steps;
    if (imu.size() < 100 || gnss.size() < 20) return steps;
    std::vector<Hole> holes = holes_of(imu, true);
    std::ranges::copy(holes_of(gnss, false), std::back_inserter(holes));
    std::ranges::sort(holes, {}, &Hole::from);
    if (holes.empty()) return steps;
    const double unit = unit_of(imu, gnss);
    for (std::size_t k = 0; k < holes.size(); ++k) {
        const Hole hole = holes[k];
        std::optional<std::string> evidence;
        for (const double window : {short_window, 0.5 * long_window, long_window}) {
            evidence = evidence_of({imu, gnss, gravity, unit, window}, hole, window == short_window ? reach : far);
            if (evidence) break;
        }
        if (!evidence) continue;
        steps.push_back(
            {hole.imu, hole.from - (hole.imu ? imu.t.front() : gnss.t.front()), hole.to - hole.from, hole.step, *evidence});
        hole.imu ? put_back(imu, hole) : put_back(gnss, hole);
        for (Hole& later : holes) {
            if (later.imu != hole.imu || later.from < hole.to) continue;
            later.from -= hole.step;
            later.to -= hole.step;
        }
    }
    return steps;
}

}  // namespace schuler::inspect::detail
