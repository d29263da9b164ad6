#include "schuler/inspect/detail/units_by_value.h"

#include "schuler/core/units.h"
#include "schuler/inspect/detail/motion/still.h"
#include "schuler/inspect/detail/robust.h"
#include "schuler/math/rotation.h"
#include "schuler/sensor/grades.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace schuler::inspect::detail {
namespace {

struct Candidate {
    const char* unit;
    double factor;  // to the canonical unit
};

// The candidate that brings a magnitude nearest (in ratio) to its expected value.
const Candidate& nearest(std::span<const Candidate> candidates, double size, double expected) {
    return *std::min_element(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
        return std::abs(std::log(size * a.factor / expected)) < std::abs(std::log(size * b.factor / expected));
    });
}

double median_norm(const LoadedFile& file, const char* x, const char* y, const char* z) {
    std::vector<double> norms;
    norms.reserve(file.time_ns.size());
    for (std::size_t i = 0; i < file.time_ns.size(); ++i) norms.push_back(file.vector(x, y, z, i).norm());
    return median(std::move(norms));
}

bool stated(const LoadedFile& file, const char* canonical) {
    const io::ColumnMatch* match = file.plan.find(canonical);
    return match != nullptr && match->unit_stated;
}

void rescale(LoadedFile& file, std::initializer_list<const char*> names, double factor) {
    for (const char* name : names) {
        const auto it = file.columns.find(name);
        if (it == file.columns.end()) continue;
        for (double& v : it->second) v *= factor;
    }
}

double name_factor(const LoadedFile& file, const char* canonical) {
    const io::ColumnMatch* match = file.plan.find(canonical);
    return match != nullptr ? match->factor : 1.0;
}

// Rates whose specific force is g times the interval: increments under the names of rates.
bool take_as_increments(LoadedFile& file, double norm) {
    const double step = file.cadence.step;
    if (!(step > 0.0) || std::abs(norm / step / units::g0 - 1.0) > 0.1 || std::abs(norm / units::g0 - 1.0) < 0.1) return false;
    constexpr std::array<std::array<const char*, 2>, 6> names{{{"gyro_x_rad_s", "dtheta_x_rad"},
                                                               {"gyro_y_rad_s", "dtheta_y_rad"},
                                                               {"gyro_z_rad_s", "dtheta_z_rad"},
                                                               {"accel_x_m_s2", "dv_x_m_s"},
                                                               {"accel_y_m_s2", "dv_y_m_s"},
                                                               {"accel_z_m_s2", "dv_z_m_s"}}};
    for (const auto& [rate, increment] : names) {
        auto node = file.columns.extract(rate);
        node.key() = increment;
        file.columns.insert(std::move(node));
        for (io::ColumnMatch& match : file.plan.matches) {
            if (match.canonical != rate) continue;
            match.canonical = increment;
            file.column_map[increment] = match.file_name;
        }
    }
    file.problem(Level::Warning,
                 fmt::format("the accelerometer columns are named like rates, but their norm {:.4g} is gravity times the step: "
                             "taken as velocity and angle increments",
                             norm),
                 "rename the columns to dtheta_x_rad, ..., dv_x_m_s, ...");
    return true;
}

void judge_accel(LoadedFile& file, std::vector<UnitChange>& changes) {
    if (!file.has("accel_x_m_s2")) return;
    const double norm = median_norm(file, "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2");
    if (!(norm > 0.0)) {
        file.problem(Level::Error, "the accelerometers read zero: they do not show gravity",
                     "log specific force, not acceleration without gravity");
        return;
    }
    if (norm > 7.0 && norm < 14.0) return;
    // the last one: a column named after g that contains m/s2
    constexpr std::array<Candidate, 6> candidates{
        {{"m/s2", 1.0}, {"g", units::g0}, {"mg", units::mg}, {"ug", units::ug}, {"cm/s2", 1e-2}, {"m/s2", 1.0 / units::g0}}};
    const Candidate& best = nearest(candidates, norm, units::g0);
    const double size = norm * best.factor;
    if (std::abs(size / units::g0 - 1.0) > 0.1 && take_as_increments(file, norm)) return;
    if (size < 6.0 || size > 16.0 || best.factor == 1.0) {
        file.problem(
            Level::Error,
            fmt::format("the norm of the accelerometers is {:.4g} m/s2 by their names, which is not gravity in any known unit",
                        norm),
            "give the factor: [imu] scale = { accel_m_s2 = ... }; data without gravity cannot be used");
        return;
    }
    rescale(file, {"accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"}, best.factor);
    const double factor = best.factor * name_factor(file, "accel_x_m_s2");
    const bool named = stated(file, "accel_x_m_s2");
    const std::string why = fmt::format("the median norm is {:.4g}, gravity in {}", norm, best.unit);
    file.problem(named ? Level::Error : Level::Info,
                 named ? fmt::format("the accelerometer columns state a unit that cannot be: {}", why)
                       : fmt::format("accelerometer unit by value: {}", why),
                 fmt::format("[imu] scale = {{ accel_m_s2 = {:.10g} }}", factor));
    changes.push_back({"accel_m_s2", factor, best.unit, 0.97, why, named});
}

