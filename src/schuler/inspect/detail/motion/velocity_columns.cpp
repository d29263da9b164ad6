#include "schuler/inspect/detail/motion/velocity_columns.h"

#include "schuler/earth/earth.h"
#include "schuler/inspect/detail/robust.h"

#include <Eigen/Core>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <optional>

namespace schuler::inspect::detail {
namespace {

/// An epoch with position and velocity.
struct Epoch {
    double t = 0.0;  // s
    Geodetic p;
    Eigen::Vector3d v = Eigen::Vector3d::Zero();
};

/// One interval: displacement, integral and change of the velocity, in the order of the columns.
struct Interval {
    double dt = 0.0;
    std::size_t first = 0, last = 0;  // of the epochs
    Eigen::Vector3d moved = Eigen::Vector3d::Zero(), integral = Eigen::Vector3d::Zero(), change = Eigen::Vector3d::Zero();
};

std::vector<Epoch> epochs_of(const std::vector<GnssFix>& fixes) {
    std::vector<Epoch> epochs;
    if (fixes.empty()) return epochs;
    const auto sound = [](const GnssFix& f) {
        return f.fix != FixType::None && std::isfinite(f.position.lat) && std::isfinite(f.position.lon) &&
               std::isfinite(f.velocity_n.x()) && std::isfinite(f.velocity_n.y());
    };
    for (const GnssFix& f : fixes) {
        if (!sound(f)) continue;
        const double t = (f.time - fixes.front().time).seconds();
        if (!epochs.empty() && t <= epochs.back().t) continue;
        Epoch e{t, f.position, f.velocity_n};
        if (!std::isfinite(e.p.h)) e.p.h = epochs.empty() ? 0.0 : epochs.back().p.h;
        if (!std::isfinite(e.v.z())) e.v.z() = 0.0;
        epochs.push_back(e);
    }
    return epochs;
}

double usual_step(const std::vector<Epoch>& epochs) {
    std::vector<double> steps;
    for (std::size_t k = 1; k < epochs.size(); ++k) steps.push_back(epochs[k].t - epochs[k - 1].t);
    return steps.empty() ? 0.0 : median(std::move(steps));
}

/// One sigma of the horizontal positions from third differences, m: noise, and what a curve of the track or positions that are
/// held over several rows add to it.
double noise_of(const std::vector<Epoch>& epochs) {
    const earth::Earth earth;
    std::vector<double> squares;
    for (std::size_t k = 3; k < epochs.size(); ++k) {
        const auto from_first = [&](std::size_t i) {
            return Eigen::Vector2d(earth::ned_difference(earth, epochs[i].p, epochs[k - 3].p).head<2>());
        };
        squares.push_back((from_first(k) - 3.0 * from_first(k - 1) + 3.0 * from_first(k - 2)).squaredNorm());
    }
    constexpr double gain = 20.0;  // variance of a third difference of unit noise
    return squares.empty() ? 0.0 : std::sqrt(quantile(squares, 0.75) / 2.0 / gain);
}

constexpr double jump = 3e3;  // m/s: faster than any vehicle

/// Calls `take` with the intervals that `ends` closes; a hole in the log, or a jump, begins a new one.
template <class Ends, class Take>
void each_interval(const std::vector<Epoch>& epochs, double step, const Ends& ends, const Take& take) {
    const earth::Earth earth;
    std::size_t first = 0;
    Eigen::Vector3d integral = Eigen::Vector3d::Zero();
    for (std::size_t k = 1; k < epochs.size(); ++k) {
        const double dt = epochs[k].t - epochs[k - 1].t;
        integral += 0.5 * dt * (epochs[k].v + epochs[k - 1].v);
        const Eigen::Vector3d moved = earth::ned_difference(earth, epochs[k].p, epochs[first].p);
        const Interval i{epochs[k].t - epochs[first].t, first, k, moved, integral, epochs[k].v - epochs[first].v};
        const bool broken = dt > 3.0 * step || i.moved.head<2>().norm() > jump * i.dt || !i.integral.allFinite();
        if (!broken && !ends(i)) continue;
        if (!broken) take(i);
        first = k;
        integral.setZero();
    }
}

/// True if no quarter of the time has most of the way, as a jump of the positions of a vehicle that stays has.
bool is_steady(const std::vector<Epoch>& epochs, const Interval& i) {
    const earth::Earth earth;
    constexpr double most = 0.6, quarters = 4.0;
    const Eigen::Vector2d way = i.moved.head<2>();
    double before = 0.0;
    std::size_t k = i.first;
    for (double quarter = 1.0; quarter <= quarters; ++quarter) {
        const double stop = epochs[i.first].t + quarter / quarters * i.dt;
        while (k < i.last && epochs[k + 1].t <= stop + 1e-6) ++k;
        const Eigen::Vector2d so_far = earth::ned_difference(earth, epochs[k].p, epochs[i.first].p).head<2>();
        const double share = so_far.dot(way) / way.squaredNorm();
        if (share - before > most) return false;
        before = share;
    }
    return true;
}

std::vector<Interval> travelled(const std::vector<Epoch>& epochs) {
    constexpr double sure = 15.0, shortest = 10.0, quick = 4.0, longest = 30.0;  // sigmas; m; s; s
    const double step = usual_step(epochs), far = std::max(shortest, sure * noise_of(epochs));
    std::vector<Interval> intervals;
    const double fast = std::max(quick, 3.0 * step), slow = std::max(longest, 6.0 * step);
    each_interval(
        epochs, step, [&](const Interval& i) { return (i.dt >= fast && i.moved.head<2>().norm() >= far) || i.dt >= slow; },
        [&](const Interval& i) {
            if (i.moved.head<2>().norm() >= far && is_steady(epochs, i)) intervals.push_back(i);
        });
    return intervals;
}

/// Factor of the columns in one order, and of the change of the velocity over an interval (the delay times the factor).
struct Fit {
    double factor = 0.0;
    std::vector<double> misses;  // of the intervals
    double miss = 1.0;
    std::vector<double> weights;
};

Eigen::Vector2d ordered(const VelocityOrder& order, const Eigen::Vector3d& columns) {
    return {order.sign[0] * columns(order.from[0]), order.sign[1] * columns(order.from[1])};
}

/// Normal equations of one interval for factor and delay.
void add_equations(const VelocityOrder& order, const Interval& i, double weight, Eigen::Matrix2d& A, Eigen::Vector2d& b) {
    const Eigen::Vector2d u = ordered(order, i.integral), c = ordered(order, i.change), d = i.moved.head<2>();
    A(0, 0) += weight * u.dot(u);
    A(0, 1) += weight * u.dot(c);
    A(1, 1) += weight * c.dot(c);
    b += weight * Eigen::Vector2d(u.dot(d), c.dot(d));
}

/// Factor and delay times factor; the delay of no receiver exceeds its limit.
Eigen::Vector2d solved(Eigen::Matrix2d A, const Eigen::Vector2d& b) {
    constexpr double longest_delay = 1.5;  // s
    A(1, 0) = A(0, 1);
    if (!(A(0, 0) > 0.0)) return Eigen::Vector2d::Zero();
    Eigen::Vector2d x(b(0) / A(0, 0), 0.0);
    const double determinant = A.determinant();
    if (determinant > 1e-9 * A(0, 0) * A(1, 1)) x = A.inverse() * b;
    const double most = longest_delay * std::abs(x(0));
    if (std::abs(x(1)) > most) {
        x(1) = std::copysign(most, x(1));
        x(0) = (b(0) - A(0, 1) * x(1)) / A(0, 0);
    }
    return x;
}

double miss_of(const VelocityOrder& order, const Interval& i, const Eigen::Vector2d& x) {
    const Eigen::Vector2d left = i.moved.head<2>() - x(0) * ordered(order, i.integral) - x(1) * ordered(order, i.change);
    return std::min(1.0, left.squaredNorm() / i.moved.head<2>().squaredNorm());
}

double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double v : values) sum += v / static_cast<double>(values.size());
    return sum;
}

