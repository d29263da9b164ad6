#include "schuler/fusion/tuning/tune.h"

#include "schuler/core/units.h"
#include "schuler/filter/stream/fix_noise.h"
#include "schuler/filter/update/vibration.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/trial.h"
#include "schuler/fusion/tuning/trial_judge.h"
#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <map>
#include <utility>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

struct Minimum {
    double at = 0.0;
    double step = 0.0;                ///< spacing of the last trials
    std::map<double, double> trials;  ///< arguments and results
};

/// A value not returned by any trial.
constexpr double untried = 1e9;

/// One sigma of a minimum of a negative log-likelihood (`scale` times the argument), from the distance at which it has risen
/// clearly: it changes by a few units depending on the rejection of single fixes. If it does not rise, the distance searched.
double sigma_of(const Minimum& minimum, double scale) {
    constexpr double clear = 4.0;
    const double lowest = minimum.trials.at(minimum.at);
    const auto side = [&](auto first, auto last) {
        double farthest = 0.0;
        for (auto it = first; it != last; ++it) {
            if (it->second >= untried) continue;
            const double away = std::abs(it->first - minimum.at), rise = (it->second - lowest) * scale;
            if (away > 0.0 && rise >= clear) return away / std::sqrt(2.0 * rise);
            farthest = std::max(farthest, away);
        }
        return farthest;
    };
    const auto at = minimum.trials.find(minimum.at);
    return std::max(
        {side(at, minimum.trials.end()), side(std::make_reverse_iterator(at), minimum.trials.rend()), 0.5 * minimum.step});
}

/// Minimum of f on a grid, refined by halving the grid step; arguments below `least` or above `most` are not tried.
Minimum minimise(const std::function<double(double)>& f, double low, double high, int points, int refinements, double least,
                 double most) {
    low = std::clamp(low, least, most);
    high = std::clamp(high, least, most);
    double step = (high - low) / (points - 1), best = low, best_cost = 1e300;
    std::map<double, double> trials;
    for (int i = 0; i < points; ++i) {
        const double x = low + step * i;
        if (trials.contains(x)) continue;
        const double c = f(x);
        trials[x] = c;
        if (c < best_cost) {
            best = x;
            best_cost = c;
        }
    }
    for (int r = 0; r < refinements; ++r) {
        step *= 0.5;
        for (const double x : {std::max(least, best - step), std::min(most, best + step)}) {
            if (trials.contains(x)) continue;
            const double c = f(x);
            trials[x] = c;
            if (c < best_cost) {
                best = x;
                best_cost = c;
            }
        }
    }
    return {best, step, std::move(trials)};
}

}  // namespace

double as_written(double si, double unit) { return std::strtod(fmt::format("{:.6g}", si / unit).c_str(), nullptr) * unit; }

MissingStd missing_std(const Recording& recording) {
    MissingStd missing;
    for (const GnssFix& fix : recording.gnss) {
        for (int i = 0; i < 3; ++i) {
            missing.position = missing.position || !is_stated(fix.std_position(i));
            missing.velocity = missing.velocity || (std::isfinite(fix.velocity_n(i)) && !is_stated(fix.std_velocity(i)));
        }
    }
    return missing;
}

std::vector<FixNoise> fix_noise(const Recording& recording, const GnssSettings& settings, WarningLog& warnings) {
    std::vector<FixNoise> noise;
    noise.reserve(recording.gnss.size());
    std::size_t no_position = 0, no_velocity = 0;
    for (const GnssFix& fix : recording.gnss) {
        bool position = true, velocity = true;
        for (int i = 0; i < 3; ++i) {
            position = position && is_stated(fix.std_position(i));
            velocity = velocity && (is_stated(fix.std_velocity(i)) || !std::isfinite(fix.velocity_n(i)));
        }
        no_position += position ? 0 : 1;
        no_velocity += velocity ? 0 : 1;
        noise.push_back(noise_of(fix, settings));
    }
    if (no_position > 0)
        warnings.add("gnss.std",
                     fmt::format("{} GNSS epochs have no usable position sigma: {:.2f}, {:.2f}, {:.2f} m (north, east, "
                                 "down) are used",
                                 no_position, settings.default_std_position(0), settings.default_std_position(1),
                                 settings.default_std_position(2)));
    if (no_velocity > 0 && settings.use_velocity)
        warnings.add("gnss.std_velocity", fmt::format("{} GNSS epochs have no usable velocity sigma: {:.3f}, {:.3f}, {:.3f} m/s "
                                                      "are used",
                                                      no_velocity, settings.default_std_velocity(0),
                                                      settings.default_std_velocity(1), settings.default_std_velocity(2)));
    return noise;
}