void judge_mag(LoadedFile& file, std::vector<UnitChange>& changes) {
    if (!file.has("mag_x_ut")) return;
    const double norm = median_norm(file, "mag_x_ut", "mag_y_ut", "mag_z_ut");
    constexpr std::array<Candidate, 5> candidates{{{"uT", 1.0}, {"gauss", 100.0}, {"mgauss", 0.1}, {"nT", 1e-3}, {"T", 1e6}}};
    if (!(norm > 0.0)) return;
    const bool named = stated(file, "mag_x_ut");
    constexpr double least = 10.0, most = 200.0, earth_least = 20.0, earth_most = 70.0, typical = 45.0;  // uT
    if (named && norm > least && norm < most) return;  // a magnet nearby, perhaps
    const double written = norm / (named ? name_factor(file, "mag_x_ut") : 1.0);
    const bool normalised = std::abs(written - 1.0) < 0.05;
    Candidate best = normalised ? Candidate{"normalised", typical / written} : nearest(candidates, written, typical);
    const double size = written * best.factor;
    if (named && !(size > earth_least && size < earth_most)) return;
    const double factor = size / norm;
    if (std::abs(factor - 1.0) < 1e-6) return;
    rescale(file, {"mag_x_ut", "mag_y_ut", "mag_z_ut"}, factor);
    const std::string why = fmt::format("the median norm is {:.4g}, the Earth's field 20 to 70 uT", written);
    if (named)
        file.problem(Level::Warning,
                     fmt::format("the magnetometer columns state a unit that cannot be: {}; taken as {}", why, best.unit),
                     fmt::format("[mag] scale = {{ mag_ut = {:.10g} }}", best.factor));
    changes.push_back({"mag_ut", best.factor, best.unit, size > earth_least && size < earth_most ? 0.9 : 0.5, why, named});
}

void judge_position(LoadedFile& file, std::vector<UnitChange>& changes) {
    if (!file.has("lat_deg") || !file.has("lon_deg")) return;
    const auto extreme = [&](const char* name) {
        double m = 0.0;
        for (const double v : file[name]) m = std::max(m, std::isfinite(v) ? std::abs(v) : 0.0);
        return m;
    };
    if (file.plan.find("lat_deg")->degrees_minutes)
        file.problem(
            Level::Info,
            "latitude and longitude are read as degrees and minutes (ddmm.mmmm): no minutes of 60 or more, and beyond 360 or with all their digits",
            "if they are degrees: [gnss] scale = { lat_deg = 1, lon_deg = 1 }");
    const double lat = extreme("lat_deg"), lon = extreme("lon_deg");
    double factor = 1.0;
    std::string unit, why;
    double confidence = 0.95;
    constexpr double near_equator = 1e5;  // in 1e-7 degrees: a kilometre; smaller values are not in this unit but wrong
    if (lat > near_equator && lat <= 90e7 && lon <= 360e7) {
        factor = 1e-7;
        unit = "1e-7 deg";
        why = fmt::format("values up to {:.4g} are whole numbers of 1e-7 degrees", std::max(lat, lon));
    } else if (!stated(file, "lat_deg") && lat <= 1.5709 && lon <= 6.2832 && lat > 0.0) {
        factor = 1.0 / units::deg;
        unit = "rad";
        confidence = 0.85;
        why = fmt::format(
            "|latitude| stays below {:.4g} and |longitude| below {:.4g}: radians (or a place within 1.6 degrees of latitude 0, "
            "longitude 0)",
            lat, lon);
    }
    if (factor != 1.0) {
        rescale(file, {"lat_deg", "lon_deg"}, factor);
        for (const char* key : {"lat_deg", "lon_deg"})
            changes.push_back({key, factor * name_factor(file, key), unit, confidence, why, factor < 1.0 && stated(file, key)});
    } else if (lat > 90.0) {
        file.problem(Level::Error, fmt::format("latitudes up to {:.6g} deg", lat),
                     "name the right columns: [gnss] columns = { lat_deg = \"...\" }");
    }
    if (file.has("height_m") && !stated(file, "height_m") && extreme("height_m") > 1e5) {
        rescale(file, {"height_m"}, 1e-3);
        changes.push_back({"height_m", 1e-3, "mm", 0.9, fmt::format("heights up to {:.4g}", extreme("height_m") * 1e3)});
    }
}

