#include "schuler/fusion/start.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/fusion/heading_search.h"
#include "schuler/fusion/tuning/trial.h"
#include "schuler/ins/align.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

/// The first fix usable for a start: not withheld, horizontal position known, within the IMU's time.
const Event* first_fix(const RunData& data, const Settings& settings) {
    const ImuIncrement& front = data.imu.increments.front();
    Time from = front.time - Duration::from_seconds(front.dt);
    if (settings.start) from = std::max(from, *settings.start);
    if (settings.initial.time) from = std::max(from, *settings.initial.time);
    for (const Event& e : data.events)
        if (e.kind == MeasurementKind::GnssPosition && !e.withheld && (e.components & 3) == 3 && e.valid >= from &&
            e.valid <= data.imu.increments.back().time)
            return &e;
    return nullptr;
}

/// Mean raw rate and specific force in an initial standstill; length 0 if there is none.
struct StillStart {
    double length = 0.0;
    Vector3d rate = Vector3d::Zero(), force = Vector3d::Zero();
    Time end{};
};

StillStart still_at(const RunData& data, Time start) {
    StillStart s;
    Time last = start;
    for (const StillWindow& w : data.still.windows) {
        if (w.end < start) continue;
        if ((w.end - last).seconds() > 1.0) break;
        s.rate += w.mean_rate_b * w.length;
        s.force += w.mean_force_b * w.length;
        s.length += w.length;
        last = s.end = w.end;
        if (s.length > 60.0) break;
    }
    if (s.length > 0.0) {
        s.rate /= s.length;
        s.force /= s.length;
    }
    return s;
}

/// Mean specific force over a short time after an instant, body axes.
Vector3d mean_force(const RunData& data, std::size_t first, double span) {
    Vector3d sum = Vector3d::Zero();
    double t = 0.0;
    for (std::size_t i = first; i < data.imu.increments.size() && t < span; ++i) {
        sum += data.imu.increments[i].dv;
        t += data.imu.increments[i].dt;
    }
    return sum / t;
}

/// Acceleration of the vehicle (NED) from GNSS velocities around an instant; zero if there are none.
Vector3d gnss_acceleration(const RunData& data, Time at) {
    const GnssFix* first = nullptr;
    Time t0{};
    for (const Event& e : data.events) {
        if (e.kind != MeasurementKind::GnssVelocity || e.withheld || e.components != 7 || e.valid < at) continue;
        const GnssFix& fix = data.recording->gnss[e.index];
        if (first == nullptr) {
            first = &fix;
            t0 = e.valid;
        } else if ((e.valid - t0).seconds() > 0.7) {
            return (e.valid - t0).seconds() < 3.0 ? Vector3d((fix.velocity_n - first->velocity_n) / (e.valid - t0).seconds())
                                                  : Vector3d(Vector3d::Zero());
        }
    }
    return Vector3d::Zero();
}

/// First actual motion of the vehicle: a second of GNSS speed above a limit not reached by noise.
Time first_motion(const RunData& data, Time from) {
    int run = 0;
    Time since{};
    const GnssFix* anchor = nullptr;
    for (const Event& e : data.events) {
        if (e.valid < from || e.withheld) continue;
        if (e.kind == MeasurementKind::GnssVelocity && (e.components & 3) == 3) {
            const double speed = data.recording->gnss[e.index].velocity_n.head<2>().norm();
            const double limit = std::max(0.8, 4.0 * data.fix_noise[e.index].velocity.head<2>().maxCoeff());
            if (speed < limit) {
                run = 0;
                continue;
            }
            if (run++ == 0) since = e.valid;
            if (run >= 3) return since;
        } else if (e.kind == MeasurementKind::GnssPosition && (e.components & 3) == 3) {
            const GnssFix& fix = data.recording->gnss[e.index];
            if (fix.velocity_n.head<2>().allFinite()) continue;
            if (anchor == nullptr) anchor = &fix;
            const double far = earth::ned_difference({}, fix.position, anchor->position).head<2>().norm();
            if (far > std::max(3.0, 6.0 * data.fix_noise[e.index].position.head<2>().maxCoeff())) return e.valid;
        }
    }
    return data.imu.increments.back().time;
}

