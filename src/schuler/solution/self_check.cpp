#include "schuler/solution/self_check.h"

#include "schuler/core/parallel.h"
#include "schuler/core/units.h"
#include "schuler/fusion/run_filter.h"
#include "schuler/math/rotation.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/health.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

namespace schuler::solution {
namespace {

using fusion::MeasurementKind;
using fusion::MeasurementStatus;

/// Intervals of standstill and turns in a run.
class Regimes {
public:
    explicit Regimes(const std::vector<SolutionRow>& rows) : rows_(rows) {}

    [[nodiscard]] Regime at(Time t) const {
        constexpr double slow = 0.5, turn = 5.0 * units::deg;  // m/s, rad/s
        const auto next = std::ranges::lower_bound(rows_, t, {}, &SolutionRow::time);
        if (next == rows_.begin() || next == rows_.end()) return Regime::Rest;
        const SolutionRow &after = *next, &before = *std::prev(next);
        const double dt = std::max(1e-3, (after.time - before.time).seconds());
        const double rate = std::abs(math::wrap_pi(after.rpy.z() - before.rpy.z())) / dt;
        if (after.v_eb_n.head<2>().norm() < slow) return Regime::Rest;
        return rate > turn ? Regime::Turning : Regime::Straight;
    }

private:
    const std::vector<SolutionRow>& rows_;
};

/// Fixes of the undisturbed run with their status.
std::vector<CheckFix> fixes_of(const LoadedDataset& data, const fusion::Result& result) {
    std::vector<CheckFix> fixes;
    std::vector<double> sigmas;
    const Regimes regime(result.forward.rows);
    const auto t = [&](Time time) { return (time - data.origin).seconds(); };
    for (const fusion::MeasurementRecord& r : result.measurements)
        if (r.kind == MeasurementKind::GnssPosition && r.sigma.x() > 0.0 && r.status != MeasurementStatus::Withheld) {
            fixes.push_back(
                {t(r.stamp), r.status == MeasurementStatus::Accepted && !r.other_level, regime.at(r.stamp) != Regime::Rest});
            sigmas.push_back(r.sigma.head<2>().norm());
        }
    if (fusion::uses_ranges(data.config.filter.coupling))
        for (const GnssFix& fix : data.recording.gnss)  // used for comparison only
            if (fix.fix != FixType::None && std::isfinite(fix.position.lat)) {
                fixes.push_back({t(fix.time), true, regime.at(fix.time) != Regime::Rest});
                sigmas.push_back(fix.std_position.head<2>().norm());  // NaN: not known
            }
    leave_out_vague(fixes, sigmas);
    // The positions of a receiver in dispute, though within their sigmas, do not tell how good the inertial unit is.
    for (const HealthInterval& h : disputes_of(health_of(data, result)))
        for (CheckFix& f : fixes) f.good &= !(f.t >= t(h.from) && f.t <= t(h.to));
    return fixes;
}

std::array<FixRegime, regimes> by_regime(const fusion::Result& result, const Regimes& motion) {
    std::array<FixRegime, regimes> out;
    for (const fusion::MeasurementRecord& r : result.measurements) {
        const bool used = r.status == MeasurementStatus::Accepted;
        if (r.kind != MeasurementKind::GnssPosition || r.status == MeasurementStatus::Withheld || r.dof == 0 ||
            r.time < result.findings.aligned_at)
            continue;
        FixRegime& f = out[static_cast<std::size_t>(motion.at(r.time))];
        ++f.fixes;
        f.refused += used ? 0 : 1;
        f.inside.add(used && (r.innovation.array().abs() <= 3.0 * r.sigma.array()).all());
        if (used) f.nis += r.nis / r.dof;
    }
    for (FixRegime& f : out) f.nis = f.fixes > f.refused ? f.nis / static_cast<double>(f.fixes - f.refused) : std::nan("");
    return out;
}

/// Every second window, starting with this one.
std::vector<std::size_t> half(std::size_t count, std::size_t first) {
    std::vector<std::size_t> out;
    for (std::size_t i = first; i < count; i += 2) out.push_back(i);
    return out;
}

/// Runs of one log with windows withheld.
class Checker {
public:
    Checker(const LoadedDataset& data, const fusion::Result& result, const CheckWindows& windows)
        : data_(data), windows_(windows), base_(*result.findings.in_force) {
        for (const CheckFix& f : fixes_of(data, result))
            if (!f.good) refused_.insert(Duration::from_seconds(f.t).ns / 1000);
    }

    [[nodiscard]] fusion::Settings with(const NoiseScale& scale) const {
        fusion::Settings s = base_;
        s.imu.gyro_noise_scale = scale.gyro;
        s.imu.accel_noise_scale = scale.accel;
        return s;
    }

