// The clocks of IMU and GNSS: test of the stated times with the motion.
#include "schuler/inspect/detail/motion/clock.h"
#include "schuler/inspect/detail/motion/clock_steps.h"
#include "schuler/inspect/detail/study.h"

#include "schuler/core/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

constexpr double decisive = 25.0;  // support of a shift for further evaluation: above chance among all shifts of a day
constexpr double beyond_stated = 15.0;
constexpr double beyond_rival = 6.0;  // a likelihood ratio of 400 to the second best
constexpr double trust_in_known = 5.0;

double leap_seconds(const Study& study) {
    constexpr double dated = 1e8, latest = 18.0;
    const double t = study.gnss_file->report.start_s;
    const bool from_1980 = study.gnss_file->gps_time || (t > dated && t < 1.5e9);
    return from_1980 ? static_cast<double>(gps_minus_utc(static_cast<std::int64_t>(t))) : latest;
}

/// The fit of the IMU to the track at a shift, with the gyros in the unit that the course shows.
MotionFit fit_at(const Study& study, double shift, double window) {
    ImuSeries imu = study.imu;
    set_clock(imu, shift, 0.0, 0.0);
    Eigen::Vector3d f = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < imu.size(); ++i) {
        f += imu.f[i];
        w += imu.w[i] / static_cast<double>(imu.size());
    }
    const CourseSlope course = course_slope(imu, study.gnss, -f.normalized(), w);
    const double unit = gyro_unit_of(course).value_or(GyroUnit{}).factor;
    for (Eigen::Vector3d& rate : imu.w) rate *= unit;
    const StillPeriods still = still_periods(imu, study.gnss);
    const FitSource source = study.gnss.has_velocity() ? FitSource::Velocity : FitSource::Displacement;
    return fit_motion(imu, study.gnss, source, still.w, still.any(), study.gravity, window);
}

struct Choice {
    ClockPeak peak;
    std::optional<KnownShift> known;
    bool unique = false;
    double rival = 0.0;  // support of the second best
};

/// The best shift; a known shift between clocks is preferred to a slightly better one.
std::optional<Choice> best_of(const ClockScan& scan, double leap) {
    if (scan.peaks.empty()) return std::nullopt;
    Choice best{scan.peaks.front(), known_shift(scan.peaks.front().shift, leap), false};
    for (const ClockPeak& p : scan.peaks) {
        if (best.known || p.support < scan.peaks.front().support - trust_in_known) break;
        if (const auto known = known_shift(p.shift, leap)) best = {p, known, false};
    }
    double rival = 0.0;
    for (const ClockPeak& p : scan.peaks) {
        if (std::abs(p.shift - best.peak.shift) < scan.width) continue;
        const bool lesser = best.known && !known_shift(p.shift, leap);
        rival = std::max(rival, p.support - (lesser ? beyond_rival + trust_in_known : 0.0));
    }
    best.rival = rival;
    best.unique = best.peak.support > decisive && best.peak.support - rival > beyond_rival;
    return best;
}

/// Accepted without a fit, which steps, waves and vibration can corrupt: a known shift, or one without any rival.
bool plain(const Choice& best, const ClockScan& scan) {
    constexpr double much = 40.0;
    const double support = best.peak.support;
    return support > much && support > scan.stated + 0.9 * much &&
           (best.known || (support > 1.5 * much && support > best.rival + 0.75 * much));
}

std::string words_of_shift(double shift) {
    return fmt::format("{:.10g} s {}", std::abs(shift), shift < 0.0 ? "earlier" : "later");
}

}  // namespace

bool shows_lag(const Agreement& a) { return a.found && a.contrast >= 0.2 && a.sigma <= 0.1; }
bool shows_lag(const MotionFit& fit) { return fit.windows >= 3 && shows_lag(fit.horizontal); }

void judge_clock_steps(Study& study) {
    if (study.imu_file == nullptr || study.gnss_file == nullptr || !study.overlap || study.dated_fixes_move()) return;
    study.clock_steps = take_out_clock_steps(study.imu, study.gnss, study.gravity);
    for (const ClockStep& step : study.clock_steps) {
        const std::string& file = (step.imu ? study.imu_file : study.gnss_file)->report.path;
        study.doubts.push_back(fmt::format(
            "{}: its clock steps by {:.6g} s {:.1f} s after its first sample ({}); what comes after is taken earlier by that",
            file, step.seconds, step.after, step.evidence));
        study.found(step.imu ? "imu.clock_step" : "gnss.clock_step", fmt::format("{:.6g} s", step.seconds), 0.9,
                    study.doubts.back());
        study.problem(Level::Warning, study.doubts.back(), "look at what sets the clock of that log");
    }
}