namespace {

/// m: upper limit of the wander of any receiver; a poor model of the inertial unit must not be taken for it.
constexpr double most_wander = 2.5;
/// Slow errors north, east, down of a receiver relative to the horizontal ones: all satellites are on one side of it. `stated`: typical
/// sigmas of the log, zero if there are none; a smaller ratio than usual is accepted, or nothing would be left for the white part.
Vector3d upright(const Vector3d& stated) {
    constexpr double usual = 1.5;
    return {1.0, 1.0, stated.x() > 0.0 && stated.z() > 0.0 ? std::clamp(stated.z() / stated.x(), 1.0, usual) : usual};
}

/// Median of the sigmas stated by a receiver without corrections, m, NED; 0 if most fixes have corrections.
Vector3d stated_by_autonomous(const Recording& recording) {
    Vector3d out = Vector3d::Zero();
    for (int i = 0; i < 3; ++i) {
        std::vector<double> stated;
        for (const GnssFix& f : recording.gnss)
            if (f.fix == FixType::Autonomous || (f.fix == FixType::Unknown && f.std_position(i) > 0.5))
                stated.push_back(f.std_position(i));
        std::erase_if(stated,
                      [](double s) { return !(s > 0.0 && s < 20.0); });  // m: corrected ones are better, useless ones are white
        if (2 * stated.size() > recording.gnss.size()) out(i) = math::median(std::move(stated));
    }
    return out;
}

/// A positive setting searched on a logarithmic scale about its value before tuning; never NaN, retained between rounds.
struct LogKnob {
    const char* key;                               ///< of dataset.toml
    std::function<void(Settings&, double)> apply;  ///< sets the setting to its initial value times exp(x)
    double low, high;                              ///< of x, first round
    bool surroundings = false;
    double least = -1e3, most = 1e3;      ///< of x, in every round
    double expected = 0.0, spread = 0.0;  ///< of x a priori, one sigma; 0: no prior
    double x = 0.0;

