// Time scale, overlap of the files, and the series on one axis of seconds.
#include "schuler/inspect/detail/study.h"

#include "schuler/core/units.h"
#include "schuler/earth/gravity.h"
#include "schuler/io/text/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

constexpr double week = 604800.0;

bool name_says(const LoadedFile& file, std::initializer_list<const char*> words) {
    const io::ColumnMatch* match = file.plan.find("time_s");
    if (match == nullptr) return false;
    const std::vector<std::string> have = io::words_of_name(match->file_name);
    return std::any_of(words.begin(), words.end(),
                       [&](const char* w) { return std::find(have.begin(), have.end(), w) != have.end(); });
}

struct Scale {
    std::string name;
    double confidence;
    std::string why;
};

Scale scale_of(const LoadedFile& file) {
    const double t = file.report.start_s;
    if (file.gps_time) return {"gps", 1.0, "dated GPS times"};
    if (name_says(file, {"utc", "unix"})) return {"utc", 0.9, "the column's name"};
    if (t > 1.55e9 && t < 4e9) return {"utc", 0.8, fmt::format("{:.0f} s counts from 1970: the clock of a computer", t)};
    const io::ColumnMatch* time = file.plan.find("time_s");
    if (t > 1.0e9 && t < 4e9 && time != nullptr && time->time_unit == io::TimeUnit::Nanoseconds)
        return {"utc", 0.7, "nanoseconds from 1970: the clock of a computer"};
    if (t > 1.0e9 && t < 4e9) return {"gps", 0.5, fmt::format("{:.0f} s could count from 1980 (GPS) or from 1970 (UTC)", t)};
    if (name_says(file, {"gps", "tow", "itow", "sow"})) return {"gps", 0.95, "the column's name"};
    if (t >= 5000.0 && file.report.stop_s < 1.1 * week)
        return {"gps", 0.75, fmt::format("{:.0f} s looks like seconds of the GPS week", t)};
    if (std::abs(t) < 5000.0) return {"relative", 0.8, "the times start near zero"};
    return {"boot", 0.5, "neither seconds of a week nor of an epoch"};
}

/// The IMU's columns of a file as samples.
class ImuColumns {
public:
    ImuColumns(const LoadedFile& file, Duration shift) : times_(file.time_ns), shift_(shift) {
        const bool increments = file.has("dtheta_x_rad");
        const char* const names[2][6] = {
            {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"},
            {"dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"}};
        for (std::size_t k = 0; k < 6; ++k) {
            const std::string name = names[increments ? 1 : 0][k];
            columns_[k] = file.has(name) ? &file[name] : nullptr;
        }
    }
    [[nodiscard]] ImuSample operator()(std::size_t row) const {
        const auto value = [&](std::size_t k) { return columns_[k] != nullptr ? (*columns_[k])[row] : not_given; };
        return {Time{times_[row]} + shift_, {value(0), value(1), value(2)}, {value(3), value(4), value(5)}};
    }

private:
    const std::vector<std::int64_t>& times_;
    Duration shift_;
    std::array<const std::vector<double>*, 6> columns_{};
};

ImuSeries series_of(const LoadedFile& file, Duration shift, ImuKind kind, Time origin) {
    const ImuColumns samples(file, shift);
    const std::size_t n = file.time_ns.size();
    // a day of samples is a gigabyte: there is no second copy unless they have to be sorted
    if (std::ranges::is_sorted(file.time_ns)) return imu_series(n, samples, kind, origin);
    std::vector<ImuSample> sorted;
    sorted.reserve(n);
    for (std::size_t i = 0; i < n; ++i) sorted.push_back(samples(i));
    std::ranges::stable_sort(sorted, {}, &ImuSample::time);
    return imu_series(sorted, kind, origin);
}

void check_overlap(Study& study) {
    const FileReport& imu = study.imu_file->report;
    const FileReport& gnss = study.gnss_file->report;
    const auto common = [&](double shift) {
        return std::min(imu.stop_s + shift, gnss.stop_s) - std::max(imu.start_s + shift, gnss.start_s);
    };
    double shared = common(0.0);
    if (shared <= 0.0 && gnss.start_s > week && std::abs(imu.start_s) < 1.1 * week) {
        // Seconds of the week and dated times differ by whole weeks.
        const double weeks = std::floor(gnss.start_s / week) * week;
        if (common(weeks) > 0.0) {
            study.imu_shift = weeks;
            shared = common(weeks);
            study.found("imu.time_offset_s", fmt::format("{:.0f}", weeks), 0.85,
                        fmt::format("the IMU counts seconds of the week, the GNSS is dated: week {:.0f}", weeks / week));
        }
    }
    study.overlap = shared > 10.0;
    constexpr double fewest_seconds = 20.0;
    if (shared > 0.0 && shared < fewest_seconds) {
        study.doubts.push_back(
            fmt::format("{} and {} have only {:.1f} s in common: too short to find heading, biases and latencies; record a "
                        "minute or more, at rest first and then in motion",
                        imu.path, gnss.path, shared));
        study.problem(Level::Warning, study.doubts.back(), "");
    }
    if (shared <= 0.0) {
        study.problem(
            Level::Error,
            fmt::format("IMU ({:.1f} to {:.1f} s) and GNSS ({:.1f} to {:.1f} s) have no time in common", imu.start_s, imu.stop_s,
                        gnss.start_s, gnss.stop_s),
            fmt::format("bring them to one time axis: if both logs began together, [imu] time_offset_s = {:.3f}; otherwise "
                        "name other time columns",
                        gnss.start_s - imu.start_s));
    } else if (shared >= fewest_seconds && shared < 0.5 * (gnss.stop_s - gnss.start_s)) {
        study.problem(Level::Warning, fmt::format("IMU and GNSS have only {:.1f} s in common", shared),
                      "check that the files are of the same run");
    }
}

}  // namespace

