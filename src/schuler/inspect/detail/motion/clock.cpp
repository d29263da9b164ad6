#include "schuler/inspect/detail/motion/clock.h"

#include "schuler/math/fft.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

namespace schuler::inspect::detail {
namespace {

constexpr double least_common = 10.0;  // s

/// Values on a uniform grid; missing where `known` is 0.
struct Channel {
    std::vector<double> value, known;
};
using Channels = std::array<Channel, 3>;

struct Grid {
    double first, step;
    std::size_t size;
    [[nodiscard]] double at(std::size_t i) const { return first + step * static_cast<double>(i); }
};

Channels empty_channels(const Grid& grid) {
    Channels channels;
    for (Channel& c : channels) {
        c.value.assign(grid.size, 0.0);
        c.known.assign(grid.size, 0.0);
    }
    return channels;
}

void put(Channel& c, std::size_t i, double value) {
    c.value[i] = value;
    c.known[i] = 1.0;
}

/// Cumulative sums of a series, for means over any interval.
std::vector<Eigen::Vector3d> sums_of(const std::vector<Eigen::Vector3d>& values) {
    std::vector<Eigen::Vector3d> sums(values.size() + 1, Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < values.size(); ++i) sums[i + 1] = sums[i] + values[i];
    return sums;
}

Channels imu_channels(const ImuSeries& imu, const Grid& grid, double width) {
    Channels out = empty_channels(grid);
    const std::vector<Eigen::Vector3d> w = sums_of(imu.w), f = sums_of(imu.f);
    const double full = width / std::max(imu.step, 1e-9);
    constexpr double level = 20.0;  // s: averaging time in which the mean force is vertical
    for (std::size_t i = 0; i < grid.size; ++i) {
        const auto mean = [&](const std::vector<Eigen::Vector3d>& sums, double span, std::size_t& n) {
            const auto a =
                static_cast<std::size_t>(std::lower_bound(imu.t.begin(), imu.t.end(), grid.at(i) - 0.5 * span) - imu.t.begin());
            const auto b =
                static_cast<std::size_t>(std::upper_bound(imu.t.begin(), imu.t.end(), grid.at(i) + 0.5 * span) - imu.t.begin());
            n = b - a;
            return Eigen::Vector3d((sums[b] - sums[a]) / std::max<double>(1.0, static_cast<double>(n)));
        };
        std::size_t n = 0, many = 0;
        const Eigen::Vector3d force = mean(f, width, n), rate = mean(w, width, n), vertical = mean(f, level, many);
        if (static_cast<double>(n) < 0.6 * full || n < 1 || vertical.norm() <= 0.0) continue;
        const Eigen::Vector3d up = vertical.normalized();
        put(out[0], i, -rate.dot(up));
        put(out[1], i, force.norm());
        put(out[2], i, (force - force.dot(up) * up).norm());
    }
    return out;
}

/// Velocities of the track: the receiver's, else from positions at least a second apart.
std::vector<Eigen::Vector3d> velocities(const GnssSeries& gnss) {
    if (gnss.has_velocity()) return gnss.v;
    std::vector<Eigen::Vector3d> v(gnss.size(), Eigen::Vector3d::Zero());
    std::size_t a = 0, b = 0;
    for (std::size_t k = 0; k < gnss.size(); ++k) {
        while (a + 1 < k && gnss.t[k] - gnss.t[a + 1] >= 0.5) ++a;
        b = std::max(b, k);
        while (b + 1 < gnss.size() && gnss.t[b] - gnss.t[k] < 0.5) ++b;
        if (b > a) v[k] = (gnss.p[b] - gnss.p[a]) / (gnss.t[b] - gnss.t[a]);
    }
    return v;
}

Channels gnss_channels(const GnssSeries& gnss, const Grid& grid, double width, double gravity) {
    Channels out = empty_channels(grid);
    const std::vector<Eigen::Vector3d> v = velocities(gnss);
    const double slowest = gnss.has_velocity() ? 0.7 : 2.0;  // m/s: below this the course is too noisy
    const auto at = [&](double t, Eigen::Vector3d& value) {
        if (t < gnss.t.front() || t > gnss.t.back()) return false;
        const std::size_t k = std::min(index_before(gnss.t, t), gnss.size() - 2);
        const double dt = gnss.t[k + 1] - gnss.t[k];
        if (dt > std::max(2.5 * gnss.step, 1.2)) return false;
        value = v[k] + (t - gnss.t[k]) / dt * (v[k + 1] - v[k]);
        return true;
    };
    Eigen::Vector3d a, b;
    for (std::size_t i = 0; i < grid.size; ++i) {
        if (!at(grid.at(i) - 0.5 * width, a) || !at(grid.at(i) + 0.5 * width, b)) continue;
        Eigen::Vector3d force = (b - a) / width;
        put(out[2], i, force.head<2>().norm());
        force.z() -= gravity;
        put(out[1], i, force.norm());
        if (a.head<2>().norm() > slowest && b.head<2>().norm() > slowest)
            put(out[0], i, math::wrap_pi(std::atan2(b.y(), b.x()) - std::atan2(a.y(), a.x())) / width);
    }
    return out;
}

/// Zero mean of the known values, limited to five robust sigmas.
void settle(Channel& c) {
    std::vector<double> known;
    for (std::size_t i = 0; i < c.value.size(); ++i)
        if (c.known[i] > 0.0) known.push_back(c.value[i]);
    if (known.empty()) return;
    double mean = 0.0, square = 0.0;
    for (const double x : known) mean += x / static_cast<double>(known.size());
    for (const double x : known) square += (x - mean) * (x - mean) / static_cast<double>(known.size());
    const double limit = 4.0 * std::sqrt(square), centre = median(std::move(known));
    for (std::size_t i = 0; i < c.value.size(); ++i)
        c.value[i] = c.known[i] > 0.0 ? std::clamp(c.value[i] - centre, -limit, limit) : 0.0;
}

/// Ranks of the known values, from -1 to 1, with zero mean.
void rank(Channel& c) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < c.value.size(); ++i)
        if (c.known[i] > 0.0) order.push_back(i);
    std::ranges::sort(order, {}, [&](std::size_t i) { return c.value[i]; });
    const auto count = static_cast<double>(order.size());
    for (std::size_t k = 0; k < order.size(); ++k) c.value[order[k]] = (2.0 * static_cast<double>(k) + 1.0) / count - 1.0;
}

