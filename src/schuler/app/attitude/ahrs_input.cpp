#include "schuler/ahrs/calibration.h"
#include "schuler/ahrs/constant_magnet.h"
#include "schuler/ahrs/magnetometer_clock.h"
#include "schuler/app/attitude/ahrs.h"
#include "schuler/core/units.h"
#include "schuler/dataset/data_folder.h"
#include "schuler/earth/magnetic_model.h"
#include "schuler/math/rotation.h"
#include "schuler/solution/loaded_dataset.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace schuler::app {
namespace {

using Eigen::Vector3d;

constexpr double slow = 3.0;               // m/s, below which a receiver's course does not give the heading
constexpr double default_speed_std = 0.5;  // m/s

/// The largest magnitude of each axis, if it is the range limit of the instrument: the same extreme value several times in a row, for long
/// or at least twice with slower motion between, while the other axes show noise. Steady rotation in a noise-free simulation does not count.
template <class Samples, class Get>
Vector3d range_of(const Samples& samples, Get get, double least, double unusual) {
    constexpr double left = 0.9, quiet = 1e-6;      // of the extreme: no longer at it; less than any instrument's noise
    constexpr int enough = 2, longest_chance = 20;  // occurrences; consecutive samples that cannot be coincidence
    Vector3d range = Vector3d::Constant(std::numeric_limits<double>::infinity());
    for (int axis = 0; axis < 3; ++axis) {
        double extreme = 0.0;
        for (const auto& s : samples) extreme = std::max(extreme, std::abs(get(s)(axis)));
        if (extreme < unusual) continue;
        // for a small range, the duration at the limit decides
        const int at_the_stop = extreme < least ? 20 : 3;
        int run = 0, visits = 0;
        bool noisy = false, away = true;
        Vector3d before = Vector3d::Zero();
        for (const auto& s : samples) {
            Vector3d others = get(s);
            const double size = std::abs(others(axis));
            others(axis) = 0.0;
            if (size >= extreme) {
                noisy = noisy || (run > 0 && (others - before).cwiseAbs().maxCoeff() > quiet * extreme);
                if (++run >= at_the_stop && noisy && away) {
                    ++visits;
                    away = false;
                }
                if (run >= longest_chance && noisy) visits = enough;
            } else {
                run = 0;
                noisy = false;
                away = away || size < left * extreme;
            }
            before = others;
        }
        if (visits >= enough) range(axis) = extreme;
    }
    return range;
}

std::vector<ahrs::SpeedSample> speeds_of(const Recording& r, fusion::VehicleKind kind) {
    std::vector<ahrs::SpeedSample> out;
    if (kind != fusion::VehicleKind::Car && kind != fusion::VehicleKind::Air) return out;
    for (const GnssFix& f : r.gnss) {
        const double speed = f.velocity_n.head<2>().norm();
        if (f.fix == FixType::None || !std::isfinite(speed) || speed < slow) continue;
        const double std = f.std_velocity.head<2>().norm();
        out.push_back({f.time - Duration::from_seconds(f.velocity_age), speed, std::isfinite(std) ? std : default_speed_std});
    }
    return out;
}

/// The Earth's field at the position and time of the log, if both are known.
void field_from_model(const solution::LoadedDataset& data, AhrsInput& out, WarningLog& warnings) {
    const Recording& r = data.recording;
    Geodetic where = data.config.filter.initial.position;
    if (!r.gnss.empty() && std::isfinite(r.gnss.front().position.lat)) where = r.gnss.front().position;
    const double year = r.imu.empty() ? not_given : dataset::decimal_year_of(data.config.time, r.imu.front().time);
    if (!std::isfinite(where.lat) || !std::isfinite(where.lon) || !std::isfinite(year)) return;
    const std::filesystem::path folder = dataset::magnetic_model_folder();
    if (folder.empty()) {
        warnings.add("ahrs.model",
                     "the World Magnetic Model's files are not installed: heading is magnetic; set SCHULER_DATA_DIR");
        return;
    }
    const earth::MagneticModel model("wmm2025", folder.string());
    if (year < model.first_year() || year > model.last_year()) {
        warnings.add("ahrs.model.date",
                     fmt::format("{:.1f} is outside the magnetic model's years {:.0f} to {:.0f}: heading may be off "
                                 "by some tenths of a degree",
                                 year, model.first_year(), model.last_year()));
    }
    const earth::MagneticField field = model.at(year, {where.lat, where.lon, std::isfinite(where.h) ? where.h : 0.0});
    out.settings.mekf.heading.known_field_n = Vector3d(field.horizontal(), 0.0, field.field_n.z());
    out.settings.mekf.heading.declination = field.declination();
    out.settings.vector.horizontal_field = field.horizontal();
    out.settings.vector.vertical_field = field.field_n.z();
    out.field_from_model = true;
}

/// Horizontal and vertical field from the first seconds of the log, for the filters that require them.
void field_from_log(AhrsInput& out) {
    constexpr double seconds = 2.0;
    Vector3d force = Vector3d::Zero(), field = Vector3d::Zero();
    const Time end = out.imu.front().time + Duration::from_seconds(seconds);
    for (const ImuSample& s : out.imu) {
        if (s.time > end) break;
        if (s.accel.allFinite()) force += s.accel;
    }
    for (const MagSample& s : out.mag) {
        if (s.time > end) break;
        if (s.field_b.allFinite() && (field.isZero() || s.field_b.norm() > 0.0))
            field = field.isZero() ? s.field_b : (0.9 * field + 0.1 * s.field_b).eval();
    }
    if (force.norm() == 0.0 || field.norm() == 0.0) return;
    const double down = -field.dot(force.normalized());
    out.settings.vector.vertical_field = down;
    out.settings.vector.horizontal_field = std::max(1e-6, (field + down * force.normalized()).norm());
}

/// Corrects the times of a magnetometer that is late or early; a delay that the user gave is only checked.
void synchronise(AhrsInput& out, const std::set<std::string>& given, WarningLog& warnings) {
    if (out.mag.empty()) return;
    const ahrs::MagnetometerClock clock = ahrs::find_delay(out.imu, out.mag);
    if (clock.delay == 0.0) return;
    const bool is_given = given.contains("mag.time_offset_s");
    warnings.add(
        "ahrs.mag.delay",
        fmt::format(
            "the magnetometer's times are {:.2f} s {} against the IMU's ({:.0f} % of the field's variation is consistent with the gyro, and {:.0f} % with that corrected): {}",
            std::abs(clock.delay), clock.delay > 0.0 ? "late" : "early", 100.0 * clock.as_given, 100.0 * clock.explained,
            is_given
                ? fmt::format("this contradicts the given mag.time_offset_s, which is used; add {:.2f} s to it", -clock.delay)
                : fmt::format("corrected; [mag] time_offset_s = {:.2f} states it", -clock.delay)));
    if (is_given) return;
    for (MagSample& s : out.mag) s.time = s.time - Duration::from_seconds(clock.delay);
    std::erase_if(out.mag, [&](const MagSample& s) { return s.time < out.imu.front().time; });
    out.mag_delay = clock.delay;
}

/// A magnet that is on the sensor throughout the log adds a constant to all readings. The filter would find it after some turning only.
void take_off_magnet(AhrsInput& out, WarningLog& warnings) {
    if (out.mag.empty()) return;
    const auto magnet = ahrs::find_constant_magnet(out.imu, out.mag);
    if (!magnet) return;
    for (MagSample& s : out.mag) s.field_b -= magnet->field_b;
    out.magnet_b = magnet->field_b;
    double& std = out.settings.mekf.heading.hard_iron_std;
    std = std::hypot(std, magnet->std);
    warnings.add("ahrs.mag.magnet",
                 fmt::format("a constant field of {:.0f} uT turns with the sensor: a magnet or iron on it, which is subtracted",
                             magnet->field_b.norm() / units::microtesla));
}

/// Rotates the data of a magnetometer whose axes differ from the IMU's.
void straighten(AhrsInput& out, WarningLog& warnings) {
    if (out.mag.empty()) return;
    out.axes = ahrs::recognise_axes(out.imu, out.mag, out.settings.mekf.heading.known_field_n.z());
    if (!out.axes.swapped) return;
    for (MagSample& s : out.mag) s.field_b = (out.axes.C_bs * s.field_b).eval();
    const Vector3d range = out.settings.mekf.guard.field_range;
    for (int i = 0; i < 3; ++i) {
        Eigen::Index of = 0;
        out.axes.C_bs.row(i).cwiseAbs().maxCoeff(&of);
        out.settings.mekf.guard.field_range(i) = range(of);
    }
    warnings.add(
        "ahrs.mag.axes.turned",
        fmt::format(
            "the magnetometer turns with the gyro only as {} (body axis = reading; {:.0f} % of the field's variation is consistent with the gyro, {:.0f} % as given): the axes were remapped{}; name its columns accordingly",
            ahrs::axes_text(out.axes.C_bs), 100.0 * out.axes.explained, 100.0 * out.axes.as_given,
            out.axes.sign_assumed ? ", the field taken to point down, as north of the equator" : ""));
}

void calibrate(AhrsInput& out, WarningLog& warnings) {
    const double size = out.settings.mekf.heading.known_field_n.norm();
    const auto tell = [&](const char* key, const char* name, const ahrs::JudgedCalibration& judged) {
        if (!judged.fit) warnings.add(key, fmt::format("the {} is left uncalibrated: {}", name, judged.reason));
        out.calibration.push_back(fmt::format("{}: {}: {}", name, judged.fit ? "applied" : "refused", judged.reason));
    };
    if (!out.mag.empty()) {
        const auto judged = ahrs::judge_magnetometer(out.imu, out.mag, std::isfinite(size) ? size : 0.0);
        tell("ahrs.calibration.mag", "magnetometer", judged);
        if (judged.fit) {
            for (MagSample& s : out.mag) s.field_b = judged.fit->apply(s.field_b);
        }
    }
    const auto judged = ahrs::judge_accelerometer(out.imu, out.settings.mekf.tilt.gravity);
    tell("ahrs.calibration.accel", "accelerometer", judged);
    if (judged.fit) {
        for (ImuSample& s : out.imu) s.accel = judged.fit->apply(s.accel);
    }
}

}  // namespace