/// Least squares of relative misfits, reweighted so that intervals with a jump have no say. `fixed`: the factor is given.
Fit fitted(const std::vector<Interval>& intervals, const VelocityOrder& order, std::optional<double> fixed) {
    Fit fit;
    fit.weights.assign(intervals.size(), 1.0);
    Eigen::Vector2d x = Eigen::Vector2d::Zero();
    constexpr int rounds = 12;
    for (int round = 0; round < rounds; ++round) {
        Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
        Eigen::Vector2d b = Eigen::Vector2d::Zero();
        for (std::size_t k = 0; k < intervals.size(); ++k)
            add_equations(order, intervals[k], fit.weights[k] / intervals[k].moved.head<2>().squaredNorm(), A, b);
        x = solved(A, b);
        if (fixed) {
            const double most = 1.5 * std::abs(*fixed);
            x = {*fixed, A(1, 1) > 0.0 ? std::clamp((b(1) - A(0, 1) * *fixed) / A(1, 1), -most, most) : 0.0};
        }
        fit.misses.clear();
        for (const Interval& i : intervals) fit.misses.push_back(miss_of(order, i, x));
        const double usual = std::max(1e-4, median(fit.misses));
        for (std::size_t k = 0; k < intervals.size(); ++k) fit.weights[k] = 1.0 / (1.0 + fit.misses[k] / (4.0 * usual));
    }
    fit.factor = x(0);
    fit.miss = mean(fit.misses);
    return fit;
}

