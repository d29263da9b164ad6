// The IMU section: axes and mounting, grade, and anomalies of the samples.
#include "schuler/inspect/detail/study.h"

#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/math/rotation.h"
#include "schuler/sensor/grades.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

constexpr double per_deg = 1.0 / units::deg;

void judge_axes(Study& study) {
    const Mounting& m = study.mounting;
    if (!m.found) {
        study.draft.set("imu", "axes", std::string("frd"), "a guess: no gravity seen in the accelerometers", true,
                        Known::Default);
        return;
    }
    std::string why = fmt::format("gravity when {} lies {:.0f} deg from the nearest sensor axis",
                                  study.still.any() ? "still" : "averaged", m.vertical_angle * per_deg);
    if (m.forward_from == ForwardFrom::Travel) {
        why += fmt::format("; travel in sensor axes is [{:.3f}, {:.3f}, {:.3f}] over {} epochs (spread {:.1f} deg)",
                           study.travel.forward_s.x(), study.travel.forward_s.y(), study.travel.forward_s.z(), m.epochs,
                           m.forward_spread * per_deg);
    } else if (m.forward_from == ForwardFrom::AttitudeLog) {
        why += fmt::format("; the gyros turn as the attitude in {} does ({} steps)", study.reference_file->report.path, m.epochs);
    } else {
        why += "; which axis points forward does not show in these data";
    }
    if (std::abs(study.course.correlation) > 0.7) {
        why += fmt::format("; course rate / gyro rate about the vertical = {:.2f} (correlation {:.2f})", study.course.slope,
                           study.course.correlation);
    }
    study.found("imu.axes", m.axes, m.confidence, why);
    const std::string forward =
        m.forward_from == ForwardFrom::Travel
            ? fmt::format("forward from {} epochs of travel, spread {:.1f} deg", m.epochs, m.forward_spread * per_deg)
        : m.forward_from == ForwardFrom::AttitudeLog ? "forward from the attitude log"
                                                     : "forward only supposed: check it";
    study.draft.set("imu", "axes", m.axes,
                    fmt::format("{}: gravity {} ({:.0f} deg off), {}", how_sure(m.confidence),
                                study.still.any() ? "at rest" : "on average", m.vertical_angle * per_deg, forward));
    if (std::abs(study.course.correlation) > 0.7 && study.course.slope < 0.0) {
        study.problem(
            Level::Error,
            fmt::format(
                "the gyros turn against the GNSS course (slope {:.2f}): gyro signs do not belong to the accelerometers' axes",
                study.course.slope),
            "check the sign of the gyro columns; [imu] scale = { gyro_rad_s = -1 } turns all three round");
    }
}

void judge_mounting(Study& study) {
    const Mounting& m = study.mounting;
    const bool supposed = m.forward_from == ForwardFrom::Supposed && !study.given.has("imu.axes") && !study.given.mounting_rpy;
    if (m.forward_from != ForwardFrom::Travel) {
        if (study.vehicle == "ship") {  // the course shows the bow, not the axes of the unit
            study.forward_supposed = m.found && supposed;
            return;
        }
        study.forward_supposed = m.found && supposed;  // the course shows the bow, not the unit's axes
        constexpr double telling = 5.0;                // m/s
        std::vector<double> speeds;
        for (std::size_t k = 0; k < study.gnss.size(); ++k) speeds.push_back(study.gnss.speed(k));
        const bool travels = !speeds.empty() && quantile(std::move(speeds), 0.9) > telling;
        if (!m.found || study.gnss.has_velocity() || !travels) return;
        // In the air the mean force is not vertical: the level is known only after a standstill.
        if (study.still.any())
            study.draft.set("imu", "mounting_deg", std::string("estimate"),
                            "forward is only supposed here; the filter finds the direction of travel");
        else if (supposed) study.forward_supposed = true;
        return;
    }
    const Eigen::Vector3d rpy = m.rest_rpy * per_deg;
    const std::string text = fmt::format("roll {:.1f}, pitch {:.1f}, yaw {:.1f} deg", rpy.x(), rpy.y(), rpy.z());
    if (study.vehicle != "car") {
        study.found("imu.mounting_deg", text, 0.3, "beyond the axes; in the air this contains sideslip and angle of attack");
        return;
    }
    constexpr double least = 0.3, least_roll = 2.0;  // deg: what slopes and camber of roads leave open
    // about 20 epochs of a window share their error
    const double sigma = std::max(least, m.forward_spread * per_deg / std::sqrt(std::max(1.0, m.epochs / 20.0)));
    study.found(
        "imu.mounting_deg", text, 0.85,
        fmt::format("beyond the axes, from travel and mean vertical; pitch and yaw within {:.1f} deg, roll within about 2 deg",
                    sigma));
    if (std::hypot(rpy.y(), rpy.z()) > 2.0 * sigma || std::abs(rpy.x()) > least_roll) {
        study.draft.set("imu", "mounting_deg", std::string("estimate"),
                        fmt::format("{} beyond the axes found here; the filter finds it again", text));
    } else {
        study.draft.set("imu", "mounting_deg", std::vector<double>(3, 0.0),
                        fmt::format("likely: {} is not more than the method can tell", text));
        if (!study.given.mounting_rpy)
            study.draft.set("imu", "found_mounting_std_deg",
                            std::round(100.0 * std::max(sigma, std::hypot(rpy.y(), rpy.z()))) / 100.0,
                            "pitch and yaw of that mounting, one sigma");
    }
}