    /// The withheld fixes of these windows that were not refused in the undisturbed run; `motion` receives the run's rows.
    std::vector<WithheldEpoch> run(fusion::Settings settings, const std::vector<std::size_t>& chosen,
                                   std::vector<SolutionRow>& motion) const {
        settings.smooth = settings.state_rows = settings.covariance_rows = settings.backward = false;
        settings.output_instants.clear();
        settings.output_lever_arm_b.setZero();
        constexpr double rate = 5.0;  // Hz: sufficient to show the motion
        settings.output_rate = rate;
        const std::size_t first = settings.outages.size();
        for (const std::size_t k : chosen) settings.outages.push_back(windows_.windows[k]);
        WarningLog heard;  // already
        fusion::Result r = fusion::run_filter(data_.recording, settings, heard);
        motion = std::move(r.forward.rows);
        const Regimes regime(motion);
        std::vector<WithheldEpoch> out;
        for (const fusion::OutageEpoch& e : r.forward.outage_epochs) {
            const auto k = static_cast<std::size_t>(e.outage);
            if (e.outage < 0 || k < first) continue;
            const double t = (e.time - data_.origin).seconds();
            if (e.end || refused_.contains(Duration::from_seconds(t).ns / 1000)) continue;
            const std::size_t window = chosen[k - first];
            out.push_back({window, t - windows_.windows[window].start, regime.at(e.time), e.error, e.sigma, e.sigma_state});
        }
        return out;
    }

private:
    const LoadedDataset& data_;
    const CheckWindows& windows_;
    fusion::Settings base_;
    std::set<std::int64_t> refused_;  ///< us after the origin
};

std::vector<WithheldEpoch> both(const std::vector<WithheldEpoch>& a, const std::vector<WithheldEpoch>& b) {
    std::vector<WithheldEpoch> all = a;
    all.insert(all.end(), b.begin(), b.end());
    return all;
}

/// True if neither a barometer nor wheels support the height while there is no fix.
bool height_is_free(const LoadedDataset& data, const fusion::Settings& s) {
    return (data.recording.baro.empty() || !s.baro.use) && !s.constraints.nonholonomic && !s.constraints.nonholonomic_auto;
}

using Halves = std::array<std::vector<WithheldEpoch>, 2>;

/// Both halves of the windows with increased noise until the requesting half is covered, requires no more, or does not improve.
Halves with_wider_noise(const Checker& checker, const std::array<std::vector<std::size_t>, 2>& windows, double length,
                        std::size_t speaks, int axes, int trials, double share, NoiseScale& scale) {
    Halves now;
    for (int trial = 1;; ++trial) {
        for_each_run(2, 2,
                     [&](std::size_t i) {
                         std::vector<SolutionRow> unread;
                         now[i] = checker.run(checker.with(scale), windows[i], unread);
                     },
                     {});
        const Coverage c = coverage_of(now[speaks], length);
        const double now_inside = inside_of(c, axes).share();
        if (trial >= trials || covers(c, axes) || now_inside <= share) return now;
        share = now_inside;
        const NoiseScale more = missing_noise(now[speaks], axes);
        const NoiseScale larger = scale.times(more);
        if (larger.gyro == scale.gyro && larger.accel == scale.accel) return now;
        scale = larger;
    }
}

void check(SelfCheck& out, const LoadedDataset& data, const fusion::Result& result, std::optional<fusion::Settings>& wider) {
    constexpr double settle = 20.0;  // s after alignment
    const fusion::Findings& found = result.findings;
    const double from = ((found.heading_found ? found.aligned_at : found.started_at) - data.origin).seconds() + settle;
    const double to = (result.forward.rows.back().time - data.origin).seconds();
    const CheckWindows windows = check_windows(fixes_of(data, result), from, to, data.config.filter.outages);
    out.why_not = windows.why_none;
    if (!out.done()) return;
    out.length = windows.length;
    const Checker checker(data, result, windows);
    const std::array<std::vector<std::size_t>, 2> halves{half(windows.windows.size(), 0), half(windows.windows.size(), 1)};
    Halves epochs;
    std::array<std::vector<SolutionRow>, 2> motion;
    for_each_run(2, 2, [&](std::size_t i) { epochs[i] = checker.run(*found.in_force, halves[i], motion[i]); }, {});
    out.motion = std::move(motion[0]);
    out.coverage = coverage_of(both(epochs[0], epochs[1]), windows.length);
    const fusion::ImuSettings& imu = data.config.filter.imu;
    if (covers(out.coverage) || imu.gyro_noise_scale || imu.accel_noise_scale || data.config.scheme == settings::Scheme::Separate)
        return;

    // The second half is used if the first requires nothing.
    const int axes = height_is_free(data, *found.in_force) ? 3 : 2;
    std::size_t speaks = 0;
    NoiseScale scale = missing_noise(epochs[0], axes);
    if (scale.is_one()) scale = missing_noise(epochs[speaks = 1], axes);
    if (scale.is_one()) return;
    constexpr std::size_t short_log = 300'000;  // IMU epochs: processing them takes a fraction of the start-up time
    const int trials = data.recording.imu.size() <= short_log ? 3 : 1;
    const double share = inside_of(coverage_of(epochs[speaks], windows.length), axes).share();
    Halves now = with_wider_noise(checker, halves, windows.length, speaks, axes, trials, share, scale);
    const std::size_t judges = 1 - speaks;
    Coverage without = coverage_of(epochs[judges], windows.length), with = coverage_of(now[judges], windows.length);
    // A noise sufficient for one half but not for the other is too small: the other half is then used as well, each is evaluated
    // with the noise required by the other, and the larger noise is adopted.
    const NoiseScale others = covers(with, axes) ? NoiseScale{} : missing_noise(epochs[judges], axes);
    if (others.gyro > scale.gyro || others.accel > scale.accel) {
        NoiseScale second = others;
        const Halves then =
            with_wider_noise(checker, halves, windows.length, judges, axes, trials, inside_of(without, axes).share(), second);
        without = out.coverage;
        with = coverage_of(both(then[speaks], now[judges]), windows.length);
        now = then;
        const NoiseScale larger = scale.or_larger(second);
        if (larger.gyro != second.gyro || larger.accel != second.accel)
            for_each_run(2, 2,
                         [&](std::size_t i) {
                             std::vector<SolutionRow> unread;
                             now[i] = checker.run(checker.with(larger), halves[i], unread);
                         },
                         {});
        scale = larger;
    }
    out.tried = scale;
    const Coverage all = coverage_of(both(now[0], now[1]), windows.length);
    if (!was_missing({without, with, axes}, {out.coverage, all, axes})) return;
    out.before = without;
    out.coverage = with;
    out.all = all;
    out.widened = true;
    wider = checker.with(scale);
}

}  // namespace

void SelfCheck::keep_as_it_was() {
    if (before) coverage = *before;
    before = all = std::nullopt;
    widened = false;
}

void judge_fixes(SelfCheck& check, const fusion::Result& result) {
    if (check.done()) check.fixes = by_regime(result, Regimes(check.motion));
}

SelfCheck self_check(const LoadedDataset& data, const fusion::Result& result, std::optional<fusion::Settings>& wider) {
    const auto begin = std::chrono::steady_clock::now();
    SelfCheck out;
    if (!data.config.run.self_check) out.why_not = "it is switched off (filter.self_check)";
    else if (data.config.scheme == settings::Scheme::Gnss || !result.findings.in_force)
        out.why_not = "the scheme is \"gnss\": there is no filter";
    else if (data.recording.gnss.empty()) out.why_not = "there are no fixes to withhold";
    else {
        try {
            check(out, data, result, wider);
        } catch (const Error& e) {
            out = {};
            out.why_not = fmt::format("with fixes withheld the filter fails: {}", e.reason());
        }
    }
    out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return out;
}

std::string self_check_table(const SelfCheck& c) {
    if (!c.done()) return fmt::format("self-check: none, {}\n", c.why_not);
    const auto percent = [](const Inside& x) { return fmt::format("{:.1f} %", 100.0 * x.share()); };
    std::string out =
        fmt::format("self-check: fixes withheld in {} windows of {:.0f} s{} ({:.2f} s)\n", c.coverage.windows.epochs, c.length,
                    c.widened ? " that had no part in widening" : "", c.seconds);
    const auto line = [&](const char* what, const Coverage& x) {
        out += fmt::format(
            "  {:<24} {:>8} of {} epochs inside 3 sigma (horizontal {}, vertical {}), {} of {} windows held; at the end {:.3g} m "
            "at sigma {:.3g} m\n",
            what, percent(x.epochs), x.epochs.epochs, percent(x.horizontal), percent(x.vertical), x.held.inside, x.held.epochs,
            x.end_rms, x.sigma_rms);
    };
    if (c.before) line("before widening", *c.before);
    line(c.widened ? "with wider noise" : "as it is", c.coverage);
    if (c.all) line("  in all windows", *c.all);
    if (c.tried)
        out += fmt::format(
            "  the other windows indicate {:.3g} times the noise of the gyros and {:.3g} times that of the accelerometers: {}\n",
            c.tried->gyro, c.tried->accel, c.widened ? "in force" : "it makes these no truer, left out");
    for (std::size_t k = 0; k < regimes; ++k) {
        const FixRegime& f = c.fixes[k];
        if (f.fixes == 0) continue;
        const Inside& w = c.coverage.by_regime[k];
        out +=
            fmt::format("  {:<24} {} fixes, {} refused, NIS {:.2f} a component; withheld {}\n", name_of(static_cast<Regime>(k)),
                        f.fixes, f.refused, f.nis, w.epochs > 0 ? percent(w) + " inside" : "none");
    }
    return out;
}

}  // namespace schuler::solution