/// One sigma of the factor: tenths of the intervals left out in turn, with the final weights.
double factor_sigma(const std::vector<Interval>& intervals, const VelocityOrder& order, const Fit& fit) {
    constexpr std::size_t parts = 10;
    std::vector<double> factors;
    for (std::size_t part = 0; part < parts; ++part) {
        Eigen::Matrix2d A = Eigen::Matrix2d::Zero();
        Eigen::Vector2d b = Eigen::Vector2d::Zero();
        for (std::size_t k = 0; k < intervals.size(); ++k)
            if (k * parts / intervals.size() != part)
                add_equations(order, intervals[k], fit.weights[k] / intervals[k].moved.head<2>().squaredNorm(), A, b);
        factors.push_back(solved(A, b)(0));
    }
    const double middle = mean(factors);
    double sum = 0.0;
    for (const double f : factors) sum += (f - middle) * (f - middle);
    return std::sqrt(sum * (parts - 1.0) / parts);
}

/// All orders and signs of two horizontal components out of three columns; the third takes the rest. Those nearest to the names
/// first: an equal fit does not displace them.
std::vector<VelocityOrder> orders(bool has_down) {
    std::vector<VelocityOrder> all;
    constexpr std::array<std::array<int, 3>, 6> places{{{0, 1, 2}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}}};
    constexpr std::array<std::array<double, 3>, 4> signs{
        {{1.0, 1.0, 1.0}, {-1.0, -1.0, 1.0}, {1.0, -1.0, 1.0}, {-1.0, 1.0, 1.0}}};
    for (const auto& from : places) {
        if (!has_down && from[2] != 2) continue;
        for (const auto& sign : signs) all.push_back({from, sign});
    }
    return all;
}

/// Mean and its sigma of the differences of two lists of misses.
std::pair<double, double> difference(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> d;
    for (std::size_t k = 0; k < a.size(); ++k) d.push_back(a[k] - b[k]);
    const double middle = mean(d);
    double sum = 0.0;
    for (const double v : d) sum += (v - middle) * (v - middle);
    const auto n = static_cast<double>(d.size());
    return {middle, std::sqrt(sum / n / std::max(1.0, n - 1.0))};
}