class Correlator {
public:
    explicit Correlator(std::size_t size) : fft_(size), in_(size), out_(size) {}
    using Spectrum = std::vector<std::complex<float>>;

    [[nodiscard]] Spectrum of(const std::vector<double>& x) {
        std::fill(in_.begin(), in_.end(), std::complex<float>());
        for (std::size_t i = 0; i < x.size(); ++i) in_[i] = static_cast<float>(x[i]);
        Spectrum s(in_.size());
        fft_.forward(in_, s);
        return s;
    }
    /// sum over i of x_i y_{i+k}, for k from 0; negative k at the end.
    [[nodiscard]] std::vector<double> correlate(const Spectrum& x, const Spectrum& y) {
        for (std::size_t i = 0; i < in_.size(); ++i) in_[i] = std::conj(x[i]) * y[i];
        fft_.inverse(in_, out_);
        std::vector<double> r(out_.size());
        for (std::size_t i = 0; i < r.size(); ++i) r[i] = static_cast<double>(out_[i].real());
        return r;
    }

private:
    math::Fft fft_;
    Spectrum in_, out_;
};

std::vector<double> squares(const std::vector<double>& x) {
    std::vector<double> out;
    for (const double v : x) out.push_back(v * v);
    return out;
}

/// Support and correlation of one channel at every lag of the circular correlation.
struct ChannelScan {
    std::vector<double> support, rho, common;
};

ChannelScan scan_channel(Correlator& by, const Channel& x, const Channel& y, double step) {
    const auto X = by.of(x.value), Y = by.of(y.value), MX = by.of(x.known), MY = by.of(y.known);
    const auto X2 = by.of(squares(x.value)), Y2 = by.of(squares(y.value));
    const std::vector<double> n = by.correlate(MX, MY), xy = by.correlate(X, Y), sx = by.correlate(X, MY),
                              sy = by.correlate(MX, Y), sxx = by.correlate(X2, MY), syy = by.correlate(MX, Y2);
    // Bartlett: the variance of a correlation of unrelated series is the sum of the products of their own correlations, over n.
    const std::vector<double> rx = by.correlate(X, X), ry = by.correlate(Y, Y);
    double memory = 1.0;
    const auto reach = std::min(static_cast<std::size_t>(60.0 / step), n.size() / 2 - 1);
    for (std::size_t k = 1; k < reach && rx[0] > 0.0 && ry[0] > 0.0; ++k) memory += 2.0 * (rx[k] / rx[0]) * (ry[k] / ry[0]);
    memory = std::max(memory, 1.0 / step);
    double known = 0.0;
    for (const double m : x.known) known += m;
    const double least = 1e-3 * rx[0] / std::max(known, 1.0);  // of the variance: at rest there is nothing to compare
    ChannelScan out;
    out.support.assign(n.size(), 0.0);
    out.rho.assign(n.size(), 0.0);
    out.common.assign(n.size(), 0.0);
    for (std::size_t k = 0; k < n.size(); ++k) {
        out.common[k] = n[k] * step;
        if (n[k] * step < least_common) continue;
        const double vx = sxx[k] - sx[k] * sx[k] / n[k], vy = syy[k] - sy[k] * sy[k] / n[k];
        if (vx <= least * n[k] || vy <= 0.0) continue;
        const double rho = std::clamp((xy[k] - sx[k] * sy[k] / n[k]) / std::sqrt(vx * vy), -0.9999, 0.9999);
        out.rho[k] = rho;
        const double sign = rho > 0.0 ? 1.0 : -1.0;
        out.support[k] = -0.5 * sign * (n[k] / memory) * std::log1p(-rho * rho);
    }
    return out;
}

