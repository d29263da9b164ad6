// The common basis: reference samples, rest, the fits of IMU to GNSS, travel and mounting.
#include "schuler/inspect/detail/study.h"

#include "schuler/core/units.h"
#include "schuler/inspect/detail/motion/clock.h"
#include "schuler/inspect/detail/motion/waves.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

// Attitude of the reference file; quaternions of the sensor itself give no information about a mounting and are ignored.
std::vector<ReferenceSample> reference_attitude(const LoadedFile& file) {
    std::vector<ReferenceSample> samples;
    if (!file.has("roll_deg") || !file.has("pitch_deg") || !file.has("heading_deg")) return samples;
    for (std::size_t i = 0; i < file.time_ns.size(); ++i) {
        ReferenceSample s;
        s.time = Time{file.time_ns[i]};
        s.rpy = file.vector("roll_deg", "pitch_deg", "heading_deg", i) * units::deg;
        samples.push_back(s);
    }
    return samples;
}

double median_age(const LoadedFile& file, const char* column) {
    if (!file.has(column)) return std::nan("");
    // A time of validity of the velocity alone does not apply to the position.
    const io::ColumnMatch* whole = file.plan.find("time_valid_s");
    const io::ColumnMatch* velocity = file.plan.find("vel_time_valid_s");
    if (whole != nullptr && velocity != nullptr && whole->column == velocity->column &&
        column == std::string_view("time_valid_s"))
        return std::nan("");
    return -median(file[column]);
}

Eigen::Vector3d mean_specific_force(const ImuSeries& imu) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& f : imu.f) sum += f;
    return imu.empty() ? sum : Eigen::Vector3d(sum / static_cast<double>(imu.size()));
}

double angle_between(const Eigen::Matrix3d& A, const Eigen::Matrix3d& B) { return Eigen::AngleAxisd(A * B.transpose()).angle(); }

/// Given axes are used. Mounting angles given without axes refer to forward-right-down, unless the data show that they refer to
/// the sensor's own axes.
void take_given_axes(Study& study) {
    Mounting& m = study.mounting;
    const Given& given = study.given;
    if (given.has("imu.axes")) {
        take_axes(m, given.C_bs, given.axes);
        return;
    }
    if (!given.mounting_rpy || !m.found) return;
    const Eigen::Matrix3d turn = math::dcm_from_rpy(*given.mounting_rpy);
    const auto miss = [&](const Eigen::Matrix3d& axes) {
        if (m.full) return angle_between(turn * axes, m.C_total);
        const Eigen::Vector3d down_s = study.still.any() ? -study.still.f : -mean_specific_force(study.imu);
        return std::acos(std::clamp((turn * axes).row(2).dot(down_s.normalized().transpose()), -1.0, 1.0));
    };
    if (miss(Eigen::Matrix3d::Identity()) <= miss(m.C_bs) + 15.0 * units::deg) take_axes(m, Eigen::Matrix3d::Identity(), "frd");
}

/// The fit in short windows; if they show no lag, as with slow curves of a low-noise unit, in long ones if these do.
MotionFit fitted(const Study& study, FitSource source, const Eigen::Vector3d& bias, bool known) {
    MotionFit fit = fit_motion(study.imu, study.gnss, source, bias, known, study.gravity);
    if (shows_lag(fit)) return fit;
    const MotionFit slow = fit_motion(study.imu, study.gnss, source, bias, known, study.gravity, long_window);
    if (!shows_lag(slow)) return fit;
    fit.horizontal = slow.horizontal;
    fit.down = slow.down;
    fit.curves = slow.curves;
    fit.window_length = slow.window_length;
    return fit;
}

void fit_track(Study& study) {
    study.still = still_periods(study.imu, study.overlap ? study.gnss : GnssSeries{});
    if (!study.overlap) return;
    study.velocity_fit = fitted(study, FitSource::Velocity, study.still.w, study.still.any());
    const bool biased = study.velocity_fit.windows >= 3;
    study.position_fit = fitted(study, FitSource::Displacement, biased ? study.velocity_fit.gyro_bias : study.still.w,
                                biased || study.still.any());
    study.travel = travel_of(study.gnss.has_velocity() ? study.velocity_fit : study.position_fit);
}