    /// Negative logarithm of its prior density.
    [[nodiscard]] double surprise(double at) const { return spread > 0.0 ? 0.5 * std::pow((at - expected) / spread, 2) : 0.0; }
};

bool is_precise(const Recording& recording) {
    return std::ranges::any_of(recording.gnss,
                               [](const GnssFix& f) { return f.fix == FixType::RtkFixed || f.fix == FixType::RtkFloat; });
}

filter::Vibration mean_vibration(const ImuTimeline& imu) {
    filter::Vibration now, mean;
    for (const ImuIncrement& increment : imu.increments) {
        now.add(increment);
        mean.gyro_psd += now.gyro_psd;
        mean.accel_psd += now.accel_psd;
    }
    mean.gyro_psd /= static_cast<double>(imu.increments.size());
    mean.accel_psd /= static_cast<double>(imu.increments.size());
    return mean;
}

std::vector<LogKnob> noise_knobs(const Settings& before, const Recording& recording, const ImuTimeline& imu_log,
                                 MissingStd missing, bool has_velocity) {
    std::vector<LogKnob> knobs;
    const sensor::ImuErrorModel imu = before.imu.errors;
    const GnssSettings g = before.gnss;
    // Loggers stamp fixes on arrival. The effect on the fixes depends on the motion like the unit's errors, so it is estimated first.
    const double least_jitter = std::log(0.003), most_jitter = std::log(0.35);  // s
    if (before.imu.estimate_noise && !g.jitter)
        knobs.push_back({"gnss.jitter_s", [](Settings& s, double x) { s.gnss.jitter = std::exp(x); }, least_jitter, std::log(0.2),
                         false, least_jitter, most_jitter});
    if (before.imu.estimate_noise) {
        // White noise cannot exceed the differences of successive samples. Without this bound all errors not explained by the
        // trial's states are attributed to it, resulting in a filter without heading information that becomes uncertain at rest.
        constexpr double all = 1.5, worse = 3.0;  // of the observed value, of the grade
        const filter::Vibration mean = mean_vibration(imu_log);
        const double shaken = std::log(all), none = -3.0;
        // If the fixes are too poor to determine it, the value of the grade is used.
        constexpr double spread = 1.5;  // a factor of 4.5
        const double most_gyro = std::log(std::max(worse, all * std::sqrt(mean.gyro_psd) / imu.gyro_noise));
        const double most_accel = std::log(std::max(worse, all * std::sqrt(mean.accel_psd) / imu.accel_noise));
        if (!before.imu.gyro_vibration)
            knobs.push_back({"imu.gyro_vibration", [](Settings& s, double x) { s.imu.gyro_vibration = std::exp(x); }, none,
                             shaken, false, none, shaken, none, 2.0 * spread});
        if (!before.imu.accel_vibration)
            knobs.push_back({"imu.accel_vibration", [](Settings& s, double x) { s.imu.accel_vibration = std::exp(x); }, none,
                             shaken, false, none, shaken, none, 2.0 * spread});
        knobs.push_back({"imu.gyro_noise_deg_sqrt_h",
                         [imu](Settings& s, double x) { s.imu.errors.gyro_noise = std::exp(x) * imu.gyro_noise; }, -1.4, 4.2,
                         false, -1e3, most_gyro, 0.0, spread});
        knobs.push_back({"imu.accel_noise_m_s_sqrt_h",
                         [imu](Settings& s, double x) { s.imu.errors.accel_noise = std::exp(x) * imu.accel_noise; }, -1.4, 5.6,
                         false, -1e3, most_accel, 0.0, spread});
    }
    if (g.estimate_std && missing.position) {
        knobs.push_back({"gnss.default_std_m",
                         [g](Settings& s, double x) {
                             s.gnss.default_std_position.head<2>() = std::exp(x) * g.default_std_position.head<2>();
                         },
                         -4.0, 1.2});
        knobs.push_back(
            {"gnss.default_std_m",
             [g](Settings& s, double x) { s.gnss.default_std_position.z() = std::exp(x) * g.default_std_position.z(); }, -4.0,
             1.2});
    }
    const bool precise = is_precise(recording);
    // Receivers have correlated errors: internal filters, atmosphere, multipath. Their size follows from the correlation of
    // innovations; with stated sigmas, the physics of a receiver without corrections gives a lower bound. A fixed solution with
    // stated sigmas has hardly any. The correlation time cannot be found from minutes of data: ten minutes, as for the atmosphere,
    // so that no solution averages below the receiver's stated accuracy.
    const auto wander = [&](double sigma, double time, double low, double high, double least) {
        const Vector3d axes = upright(stated_by_autonomous(recording));
        knobs.push_back({"gnss.correlated_m",
                         [=](Settings& s, double x) {
                             s.gnss.errors.correlated_position = std::min(most_wander, sigma * std::exp(x)) * axes;
                             s.gnss.errors.correlated_time = time;
                         },
                         low, high, false, least});
    };
    if (g.estimate_std && g.errors.correlated_position.isZero()) {
        if (missing.position) wander(0.5, 60.0, -3.0, 0.0, -1e3);
        else if (before.imu.estimate_noise && !precise) wander(0.3, 600.0, 0.0, 2.3, 0.0);
    }
    // A log's own sigmas may be far too small; if they are too large only accuracy is lost.
    const auto larger = [](double x) { return std::exp(std::max(0.0, x)); };
    if (g.estimate_std && before.imu.estimate_noise && !missing.position)
        knobs.push_back({"gnss.std_scale", [g, larger](Settings& s, double x) { s.gnss.std_scale = larger(x) * g.std_scale; },
                         0.0, 3.5, false, 0.0});
    if (g.estimate_std && before.imu.estimate_noise && !missing.velocity && has_velocity)
        knobs.push_back({"gnss.velocity_std_scale",
                         [g, larger](Settings& s, double x) { s.gnss.velocity_std_scale = larger(x) * g.velocity_std_scale; },
                         0.0, 3.5, false, 0.0});
    if (g.estimate_std && missing.velocity && has_velocity) {
        knobs.push_back({"gnss.default_std_velocity_m_s",
                         [g](Settings& s, double x) {
                             s.gnss.default_std_velocity.head<2>() = std::exp(x) * g.default_std_velocity.head<2>();
                         },
                         -2.0, 2.0});
        knobs.push_back(
            {"gnss.default_std_velocity_m_s",
             [g](Settings& s, double x) { s.gnss.default_std_velocity.z() = std::exp(x) * g.default_std_velocity.z(); }, -2.0,
             2.0});
    }
    // A receiver's own filter smooths its velocities: their errors last for seconds, common to successive fixes. A stated sigma does not
    // tell; what it contains of multipath lasts longer.
    if (g.estimate_std && before.imu.estimate_noise && has_velocity && g.errors.correlated_velocity.isZero()) {
        const double time = missing.velocity ? 3.0 : 10.0;  // s
        const double least = std::log(missing.velocity ? 0.02 : 0.005), most = std::log(missing.velocity ? 1.0 : 0.3);
        knobs.push_back({"gnss.correlated_velocity_m_s",
                         [time](Settings& s, double x) {
                             s.gnss.errors.correlated_velocity = std::exp(x) * Vector3d(1.0, 1.0, 1.5);
                             s.gnss.errors.correlated_velocity_time = time;
                         },
                         least, most, false, least, most});
    }
    if (before.imu.estimate_noise && before.baro.use && !recording.baro.empty()) {
        const BaroSettings b = before.baro;
        if (b.fit_std)
            knobs.push_back({"baro.white_m", [b](Settings& s, double x) { s.baro.std = std::exp(x) * b.std; }, -3.0, 1.5, true});
        if (b.fit_bias_walk)
            knobs.push_back({"baro.bias_walk_m", [b](Settings& s, double x) { s.baro.bias_walk = std::exp(x) * b.bias_walk; },
                             -2.0, 3.0, true});
    }
    if (before.imu.estimate_noise && before.mag.use && !recording.mag.empty()) {
        const MagSettings m = before.mag;
        if (m.fit_heading_std)
            knobs.push_back({"mag.heading_std_deg",
                             [m](Settings& s, double x) { s.mag.heading_std = std::exp(x) * m.heading_std; }, -2.0, 2.0, true});
        if (m.fit_bias_walk)
            knobs.push_back({"mag.heading_bias_walk_deg",
                             [m](Settings& s, double x) { s.mag.bias_walk = std::exp(x) * m.bias_walk; }, -3.0, 3.0, true});
        // One log draws the deviations of a body only once: they tell little of their sigma.
        constexpr double half = -0.7, most = 1.0;
        // A disturbance that is not given is found on its own, not as the quarter of what is tried for the deviation.
        const double disturbance = m.used_disturbance();
        if (m.deviation_std > 0.0 && m.fit_deviation)
            knobs.push_back({"mag.heading_deviation_deg",
                             [m, disturbance](Settings& s, double x) {
                                 s.mag.deviation_std = std::exp(x) * m.deviation_std;
                                 if (!std::isfinite(s.mag.disturbance_std)) s.mag.disturbance_std = disturbance;
                             },
                             half, most, true, half, most});
        if (disturbance > 0.0 && m.fit_disturbance)
            knobs.push_back({"mag.heading_disturbance_deg",
                             [disturbance](Settings& s, double x) { s.mag.disturbance_std = std::exp(x) * disturbance; }, -1.4,
                             1.4, true, -1.4, 1.6, 0.0, 1.0});
    }
    return knobs;
}

/// Fitted values are limited by the physics of the devices, however quiet they were in the trial: a receiver without stated
/// sigmas and corrections has correlated errors of a metre (open services reach 2 to 4 m at 95 % horizontally) and a scatter of
/// some centimetres; a magnetometer's errors change with its vehicle's direction and currents.
void keep_physical(Settings& settings, const Settings& before, const Recording& recording, MissingStd missing) {
    constexpr double least_white = 0.1, least_slow = 1.0, least_velocity = 0.02, least_heading = 0.02;  // m, m, m/s, rad
    const bool precise = is_precise(recording);
    GnssSettings& g = settings.gnss;
    // The accuracy stated by an autonomous receiver is mostly that of its slow errors, which minutes of a log do not fully reveal.
    if (before.gnss.estimate_std && before.imu.estimate_noise && !missing.position &&
        before.gnss.errors.correlated_position.isZero()) {
        const Vector3d stated = stated_by_autonomous(recording), axes = upright(stated);
        constexpr double refuted =
            1.5;  // the fixes scatter by this much more than stated: the stated values do not include their slow errors either
        const bool is_refuted = g.std_scale > refuted && stated.x() > 0.0;
        const Vector3d accuracy = is_refuted ? Vector3d((g.std_scale * stated).cwiseMax(least_slow * axes)) : stated;
        const Vector3d slow = g.errors.correlated_position.cwiseMax(accuracy.cwiseMin(most_wander * axes));
        // The fitted value is the scatter: a larger slow part increases the total, and does not reduce the white part.
        if (stated.x() > 0.0 && slow.x() > g.errors.correlated_position.x()) {
            const double white = white_part(g.std_scale * stated.x(), g.errors.correlated_position.x());
            g.std_scale = std::max(g.std_scale, std::hypot(white, slow.x()) / stated.x());
        }
        g.errors.correlated_position = slow;
    }
    if (before.gnss.estimate_std && missing.position && !precise) {
        g.default_std_position = g.default_std_position.cwiseMax(least_white);
        if (before.gnss.errors.correlated_position.isZero())  // at least as large as the scatter
            g.errors.correlated_position = g.errors.correlated_position.cwiseMax(g.default_std_position.cwiseMin(most_wander))
                                               .cwiseMax(least_slow * upright(Vector3d::Zero()));
    }
    if (before.gnss.estimate_std && missing.velocity) g.default_std_velocity = g.default_std_velocity.cwiseMax(least_velocity);
    if (before.imu.estimate_noise && before.mag.use && before.mag.fit_heading_std)
        settings.mag.heading_std = std::max(settings.mag.heading_std, std::min(least_heading, before.mag.heading_std));
}

/// Search range of a latency, s.
struct Reach {
    double around = 0.0, size = 1e9;
    [[nodiscard]] bool holds(double x) const { return std::abs(x - around) <= size; }
};

}  // namespace