// Compares given axes or angles with those of the data, in the directions determined by the data.
void check_given_axes(Study& study) {
    const Mounting& m = study.mounting;
    const Given& given = study.given;
    if (!m.found || (!given.has("imu.axes") && !given.mounting_rpy)) return;
    const Eigen::Matrix3d C = given.mounting_rpy ? Eigen::Matrix3d(math::dcm_from_rpy(*given.mounting_rpy) * m.C_bs) : m.C_bs;
    const char* key = given.mounting_rpy ? "imu.mounting_deg" : "imu.axes";
    const std::string said = given.mounting_rpy
                                 ? fmt::format("[{:.1f}, {:.1f}, {:.1f}]", given.mounting_rpy->x() * per_deg,
                                               given.mounting_rpy->y() * per_deg, given.mounting_rpy->z() * per_deg)
                                 : fmt::format("\"{}\"", given.axes);
    const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
        return std::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * per_deg;
    };
    // Up at rest: ground and vehicle are level to a few degrees; axes alone are given to the nearest quarter turn.
    const double slack = given.mounting_rpy ? 0.0 : 50.0;
    if (study.still.any()) {
        const double off = angle(-C.row(2).transpose(), study.still.f);
        if (off > 3.0 * 5.0 + slack) {
            study.contradicts(
                key, fmt::format("{} is given; at rest gravity lies {:.0f} deg from the down axis that this means", said, off));
            return;
        }
    }
    if (m.forward_from != ForwardFrom::Travel) return;
    // Only wheeled vehicles move along their axes; in the air there are sideslip and wind, hand-held any direction.
    const double spread = m.forward_spread * per_deg / std::sqrt(std::max(1.0, m.epochs / 20.0));
    const double sigma = study.vehicle == "car" ? std::max(0.7, spread) : std::max(10.0, m.forward_spread * per_deg);
    // The forces that show the level contain the accelerometers' biases.
    const sensor::ImuErrorModel unit = sensor::imu_grade("consumer");
    const double level = given.accel_bias.value_or(unit.accel_initial_bias()) / study.gravity * per_deg;
    const Eigen::Vector3d forward = C.row(0), down = C.row(2), travel = study.travel.forward_s;
    const double pitch = std::asin(std::clamp(travel.dot(down), -1.0, 1.0)) * per_deg, off = angle(forward, travel);
    const double yaw = std::sqrt(std::max(0.0, off * off - pitch * pitch)), pitch_sigma = std::hypot(sigma, level);
    constexpr double many = 3.0;
    if (std::hypot(std::max(0.0, yaw - slack) / sigma, std::max(0.0, std::abs(pitch) - slack) / pitch_sigma) > many) {
        study.contradicts(key,
                          fmt::format("{} is given; the direction of travel lies {:.1f} +- {:.1f} deg from the forward axis that "
                                      "this means",
                                      said, off, yaw / sigma > std::abs(pitch) / pitch_sigma ? sigma : pitch_sigma));
    }
}

// The best grade consistent with noise and bias: noise clearly below that of the next worse grade, whose biases could otherwise
// not be excluded, and bias within four sigma of switch-on. The noise includes vibration, so it alone does not classify an
// instrument below consumer grade.
std::string grade_for(double gyro_noise, double accel_noise, double gyro_bias) {
    constexpr double clearly = 0.6;
    constexpr std::array<const char*, 4> names{"navigation", "tactical", "mems", "consumer"};
    for (std::size_t i = 0; i + 1 < names.size(); ++i) {
        const sensor::ImuErrorModel worse = sensor::imu_grade(names[i + 1]);
        const bool quiet = gyro_noise < clearly * worse.gyro_noise || accel_noise < clearly * worse.accel_noise;
        const bool possible = gyro_noise < 2.0 * sensor::imu_grade(names[i]).gyro_noise &&
                              accel_noise < 3.0 * sensor::imu_grade(names[i]).accel_noise;
        if (quiet && possible && gyro_bias < 4.0 * sensor::imu_grade(names[i]).gyro_initial_bias()) return names[i];
    }
    return gyro_bias < 4.0 * sensor::imu_grade("consumer").gyro_initial_bias() ? "consumer" : "adis16405";
}