/// Clocks of low-cost loggers run some 10 to 100 ppm fast or slow: a second in some hours.
void take_out_drift(Study& study) {
    if (!study.overlap || study.given.has("imu.clock_drift_ppm")) return;
    const MotionFit& fit = shows_lag(study.velocity_fit) ? study.velocity_fit : study.position_fit;
    if (!shows_lag(fit)) return;
    ClockDrift drift = drift_of(fit.curves);
    const double span = fit.curves.empty() ? 0.0 : fit.curves.back().t - fit.curves.front().t;
    // The effect of gain errors on the lags changes as slowly as the motion: some consecutive windows have the same error.
    const double apart = std::max(3.0, static_cast<double>(fit.curves.size()) / 4.0);
    if (span > 0.0) drift.sigma = std::hypot(drift.sigma, 1e6 * lag_by_gain(fit) * std::sqrt(12.0 / apart) / span);
    constexpr double significant = 5.0, least = 0.01;  // sigmas; s over the log
    if (!drift.found || std::abs(drift.ppm) < significant * drift.sigma || std::abs(drift.ppm) * 1e-6 * span < least) return;
    study.clock_drift = std::round(10.0 * drift.ppm) / 10.0;
    study.clock_drift_sigma = drift.sigma;
    study.found("imu.clock_drift_ppm", fmt::format("{:.1f} +- {:.1f} ppm", drift.ppm, drift.sigma), 0.9,
                fmt::format("the GNSS falls {} the IMU by {:.0f} ms over {:.0f} s of motion",
                            drift.ppm > 0.0 ? "before" : "behind", std::abs(drift.ppm) * 1e-3 * span, span));
    set_clock(study.imu, 0.0, study.clock_drift, study.imu.t.front());
    fit_track(study);
}

}  // namespace

double felt_in_turns(const Study& study) {
    const Travel& t = study.travel;
    if (t.epochs < 30) return not_given;
    const Eigen::Vector3d right = t.down_s.cross(t.forward_s);
    constexpr double span = 2.0;                    // s
    std::vector<std::pair<double, double>> epochs;  // acceleration, force
    double mean_force = 0.0;
    for (std::size_t i = 0; i < study.imu.size();) {
        Eigen::Vector3d w = Eigen::Vector3d::Zero(), f = Eigen::Vector3d::Zero();
        const std::size_t first = i;
        for (; i < study.imu.size() && study.imu.t[i] < study.imu.t[first] + span; ++i) {
            w += study.imu.w[i];
            f += study.imu.f[i];
        }
        const auto n = static_cast<double>(i - first);
        const double middle = study.imu.t[first] + 0.5 * span;
        if (middle < study.gnss.t.front() || middle > study.gnss.t.back()) continue;
        const double speed = study.gnss.speed(index_before(study.gnss.t, middle));
        epochs.emplace_back(speed * (w / n - study.still.w).dot(t.down_s), (f / n).dot(right));
        mean_force += epochs.back().second;
    }
    if (epochs.empty()) return not_given;
    mean_force /= static_cast<double>(epochs.size());
    double fa = 0.0, aa = 0.0;
    int turns = 0;
    for (const auto& [a, f] : epochs) {
        if (std::abs(a) < 0.5) continue;
        ++turns;
        fa += (f - mean_force) * a;
        aa += a * a;
    }
    return turns < 5 ? not_given : fa / aa;
}

void study_motion(Study& study) {
    if (study.gnss_file != nullptr) {
        const double position = median_age(*study.gnss_file, "time_valid_s"),
                     velocity = median_age(*study.gnss_file, "vel_time_valid_s");
        study.states_position_age = std::isfinite(position);
        study.states_velocity_age = std::isfinite(velocity) || study.states_position_age;
        study.position_age = study.states_position_age ? position : 0.0;
        study.velocity_age = std::isfinite(velocity) ? velocity : study.position_age;
    }
    if (study.reference_file != nullptr) study.reference = reference_attitude(*study.reference_file);
    if (study.gnss_file != nullptr) {
        study.velocity_behind_position = velocity_behind_position(study.gnss, false);
        study.down_velocity_behind_height = velocity_behind_position(study.gnss, true);
    }
    if (study.imu_file == nullptr || study.imu.empty()) return;
    for (UnitChange& change : judge_gyro_unit(*study.imu_file, study.imu, study.overlap ? study.gnss : GnssSeries{}))
        study.imu_units.push_back(std::move(change));
    fit_track(study);
    if (judge_accelerometers(study) || judge_gyro_signs(study)) fit_track(study);
    take_out_drift(study);
    const GnssSeries none;
    const GnssSeries& gnss = study.overlap ? study.gnss : none;
    const AttitudeAgreement attitude = attitude_agreement(study.imu, study.still.w, study.reference, study.origin);
    const bool rest = study.still.any();
    study.mounting = mounting_of(rest ? study.still.f : mean_specific_force(study.imu), rest, study.travel, attitude);
    take_given_axes(study);
    study.course = course_slope(study.imu, gnss, study.mounting.C_bs.row(2).transpose(), study.still.w);
}

