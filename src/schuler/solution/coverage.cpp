#include "schuler/solution/coverage.h"

#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>

namespace schuler::solution {
namespace {

using Eigen::Vector3d;

constexpr double sigmas = 3.0;

/// Median interval of neighbours, s.
double usual_step(std::span<const CheckFix> fixes) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < fixes.size(); ++i) steps.push_back(fixes[i].t - fixes[i - 1].t);
    if (steps.empty()) return std::numeric_limits<double>::infinity();
    std::ranges::nth_element(steps, steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2));
    return steps[steps.size() / 2];
}

/// Time between a window and the next one, s.
double pause_after(double length) { return std::max(length, 10.0); }

/// A window may follow a user's outage as soon as there are some fixes again: the sigmas must be valid then, too.
bool clear_of(std::span<const fusion::Outage> outages, double start, double stop) {
    constexpr double some_fixes = 3.0;  // s
    return std::ranges::none_of(outages, [&](const fusion::Outage& o) {
        return start < o.start + o.duration + some_fixes && stop + some_fixes > o.start;
    });
}

/// Fixes throughout, used before and after, and mostly good; mostly `in_motion` if requested.
bool can_be_judged(std::span<const CheckFix> fixes, double start, double stop, double step, bool in_motion) {
    constexpr double tolerance = 1e-6;
    const auto begin = std::ranges::upper_bound(fixes, start + tolerance, {}, &CheckFix::t);
    const auto end = std::ranges::lower_bound(fixes, stop - tolerance, {}, &CheckFix::t);
    if (begin == fixes.begin() || end == fixes.end() || end - begin < 3) return false;
    const auto before = std::prev(begin);
    if (!before->good || start - before->t > 2.0 * step || end->t - stop > 2.0 * step) return false;
    const auto good = std::count_if(begin, end, [](const CheckFix& f) { return f.good; });
    if (in_motion && 2 * std::count_if(begin, end, [](const CheckFix& f) { return f.moving; }) <= end - begin) return false;
    const double whole = (stop - start) / step;
    return 2 * good > end - begin && 2.0 * static_cast<double>(end - begin) > whole;
}

std::vector<fusion::Outage> windows_of(double length, std::span<const CheckFix> fixes, double from, double to,
                                       std::span<const fusion::Outage> outages, bool in_motion) {
    std::vector<fusion::Outage> windows;
    const double step = usual_step(fixes);
    for (double t = from; t + length <= to;) {
        if (clear_of(outages, t, t + length) && can_be_judged(fixes, t, t + length, step, in_motion)) {
            windows.push_back({t, length});
            t += length + pause_after(length);
        } else {
            t += 0.5 * length;
        }
    }
    return windows;
}

bool within(const WithheldEpoch& e, int axes) {
    for (int i = 0; i < axes; ++i)
        if (e.sigma(i) > 0.0 && !(std::abs(e.error(i)) <= sigmas * e.sigma(i))) return false;
    return true;
}

double squares(const Vector3d& v) { return v.head<2>().squaredNorm(); }

std::vector<GrowthPoint> growth_of(std::span<const WithheldEpoch> epochs, double length) {
    constexpr std::size_t points = 12;
    std::vector<GrowthPoint> growth(points);
    for (const WithheldEpoch& e : epochs) {
        const double part = std::clamp(e.since / length, 0.0, 1.0);
        GrowthPoint& p = growth[std::min(points - 1, static_cast<std::size_t>(part * static_cast<double>(points)))];
        p.since += e.since;
        p.error += squares(e.error);
        p.sigma += squares(e.sigma);
        ++p.epochs;
    }
    std::erase_if(growth, [](const GrowthPoint& p) { return p.epochs == 0; });
    for (GrowthPoint& p : growth) {
        const auto n = static_cast<double>(p.epochs);
        p = {p.since / n, std::sqrt(p.error / n), std::sqrt(p.sigma / n), p.epochs};
    }
    return growth;
}

}  // namespace

const char* name_of(Regime regime) {
    return regime == Regime::Rest ? "at rest" : regime == Regime::Straight ? "straight on" : "turning";
}

void Inside::add(bool is_inside) {
    ++epochs;
    inside += is_inside ? 1 : 0;
}

double Inside::share() const {
    return epochs > 0 ? static_cast<double>(inside) / static_cast<double>(epochs) : std::numeric_limits<double>::quiet_NaN();
}

void leave_out_vague(std::vector<CheckFix>& fixes, const std::vector<double>& sigmas) {
    constexpr double many = 10.0, least = 30.0;  // times the median; m
    if (fixes.empty()) return;
    const double limit = std::max(least, many * math::median(sigmas));
    for (std::size_t i = 0; i < fixes.size(); ++i) fixes[i].good &= !(sigmas[i] > limit);
}