// Agreement of gravity in sensor axes with the integrated rates, times a factor, over half a second: mean squared residual.
double gravity_miss(const ImuSeries& imu, double factor, double& unturned) {
    const auto half = std::max<std::size_t>(3, static_cast<std::size_t>(0.5 / std::max(imu.step, 1e-4)));
    const std::size_t side = std::max<std::size_t>(1, half / 5);
    double miss = 0.0;
    unturned = 0.0;
    std::size_t n = 0;
    const auto force = [&](std::size_t at) {
        Eigen::Vector3d f = Eigen::Vector3d::Zero();
        for (std::size_t i = at - side; i <= at + side; ++i) f += imu.f[i];
        return Eigen::Vector3d(f.normalized());
    };
    const std::size_t stride = std::max(half, imu.size() / 4000);
    for (std::size_t at = side; at + half + side < imu.size(); at += stride) {
        if (imu.t[at + half] - imu.t[at] > 1.0) continue;
        Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
        for (std::size_t i = at + 1; i <= at + half; ++i) {
            const Eigen::Vector3d angle = factor * 0.5 * (imu.w[i] + imu.w[i - 1]) * (imu.t[i] - imu.t[i - 1]);
            turn = turn * math::quaternion_from_rotation_vector(angle);
        }
        const Eigen::Vector3d before = force(at), after = force(at + half);
        miss += (turn.conjugate() * before - after).squaredNorm();
        unturned += (before - after).squaredNorm();
        ++n;
    }
    constexpr std::size_t fewest = 20;  // a few turns may be noise
    if (n < fewest) return unturned = 0.0;
    unturned /= static_cast<double>(n);
    return miss / static_cast<double>(n);
}

}  // namespace

std::vector<UnitChange> judge_units(LoadedFile& file) {
    std::vector<UnitChange> changes;
    judge_accel(file, changes);
    judge_mag(file, changes);
    judge_position(file, changes);
    if (file.table == io::TableKind::Gnss) judge_receiver_integers(file, changes);
    return changes;
}

CourseSlope course_slope(const ImuSeries& imu, const GnssSeries& gnss, const Eigen::Vector3d& down_s,
                         const Eigen::Vector3d& gyro_bias) {
    CourseSlope result;
    if (!gnss.has_velocity() || imu.empty()) return result;
    double cc = 0.0, ww = 0.0, cw = 0.0;
    for (std::size_t k = 1; k + 1 < gnss.size(); ++k) {
        const double a = gnss.t[k - 1], b = gnss.t[k + 1];
        if (b - a > 2.5 || gnss.speed(k - 1) < 2.0 || gnss.speed(k + 1) < 2.0 || a < imu.t.front() || b > imu.t.back()) continue;
        const double course =
            math::wrap_pi(std::atan2(gnss.v[k + 1].y(), gnss.v[k + 1].x()) - std::atan2(gnss.v[k - 1].y(), gnss.v[k - 1].x())) /
            (b - a);
        double w = 0.0;
        std::size_t n = 0;
        for (std::size_t i = index_before(imu.t, a) + 1; i < imu.size() && imu.t[i] <= b; ++i, ++n)
            w += (imu.w[i] - gyro_bias).dot(down_s);
        if (n == 0) continue;
        w /= static_cast<double>(n);
        cc += course * course;
        ww += w * w;
        cw += course * w;
        ++result.epochs;
    }
    if (result.epochs < 20 || ww <= 0.0 || cc <= 0.0) return result;
    result.slope = cw / ww;
    result.correlation = cw / std::sqrt(cc * ww);
    return result;
}

std::optional<GyroUnit> gyro_unit_of(const CourseSlope& course) {
    constexpr double clear = 0.7, near = 1.3;
    if (std::abs(course.correlation) <= clear) return std::nullopt;
    const double ratio = std::abs(course.slope);
    constexpr std::array<double, 4> factors{1.0, units::deg, 1e-3 * units::deg, 1.0 / units::deg};
    const double factor = *std::ranges::min_element(factors, {}, [&](double f) { return std::abs(std::log(f / ratio)); });
    // Errors of the rates make the slope too small, by the square of the correlation at most.
    const double most = ratio / (course.correlation * course.correlation);
    return GyroUnit{factor, ratio < near * factor && factor < near * most};
}

namespace {

/// Typical gyro noise for this accelerometer noise, m/s/sqrt(s), according to the grades; rad/sqrt(s). Vibration raises both alike.
double gyro_noise_beside(double accel_noise) {
    constexpr std::array<const char*, 4> names{"navigation", "tactical", "mems", "consumer"};
    double x0 = 0.0, y0 = 0.0;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const sensor::ImuErrorModel grade = sensor::imu_grade(names[i]);
        const double x = std::log(grade.accel_noise), y = std::log(grade.gyro_noise), at = std::log(accel_noise);
        if (i == 0 && at <= x) return grade.gyro_noise;
        if (i > 0 && at <= x) return std::exp(y0 + (y - y0) * (at - x0) / (x - x0));
        x0 = x;
        y0 = y;
    }
    return std::exp(y0) * accel_noise / std::exp(x0);
}

}  // namespace

