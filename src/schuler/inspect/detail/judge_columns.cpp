// Columns whose content differs from their names: exchanged latitude and longitude, sensors of opposite sign or with exchanged axes.
#include "schuler/inspect/detail/study.h"

#include "schuler/core/units.h"
#include "schuler/earth/earth.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

/// Displacements over about `span` s compared with the mean velocity between them: sums of squared differences and displacements.
struct Misfit {
    double miss = 0.0, moved = 0.0;
};
Misfit misfit(const LoadedFile& file, double span, const char* lat, const char* lon, const char* north = "vel_n_m_s",
              const char* east = "vel_e_m_s") {
    const std::vector<double>&p = file[lat], &q = file[lon], &vn = file[north], &ve = file[east];
    const earth::Earth earth;
    Misfit sum;
    std::size_t first = 0;
    double n = 0.0, e = 0.0;
    for (std::size_t k = 1; k < p.size(); ++k) {
        const double dt = static_cast<double>(file.time_ns[k] - file.time_ns[k - 1]) * 1e-9;
        n += 0.5 * dt * (vn[k] + vn[k - 1]);
        e += 0.5 * dt * (ve[k] + ve[k - 1]);
        const double whole = static_cast<double>(file.time_ns[k] - file.time_ns[first]) * 1e-9;
        if (whole < span) continue;
        const Geodetic a{p[first] * units::deg, q[first] * units::deg, 0.0}, b{p[k] * units::deg, q[k] * units::deg, 0.0};
        const Eigen::Vector2d moved = earth::ned_difference(earth, b, a).head<2>();
        const double miss = (moved - Eigen::Vector2d(n, e)).squaredNorm();
        const double jump = std::pow(500.0 * span, 2);  // m^2: impossible for any vehicle
        if (dt > 0.0 && dt < 2.5 && std::isfinite(miss) && miss < jump) {
            sum.miss += miss;
            sum.moved += n * n + e * e;
        }
        first = k;
        n = e = 0.0;
    }
    return sum;
}

Eigen::Vector3d mean_force(const ImuSeries& imu) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const Eigen::Vector3d& f : imu.f) sum += f / static_cast<double>(imu.size());
    return sum;
}

}  // namespace

void judge_coordinates(Study& study) {
    if (study.gnss_file == nullptr) return;
    LoadedFile& file = *study.gnss_file;
    if (!file.has("lat_deg") || !file.has("lon_deg") || !file.has("vel_n_m_s") || !file.has("vel_e_m_s")) return;
    constexpr double most = 90.0;
    if (std::ranges::any_of(file["lon_deg"], [](double x) { return std::abs(x) > most; })) return;
    constexpr double much = 400.0, wrong = 0.1, right = 0.05;  // m^2; fractions of the motion
    // Over 2 s most vehicles move farther than the positions scatter; noise of metres at walking or driving speed needs longer.
    Misfit as_named, exchanged;
    double span = 0.0;
    for (const double s : {2.0, 10.0, 30.0}) {
        as_named = misfit(file, s, "lat_deg", "lon_deg");
        if (as_named.moved < much || as_named.miss < wrong * as_named.moved) return;
        exchanged = misfit(file, s, "lon_deg", "lat_deg");
        if (exchanged.miss > right * exchanged.moved || exchanged.miss > right * as_named.miss) continue;
        span = s;
        break;
    }
    if (span == 0.0) return;
    // Near the equator the velocities may be the exchanged ones just as well.
    const Misfit velocities = misfit(file, span, "lat_deg", "lon_deg", "vel_e_m_s", "vel_n_m_s");
    constexpr double alike = 2.0;
    if (alike * velocities.miss < exchanged.miss) return;
    const io::ColumnMatch *lat = file.plan.find("lat_deg"), *lon = file.plan.find("lon_deg");
    if (velocities.miss < alike * exchanged.miss) {
        leave_out_velocities(study,
                             fmt::format("either latitude and longitude ({}, {}) or the velocities north and east ({}, {}) "
                                         "are exchanged: so near the equator they do not show which",
                                         lat->file_name, lon->file_name, file.plan.find("vel_n_m_s")->file_name,
                                         file.plan.find("vel_e_m_s")->file_name));
        return;
    }
    const std::string text = fmt::format(
        "latitude and longitude are exchanged: the positions agree with the velocities only with {} as the latitude "
        "(of the motion {:.1g} remain, otherwise {:.1g})",
        lon->file_name, std::sqrt(exchanged.miss / exchanged.moved), std::sqrt(as_named.miss / as_named.moved));
    if (file.as.overrides.columns.contains("lat_deg") || file.as.overrides.columns.contains("lon_deg") ||
        lat->file_name == lon->file_name) {
        study.contradicts("gnss.columns", text);
        return;
    }
    file.column_map["lat_deg"] = lon->file_name;
    file.column_map["lon_deg"] = lat->file_name;
    std::swap(file.columns["lat_deg"], file.columns["lon_deg"]);
    study.found("gnss.columns", "latitude and longitude exchanged", 0.95, text);
    study.doubts.push_back(fmt::format("{}: {}; taken so", file.report.path, text));
    file.problem(Level::Warning, text, "name the columns rightly");
}