const std::vector<std::pair<std::string, ahrs::FilterKind>>& attitude_filters() {
    static const std::vector<std::pair<std::string, ahrs::FilterKind>> filters{
        {"dcm", ahrs::FilterKind::Dcm},
        {"quaternion", ahrs::FilterKind::Quaternion},
        {"quaternion-printed", ahrs::FilterKind::QuaternionPrinted},
        {"quaternion-coupled", ahrs::FilterKind::QuaternionCoupled},
        {"mekf", ahrs::FilterKind::Mekf}};
    return filters;
}

AhrsInput ahrs_input(const solution::LoadedDataset& data, const AhrsRequest& request, WarningLog& warnings) {
    AhrsInput out;
    for (const auto& [name, kind] : attitude_filters())
        if (name == request.filter) out.settings.filter = kind;
    out.settings.offline = request.offline;
    if (request.offline && out.settings.filter != ahrs::FilterKind::Mekf)
        throw input_error("only the mekf has an offline solution", {{}, 0, 0, "--offline"}, "leave out --offline, or --filter");
    const fusion::Settings& f = data.config.filter;
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(f.imu.mounting_rpy) * f.imu.C_bs;
    const Recording& r = data.recording;
    Time previous{};
    for (std::size_t i = 0; i < r.imu.size(); ++i) {
        const ImuSample& s = r.imu[i];
        const double dt = i > 0 ? (s.time - previous).seconds() : 0.0;
        previous = s.time;
        if ((f.start && s.time < *f.start) || (f.stop && s.time > *f.stop)) continue;
        const double per = f.imu.kind == ImuKind::Rates ? 1.0 : dt > 0.0 ? 1.0 / dt : not_given;
        out.imu.push_back({s.time, C_bs * (s.gyro * per), C_bs * (s.accel * per)});
    }
    if (out.imu.size() < 2)
        throw input_error("fewer than two IMU samples are in the chosen time", {}, "look at --start and --stop");
    if (f.mag.use)
        for (const MagSample& s : r.mag) out.mag.push_back({s.time, C_bs * s.field_b});
    while (!out.mag.empty() && out.mag.back().time > out.imu.back().time) out.mag.pop_back();
    out.mag.erase(out.mag.begin(),
                  std::ranges::find_if(out.mag, [&](const MagSample& s) { return s.time >= out.imu.front().time; }));
    out.speed = speeds_of(r, f.vehicle);

    settle_gyro_unit(out, warnings);
    out.settings.mekf.six_axis = request.six_axis;
    if (out.mag.empty() && !request.six_axis) {
        out.settings.mekf.six_axis = true;
        warnings.add(
            "ahrs.six_axis",
            fmt::format("no magnetometer: six axes only, heading starts at zero and drifts with the gyro; {}",
                        !f.mag.use      ? "mag.use is off"
                        : r.mag.empty() ? "a log that is there but left out: --set mag.file=NAME"
                                        : "its log has no sample within the time of the IMU's: check both time columns"));
    }
    ahrs::GuardSettings& guard = out.settings.mekf.guard;
    constexpr double least_rate = 100.0 * units::deg, least_force = 15.0, least_field = 80e-6;
    guard.gyro_range = range_of(
        out.imu, [](const ImuSample& s) { return s.gyro; }, least_rate, 0.2 * least_rate);
    guard.accel_range = range_of(
        out.imu, [](const ImuSample& s) { return s.accel; }, least_force, least_force);
    guard.field_range = range_of(
        out.mag, [](const MagSample& s) { return s.field_b; }, least_field, least_field);
    const auto limited = [](Vector3d& found, double given) {
        if (given > 0.0) found = found.cwiseMin(given);
    };
    limited(guard.gyro_range, f.imu.errors.gyro_range);
    limited(guard.accel_range, f.imu.errors.accel_range);
    guard.gap_factor = f.imu.gap_factor;
    field_from_model(data, out, warnings);
    if (std::isfinite(f.mag.declination)) out.settings.mekf.heading.declination = f.mag.declination;
    synchronise(out, data.given, warnings);
    straighten(out, warnings);
    take_off_magnet(out, warnings);
    check_ahrs_input(out, warnings);
    if (!out.field_from_model) field_from_log(out);
    if (request.calibrate) calibrate(out, warnings);
    return out;
}

std::vector<analysis::AttitudePair> attitude_pairs(const std::vector<ahrs::AttitudeRow>& rows,
                                                   const std::vector<ReferenceSample>& reference) {
    std::vector<analysis::AttitudePair> out;
    if (rows.size() < 2) return out;
    constexpr double longest = 0.1;  // s between rows permitted for interpolation
    std::size_t k = 0;
    for (const ReferenceSample& r : reference) {
        if (!r.movement || !r.rpy.allFinite() || r.time < rows.front().time) continue;
        while (k + 1 < rows.size() && rows[k + 1].time < r.time) ++k;
        if (k + 1 >= rows.size()) break;
        const ahrs::AttitudeRow &a = rows[k], &b = rows[k + 1];
        const double gap = (b.time - a.time).seconds();
        if (!(gap > 0.0) || gap > longest) continue;
        const Eigen::Quaterniond q = a.q_nb.slerp((r.time - a.time).seconds() / gap, b.q_nb);
        out.push_back({q, math::quaternion_from_rpy(r.rpy)});
    }
    return out;
}

}  // namespace schuler::app