/// A given grade is refuted if its biases are impossible. Noise above its own may be vibration: it is then measured.
void check_given_grade(Study& study, const std::string& found, double bias, double noise) {
    const Given& given = study.given;
    if (!given.gyro_bias || !study.still.any()) return;
    constexpr double many = 6.0, louder = 5.0;
    constexpr double earth_rate = earth::wgs84.w_ie;
    if (bias > many * *given.gyro_bias + 2.0 * earth_rate) {
        study.refutes("imu.grade",
                      fmt::format("its gyros' biases are {:.2g} deg/s at switch-on; at rest they turn at {:.2g} deg/s",
                                  *given.gyro_bias * per_deg, bias * per_deg),
                      FactValue(found));
    } else if (noise > louder * *given.gyro_noise && !given.has("imu.estimate_noise")) {
        study.contradicts(
            "imu.grade",
            fmt::format("its gyros' noise is {:.2g} deg/sqrt(h); at its quietest the log has {:.2g}, by noise or vibration: "
                        "noise is measured",
                        *given.gyro_noise / units::deg_per_sqrt_hour, noise / units::deg_per_sqrt_hour));
        study.draft.set("imu", "estimate_noise", true, "the log is louder than the grade that is given");
    }
}

void judge_grade(Study& study) {
    const NoiseLevel noise = noise_level(study.imu);
    const bool fitted = study.velocity_fit.windows >= 3;
    const bool biased = study.still.any() || fitted;
    const Eigen::Vector3d bias = study.still.any() ? study.still.w
                                 : fitted          ? study.velocity_fit.gyro_bias
                                                   : Eigen::Vector3d::Zero();
    // The quietest axes: vibration adds noise, mainly in some axes.
    const double gyro = median({noise.gyro.x(), noise.gyro.y(), noise.gyro.z()}) / units::deg_per_sqrt_hour;
    const double accel = median({noise.accel.x(), noise.accel.y(), noise.accel.z()}) / units::m_s_per_sqrt_hour;
    const double bias_size = bias.cwiseAbs().maxCoeff();
    std::string grade = grade_for(gyro * units::deg_per_sqrt_hour, accel * units::m_s_per_sqrt_hour, bias_size);
    // Without standstill vibration and noise cannot be separated, and a good gyro's bias may have been removed by the logger.
    const double confidence = study.still.any() ? 0.7 : 0.5;
    if (gyro <= 0.0 || accel <= 0.0) grade = "consumer";
    const std::string numbers =
        fmt::format("noise at most {:.2g} deg/sqrt(h) and {:.2g} m/s/sqrt(h) (vibration included)", gyro, accel);
    const std::string bias_text = biased ? fmt::format(", gyro bias {:.3g} deg/s", bias_size * per_deg) : std::string();
    study.found("imu.grade", grade, confidence, numbers + bias_text);
    study.draft.set("imu", "grade", grade,
                    fmt::format("{}: noise below {:.2g} deg/sqrt(h), {:.2g} m/s/sqrt(h){}; a data sheet knows better",
                                how_sure(confidence), gyro, accel, bias_text));
    check_given_grade(study, grade, bias_size, gyro * units::deg_per_sqrt_hour);
    if (biased) {
        study.found("imu.gyro_bias",
                    fmt::format("[{:.3f}, {:.3f}, {:.3f}] deg/s", bias.x() * per_deg, bias.y() * per_deg, bias.z() * per_deg),
                    study.still.any() ? 0.9 : 0.6,
                    study.still.any() ? "median rate at rest" : "from the fit to the GNSS velocity");
    }
}

void judge_gravity(Study& study) {
    if (!study.still.any()) return;
    const double excess = study.still.f_norm - study.gravity;
    study.found("imu.gravity", fmt::format("{:+.3f} m/s2", excess), 0.9,
                fmt::format("norm of the specific force at rest {:.3f} against local gravity {:.3f} m/s2", study.still.f_norm,
                            study.gravity));
    if (std::abs(excess) > 0.05) {
        study.imu_file->problem(
            Level::Info,
            fmt::format("at rest the accelerometers measure {:.3f} m/s2, {:+.3f} against local gravity: bias or scale "
                        "({:+.1f} %), mostly of the vertical one",
                        study.still.f_norm, excess, 100.0 * excess / study.gravity),
            "nothing to do: the bias is estimated; a six-position calibration would remove it");
    }
}