void judge_clock(Study& study) {
    if (study.imu_file == nullptr || study.gnss_file == nullptr || study.imu.empty() || study.gnss.size() < 20) return;
    const Given& given = study.given;
    const bool is_given = given.has("imu.time_offset_s") || given.has("gnss.time_offset_s");
    // if the user states the origin of the seconds, the loader converts dated fixes to it
    if (study.dated_fixes_move() && (given.has("time.scale") || given.has("time.week") || given.has("time.date"))) return;
    const double leap = leap_seconds(study);
    const ClockScan scan = scan_clocks(study.imu, study.gnss, study.gravity);
    const std::optional<Choice> best = best_of(scan, leap);
    if (!best || !best->unique) return;
    if (study.overlap && best->peak.support < scan.stated + beyond_stated) return;
    const double sought = best->known ? best->known->shift : best->peak.shift;
    if (study.overlap && sought > earliest_lag && sought < latest_lag) return;
    // A few seconds in which the IMU is shaken or its record spoilt agree with any manoeuvre, or hide that the times agree as they
    // are while a repeated manoeuvre agrees better: the rest of the log must not object. (Shifts within one manoeuvre all agree in part.)
    constexpr double manoeuvre = 10.0;  // s
    if (study.overlap && std::abs(best->peak.shift) > manoeuvre) {
        const ClockScan ranks = scan_clocks(study.imu, study.gnss, study.gravity, ScanOf::Ranks, best->peak.shift);
        if (ranks.asked < ranks.stated + beyond_rival || (!best->known && ranks.stated > decisive)) return;
    }
    const double supposed = best->known ? sought : sought - middle_lag;
    double window = short_window;
    MotionFit there = fit_at(study, supposed, window);
    if (!shows_lag(there)) there = fit_at(study, supposed, window = long_window);
    const bool fits = shows_lag(there) && there.rms < 0.6 * there.motion &&
                      !(study.overlap && there.rms > 0.7 * fit_at(study, 0.0, window).rms);
    if (!fits && !plain(*best, scan)) return;
    // An unknown shift includes the receiver's latency: the two cannot be separated. It is that of the positions: velocities are often
    // older, and the positions would otherwise seem to be of the future.
    Agreement older;
    if (fits && study.gnss.has_velocity()) older = velocity_behind_position(study.gnss, false);
    if (!shows_lag(older)) older = {};
    const double lag = fits ? there.horizontal.at - middle_lag - older.at : 0.0;
    const double shift = best->known ? sought : std::round(100.0 * (sought + lag)) / 100.0;
    const std::string fit_text =
        fits ? fmt::format("; {} windows, left of {:.3g} m/s motion {:.2g} m/s", there.windows, there.motion, there.rms)
             : std::string();
    const std::string evidence =
        fmt::format("at {:+.10g} s turns and accelerations of the IMU and of the track agree (correlation {:.2f}{}){}", shift,
                    best->peak.correlation, fit_text, best->known && !best->known->name.empty() ? ": " + best->known->name : "");
    const std::string stated = study.overlap ? "as they are they do not" : "as they are the logs do not overlap in time";
    if (is_given) {
        const bool of_imu = given.has("imu.time_offset_s");
        const char* key = of_imu ? "imu.time_offset_s" : "gnss.time_offset_s";
        const double better = of_imu ? given.imu.time_offset + shift : given.gnss.time_offset - shift;
        study.refusal = Refusal{(of_imu ? study.imu_file : study.gnss_file)->report.path, key,
                                fmt::format("the motion contradicts the times of IMU and GNSS: {}; {}", evidence, stated),
                                fmt::format("give {:.10g} there, or leave it out", std::round(1e3 * better) / 1e3)};
        study.contradicts(key, study.refusal->text);
        return;
    }
    study.clock_shift = shift;
    study.clock_sigma = best->known ? 0.0 : fits ? std::hypot(there.horizontal.sigma, older.sigma, 0.02) : 0.1;
    study.clock_evidence = fmt::format("{}; {}", evidence, stated);
    study.overlap = true;
    set_clock(study.imu, shift, 0.0, 0.0);
    study.found("imu.clock", words_of_shift(shift), best->known ? 0.95 : 0.8, study.clock_evidence);
    study.doubts.push_back(fmt::format("the clocks of {} and {} differ: the IMU's times are taken {} ({})",
                                       study.imu_file->report.path, study.gnss_file->report.path, words_of_shift(shift),
                                       study.clock_evidence));
    std::erase_if(study.problems, [](const Problem& p) {
        return p.level == Level::Error && p.text.find("no time in common") != std::string::npos;
    });
    study.problem(Level::Warning, study.doubts.back(), "nothing to do if that is correct; otherwise give [imu] time_offset_s");
}

}  // namespace schuler::inspect::detail