/// Level at the start: at rest from the mean specific force, in motion from that carried by the gyros or from the first moments.
Level level_of(const RunData& data, const Settings& settings, const Start& start, const StillStart& still) {
    const double g = earth::gravity_down(settings.earth.gravity, start.nav.position.lat, start.nav.position.h);
    const double by_bias = 1.5 * start.std_accel_bias.maxCoeff() / g;
    if (still.length >= 1.0) return {still.force, Vector3d(0.0, 0.0, -g), std::max(0.2 * units::deg, by_bias)};
    if (const std::optional<Level> level = carried_level(data, settings, start)) return *level;
    return {mean_force(data, start.increment, 0.5), gnss_acceleration(data, start.nav.time) - Vector3d(0.0, 0.0, g),
            std::max(3.0 * units::deg, by_bias)};
}

/// Heading by the first magnetometer sample after the start.
std::optional<HeadingWitness> magnetic_heading(const RunData& data, const Settings& settings, Time t0, const Level& level) {
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(settings.imu.mounting_rpy) * settings.imu.C_bs;
    for (const MagSample& s : data.recording->mag) {
        if (s.time < t0 || !s.field_b.allFinite() || !settings.mag.use) continue;
        const Eigen::Matrix3d C_level = ins::attitude_from_specific_force(level.f_b, level.f_n, 0.0).toRotationMatrix();
        const Vector3d field = C_level * (C_bs * s.field_b);
        return HeadingWitness{math::wrap_2pi(data.declination - std::atan2(field.y(), field.x())), settings.mag.first_std(),
                              true};
    }
    return std::nullopt;
}

/// From the first sample of a heading sensor within seconds of the start.
std::optional<HeadingWitness> sensed_heading(const RunData& data, const Settings& settings, Time t0) {
    constexpr double latest = 5.0;  // s
    if (!settings.heading.use) return std::nullopt;
    for (const HeadingSample& s : data.recording->heading) {
        if (s.time < t0 || !std::isfinite(s.heading)) continue;
        if ((s.time - t0).seconds() > latest) break;
        return HeadingWitness{s.heading, std::hypot(s.std > 0.0 ? s.std : settings.heading.std, settings.heading.offset_std),
                              false};
    }
    return std::nullopt;
}

/// The more accurate of the instruments that measure heading.
std::optional<HeadingWitness> shown_heading(const RunData& data, const Settings& settings, Time t0, const Level& level) {
    const std::optional<HeadingWitness> sensor = sensed_heading(data, settings, t0),
                                        compass = magnetic_heading(data, settings, t0, level);
    return !compass || (sensor && sensor->std < compass->std) ? sensor : compass;
}

void set_biases(Start& start, const Settings& settings) {
    start.gyro_bias = settings.initial.gyro_bias;
    start.accel_bias = settings.initial.accel_bias;
    start.std_gyro_bias = Vector3d::Constant(settings.imu.errors.gyro_initial_bias());
    start.std_accel_bias = Vector3d::Constant(settings.imu.errors.accel_initial_bias());
}

/// Velocity from the positions of the first one to three seconds, whichever time gives the smallest sigma, and that sigma; infinite if
/// fixes are too far apart.
std::pair<Vector3d, Vector3d> velocity_by_positions(const RunData& data, const Settings& settings, const Event& first) {
    constexpr double least = 0.95, most = 3.0, accel = 2.0;  // s, s, m/s^2: possible acceleration of the vehicle in that time
    const GnssFix& from = data.recording->gnss[first.index];
    std::pair<Vector3d, Vector3d> best{Vector3d::Zero(), Vector3d::Constant(std::numeric_limits<double>::infinity())};
    for (const Event& e : data.events) {
        const double dt = (e.valid - first.valid).seconds();
        if (e.kind != MeasurementKind::GnssPosition || e.withheld || (e.components & 3) != 3 || dt < least) continue;
        if (dt > most) break;
        const Vector3d noise = std::sqrt(2.0) / dt * data.fix_noise[e.index].position;
        const Vector3d std = noise.unaryExpr([&](double n) { return std::hypot(n, 0.5 * accel * dt); });
        if (std.head<2>().norm() >= best.second.head<2>().norm()) continue;
        best = {earth::ned_difference(settings.earth, data.recording->gnss[e.index].position, from.position) / dt, std};
    }
    return best;
}