namespace {

/// True if the vertical rate equals that of the course with opposite sign.
bool turns_against_course(const Study& study) {
    const Eigen::Vector3d up = study.still.any() ? study.still.f : mean_force(study.imu);
    constexpr double against = -0.6;  // correlation of the course's rate with the rate about the vertical
    return up.norm() > 0.0 && course_slope(study.imu, study.gnss, -up.normalized(), study.still.w).correlation < against;
}

struct Trial {
    Eigen::Vector3d sign;
    MotionFit fit;
};

/// The fits for all non-empty combinations of reversed gyros.
std::vector<Trial> gyros_turned_round(const Study& study, FitSource source) {
    std::vector<Trial> trials;
    for (int k = 1; k < 8; ++k) {
        const Eigen::Vector3d sign((k & 1) != 0 ? -1.0 : 1.0, (k & 2) != 0 ? -1.0 : 1.0, (k & 4) != 0 ? -1.0 : 1.0);
        ImuSeries turned = study.imu;
        for (Eigen::Vector3d& w : turned.w) w = sign.cwiseProduct(w);
        const Eigen::Vector3d bias = sign.cwiseProduct(study.still.w);
        trials.push_back({sign, fit_motion(turned, study.gnss, source, bias, study.still.any(), study.gravity)});
    }
    return trials;
}

}  // namespace