void tune(RunData& data, Settings& settings, const Start& start, const FixScreen& screen, Findings& findings,
          WarningLog& warnings) {
    TrialJudge judge(data, start, settings.gnss, screen);
    const MissingStd missing = missing_std(*data.recording);
    const Settings before = settings;
    const bool has_velocity =
        settings.gnss.use_velocity && std::any_of(data.recording->gnss.begin(), data.recording->gnss.end(),
                                                  [](const GnssFix& f) { return f.velocity_n.head<2>().allFinite(); });
    std::vector<LogKnob> knobs = noise_knobs(before, *data.recording, data.imu, missing, has_velocity);
    findings.tuned_from = start.nav.time;
    findings.tuned_to = judge.stop();
    // Latencies measured from motion in windows (with a sigma) are searched within their uncertainty: the likelihood of a whole
    // trial attributes unexplained effects, such as a fault of the inertial unit, to any latency.
    const auto reach = [&](double sigma) {
        constexpr double unmeasured = 0.15, sigmas = 4.0;  // s
        return sigma > 0.0 && sigma < unmeasured ? Reach{before.gnss.latency, sigmas * sigma} : Reach{};
    };
    const Reach near_position = reach(before.gnss.latency_std),
                near_velocity =
                    reach(before.gnss.velocity_latency_std > 0.0 ? before.gnss.velocity_latency_std : before.gnss.latency_std);
    const auto search = [&](const char* key, bool relative, const std::function<void(Settings&, double)>& apply, double low,
                            double high, int points, int refinements, bool surroundings, double least = -1e3, double most = 1e3,
                            const Reach& within = {}, const LogKnob* knob = nullptr) {
        const Minimum best = minimise(
            [&](double x) {
                if (!within.holds(x)) return untried;
                Settings s = settings;
                apply(s, x);
                const double cost = judge.cost(s, surroundings);
                return knob != nullptr && judge.count() > 0.0 ? cost + knob->surprise(x) / judge.count() : cost;
            },
            low, high, points, refinements, least, most);
        apply(settings, best.at);
        const bool torn =
            std::abs(best.at - within.around) > 0.6 * within.size;  // between the measurement and the result of the trials
        const double sigma = torn ? 0.5 * within.size : sigma_of(best, judge.count());
        const auto same = std::ranges::find(findings.tuned, key, &TunedSetting::key);
        if (same == findings.tuned.end()) findings.tuned.push_back({key, sigma, relative});
        else same->sigma = sigma;
        return best.at;
    };
    for (int round = 0; round < (knobs.empty() ? 1 : 3); ++round) {
        for (LogKnob& k : knobs) {
            k.x = round == 0 ? search(k.key, true, k.apply, k.low, k.high, 5, 1, k.surroundings, k.least, k.most, {}, &k)
                             : search(k.key, true, k.apply, k.x - 0.7, k.x + 0.7, 3, 2, k.surroundings, k.least, k.most, {}, &k);
        }
        if (!settings.gnss.estimate_latency) continue;
        // The common latency, determined by the inertial unit, and then the difference for the velocities, determined by the fixes.
        const double now = settings.gnss.latency;
        const bool apart = settings.gnss.velocity_latency && !before.gnss.velocity_latency;
        const double difference = apart ? *settings.gnss.velocity_latency - now : 0.0;
        const auto both = [=](Settings& s, double x) {
            s.gnss.latency = x;
            if (apart) s.gnss.velocity_latency = x + difference;
        };
        if (round == 0) search("gnss.latency_s", false, both, -0.2, 0.5, 8, 2, false, -1e3, 1e3, near_position);
        else search("gnss.latency_s", false, both, now - 0.1, now + 0.1, 5, 2, false, -1e3, 1e3, near_position);
        const auto sigma = [&](const char* key) -> double& {
            return std::ranges::find(findings.tuned, key, &TunedSetting::key)->sigma;
        };
        // Given the latency of the velocities, the fixes determine the additional latency of the positions, and no more.
        if (has_velocity && before.gnss.velocity_latency)
            sigma("gnss.latency_s") = std::hypot(sigma("gnss.latency_s"), 0.5 * before.gnss.velocity_latency_std);
        if (has_velocity && !before.gnss.velocity_latency) {
            const double velocity = settings.gnss.velocity_latency.value_or(settings.gnss.latency);
            search(
                "gnss.velocity_latency_s", false, [](Settings& s, double x) { s.gnss.velocity_latency = x; }, velocity - 0.2,
                velocity + 0.2, 5, 4, false, -1e3, 1e3, near_velocity);
            sigma("gnss.velocity_latency_s") = std::hypot(sigma("gnss.velocity_latency_s"), sigma("gnss.latency_s"));
        }
        if (has_velocity && !before.gnss.velocity_down_latency) {
            // A receiver delays the vertical velocity by little more than the horizontal: farther off, another period fits.
            constexpr double apart_most = 0.25;  // s
            const double horizontal = settings.gnss.velocity_latency.value_or(settings.gnss.latency),
                         down = settings.gnss.velocity_down_latency.value_or(horizontal);
            search("gnss.velocity_down_latency_s", false, [](Settings& s, double x) { s.gnss.velocity_down_latency = x; },
                   down - 0.2, down + 0.2, 5, 3, false, -1e3, 1e3, {horizontal, apart_most});
        }
    }
    const Settings fitted = settings;
    keep_physical(settings, before, *data.recording, missing);
    const auto note_floor = [&](const char* key, bool raised) {
        const auto same = std::ranges::find(findings.tuned, key, &TunedSetting::key);
        if (raised && same != findings.tuned.end()) same->at_floor = true;
    };
    note_floor("gnss.correlated_m", settings.gnss.errors.correlated_position != fitted.gnss.errors.correlated_position);
    note_floor("gnss.default_std_m", settings.gnss.default_std_position != fitted.gnss.default_std_position);
    note_floor("gnss.default_std_velocity_m_s", settings.gnss.default_std_velocity != fitted.gnss.default_std_velocity);
    note_floor("mag.heading_std_deg", settings.mag.heading_std != fitted.mag.heading_std);
    if (before.imu.estimate_noise) {
        sensor::ImuErrorModel& imu = settings.imu.errors;
        imu.gyro_noise = as_written(imu.gyro_noise, units::deg_per_sqrt_hour);
        imu.accel_noise = as_written(imu.accel_noise, units::m_s_per_sqrt_hour);
        for (std::optional<double>* share : {&settings.imu.gyro_vibration, &settings.imu.accel_vibration})
            if (*share) *share = as_written(**share, 1.0);
        if (settings.gnss.jitter) settings.gnss.jitter = as_written(*settings.gnss.jitter, 1.0);
        for (double MagSettings::*sigma :
             {&MagSettings::heading_std, &MagSettings::bias_walk, &MagSettings::deviation_std, &MagSettings::disturbance_std})
            settings.mag.*sigma = as_written(settings.mag.*sigma, units::deg);
    }
    findings.std_position_scale = settings.gnss.default_std_position.cwiseQuotient(before.gnss.default_std_position);
    findings.std_velocity_scale = settings.gnss.default_std_velocity.cwiseQuotient(before.gnss.default_std_velocity);
    WarningLog unheard;
    data.events = make_events(*data.recording, settings, data.origin, unheard, screen);
    data.fix_noise = fix_noise(*data.recording, settings.gnss, missing.position || missing.velocity ? warnings : unheard);
}

}  // namespace schuler::fusion