std::vector<GnssFix> gnss_fixes(const LoadedFile& file) {
    std::vector<GnssFix> fixes;
    for (std::size_t i = 0; i < file.time_ns.size(); ++i) {
        GnssFix fix;
        fix.time = Time{file.time_ns[i]};
        const Eigen::Vector3d p = file.vector("lat_deg", "lon_deg", "height_m", i);
        if (p.x() == 0.0 && p.y() == 0.0) continue;  // written by receivers before their first fix
        fix.position = {p.x() * units::deg, p.y() * units::deg, p.z()};
        fix.velocity_n = file.vector("vel_n_m_s", "vel_e_m_s", "vel_d_m_s", i);
        if (!file.fix.empty()) fix.fix = file.fix[i];
        fixes.push_back(fix);
    }
    std::stable_sort(fixes.begin(), fixes.end(), [](const GnssFix& a, const GnssFix& b) { return a.time < b.time; });
    return fixes;
}

/// Serial dates of a spreadsheet count days: as seconds, samples would follow each other within microseconds.
static void refuse_serial_dates(Study& study) {
    constexpr double earliest = 29'000.0, latest = 75'000.0, fastest = 2e4;  // days since 1900: 1979 to 2105; Hz
    for (const LoadedFile* file : {study.imu_file, study.gnss_file}) {
        if (file == nullptr || study.refusal || file->report.start_s < earliest || file->report.stop_s > latest) continue;
        const double slowest = file == study.imu_file ? fastest : fastest / 20.0;
        if (file->report.rate_hz < slowest) continue;
        const io::ColumnMatch* time = file->plan.find("time_s");
        study.refusal =
            Refusal{file->report.path, time != nullptr ? time->file_name : "time_s",
                    fmt::format("the times are serial dates of a spreadsheet (days since 1900): {:.0f} rows per second by them",
                                file->report.rate_hz),
                    "export the time in seconds: (date - first date) * 86400 with four decimals"};
        study.problem(Level::Error, fmt::format("{}: {}", file->report.path, study.refusal->text), study.refusal->hint);
    }
}

/// The week beside seconds of the week dates the log.
static void judge_week(Study& study) {
    const LoadedFile *imu = study.imu_file, *gnss = study.gnss_file;
    const LoadedFile* with = gnss != nullptr && gnss->week ? gnss : imu != nullptr && imu->week ? imu : nullptr;
    if (with == nullptr) {
        study.draft.set("time", "week", 2300.0, "the files do not give the GPS week; only dates in the outputs need it", false);
        return;
    }
    study.draft.set("time", "week", static_cast<double>(*with->week),
                    fmt::format("column {} of {}", with->week_column, with->report.path), true, Known::File);
    if (imu == nullptr || gnss == nullptr || !imu->week || !gnss->week) return;
    const bool between =
        std::abs(imu->report.start_s - gnss->report.start_s) > 0.5 * week;  // a week begins between their first rows
    if (*imu->week != *gnss->week && !between) {
        study.doubts.push_back(fmt::format("{} is of GPS week {} and {} of week {}: the seconds of the week alone are compared",
                                           imu->report.path, *imu->week, gnss->report.path, *gnss->week));
        study.problem(Level::Warning, study.doubts.back(), "check that the files are of the same run");
    }
}

void judge_time(Study& study) {
    refuse_serial_dates(study);
    const LoadedFile* main = study.gnss_file != nullptr  ? study.gnss_file
                             : study.imu_file != nullptr ? study.imu_file
                                                         : study.reference_file;
    if (main == nullptr) return;
    const Scale scale = scale_of(*main);
    study.found("time.scale", scale.name, scale.confidence, scale.why);
    study.draft.set("time", "scale", scale.name, fmt::format("{}: {}", how_sure(scale.confidence), scale.why), true,
                    scale.confidence >= 0.9 ? Known::File : Known::Found);
    if (scale.name == "gps" && main->report.stop_s < 1.1 * week) judge_week(study);
    study.origin = Time{main->cadence_origin_ns} + Duration::from_seconds(main->cadence.start);
    if (study.imu_file != nullptr && study.gnss_file != nullptr) check_overlap(study);
    if (study.gnss_file != nullptr) {
        study.gnss = gnss_series(gnss_fixes(*study.gnss_file), study.origin);
        if (study.gnss.empty()) {
            study.overlap = false;
            study.gnss_file->problem(Level::Error, fmt::format("none of its {} rows has a fix", study.gnss_file->time_ns.size()),
                                     "the receiver had none, or the columns of latitude and longitude are others: name them in "
                                     "dataset.toml, [gnss] columns");
        } else
            study.gravity =
                earth::gravity_down(earth::GravityModel::Somigliana, study.gnss.lat, study.gnss.has_height ? study.gnss.h : 0.0);
    }
    if (study.imu_file != nullptr) {
        const ImuKind kind = study.imu_file->has("dtheta_x_rad") ? ImuKind::Increments : ImuKind::Rates;
        study.imu = series_of(*study.imu_file, Duration::from_seconds(study.imu_shift), kind, study.origin);
    }
}

}  // namespace schuler::inspect::detail