CheckWindows check_windows(std::span<const CheckFix> fixes, double from, double to, std::span<const fusion::Outage> outages) {
    constexpr std::size_t enough = 8, least = 4;
    for (const bool in_motion : {true, false}) {
        for (const double length : {60.0, 15.0, 5.0}) {
            CheckWindows out{length, windows_of(length, fixes, from, to, outages, in_motion), {}};
            if (out.windows.size() >= enough || (length == 5.0 && out.windows.size() >= least)) return out;
        }
    }
    return {std::numeric_limits<double>::quiet_NaN(),
            {},
            fixes.size() < 2 ? "there are no fixes to withhold"
                             : "the log is too short, or has too few good fixes, for windows without GNSS"};
}

Coverage coverage_of(std::span<const WithheldEpoch> epochs, double length) {
    Coverage c;
    double error2 = 0.0, sigma2 = 0.0;
    Inside window;
    for (std::size_t i = 0; i < epochs.size(); ++i) {
        const WithheldEpoch& e = epochs[i];
        const bool inside = within(e, 3);
        c.epochs.add(inside);
        c.by_regime[static_cast<std::size_t>(e.regime)].add(inside);
        c.horizontal.add(within(e, 2));
        if (e.sigma.z() > 0.0) c.vertical.add(std::abs(e.error.z()) <= sigmas * e.sigma.z());
        window.add(within(e, 2));
        if (i + 1 < epochs.size() && epochs[i + 1].window == e.window) continue;
        c.windows.add(window.inside == window.epochs);
        c.held.add(10 * window.inside >= 9 * window.epochs);
        error2 += squares(e.error);
        sigma2 += squares(e.sigma);
        window = {};
    }
    if (c.windows.epochs > 0) {
        c.end_rms = std::sqrt(error2 / static_cast<double>(c.windows.epochs));
        c.sigma_rms = std::sqrt(sigma2 / static_cast<double>(c.windows.epochs));
    }
    c.growth = growth_of(epochs, length);
    return c;
}

namespace {

/// One component of a withheld fix for the fit of growth factors.
struct Sample {
    double weight;  ///< each window has the same weight
    double since;   ///< s
    double error2;  ///< m^2
    double fixed;   ///< m^2, of the fix and of the position at loss: independent of the noise since then
    double growth;  ///< m^2, of the filter's own variance since loss
};

/// Equivalent number of independent epochs per window: its errors grow smoothly.
constexpr double independent = 2.0;

std::vector<Sample> samples_of(std::span<const WithheldEpoch> epochs, int axes) {
    constexpr std::size_t most_per_window = 12;
    std::vector<Sample> samples;
    for (std::size_t begin = 0; begin < epochs.size();) {
        std::size_t end = begin;
        while (end < epochs.size() && epochs[end].window == epochs[begin].window) ++end;
        const std::size_t every = std::max<std::size_t>(1, (end - begin) / most_per_window);
        const double weight = independent * static_cast<double>(every) / static_cast<double>(end - begin);
        const WithheldEpoch& first = epochs[begin];
        for (std::size_t i = end; i > begin; i -= std::min(every, i - begin)) {  // the ends count
            const WithheldEpoch& e = epochs[i - 1];
            for (int axis = 0; axis < axes; ++axis) {
                if (!(e.sigma(axis) > 0.0)) continue;
                const double own = e.sigma_state(axis) * e.sigma_state(axis),
                             at_loss = first.sigma_state(axis) * first.sigma_state(axis);
                const double growth = std::max(0.0, own - at_loss);
                samples.push_back(
                    {weight, e.since, e.error(axis) * e.error(axis), e.sigma(axis) * e.sigma(axis) - growth, growth});
            }
        }
        begin = end;
    }
    return samples;
}

/// Fraction of the growth driven by the gyros at a time since loss, from the shape of the filter's own variance: a t^3 + b t^5.
class GyroShare {
public:
    explicit GyroShare(std::span<const Sample> samples) {
        double s33 = 0.0, s35 = 0.0, s55 = 0.0, y3 = 0.0, y5 = 0.0;
        for (const Sample& s : samples) {
            const double t2 = s.since * s.since, t3 = t2 * s.since, t5 = t3 * t2;
            s33 += s.weight * t3 * t3;
            s35 += s.weight * t3 * t5;
            s55 += s.weight * t5 * t5;
            y3 += s.weight * t3 * s.growth;
            y5 += s.weight * t5 * s.growth;
        }
        const double det = s33 * s55 - s35 * s35;
        if (!(det > 0.0)) return;
        a_ = (y3 * s55 - y5 * s35) / det;
        b_ = (y5 * s33 - y3 * s35) / det;
        if (a_ < 0.0) a_ = 0.0, b_ = y5 / s55;
        if (b_ < 0.0) b_ = 0.0, a_ = y3 / s33;
    }
    [[nodiscard]] double at(double t) const {
        const double accel = a_, gyro = b_ * t * t;
        return accel + gyro > 0.0 ? gyro / (accel + gyro) : 0.5;
    }
    /// Both parts are present and can be separated.
    [[nodiscard]] bool both() const { return a_ > 0.0 && b_ > 0.0; }

private:
    double a_ = 0.0, b_ = 0.0;
};

class Fit {
public:
    Fit(std::span<const WithheldEpoch> epochs, int axes) : samples_(samples_of(epochs, axes)), share_(samples_) {
        for (const Sample& s : samples_) gyro_.push_back(share_.at(s.since));
    }

