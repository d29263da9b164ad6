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

/// Displacements over about 2 s compared with the mean velocity between them: sums of squared differences and displacements.
struct Misfit {
    double miss = 0.0, moved = 0.0;
};
Misfit misfit(const LoadedFile& file, const char* lat, const char* lon) {
    const std::vector<double>&p = file[lat], &q = file[lon], &vn = file["vel_n_m_s"], &ve = file["vel_e_m_s"];
    constexpr double span = 2.0;  // s
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
        constexpr double jump = 1e6;  // m^2: impossible for any vehicle
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
    const Misfit as_named = misfit(file, "lat_deg", "lon_deg");
    constexpr double much = 400.0, wrong = 0.1, right = 0.05;  // m^2; fractions of the motion
    if (as_named.moved < much || as_named.miss < wrong * as_named.moved) return;
    const Misfit exchanged = misfit(file, "lon_deg", "lat_deg");
    if (exchanged.miss > right * exchanged.moved || exchanged.miss > right * as_named.miss) return;
    const io::ColumnMatch *lat = file.plan.find("lat_deg"), *lon = file.plan.find("lon_deg");
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

/// An assignment of the three accelerometer columns to the axes, all turned round or not.
struct Columns {
    std::array<int, 3> from{0, 1, 2};
    bool negated = false;
    [[nodiscard]] Eigen::Vector3d operator()(const Eigen::Vector3d& f) const {
        return (negated ? -1.0 : 1.0) * Eigen::Vector3d(f(from[0]), f(from[1]), f(from[2]));
    }
};
constexpr std::array<Columns, 6> assignments{
    {{{0, 1, 2}, true}, {{1, 0, 2}, false}, {{2, 1, 0}, false}, {{0, 2, 1}, false}, {{1, 2, 0}, false}, {{2, 0, 1}, false}}};

MotionFit fit_with(const Study& study, FitSource source, const Columns& columns) {
    ImuSeries read = study.imu;
    for (Eigen::Vector3d& f : read.f) f = columns(f);
    return fit_motion(read, study.gnss, source, study.still.w, study.still.any(), study.gravity);
}

void read_as(Study& study, const Columns& columns, const std::string& why) {
    LoadedFile& file = *study.imu_file;
    std::string text;
    if (columns.negated) {
        text = "accelerometer turned round in all axes";
        const auto unit = std::ranges::find(study.imu_units, "accel_m_s2", &UnitChange::key);
        if (unit != study.imu_units.end()) unit->factor = -unit->factor;
        else study.imu_units.push_back({"accel_m_s2", -file.plan.find(accel_names[0])->factor, "turned round", 0.9, why, false});
        for (const char* name : accel_names)
            for (double& v : file.columns[name]) v = -v;
    } else {
        std::array<std::vector<double>, 3> values;
        for (std::size_t i = 0; i < 3; ++i) values[i] = file.columns[accel_names[i]];
        for (std::size_t i = 0; i < 3; ++i) {
            const auto from = static_cast<std::size_t>(columns.from[i]);
            if (from == i) continue;
            const std::string& name = file.plan.find(accel_names[from])->file_name;
            file.columns[accel_names[i]] = values[from];
            file.column_map[accel_names[i]] = name;
            text +=
                fmt::format("{}{} is {}", text.empty() ? "accelerometer columns are exchanged: " : ", ", accel_names[i][6], name);
        }
        study.found("imu.columns", "accelerometers exchanged", 0.9, why);
    }
    for (Eigen::Vector3d& f : study.imu.f) f = columns(f);
    study.doubts.push_back(fmt::format("{}: {}: {}", file.report.path, text, why));
    study.problem(Level::Warning, study.doubts.back(), "check the names and signs of the columns");
}

}  // namespace