bool judge_gyro_signs(Study& study) {
    if (!study.overlap || study.imu_file == nullptr || study.imu_file->has("dtheta_x_rad")) return false;
    const MotionFit& fit = study.gnss.has_velocity() ? study.velocity_fit : study.position_fit;
    const bool turns_against = turns_against_course(study);
    if (fit.windows < 5 || (!turns_against && shows_lag(fit) && fit.rms < 0.3 * fit.motion)) return false;
    const auto& given = study.imu_file->as.overrides.scale;
    if (std::ranges::any_of(given, [](const auto& entry) { return entry.first.starts_with("gyro"); })) return false;
    const FitSource source = study.gnss.has_velocity() ? FitSource::Velocity : FitSource::Displacement;
    const std::vector<Trial> trials = gyros_turned_round(study, source);
    const double lowest = std::ranges::min(trials, {}, [](const Trial& t) { return t.fit.rms; }).fit.rms;
    // axes with little rotation may have either sign: as few as possible are reversed
    const Trial* best = nullptr;
    for (const Trial& t : trials)
        if (t.fit.rms < 1.15 * lowest && (best == nullptr || t.sign.sum() > best->sign.sum())) best = &t;
    if (best == nullptr) return false;  // no fit has a finite residual
    constexpr double clearly = 0.5;
    if (!shows_lag(best->fit) || best->fit.rms > (turns_against ? 0.9 : clearly) * fit.rms ||
        best->fit.rms > clearly * best->fit.motion)
        return false;
    static constexpr std::array<const char*, 3> names{"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"};
    std::string axes;
    const std::string why =
        fmt::format("with the sign of its column the IMU leaves {:.2g} m/s of the track's motion, turned round {:.2g} m/s",
                    fit.rms, best->fit.rms);
    const bool all = best->sign.sum() < -2.5;
    double unit = 1.0;
    for (UnitChange& change : study.imu_units)
        if (change.key == "gyro_rad_s") {
            unit = change.factor / study.imu_file->plan.find(names[0])->factor;
            if (all) change.factor = -change.factor;
        }
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (best->sign(static_cast<Eigen::Index>(i)) > 0.0) continue;
        axes += fmt::format("{}{}", axes.empty() ? "" : ", ", names[i][5]);
        for (double& v : study.imu_file->columns[names[i]]) v = -v;
        const double factor = -unit * study.imu_file->plan.find(names[i])->factor;
        if (!all) study.imu_units.push_back({names[i], factor, "turned round", 0.9, why, false});
    }
    if (all && unit == 1.0)
        study.imu_units.push_back({"gyro_rad_s", -study.imu_file->plan.find(names[0])->factor, "turned round", 0.9, why, false});
    for (Eigen::Vector3d& w : study.imu.w) w = best->sign.cwiseProduct(w);
    study.doubts.push_back(fmt::format("{}: gyro {} turned round: {}", study.imu_file->report.path, axes, why));
    study.problem(Level::Warning, study.doubts.back(), "check the sign of the column");
    return true;
}

namespace {

constexpr std::array<const char*, 3> accel_names{"accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"};

/// Which column is read as which axis of the accelerometer, and with which sign.
struct Reading {
    std::array<int, 3> from;
    std::array<double, 3> sign;
    [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& f) const {
        return {sign[0] * f(from[0]), sign[1] * f(from[1]), sign[2] * f(from[2])};
    }
};
constexpr std::array<int, 3> as_named{0, 1, 2};
constexpr std::array<double, 3> straight{1.0, 1.0, 1.0};
constexpr std::array<Reading, 3> one_reversed{
    {{as_named, {-1.0, 1.0, 1.0}}, {as_named, {1.0, -1.0, 1.0}}, {as_named, {1.0, 1.0, -1.0}}}};
constexpr std::array<Reading, 6> others{{{as_named, {-1.0, -1.0, -1.0}},
                                         {{1, 0, 2}, straight},
                                         {{2, 1, 0}, straight},
                                         {{0, 2, 1}, straight},
                                         {{1, 2, 0}, straight},
                                         {{2, 0, 1}, straight}}};

struct ReadingTrial {
    const Reading* reading = nullptr;
    MotionFit fit;
};

template <std::size_t N>
ReadingTrial best_of(const std::array<Reading, N>& readings, const Study& study, FitSource source) {
    ReadingTrial best;
    for (const Reading& reading : readings) {
        ImuSeries imu = study.imu;
        for (Eigen::Vector3d& f : imu.f) f = reading(f);
        MotionFit fit = fit_motion(imu, study.gnss, source, study.still.w, study.still.any(), study.gravity);
        if (best.reading == nullptr || fit.rms < best.fit.rms) best = {&reading, std::move(fit)};
    }
    return best;
}

/// Reads the accelerometers so, and reports it.
void read_as(Study& study, const Reading& reading, const std::string& why) {
    LoadedFile& file = *study.imu_file;
    const auto unit = std::ranges::find(study.imu_units, "accel_m_s2", &UnitChange::key);
    std::array<std::vector<double>, 3> values;
    for (std::size_t i = 0; i < 3; ++i) values[i] = file.columns[accel_names[i]];
    std::string reversed, exchanged;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto from = static_cast<std::size_t>(reading.from[i]);
        std::vector<double>& column = file.columns[accel_names[i]] = values[from];
        if (from != i) {
            file.column_map[accel_names[i]] = file.plan.find(accel_names[from])->file_name;
            exchanged +=
                fmt::format("{}{} is {}", exchanged.empty() ? "" : ", ", accel_names[i][6], file.column_map[accel_names[i]]);
        }
        if (reading.sign[i] > 0.0) continue;
        for (double& v : column) v = -v;
        reversed += fmt::format("{}{}", reversed.empty() ? "" : ", ", accel_names[i][6]);
    }
    if (!exchanged.empty()) study.found("imu.columns", exchanged, 0.9, why);
    const bool all = std::ranges::max(reading.sign) < 0.0, has_unit = unit != study.imu_units.end();
    if (all && has_unit) unit->factor = -unit->factor;
    for (std::size_t i = 0; i < 3 && !(all && has_unit); ++i) {
        if (reading.sign[i] > 0.0) continue;
        const double factor = has_unit ? unit->factor : file.plan.find(accel_names[i])->factor;
        study.imu_units.push_back({all ? "accel_m_s2" : accel_names[i], -factor, "turned round", 0.9, why, false});
        break;  // one axis, or all together
    }
    for (Eigen::Vector3d& f : study.imu.f) f = reading(f);
    study.doubts.push_back(
        exchanged.empty() ? fmt::format("{}: accelerometer {} turned round: {}", file.report.path, reversed, why)
                          : fmt::format("{}: accelerometer columns are exchanged, {}: {}", file.report.path, exchanged, why));
    study.problem(Level::Warning, study.doubts.back(), "check the names and signs of the columns");
}

}  // namespace