// The longest run of equal extreme values of an axis: a clipped sensor repeats its limit.
std::size_t clipped_samples(const std::vector<Eigen::Vector3d>& values, int axis) {
    double low = 0.0, high = 0.0;
    for (const Eigen::Vector3d& v : values) {
        low = std::min(low, v(axis));
        high = std::max(high, v(axis));
    }
    const auto run_at = [&](double limit) {
        std::size_t clipped = 0, run = 0;
        for (const Eigen::Vector3d& v : values) {
            run = v(axis) == limit ? run + 1 : 0;
            if (run == 3) clipped += 3;
            else if (run > 3) ++clipped;
        }
        return clipped;
    };
    const double typical = std::max(std::abs(low), std::abs(high));
    return typical > 0.0 ? std::max(low < 0.0 ? run_at(low) : 0, high > 0.0 ? run_at(high) : 0) : 0;
}

void judge_samples(Study& study) {
    LoadedFile& file = *study.imu_file;
    const ImuSeries& imu = study.imu;
    std::size_t stuck = 0;
    for (std::size_t i = 1; i < imu.size(); ++i) stuck += imu.w[i] == imu.w[i - 1] && imu.f[i] == imu.f[i - 1] ? 1 : 0;
    if (stuck * 10 > imu.size()) {
        file.problem(Level::Warning, fmt::format("{} of {} samples repeat the one before in all six axes", stuck, imu.size()),
                     "the log is written faster than the sensor samples: log at the sensor's own rate");
    }
    static constexpr const char* names[] = {"x", "y", "z"};
    for (int axis = 0; axis < 3; ++axis) {
        double w = 0.0, f = 0.0;
        for (std::size_t i = 0; i < imu.size(); ++i) {
            w = std::max(w, std::abs(imu.w[i](axis)));
            f = std::max(f, std::abs(imu.f[i](axis)));
        }
        const std::size_t gyro = w > 1.0 ? clipped_samples(imu.w, axis) : 0, accel = f > 15.0 ? clipped_samples(imu.f, axis) : 0;
        if (gyro > 0)
            file.problem(Level::Warning,
                         fmt::format("gyro {} stays at its extreme {:.4g} deg/s for {} samples: saturated", names[axis],
                                     w * per_deg, gyro),
                         "use a larger range");
        if (accel > 0)
            file.problem(
                Level::Warning,
                fmt::format("accelerometer {} stays at its extreme {:.4g} m/s2 for {} samples: saturated", names[axis], f, accel),
                "use a larger range or a damped mounting");
    }
}

}  // namespace

void draft_clock(Study& study) {
    if (study.imu_file == nullptr) return;
    const double weeks = study.dated_fixes_move() ? 0.0 : study.imu_shift;
    const double offset = weeks + study.clock_shift;
    if (offset != 0.0 && !study.given.has("imu.time_offset_s")) {
        const std::string why =
            study.clock_shift == 0.0 ? "likely: whole weeks, to meet the dated GNSS times" : "likely: " + study.clock_evidence;
        const double sigma = study.clock_sigma > 0.0 ? study.clock_sigma : not_given;
        study.draft.set("imu", "time_offset_s", offset, why, true, Known::Found, sigma);
        const FileReport& imu = study.imu_file->report;
        const auto along = [&](const LoadedFile* file, const char* section) {
            if (file == nullptr || study.given.has(std::string(section) + ".time_offset_s")) return;
            const double common = std::min(file->report.stop_s, imu.stop_s) - std::max(file->report.start_s, imu.start_s);
            if (common > 0.5 * std::min(file->report.stop_s - file->report.start_s, imu.stop_s - imu.start_s))
                study.draft.set(section, "time_offset_s", offset, "on the clock of the IMU", true, Known::Found, sigma);
        };
        along(study.baro_file, "baro");
        along(study.mag_file, "mag");
        for (const LoadedFile& file : study.files)
            if (file.report.kind == "odometer") along(&file, "odometer");
    }
    if (study.clock_drift != 0.0)
        study.draft.set("imu", "clock_drift_ppm", study.clock_drift,
                        "likely: the lag of the GNSS behind the IMU grows by this along the log", true, Known::Found,
                        study.clock_drift_sigma);
}

void judge_imu(Study& study) {
    if (study.imu_file == nullptr) return;
    study.draft.set("imu", "file", study.imu_file->report.path, fmt::format("{:.4g} Hz", study.imu_file->report.rate_hz));
    draft_parts(study, "imu", *study.imu_file);
    const bool increments = study.imu_file->has("dtheta_x_rad");
    study.draft.set(
        "imu", "kind", increments ? std::string("increments") : std::string("rates"),
        study.imu_file->report.kind == "kfgins_imu" ? "likely: the norm of the last three columns is gravity times the step" : "",
        true, Known::File);
    if (increments) study.draft.set("imu", "stamp", std::string("end"), "usual for increments", true, Known::Default);
    draft_columns(study, "imu", *study.imu_file, study.imu_units);
    judge_axes(study);
    judge_mounting(study);
    check_given_axes(study);
    judge_grade(study);
    judge_gravity(study);
    judge_samples(study);
}

}  // namespace schuler::inspect::detail