/// Position, velocity and time; attitude is set by the caller.
void set_position(Start& start, const RunData& data, const Settings& settings) {
    const InitialSettings& given = settings.initial;
    const Event* fix_event = first_fix(data, settings);
    const bool position_given =
        std::isfinite(given.position.lat) && std::isfinite(given.position.lon) && std::isfinite(given.position.h);
    if (fix_event == nullptr && !position_given)
        throw input_error(
            "no GNSS fix lies inside the time of the IMU log", {.file = {}, .key = "gnss"},
            "check that both files use the same time axis (`schuler inspect` shows their spans), or give [initial]");
    const ImuIncrement& front = data.imu.increments.front();
    Time t0 = front.time - Duration::from_seconds(front.dt);
    if (settings.start) t0 = std::max(t0, *settings.start);
    if (given.time) t0 = std::max(t0, *given.time);
    if (!position_given) t0 = std::max(t0, fix_event->valid);
    start.increment = increment_at(data, t0 + Duration{100'000});
    if (start.increment > 0) start.previous = data.imu.increments[start.increment - 1];
    const ImuIncrement& first = data.imu.increments[start.increment];
    start.nav.time = first.time - Duration::from_seconds(first.dt);

    const auto or_given = [](const Vector3d& g, const Vector3d& found) {
        Vector3d v;
        for (int i = 0; i < 3; ++i) v(i) = std::isfinite(g(i)) ? g(i) : found(i);
        return v;
    };
    const GnssFix* fix = fix_event != nullptr ? &data.recording->gnss[fix_event->index] : nullptr;
    Vector3d velocity = Vector3d::Zero(), std_velocity = Vector3d::Constant(settings.vehicle == VehicleKind::Air ? 20.0 : 5.0);
    if (fix != nullptr && settings.gnss.use_velocity)
        for (int i = 0; i < 3; ++i)
            if (std::isfinite(fix->velocity_n(i))) {
                velocity(i) = fix->velocity_n(i);
                std_velocity(i) = 2.0 * data.fix_noise[fix_event->index].velocity(i) + 0.1;
                if (!std::isfinite(given.velocity_n(i))) start.velocity_of_fix(i) = 1.0;
            }
    if (fix_event != nullptr && start.velocity_of_fix.isZero()) {
        const auto [moved, std_moved] = velocity_by_positions(data, settings, *fix_event);
        // Noisy positions tell less of a slow vehicle than its kind does, but they may refute that it is slow.
        const bool fast = (moved.head<2>().array().abs() > 3.0 * (std_moved + std_velocity).head<2>().array()).any();
        for (int i = 0; i < 3; ++i)
            if (std::isfinite(moved(i)) && (fast || std_moved(i) < std_velocity(i))) {
                velocity(i) = moved(i);
                std_velocity(i) = std_moved(i);
            }
    }
    start.nav.v_eb_n = or_given(given.velocity_n, velocity);
    start.std_velocity = or_given(given.std_velocity, std_velocity);
    Vector3d std_position = Vector3d::Constant(10.0);
    if (position_given) {
        start.nav.position = given.position;
    } else {
        start.nav.position = fix->position;
        if (!std::isfinite(start.nav.position.h)) start.nav.position.h = 0.0;
        const double lead = (start.nav.time - fix_event->valid).seconds();
        start.nav.position = earth::moved_by_ned(settings.earth, start.nav.position, start.nav.v_eb_n * lead);
        const FixNoise& noise = data.fix_noise[fix_event->index];
        const Vector3d& slow = settings.gnss.errors.correlated_position;
        for (int i = 0; i < 3; ++i) {
            const double whole = std::max(noise.position(i), std::hypot(noise.white_position(i), slow(i)));
            std_position(i) = whole + start.std_velocity(i) * std::abs(lead);
        }
        start.at_antenna = true;
        start.position_of_fix.setOnes();
        start.position_rate = start.nav.v_eb_n;
        if (!std::isfinite(fix->position.h)) {
            std_position.z() = 1000.0;
            start.position_of_fix.z() = start.position_rate.z() = 0.0;
        }
    }
    start.std_position = or_given(given.std_position, std_position);
}

Start found_start(const RunData& data, const Settings& settings, Findings& findings, WarningLog& warnings) {
    const InitialSettings& given = settings.initial;
    Start start;
    set_biases(start, settings);
    set_position(start, data, settings);
    const Time t0 = start.nav.time;

    const StillStart still = still_at(data, t0);
    const bool standing = still.length >= 1.0;
    if (standing) {
        const Vector3d& v = given.velocity_n;
        if ((v.array().abs() > 3.0 * start.std_velocity.array() + 0.3).any())  // false where none is given
            warnings.add("initial.velocity",
                         fmt::format("the unit is at rest at the start, which contradicts the given initial velocity of {:.2f}, "
                                     "{:.2f}, {:.2f} m/s (north, east, down): the start at rest is used",
                                     v.x(), v.y(), v.z()));
        start.nav.v_eb_n.setZero();
        start.std_velocity.setConstant(0.1);
        start.velocity_of_fix.setZero();
        start.position_rate.setZero();
    } else {
        start.velocity_rate = gnss_acceleration(data, t0).cwiseProduct(start.velocity_of_fix);
    }
    const Level level = level_of(data, settings, start, still);
    const Vector3d &f_n = level.f_n, &f_b = level.f_b;
    const double level_std = level.std;
    findings.aligned_at = t0;

    // A heading from the direction of travel has the same latency.
    const double course_rate = [&] {
        constexpr double slowest = 2.0;  // m/s
        const Eigen::Vector2d v = start.nav.v_eb_n.head<2>(), a = start.velocity_rate.head<2>();
        return v.norm() > slowest ? (v.x() * a.y() - v.y() * a.x()) / v.squaredNorm() : 0.0;
    }();

    const auto finish = [&](double heading, double std_heading, const std::string& sentence) {
        const Vector3d found = math::rpy_from_quaternion(ins::attitude_from_specific_force(f_b, f_n, heading));
        Vector3d rpy, std(level_std, level_std, std_heading);
        for (int i = 0; i < 3; ++i) {
            rpy(i) = std::isfinite(given.rpy(i)) ? given.rpy(i) : found(i);
            if (std::isfinite(given.std_rpy(i))) std(i) = given.std_rpy(i);
        }
        start.nav.q_nb = math::quaternion_from_rpy(rpy);
        start.std_rpy = std;
        findings.alignment = sentence;
        return start;
    };

    if (std::isfinite(given.rpy.z())) return finish(given.rpy.z(), 5.0 * units::deg, "attitude given");

    const double w_ie = settings.earth.ellipsoid.w_ie;
    const double horizontal_rate = w_ie * std::cos(start.nav.position.lat);
    if (standing && start.std_gyro_bias.maxCoeff() < 0.1 * horizontal_rate && still.length > 20.0) {
        const double gyro_std =
            std::hypot(start.std_gyro_bias.maxCoeff(), settings.imu.errors.gyro_noise / std::sqrt(still.length));
        const ins::Gyrocompass compass = ins::gyrocompass(settings.earth, start.nav.position, still.force, still.rate,
                                                          start.std_accel_bias.maxCoeff(), gyro_std);
        const double std = 2.0 * compass.std_rpy.z();
        return finish(compass.rpy.z(), std,
                      fmt::format("gyrocompassing over {:.0f} s, heading to {:.2f} deg", still.length, std / units::deg));
    }
    if (standing && start.std_gyro_bias.maxCoeff() > w_ie) {
        // At rest the mean rate is the bias plus the Earth rate.
        start.gyro_bias = still.rate;
        start.std_gyro_bias.setConstant(w_ie + settings.imu.errors.gyro_noise / std::sqrt(still.length) +
                                        0.2 * settings.imu.errors.gyro_bias);
    }

    // Beyond `linear` a linearised filter becomes overconfident: its own covariance is not all that is reported. Its initial
    // sigma is limited to `open`, so that it can follow later information.
    constexpr double linear = 15.0 * units::deg, open = 40.0 * units::deg;
    constexpr double unknown = 100.0 * units::deg;
    std::optional<double> tried;  // the best of equally likely headings
    const std::optional<HeadingWitness> shown = shown_heading(data, settings, t0, level);
    const Time motion = first_motion(data, t0);
    if (motion < data.imu.increments.back().time - Duration::from_seconds(3.0)) {
        Start trial = start;
        // A long standstill before the first motion gives no heading information: the trials begin shortly before the motion.
        const double wait = (motion - t0).seconds();
        const bool late = standing && wait > 30.0 && still.length > wait - 10.0;
        if (late) {
            trial.increment = increment_at(data, motion - Duration::from_seconds(10.0));
            trial.previous = data.imu.increments[trial.increment - 1];
            trial.nav.time = trial.previous.time;
        }
        const HeadingSearch search = search_heading(data, settings, trial, level, motion, shown);
        const Vector3d rpy = math::rpy_from_quaternion(search.best.nav.q_nb);
        // Errors are evaluated from here on, for any duration of the search: it ends where it begins.
        const Time until = std::min(search.until, std::max(motion, t0) + Duration::from_seconds(120.0));
        // A mixture as wide as the error of the course contains no other information.
        start.heading_of_sensor = shown && settings.heading.by_course && !shown->by_mag && search.std > 0.5 * shown->std;
        if (search.decided) {
            findings.aligned_at = until;
            const double std = std::max({2.0 * units::deg, 3.0 * search.best.std_rpy.z(), search.std});
            if (!standing) start.gyro_bias = search.best.gyro_bias;
            const std::string sentence =
                fmt::format("heading {:.1f} deg at the start found from the motion in the first {:.0f} s", rpy.z() / units::deg,
                            (search.until - t0).seconds());
            if (standing) return finish(rpy.z(), std, sentence);
            start.heading_rate = course_rate;
            start = finish(rpy.z(), std, sentence);
            for (int i = 0; i < 2; ++i)
                if (!std::isfinite(given.rpy(i)) && !std::isfinite(given.std_rpy(i)))
                    start.std_rpy(i) = std::max(1.0 * units::deg, 3.0 * search.best.std_rpy(i));
            Vector3d full = rpy;
            for (int i = 0; i < 3; ++i)
                if (std::isfinite(given.rpy(i))) full(i) = given.rpy(i);
            start.nav.q_nb = math::quaternion_from_rpy(full);
            return start;
        }
        if (!shown) tried = math::wrap_2pi(rpy.z());
        if (search.std < 60.0 * units::deg) {
            findings.aligned_at = until;
            if (!standing) start.gyro_bias = search.best.gyro_bias;
            if (!standing) start.heading_rate = course_rate;
            const double std = 1.5 * search.std;  // the tails are longer than those of a Gaussian
            const auto sentence = [&](double heading, const char* which) {
                return fmt::format(
                    "heading {:.0f} deg at the start, to {:.0f} deg: the {} of what the first {:.0f} s do not refute",
                    heading / units::deg, std / units::deg, which, (search.until - t0).seconds());
            };
            if (std < linear) {
                const double heading = math::wrap_2pi(search.heading);
                return finish(heading, std, sentence(heading, "mean"));
            }
            start.undecided_heading = std;
            const double heading = math::wrap_2pi(rpy.z());
            return finish(heading, std::min(std, open), sentence(heading, "most likely"));
        }
    }
    double top_speed = 0.0;
    for (const GnssFix& fix : data.recording->gnss)
        if (fix.velocity_n.allFinite()) top_speed = std::max(top_speed, fix.velocity_n.norm());
    // Without motion: from an instrument if there is one, otherwise unknown.
    if (shown && !std::isfinite(given.rpy.z())) {
        start.heading_of_mag = shown->by_mag;
        start.heading_of_sensor = !shown->by_mag;
    }
    if (shown)
        return finish(shown->heading, shown->std,
                      fmt::format("heading {:.0f} deg from the {}, to {:.0f} deg", shown->heading / units::deg,
                                  shown->by_mag ? "magnetometer" : "sensor of the heading", shown->std / units::deg));
    warnings.add(
        "start.heading",
        fmt::format("the heading cannot be found: {}; it starts at {} with 100 deg of uncertainty "
                    "(give initial.heading_deg)",
                    top_speed > 5.0
                        ? fmt::format("the fixes reach {:.0f} m/s, but no attitude makes the IMU follow them: check its units, "
                                      "axes and times (`schuler inspect` measures them)",
                                      top_speed)
                        : "the log has too little motion, no magnetometer and no sensor of the heading",
                    tried ? fmt::format("{:.0f} deg", *tried / units::deg) : "north"));
    findings.aligned_at = data.imu.increments.back().time;
    findings.heading_found = false;
    start.undecided_heading = unknown;
    return finish(tried.value_or(0.0), open, "heading unknown");
}

}  // namespace

bool gives_start(const InitialSettings& i) {
    return std::isfinite(i.position.lat) && i.velocity_n.allFinite() && i.rpy.allFinite() && i.std_position.allFinite() &&
           i.std_velocity.allFinite() && i.std_rpy.allFinite();
}

Start find_start(const RunData& data, const Settings& settings, Findings& findings, WarningLog& warnings) {
    Start start = found_start(data, settings, findings, warnings);
    // The acceleration in which the fixes' latency is effective from here on; another one would appear as information about it.
    constexpr double span = 0.1;  // s
    const Vector3d g_n = earth::terms_at(settings.earth, start.nav.position, start.nav.v_eb_n).g_n;
    const Vector3d acceleration = start.nav.q_nb * mean_force(data, start.increment, span) + g_n;
    if (!start.velocity_rate.isZero()) start.velocity_rate = acceleration.cwiseProduct(start.velocity_of_fix);
    return start;
}

Start with_later_fixes(const Start& start, const earth::Earth& earth, double position, double velocity) {
    Start later = start;
    later.nav.position = earth::moved_by_ned(earth, start.nav.position, position * start.position_rate);
    later.nav.v_eb_n += velocity * start.velocity_rate;
    later.nav.q_nb = Eigen::AngleAxisd(velocity * start.heading_rate, Vector3d::UnitZ()) * start.nav.q_nb;
    return later;
}

}  // namespace schuler::fusion