namespace {

struct Kind {
    std::string name;
    double confidence;
    std::string why;
};

Kind kind_without_gnss(const Study& study) {
    const double span = study.imu.empty() ? 0.0 : study.imu.t.back() - study.imu.t.front();
    if (study.still.total > 0.9 * span && span > 0.0)
        return {"static", 0.85, "the sensors are still throughout, there are no fixes"};
    return {"hand", 0.5, "it moves, there are no fixes: the kind without constraints"};
}

Kind kind_of(const Study& study) {
    if (study.gnss.size() < 5) return kind_without_gnss(study);
    std::vector<double> speeds, climbs;
    double farthest = 0.0;
    for (std::size_t k = 0; k < study.gnss.size(); ++k) {
        speeds.push_back(study.gnss.speed(k));
        if (study.gnss.has_velocity()) climbs.push_back(std::abs(study.gnss.v[k].z()));
        farthest = std::max(farthest, study.gnss.p[k].head<2>().norm());
    }
    const double fast = quantile(speeds, 0.99), climb = climbs.empty() ? 0.0 : quantile(climbs, 0.99);
    const double span = study.imu.empty() ? 0.0 : study.imu.t.back() - study.imu.t.front();
    if (study.gnss.has_velocity() ? fast < 0.6 && climb < 0.6 : farthest < 10.0) {
        return {"static", study.still.total > 0.8 * span ? 0.95 : 0.7,
                fmt::format("the GNSS speed stays below {:.2f} m/s", std::max(fast, climb))};
    }
    const Travel& t = study.travel;
    const double deg = 1.0 / units::deg;
    constexpr double fastest_car = 80.0;  // m/s
    const double felt = felt_in_turns(study);
    if (t.epochs >= 30 && t.concentration > 0.9 && (fast > fastest_car || felt < 0.5)) {
        return {"air", 0.8,
                fast > fastest_car ? fmt::format("it reaches {:.0f} m/s", fast)
                                   : fmt::format("it banks into its turns: {:.0f} % of their force is felt", 100.0 * felt)};
    }
    if (t.epochs >= 30 && t.spread < 6.0 * units::deg && t.tilt95 < 15.0 * units::deg && t.slope95 < 15.0 * units::deg) {
        return {"car", 0.9,
                fmt::format(
                    "it travels along one sensor axis (within {:.1f} deg), tilts less than {:.0f} deg, slopes below {:.0f} deg",
                    t.spread * deg, t.tilt95 * deg, t.slope95 * deg)};
    }
    // After the rule for cars, which tilt like ships on undulating ground.
    constexpr double fastest_ship = 25.0;  // m/s
    const Waves waves = waves_of(study.imu, study.gnss);
    if (waves.found && fast < fastest_ship && study.still.total < 0.1 * span)
        return {"ship", 0.6,
                fmt::format(
                    "it rolls and pitches by {:.1f} deg at the periods of waves throughout, and its height stays within {:.1f} m",
                    waves.tilt * deg, waves.height)};
    if (t.epochs >= 30 && (t.tilt95 >= 15.0 * units::deg || t.slope95 >= 15.0 * units::deg || t.concentration < 0.9)) {
        return {"air", 0.8,
                t.concentration < 0.9 ? fmt::format("it travels in any direction of its own axes, up to {:.0f} m/s", fast)
                                      : fmt::format("it tilts by {:.0f} deg and climbs or descends at {:.0f} deg", t.tilt95 * deg,
                                                    t.slope95 * deg)};
    }
    if (climb > 0.8) return {"air", 0.7, fmt::format("it climbs or descends at up to {:.1f} m/s", climb)};
    return {"hand", 0.4, "too little steady motion to decide: the kind without constraints"};
}

}  // namespace

void judge_vehicle(Study& study) {
    if (study.imu_file == nullptr) return;
    const Kind kind = kind_of(study);
    study.vehicle = study.given.vehicle.empty() ? kind.name : study.given.vehicle;
    if (study.vehicle == "static" && kind.name != "static" && kind.confidence >= 0.7)
        study.contradicts("vehicle.kind", fmt::format("\"static\" is given; the data show motion: {}", kind.why));
    study.found("vehicle.kind", kind.name, kind.confidence, kind.why);
    study.draft.set("vehicle", "kind", kind.name, fmt::format("{}: {}", how_sure(kind.confidence), kind.why));
    if (study.still.any()) {
        study.found("still", text_of(study.still.intervals, 0.0), 0.9,
                    fmt::format("{:.0f} s of quiet sensors{}; s after the first {} epoch", study.still.total,
                                study.overlap ? " and no GNSS speed" : "", study.gnss_file != nullptr ? "GNSS" : "IMU"));
    } else {
        study.found("still", "none", 0.8, "no 2 s of quiet sensors");
        study.problem(Level::Info, "the vehicle never rests: biases and level are found in motion, which takes longer",
                      "keep it stationary for 10 s or more at the start of a recording");
    }
}

}  // namespace schuler::inspect::detail