bool judge_accel_columns(Study& study) {
    if (!study.overlap || study.imu_file == nullptr || study.imu_file->has("dtheta_x_rad")) return false;
    const MotionFit& fit = study.gnss.has_velocity() ? study.velocity_fit : study.position_fit;
    if (fit.windows < 5 || (shows_lag(fit) && fit.rms < 0.3 * fit.motion && !turns_against_course(study))) return false;
    const io::ColumnOverrides& given = study.imu_file->as.overrides;
    const auto of_accel = [](const auto& entry) { return entry.first.starts_with("accel"); };
    if (std::ranges::any_of(given.scale, of_accel) || std::ranges::any_of(given.columns, of_accel)) return false;
    const FitSource source = study.gnss.has_velocity() ? FitSource::Velocity : FitSource::Displacement;
    const Columns* best = nullptr;
    MotionFit best_fit;
    for (const Columns& columns : assignments) {
        MotionFit one = fit_with(study, source, columns);
        if (best != nullptr && one.rms >= best_fit.rms) continue;
        best = &columns;
        best_fit = std::move(one);
    }
    // of the motion, of what the names leave, and of what the other explanations leave
    constexpr double well = 0.3, clearly = 0.6, better = 0.85;
    if (!shows_lag(best_fit) || best_fit.rms > well * best_fit.motion || best_fit.rms > clearly * fit.rms) return false;
    for (const Trial& gyros : gyros_turned_round(study, source))
        if (best_fit.rms > better * gyros.fit.rms) return false;
    for (int axis = 0; axis < 3; ++axis) {
        ImuSeries turned = study.imu;
        for (Eigen::Vector3d& f : turned.f) f(axis) = -f(axis);
        const MotionFit one = fit_motion(turned, study.gnss, source, study.still.w, study.still.any(), study.gravity);
        if (best_fit.rms > better * one.rms) return false;
    }
    read_as(
        study, *best,
        fmt::format("as they are named the IMU leaves {:.2g} m/s of the track's motion, so {:.2g} m/s", fit.rms, best_fit.rms));
    return true;
}

bool judge_accel_signs(Study& study) {
    constexpr double to_the_wrong_side = -0.5, clearly = 0.5, somewhat = 0.9;
    if (!study.overlap || study.imu_file == nullptr || study.imu_file->has("dtheta_x_rad")) return false;
    const MotionFit& fit = study.gnss.has_velocity() ? study.velocity_fit : study.position_fit;
    const double felt = felt_in_turns(study);
    const bool fits = shows_lag(fit) && fit.rms < 0.3 * fit.motion;
    if (fit.windows < 5 || (fits && !(felt < to_the_wrong_side) && !turns_against_course(study))) return false;
    const auto& given = study.imu_file->as.overrides.scale;
    if (std::ranges::any_of(given, [](const auto& entry) { return entry.first.starts_with("accel"); })) return false;
    const FitSource source = study.gnss.has_velocity() ? FitSource::Velocity : FitSource::Displacement;
    int best = -1;
    MotionFit best_fit;
    for (int axis = 0; axis < 3; ++axis) {
        ImuSeries turned = study.imu;
        for (Eigen::Vector3d& f : turned.f) f(axis) = -f(axis);
        MotionFit one = fit_motion(turned, study.gnss, source, study.still.w, study.still.any(), study.gravity);
        if (best >= 0 && one.rms >= best_fit.rms) continue;
        best = axis;
        best_fit = std::move(one);
    }
    // No vehicle rolls outwards in turns as much as it would roll inwards: the better fit then only has to identify the axis.
    if (!shows_lag(best_fit) || best_fit.rms > clearly * best_fit.motion ||
        best_fit.rms > (felt < to_the_wrong_side ? somewhat : clearly) * fit.rms)
        return false;
    // Gyros of opposite sign also mirror the axes: effects they explain equally well are attributed to them.
    constexpr double better = 0.85;
    const std::vector<Trial> gyros = gyros_turned_round(study, source);
    if (best_fit.rms > better * std::ranges::min(gyros, {}, [](const Trial& t) { return t.fit.rms; }).fit.rms) return false;
    const char* name = accel_names[static_cast<std::size_t>(best)];
    double unit = 1.0;
    for (const UnitChange& change : study.imu_units)
        if (change.key == "accel_m_s2") unit = change.factor / study.imu_file->plan.find(name)->factor;
    for (double& v : study.imu_file->columns[name]) v = -v;
    for (Eigen::Vector3d& f : study.imu.f) f(best) = -f(best);
    const std::string why = fmt::format(
        "{}with the sign of its column the IMU leaves {:.2g} m/s of the track's motion, turned round {:.2g} m/s",
        felt < to_the_wrong_side ? fmt::format("the force of turns is felt to the wrong side ({:.0f} %); ", 100.0 * felt)
                                 : std::string(),
        fit.rms, best_fit.rms);
    study.imu_units.push_back({name, -unit * study.imu_file->plan.find(name)->factor, "turned round", 0.9, why, false});
    study.doubts.push_back(fmt::format("{}: accelerometer {} turned round: {}", study.imu_file->report.path, name[6], why));
    study.problem(Level::Warning, study.doubts.back(), "check the sign of the column");
    return true;
}

}  // namespace schuler::inspect::detail