std::vector<UnitChange> judge_gyro_unit(LoadedFile& file, ImuSeries& imu, const GnssSeries& gnss) {
    std::vector<UnitChange> changes;
    if (imu.size() < 100) return changes;
    const bool increments = file.has("dtheta_x_rad");
    const char* first = increments ? "dtheta_x_rad" : "gyro_x_rad_s";
    Eigen::Vector3d f = Eigen::Vector3d::Zero(), w = Eigen::Vector3d::Zero();
    std::vector<double> rates;
    for (std::size_t i = 0; i < imu.size(); ++i) {
        f += imu.f[i];
        w += imu.w[i] / static_cast<double>(imu.size());
        rates.push_back(imu.w[i].norm());
    }
    const CourseSlope course = course_slope(imu, gnss, -f.normalized(), w);
    double unturned = 0.0;
    const double as_radians = gravity_miss(imu, 1.0, unturned), as_degrees = gravity_miss(imu, units::deg, unturned);
    const double too_small = gravity_miss(imu, 1.0 / units::deg, unturned);

    double factor = 1.0, confidence = 0.0;
    std::string why;
    const std::optional<GyroUnit> unit = gyro_unit_of(course);
    if (unit && unit->sure) {
        factor = unit->factor;
        confidence = 0.98;
        why = fmt::format("GNSS course rate / gyro rate about the vertical = {:.3g} over {} epochs", course.slope, course.epochs);
    } else if (unturned > 1e-3 && std::min({as_radians, as_degrees, too_small}) < 0.5 * unturned) {
        factor = as_radians <= std::min(as_degrees, too_small) ? 1.0 : as_degrees < too_small ? units::deg : 1.0 / units::deg;
        confidence = 0.95;
        why = "gravity in sensor axes turns with the integrated rates in this unit only";
    } else if (unit) {
        factor = unit->factor;
        confidence = 0.6;
        why = fmt::format(
            "GNSS course rate / gyro rate about the vertical = {:.3g}, which is none of the units but nearest to this one",
            course.slope);
    } else if (!stated(file, first)) {
        const NoiseLevel noise = noise_level(imu);
        const double gyro = median({noise.gyro.x(), noise.gyro.y(), noise.gyro.z()}),
                     accel = median({noise.accel.x(), noise.accel.y(), noise.accel.z()});
        confidence = 0.6;
        if (gyro > 0.0 && accel > 0.0) {
            constexpr std::array<Candidate, 2> candidates{{{"rad/s", 1.0}, {"deg/s", units::deg}}};
            const Candidate& best = nearest(candidates, gyro, gyro_noise_beside(accel));
            factor = best.factor;
            why = fmt::format(
                "the noise of the gyros fits that of the accelerometers in {}; there is too little motion to compare", best.unit);
        } else {
            const double typical = quantile(rates, 0.5);
            factor = typical > 0.3 ? units::deg : 1.0;
            why = fmt::format("the median rate is {:.3g}; there is too little motion to compare", typical);
        }
    }
    if (factor == 1.0 && stated(file, first)) return changes;
    if (stated(file, first) && confidence < 0.9) return changes;
    for (Eigen::Vector3d& rate : imu.w) rate *= factor;
    const std::string key = increments ? "dtheta_rad" : "gyro_rad_s";
    if (increments) rescale(file, {"dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad"}, factor);
    else rescale(file, {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s"}, factor);
    const double in_file = factor * name_factor(file, first);
    const char* name = std::abs(in_file - units::deg) < 1e-6                  ? (increments ? "deg" : "deg/s")
                       : std::abs(in_file - 1.0) < 1e-9                       ? (increments ? "rad" : "rad/s")
                       : std::abs(in_file - 1e-3) < 1e-9                      ? (increments ? "mrad" : "mrad/s")
                       : std::abs(in_file / (1e-3 * units::deg) - 1.0) < 1e-6 ? (increments ? "mdeg" : "mdeg/s")
                                                                              : "other";
    if (stated(file, first)) {
        file.problem(Level::Error, "the gyro columns state a unit that cannot be: " + why,
                     fmt::format("[imu] scale = {{ {} = {:.10g} }}", key, in_file));
    }
    changes.push_back({key, in_file, name, confidence, why, stated(file, first)});
    return changes;
}

}  // namespace schuler::inspect::detail