std::size_t good_size(std::size_t least) {
    std::size_t size = 1;
    while (size < least) size *= 2;
    return size;
}

}  // namespace

ClockScan scan_clocks(const ImuSeries& imu, const GnssSeries& gnss, double gravity, ScanOf what, double asked) {
    ClockScan scan;
    if (imu.size() < 100 || gnss.size() < 20) return scan;
    const double imu_span = imu.t.back() - imu.t.front(), gnss_span = gnss.t.back() - gnss.t.front();
    constexpr double most_cells = 1 << 21;
    const double step = std::max({0.2, gnss.step / 5.0, (imu_span + gnss_span) / most_cells});
    const double width = std::max(1.0, 2.0 * gnss.step);
    const Grid a{imu.t.front(), step, static_cast<std::size_t>(imu_span / step) + 1};
    const Grid b{gnss.t.front(), step, static_cast<std::size_t>(gnss_span / step) + 1};
    Channels x = imu_channels(imu, a, width), y = gnss_channels(gnss, b, width, gravity);
    const std::size_t size = good_size(a.size + b.size);
    Correlator by(size);
    std::vector<double> support(size, 0.0), rho(size, 0.0), most(size, 0.0);
    for (std::size_t c = 0; c < x.size(); ++c) {
        for (Channel* channel : {&x[c], &y[c]}) what == ScanOf::Ranks ? rank(*channel) : settle(*channel);
        const ChannelScan s = scan_channel(by, x[c], y[c], step);
        for (std::size_t k = 0; k < size; ++k) {
            support[k] += s.support[k];
            if (s.support[k] > most[k]) {
                most[k] = s.support[k];
                rho[k] = s.rho[k];
            }
        }
    }
    // cell i of the IMU corresponds to cell i + k of the GNSS
    const auto shift_of = [&](std::size_t k) {
        const double cells = k < b.size ? static_cast<double>(k) : static_cast<double>(k) - static_cast<double>(size);
        return b.first - a.first + cells * step;
    };
    scan.width = 3.0 * width;
    for (std::size_t k = 0; k < size; ++k) {
        const double l = support[(k + size - 1) % size], m = support[k], r = support[(k + 1) % size];
        const double shift = shift_of(k);
        if (shift > earliest_lag - step && shift < latest_lag + step) scan.stated = std::max(scan.stated, m);
        if (std::abs(shift - asked) < scan.width) scan.asked = std::max(scan.asked, m);
        if (m <= 5.0 || m < l || m <= r) continue;
        const double curve = l - 2.0 * m + r;
        scan.peaks.push_back({shift + (curve < 0.0 ? step * std::clamp(0.5 * (l - r) / curve, -0.5, 0.5) : 0.0), m, rho[k]});
    }
    std::ranges::sort(scan.peaks, [](const ClockPeak& p, const ClockPeak& q) { return p.support > q.support; });
    if (scan.peaks.size() > 50) scan.peaks.resize(50);
    return scan;
}