/// Slope of the height changes on the integral of the vertical column, with its delay.
void compare_vertical(const std::vector<Epoch>& epochs, VelocityColumns& out) {
    constexpr double span = 5.0;  // s: longer than the periods that a delayed height turns round
    const double step = usual_step(epochs), length = std::max(span, 3.0 * step);
    const int column = out.order.from[2];
    std::vector<Interval> intervals;
    each_interval(
        epochs, step, [&](const Interval& i) { return i.dt >= length; }, [&](const Interval& i) { intervals.push_back(i); });
    constexpr std::size_t fewest = 20, parts = 10;
    if (intervals.size() < fewest) return;
    std::vector<double> changes, rates;
    for (const Interval& i : intervals) {
        changes.push_back(i.moved.z() / i.dt);
        rates.push_back(out.factor * i.integral(column) / i.dt);
    }
    std::vector<double> weights(intervals.size(), 1.0);
    struct Line {
        double slope = 0.0, level = 0.0, correlation = 0.0;
    };
    const auto line_without = [&](std::size_t part) {
        double n = 0.0, u = 0.0, d = 0.0, uu = 0.0, ud = 0.0, dd = 0.0;
        for (std::size_t k = 0; k < changes.size(); ++k) {
            if (k * parts / changes.size() == part) continue;
            const double w = weights[k];
            n += w;
            u += w * rates[k];
            d += w * changes[k];
            uu += w * rates[k] * rates[k];
            ud += w * rates[k] * changes[k];
            dd += w * changes[k] * changes[k];
        }
        uu -= u * u / n;
        ud -= u * d / n;
        dd -= d * d / n;
        if (!(uu > 0.0) || !(dd > 0.0)) return Line{};
        return Line{ud / uu, (d - ud / uu * u) / n, ud / std::sqrt(uu * dd)};
    };
    Line line;
    constexpr int rounds = 10;
    for (int round = 0; round < rounds; ++round) {  // a jump of the height has no say
        line = line_without(parts);
        std::vector<double> left;
        for (std::size_t k = 0; k < changes.size(); ++k) left.push_back(changes[k] - line.level - line.slope * rates[k]);
        const double usual = std::max(1e-9, robust_sigma(left));
        for (std::size_t k = 0; k < changes.size(); ++k) weights[k] = 1.0 / (1.0 + left[k] * left[k] / (9.0 * usual * usual));
    }
    std::vector<double> slopes;
    for (std::size_t part = 0; part < parts; ++part) slopes.push_back(line_without(part).slope);
    const double middle = mean(slopes);
    double sum = 0.0;
    for (const double s : slopes) sum += (s - middle) * (s - middle);
    out.vertical_intervals = static_cast<int>(intervals.size());
    out.vertical_sigma = std::sqrt(sum * (parts - 1.0) / parts);
    constexpr double together = 0.8, significant = 8.0;
    if (std::abs(line.correlation) > together && std::abs(line.slope) > significant * out.vertical_sigma)
        out.vertical_factor = line.slope;
}

}  // namespace

VelocityColumns velocity_columns(const std::vector<GnssFix>& fixes, bool has_down) {
    VelocityColumns out;
    const std::vector<Epoch> epochs = epochs_of(fixes);
    const std::vector<Interval> intervals = travelled(epochs);
    constexpr int fewest = 10;
    out.intervals = static_cast<int>(intervals.size());
    if (out.intervals >= fewest) {
        const Fit named = fitted(intervals, {}, 1.0);
        out.miss_as_named = named.miss;
        std::vector<std::pair<VelocityOrder, Fit>> fits;
        for (const VelocityOrder& order : orders(has_down)) {
            Fit fit = fitted(intervals, order, std::nullopt);
            if (fit.factor > 0.0) fits.emplace_back(order, std::move(fit));
        }
        if (fits.empty()) return out;
        const Fit& lowest = std::ranges::min_element(fits, {}, [](const auto& f) { return f.second.miss; })->second;
        constexpr double alike = 0.01, sigmas = 3.0;
        const auto chosen = std::ranges::find_if(fits, [&](const auto& f) {
            const auto [worse, sigma] = difference(f.second.misses, lowest.misses);
            return worse <= std::max(alike, sigmas * sigma);
        });
        out.order = chosen->first;
        out.factor = chosen->second.factor;
        out.miss = chosen->second.miss;
        out.factor_sigma = factor_sigma(intervals, chosen->first, chosen->second);
        out.gain_sigma = difference(named.misses, chosen->second.misses).second;
    }
    if (has_down && (out.intervals < fewest || out.miss < 0.1)) compare_vertical(epochs, out);
    return out;
}

}  // namespace schuler::inspect::detail
