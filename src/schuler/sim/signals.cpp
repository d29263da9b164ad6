#include "schuler/sim/signals.h"

#include "schuler/core/error.h"
#include "schuler/gnss/satellite.h"
#include "schuler/math/random.h"
#include "schuler/sim/detail/require.h"
#include "schuler/sim/detail/sight_lines.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

namespace schuler::sim {

namespace {

constexpr double rate = 20.0;              // Hz
constexpr std::size_t lead = 2;            // samples before the start, for the slopes
constexpr double chip_rate = 1.023e6;      // chips/s, of GPS L1 C/A
constexpr double received_power = -158.5;  // dBW, its least [ISGPS200:6.3.1]

using detail::require;

double strength_at(const SignalSettings& s, double t) {
    if (s.profile.empty()) return s.cn0;
    const auto next = std::ranges::upper_bound(s.profile, t, {}, &StrengthPoint::time);
    if (next == s.profile.begin()) return next->cn0;
    const StrengthPoint& a = *(next - 1);
    if (next == s.profile.end()) return a.cn0;
    return a.cn0 + (next->cn0 - a.cn0) * (t - a.time) / (next->time - a.time);
}

/// Power of a jammer at the antenna in watts, by free-space propagation.
double received_from(const Jammer& j, const Ecef& antenna, const earth::Ellipsoid& ellipsoid, double t) {
    if (t < j.start || t >= j.start + j.duration) return 0.0;
    const double distance = std::max(1.0, (earth::ecef_from_geodetic(ellipsoid, j.position).r - antenna.r).norm());
    const double wavelength = gnss::speed_of_light / gnss::l1_frequency;
    return j.power * std::pow(wavelength / (4.0 * std::numbers::pi * distance), 2);
}

}  // namespace

void check(const SignalSettings& s) {
    require(s.ranging.stations.empty(), "ranges.stations", "a satellite receiver does not track them",
            "leave out [receiver] or the stations");
    require(s.ranging.multipath.amplitude == 0.0, "ranges.multipath_m", "reflections are not simulated in correlators",
            "leave out [receiver] or the reflections");
    require(s.cn0 > 0.0 && s.cn0 < 80.0, "receiver.cn0_db_hz", "is not a valid C/N0", "give 20 to 55 dB-Hz");
    for (std::size_t i = 0; i < s.profile.size(); ++i) {
        require(s.profile[i].cn0 >= -20.0 && s.profile[i].cn0 < 80.0, "receiver.cn0_profile", "has a strength that no signal has",
                "give -20 to 80 dB-Hz");
        require(i == 0 || s.profile[i].time > s.profile[i - 1].time, "receiver.cn0_profile", "is not in order of time",
                "sort it by time_s");
    }
    for (const Jammer& j : s.jammers)
        require(j.power > 0.0 && j.spread > 0.0, "receiver.jammer", "has no power, or no spread", "give watts, and 1 to 2.22");
}

Signals::Signals(const RangingScenario& scenario, const TruthPath& path, const SignalSettings& settings) {
    check(settings);
    const auto count = static_cast<std::size_t>(std::ceil(scenario.duration * rate)) + 2 * lead + 2;
    const auto time = [](std::size_t k) { return (static_cast<double>(k) - static_cast<double>(lead)) / rate; };
    const detail::SightLines lines(scenario, path, settings.ranging);
    const sensor::RangeErrorModel& slow = settings.ranging.errors.satellite;
    for (const detail::Transmitter& transmitter : lines.transmitters()) {
        if (!lines.allowed(transmitter)) continue;
        Track track;
        track.satellite = *transmitter.satellite;
        std::ranges::copy_if(settings.ranging.faults, std::back_inserter(track.faults),
                             [&](const RangeFault& f) { return f.source == transmitter.name; });
        bool seen = false;
        math::Random random(scenario.seed, "signals.slow." + transmitter.name);
        const double kept = std::exp(-1.0 / (rate * slow.correlation_time));
        double delay = slow.correlated * random.normal();
        math::Random random_rate(scenario.seed, "signals.slow_rate." + transmitter.name);
        const double left = std::exp(-1.0 / (rate * slow.correlated_rate_time));
        double rate_error = slow.correlated_rate * random_rate.normal();
        for (std::size_t k = 0; k < count; ++k) {
            // before the start the path is extrapolated from its initial state
            const double t = time(k), on_path = std::max(t, 0.0);
            const auto line = lines.to(transmitter, on_path);
            const bool view = line && lines.above_masks(transmitter, *line, on_path);
            seen = seen || view;
            track.range.push_back(line ? line->range - gnss::speed_of_light * line->transmitter.clock : 0.0);
            track.state.push_back(static_cast<char>(!view ? 0 : lines.silent(transmitter, on_path) ? 1 : 2));
            track.delay.push_back(static_cast<float>(delay));
            delay = kept * delay + std::sqrt(1.0 - kept * kept) * slow.correlated * random.normal();
            if (!(slow.correlated_rate > 0.0)) continue;
            track.rate_error.push_back(static_cast<float>(rate_error));
            rate_error = left * rate_error + std::sqrt(1.0 - left * left) * slow.correlated_rate * random_rate.normal();
        }
        for (std::size_t k = lead; k-- > 0;)
            track.range[k] = 3.0 * track.range[k + 1] - 3.0 * track.range[k + 2] + track.range[k + 3];
        if (seen) tracks_.push_back(std::move(track));
    }
    for (std::size_t k = 0; k < count; ++k) {
        const double t = std::max(time(k), 0.0);
        const Kinematics at = path.at(t);
        const Ecef place = earth::ecef_from_geodetic(scenario.earth.ellipsoid, at.position);
        double ratio = 0.0, noise = 0.0;
        for (const Jammer& j : settings.jammers) {
            const double js = received_from(j, place, scenario.earth.ellipsoid, t) / std::pow(10.0, received_power / 10.0);
            ratio += js;
            noise += js / (j.spread * chip_rate);
        }
        const double clean = strength_at(settings, t);
        clean_.push_back(static_cast<float>(clean));
        jammed_.push_back(static_cast<float>(-10.0 * std::log10(std::pow(10.0, -clean / 10.0) + noise)));
        ratio_.push_back(static_cast<float>(10.0 * std::log10(ratio)));
    }
}

std::size_t Signals::index(double t, double& part) const {
    const double at = std::max(t, 0.0) * rate + static_cast<double>(lead);
    const auto k = std::min(static_cast<std::size_t>(at), clean_.size() - lead - 2);
    part = at - static_cast<double>(k);
    return k;
}

SignalMotion Signals::motion(std::size_t i, double t) const {
    double s = 0.0;
    const std::size_t k = index(t, s);
    const double* r = tracks_[i].range.data() + k;
    const auto slope = [](const double* x) { return (8.0 * (x[1] - x[-1]) - (x[2] - x[-2])) / 12.0; };  // a sample
    // Hermite's cubic between samples k and k + 1
    const double m0 = slope(r), m1 = slope(r + 1), d = r[1] - r[0];
    const double c2 = 3.0 * d - 2.0 * m0 - m1, c3 = m0 + m1 - 2.0 * d;
    SignalMotion out{r[0] + s * (m0 + s * (c2 + s * c3)), rate * (m0 + s * (2.0 * c2 + 3.0 * s * c3)),
                     rate * rate * (2.0 * c2 + 6.0 * s * c3), rate * rate * rate * 6.0 * c3};
    for (const RangeFault& f : tracks_[i].faults) {
        if (!f.active(t)) continue;
        out.rate += f.rate_error();
        out.range += f.of_carrier(t);
    }
    return out;
}

bool Signals::in_view(std::size_t i, double t) const {
    double s = 0.0;
    return tracks_[i].state[index(t, s)] > 0;
}

double Signals::cn0(std::size_t i, double t) const {
    double s = 0.0;
    const std::size_t k = index(t, s);
    if (tracks_[i].state[k] < 2) return 0.0;
    return std::pow(10.0, (jammed_[k] + s * (jammed_[k + 1] - jammed_[k])) / 10.0);
}

double Signals::code_delay(std::size_t i, double t) const {
    double s = 0.0;
    const std::size_t k = index(t, s);
    const std::vector<float>& d = tracks_[i].delay;
    double delay = d[k] + s * (d[k + 1] - d[k]);
    for (const RangeFault& f : tracks_[i].faults)
        if (f.active(t)) delay += f.error(t) - f.of_carrier(t);
    return delay;
}

double Signals::rate_error(std::size_t i, double t) const {
    const std::vector<float>& e = tracks_[i].rate_error;
    if (e.empty()) return 0.0;
    double s = 0.0;
    const std::size_t k = index(t, s);
    return e[k] + s * (e[k + 1] - e[k]);
}

double Signals::jammer_to_signal(double t) const {
    double s = 0.0;
    return ratio_[index(t, s)];
}

}  // namespace schuler::sim