std::optional<KnownShift> known_shift(double shift, double leap) {
    constexpr double hour = 3600.0, day = 24.0 * hour, week = 7.0 * day, epochs = 315'964'800.0;
    for (const double seconds : {0.0, leap, -leap}) {
        // a late GNSS appears to require later IMU times
        const double hours = std::round((shift - middle_lag - seconds) / hour) * hour;
        const double rest = shift - hours - seconds;
        if (rest < earliest_lag || rest > latest_lag) continue;
        KnownShift known{hours + seconds, {}};
        double left = hours;
        const auto add = [&](const std::string& text) { known.name += (known.name.empty() ? "" : " and ") + text; };
        if (std::abs(left) > 0.5 * epochs) {
            add(left < 0.0 ? "the IMU's times count from 1970, the receiver's from 1980"
                           : "the IMU's times count from 1980, the receiver's from 1970");
            left -= std::copysign(epochs, left);
        }
        if (std::abs(left) >= week - 15.0 * hour && std::abs(std::remainder(left, week)) < 15.0 * hour) {
            const double weeks = std::round(left / week);
            add(fmt::format("{:.0f} week{}", std::abs(weeks), std::abs(weeks) == 1.0 ? "" : "s"));
            left -= weeks * week;
        } else if (std::abs(left) >= day) {
            const double days = std::trunc(left / day);
            add(fmt::format("{:.0f} day{}", std::abs(days), std::abs(days) == 1.0 ? "" : "s"));
            left -= days * day;
        }
        if (left != 0.0) add(fmt::format("{:.0f} h (a time zone?)", std::abs(left / hour)));
        if (seconds != 0.0) add(fmt::format("the {:.0f} leap seconds between UTC and GPS time", leap));
        return known;
    }
    return std::nullopt;
}

ClockDrift drift_of(const std::vector<LagCurve>& curves) {
    ClockDrift out;
    constexpr std::size_t least = 12;
    if (curves.size() < least) return out;
    constexpr double most = 400.0, pitch = 10.0;  // ppm
    constexpr int rates = 2 * static_cast<int>(most / pitch) + 1;
    const double middle = 0.5 * (curves.front().t + curves.back().t), span = curves.back().t - curves.front().t;
    if (span < 60.0) return out;
    const std::size_t groups = std::min<std::size_t>(20, curves.size());
    const auto lags = static_cast<std::size_t>(lag_count);
    std::vector<std::vector<double>> cost(groups, std::vector<double>(rates * lags, 0.0));
    for (std::size_t w = 0; w < curves.size(); ++w) {
        std::vector<double>& into = cost[w * groups / curves.size()];
        const std::vector<double>& c = curves[w].horizontal;
        for (int r = 0; r < rates; ++r) {
            const double moved = (pitch * r - most) * 1e-6 * (curves[w].t - middle) / lag_step;  // in units of lag_step
            for (std::size_t i = 0; i < lags; ++i) {
                // parabolic interpolation between the lags: linear interpolation would favour drifts that coincide with them
                const double at = std::clamp(static_cast<double>(i) + moved, 0.0, static_cast<double>(lags - 1));
                const auto k = std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(at)), 1, lags - 2);
                const double x = at - static_cast<double>(k);
                into[static_cast<std::size_t>(r) * lags + i] +=
                    c[k] + 0.5 * x * (c[k + 1] - c[k - 1]) + 0.5 * x * x * (c[k + 1] - 2.0 * c[k] + c[k - 1]);
            }
        }
    }
    std::vector<double> total(rates * lags, 0.0), ridge(rates);
    for (const auto& g : cost)
        for (std::size_t i = 0; i < total.size(); ++i) total[i] += g[i];
    const auto best = [&](const std::vector<double>* without, bool& inside) {
        for (int r = 0; r < rates; ++r) {
            std::vector<double> row(lags);
            for (std::size_t i = 0; i < lags; ++i) {
                const std::size_t at = static_cast<std::size_t>(r) * lags + i;
                row[i] = total[at] - (without != nullptr ? (*without)[at] : 0.0);
            }
            ridge[static_cast<std::size_t>(r)] = lowest_point(0.0, 1.0, row).value;
        }
        const Minimum m = lowest_point(-most, pitch, ridge);
        inside = m.inside;
        return m.at;
    };
    const double slope = best(nullptr, out.found);
    double mean = 0.0, squares = 0.0;
    std::vector<double> places;
    for (const auto& g : cost) {
        bool inside = false;
        places.push_back(best(&g, inside));
        mean += places.back() / static_cast<double>(groups);
    }
    for (const double p : places) squares += (p - mean) * (p - mean);
    out.ppm = -slope;
    out.sigma = std::hypot(std::sqrt(squares * (static_cast<double>(groups) - 1.0) / static_cast<double>(groups)), 0.3 * pitch);
    return out;
}

void set_clock(ImuSeries& imu, double shift, double drift_ppm, double from) {
    for (double& t : imu.t) t += shift - drift_ppm * 1e-6 * (t - from);
}

}  // namespace schuler::inspect::detail