bool judge_accelerometers(Study& study) {
    constexpr double to_the_wrong_side = -0.5, well = 0.3, clearly = 0.5, somewhat = 0.9, better = 0.85;
    if (!study.overlap || study.imu_file == nullptr || study.imu_file->has("dtheta_x_rad")) return false;
    const MotionFit& fit = study.gnss.has_velocity() ? study.velocity_fit : study.position_fit;
    const double felt = felt_in_turns(study);
    const bool outwards = felt < to_the_wrong_side, fits = shows_lag(fit) && fit.rms < well * fit.motion,
               mirrored = turns_against_course(study);
    if (fit.windows < 5 || (fits && !outwards && !mirrored)) return false;
    const io::ColumnOverrides& given = study.imu_file->as.overrides;
    const auto of_accel = [](const auto& entry) { return entry.first.starts_with("accel"); };
    if (std::ranges::any_of(given.scale, of_accel)) return false;
    const FitSource source = study.gnss.has_velocity() ? FitSource::Velocity : FitSource::Displacement;
    const auto why = [&](const MotionFit& other) {
        return fmt::format(
            "{}as they are named the IMU leaves {:.2g} m/s of the track's motion, so {:.2g} m/s",
            outwards ? fmt::format("the force of turns is felt to the wrong side ({:.0f} %); ", 100.0 * felt) : std::string(),
            fit.rms, other.rms);
    };
    // Gyros of opposite sign also mirror the axes: effects they explain equally well are attributed to them.
    const double gyros =
        std::ranges::min(gyros_turned_round(study, source), {}, [](const Trial& t) { return t.fit.rms; }).fit.rms;
    const ReadingTrial one = best_of(one_reversed, study, source);
    if ((!fits || mirrored) && std::ranges::none_of(given.columns, of_accel)) {
        const ReadingTrial other = best_of(others, study, source);
        if (shows_lag(other.fit) && other.fit.rms < well * other.fit.motion && other.fit.rms < clearly * fit.rms &&
            other.fit.rms < better * one.fit.rms && other.fit.rms < better * gyros) {
            read_as(study, *other.reading, why(other.fit));
            return true;
        }
    }
    // No vehicle rolls outwards in turns as much as it would roll inwards: the better fit then only has to identify the axis.
    if (!shows_lag(one.fit) || one.fit.rms > clearly * one.fit.motion ||
        one.fit.rms > (outwards ? somewhat : clearly) * fit.rms || one.fit.rms > better * gyros)
        return false;
    read_as(study, *one.reading, why(one.fit));
    return true;
}

}  // namespace schuler::inspect::detail