    [[nodiscard]] bool has_both() const { return share_.both(); }

    /// Log-likelihood for a scaled growth of variance; accel, gyro >= 1.
    [[nodiscard]] double likelihood(double accel, double gyro) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            const Sample& s = samples_[i];
            const double variance = variance_of(i, accel, gyro);
            sum -= 0.5 * s.weight * (std::log(variance) + s.error2 / variance);
        }
        return sum;
    }

    [[nodiscard]] double coverage(double accel, double gyro) const {
        double all = 0.0, inside = 0.0;
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            all += samples_[i].weight;
            if (samples_[i].error2 <= sigmas * sigmas * variance_of(i, accel, gyro)) inside += samples_[i].weight;
        }
        return all > 0.0 ? inside / all : 1.0;
    }

private:
    [[nodiscard]] double variance_of(std::size_t i, double accel, double gyro) const {
        const Sample& s = samples_[i];
        return std::max(s.fixed + s.growth * (accel + gyro_[i] * (gyro - accel)), 1e-12);
    }

    std::vector<Sample> samples_;
    GyroShare share_;
    std::vector<double> gyro_;
};

/// sigma of the growth = noise^power.
constexpr double power = 0.85;
double noise_of(double growth) { return std::min(NoiseScale::most, std::pow(growth, 0.5 / power)); }
/// With the digits of a settings file.
double rounded(double x) { return std::strtod(fmt::format("{:.3g}", x).c_str(), nullptr); }

}  // namespace

const Inside& inside_of(const Coverage& c, int axes) { return axes < 3 ? c.horizontal : c.epochs; }

bool covers(const Coverage& c, int axes) {
    const std::size_t lost = c.held.epochs - c.held.inside;
    return inside_of(c, axes).share() >= wanted_coverage && 20 * lost <= std::max<std::size_t>(c.held.epochs, 20);
}

NoiseScale NoiseScale::or_larger(const NoiseScale& other) const {
    return {std::max(gyro, other.gyro), std::max(accel, other.accel), apart || other.apart};
}

NoiseScale NoiseScale::times(const NoiseScale& more) const {
    return {rounded(std::min(most, gyro * more.gyro)), rounded(std::min(most, accel * more.accel)), apart || more.apart};
}

double Increase::gain() const {
    return (inside_of(after, axes).share() - inside_of(before, axes).share()) + (after.held.share() - before.held.share());
}

bool Increase::worsens(double factor) const { return !(after.end_rms < factor * before.end_rms); }

bool was_missing(const Increase& judges, const Increase& all) {
    constexpr double by_half = 1.5, beyond_chance = 3.0;
    const bool still_covered = covers(judges.after, judges.axes);
    if (all.worsens(by_half) || judges.worsens(still_covered ? beyond_chance : by_half)) return false;
    return judges.gain() > 0.0 || (covers(judges.before, judges.axes) && still_covered && all.gain() > 0.0);
}

NoiseScale missing_noise(std::span<const WithheldEpoch> epochs, int axes) {
    const Fit fit(epochs, axes);
    const double most = std::pow(NoiseScale::most, 2.0 * power);
    constexpr double step = 1.1, much_better = 0.5 * 6.6;  // chi-square of one degree of freedom, 1 %
    double common = 1.0, accel = 1.0, gyro = 1.0;
    double best = fit.likelihood(1.0, 1.0);
    for (double k = step; k < most * step; k *= step) {
        const double l = fit.likelihood(k, k);
        if (l > best) best = l, common = k;
    }
    accel = gyro = common;
    bool apart = false;
    if (fit.has_both()) {
        double both = best;
        for (double a = 1.0; a < most * step; a *= step)
            for (double g = 1.0; g < most * step; g *= step)
                if (const double l = fit.likelihood(a, g); l > std::max(both, best + much_better))
                    both = l, accel = a, gyro = g, apart = true;
    }
    if (std::max(accel, gyro) == 1.0 && fit.coverage(1.0, 1.0) >= wanted_coverage) return {};
    const double found = fit.likelihood(accel, gyro);
    while (std::max(accel, gyro) * step < most && fit.likelihood(accel * step, gyro * step) > found - 2.0) {
        accel *= step;
        gyro *= step;
    }
    // Errors with longer tails than normal ones require more than their mean size.
    while (fit.coverage(accel, gyro) < wanted_coverage && std::max(accel, gyro) < most) {
        accel *= step;
        gyro *= step;
    }
    return {rounded(noise_of(gyro)), rounded(noise_of(accel)), apart};
}

}  // namespace schuler::solution
