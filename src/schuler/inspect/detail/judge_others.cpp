// Barometer, magnetometer and reference.
#include "schuler/inspect/detail/study.h"

#include "schuler/core/error.h"
#include "schuler/earth/atmosphere.h"
#include "schuler/inspect/detail/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

// Heights of the barometer, converted from pressure if that is logged.
std::vector<double> baro_heights(const LoadedFile& file) {
    if (file.has("height_m")) return file["height_m"];
    std::vector<double> heights;
    for (const double p : file["pressure_pa"]) {
        heights.push_back(p > 1000.0 && p < 120000.0 ? earth::geopotential_height_from_pressure(p) : std::nan(""));
    }
    return heights;
}

double seconds_in(const Study& study, const LoadedFile& file, std::size_t row) {
    return (Time{file.time_ns[row]} - study.origin).seconds();
}

void compare_with_gnss(Study& study, const LoadedFile& file, const std::vector<double>& heights) {
    std::vector<double> differences, gnss_heights;
    for (std::size_t i = 0; i < heights.size(); ++i) {
        const double t = seconds_in(study, file, i);
        if (study.gnss.empty() || t < study.gnss.t.front() || t > study.gnss.t.back()) continue;
        const std::size_t k = index_before(study.gnss.t, t);
        const double h = study.gnss.h - study.gnss.p[k].z();
        differences.push_back(heights[i] - h);
        gnss_heights.push_back(h);
    }
    if (differences.size() < 20) return;
    const double offset = median(differences), spread = robust_sigma(differences);
    study.found("baro.offset", fmt::format("{:+.1f} m against the GNSS height, spread {:.2f} m", offset, spread), 0.9,
                "median and robust sigma of the difference");
    study.draft.note("baro", fmt::format("reads {:+.1f} m against the GNSS height (spread {:.2f} m): its offset is estimated",
                                         offset, spread));
}

// A reference on a different axis than the data: an offset of whole weeks between seconds of the week and dated times.
void place_in_time(Study& study, const LoadedFile& file) {
    const LoadedFile* main = study.gnss_file != nullptr ? study.gnss_file : study.imu_file;
    if (main == nullptr || study.dated_fixes_move()) return;
    const FileReport& data = main->report;
    const auto meets = [&](double shift) {
        return std::min(data.stop_s, file.report.stop_s + shift) > std::max(data.start_s, file.report.start_s + shift);
    };
    if (meets(0.0)) return;
    constexpr double week = 604800.0;
    const double weeks = std::floor(data.start_s / week) * week;
    if (weeks > 0.0 && meets(weeks)) {
        study.draft.set("reference", "time_offset_s", weeks, "likely: whole weeks, to meet the dated times");
        return;
    }
    study.problem(Level::Warning, "the reference and the data have no time in common",
                  "give [reference] time_offset_s, or leave the reference out");
}

void draft_mag(Study& study, LoadedFile& file, double norm, double share, bool usable) {
    study.draft.set("mag", "file", file.report.path, fmt::format("norm {:.1f} uT +- {:.1f} %", norm, 100.0 * share));
    draft_parts(study, "mag", file);
    draft_columns(study, "mag", file, study.mag_units);
    if (!usable) {
        study.draft.note("mag", "left out: take the comment signs away to use it all the same");
        study.draft.leave_out("mag");
    }
}

}  // namespace

void judge_baro(Study& study) {
    if (study.baro_file == nullptr) return;
    LoadedFile& file = *study.baro_file;
    if (file.has("pressure_pa") && !file.has("height_m")) {
        const double typical = median(file["pressure_pa"]);
        const io::ColumnMatch* match = file.plan.find("pressure_pa");
        if (typical < 1000.0 || typical > 120000.0) {
            const double factor = typical >= 10.0 && typical < 120.0     ? 1000.0
                                  : typical >= 300.0 && typical < 1200.0 ? 100.0
                                                                         : 0.0;
            const bool stated = match != nullptr && match->unit_stated;
            if (factor > 0.0) {
                for (double& p : file.columns["pressure_pa"]) p *= factor;
                study.baro_units.push_back({"pressure_pa", factor * (match != nullptr ? match->factor : 1.0),
                                            factor == 100.0 ? "hPa" : "kPa", 0.9, fmt::format("the median is {:.5g}", typical)});
            }
            if (stated || factor == 0.0)
                file.problem(Level::Error, fmt::format("a pressure of {:.5g} Pa by its name is out of range", typical),
                             "give the factor: [baro] scale = { pressure_pa = ... }");
        }
    }
    study.draft.set("baro", "file", file.report.path, fmt::format("{:.3g} Hz", file.report.rate_hz));
    draft_parts(study, "baro", file);
    draft_columns(study, "baro", file, study.baro_units);
    compare_with_gnss(study, file, baro_heights(file));
}

void judge_mag(Study& study) {
    if (study.mag_file == nullptr) return;
    LoadedFile& file = *study.mag_file;
    std::vector<double> norms;
    for (std::size_t i = 0; i < file.time_ns.size(); ++i)
        norms.push_back(file.vector("mag_x_ut", "mag_y_ut", "mag_z_ut", i).norm());
    double mean = 0.0, square = 0.0, n = 0.0;
    for (const double v : norms) {
        if (!std::isfinite(v)) continue;
        mean += v;
        square += v * v;
        n += 1.0;
    }
    if (n < 2.0) return;
    mean /= n;
    const double sigma = std::sqrt(std::max(0.0, square / n - mean * mean)), share = sigma / mean;
    const double low = quantile(norms, 0.01), high = quantile(norms, 0.99);
    study.found("mag.norm", fmt::format("{:.1f} uT, one sigma {:.1f} uT, 98 % in {:.1f} to {:.1f} uT", mean, sigma, low, high),
                0.95, "norm of the three axes; the Earth's field has 22 to 67 uT");
    const bool strength = mean > 20.0 && mean < 70.0, steady = share < 0.07;
    // the attitude filters weight every sample; a navigation filter is better without a disturbed magnetometer
    const bool weighed = study.given.weighs_field || study.gnss_file == nullptr;
    const char* fate = weighed ? "its samples weigh the less until then" : "left out until then";
    if (!strength) {
        file.problem(Level::Warning,
                     fmt::format("the magnetic field has {:.1f} uT, the Earth's 22 to 67 uT: not calibrated, or disturbed", mean),
                     fmt::format("calibrate it (rotate in all directions away from iron), or check the unit; {}", fate));
    } else if (!steady) {
        file.problem(
            Level::Warning,
            fmt::format("the norm of the magnetic field varies by {:.0f} % ({:.1f} to {:.1f} uT): disturbed or not calibrated",
                        100.0 * share, low, high),
            fmt::format("calibrate it, mount it away from currents and iron; {}", fate));
    } else if (high - low > 0.12 * mean) {
        file.problem(Level::Info,
                     fmt::format("the norm of the magnetic field goes from {:.1f} to {:.1f} uT: somewhat disturbed", low, high),
                     "expect a few degrees of heading error from it");
    }
    draft_mag(study, file, mean, share, weighed || (strength && steady));
}

void judge_reference(Study& study) {
    if (study.reference_file == nullptr) return;
    LoadedFile& file = *study.reference_file;
    const io::ColumnMatch* roll = file.plan.find("roll_deg");
    const io::ColumnMatch* qw = file.plan.find("qw");
    const auto starts_like = [](const io::ColumnMatch* match, std::initializer_list<const char*> words) {
        if (match == nullptr) return false;
        const std::vector<std::string> have = io::words_of_name(match->file_name);
        return !have.empty() && std::any_of(words.begin(), words.end(), [&](const char* w) { return have.front() == w; });
    };
    const auto is_autopilot = [&](const io::ColumnMatch* match) {
        return starts_like(match, {"onboard", "ahrs", "ekf", "nav", "est", "autopilot"});
    };
    const bool attitude = roll != nullptr || qw != nullptr;
    const bool autopilot = is_autopilot(roll != nullptr ? roll : qw != nullptr ? qw : file.plan.find("lat_deg"));
    const bool position = file.has("lat_deg") || file.has("ecef_x_m");
    std::string content = position ? "position" : "";
    if (roll != nullptr || qw != nullptr) content += content.empty() ? "attitude" : ", attitude";
    study.draft.set("reference", "file", file.report.path,
                    fmt::format("{}{}", content, autopilot ? ": the autopilot's own estimate, not truth" : ""));
    draft_columns(study, "reference", file, {});
    if (qw != nullptr) {
        const bool enu = qw->file_name.find("enu") != std::string::npos;
        study.draft.set("reference", "quaternion", enu ? std::string("sensor_to_enu") : std::string("body_to_ned"),
                        qw->file_name.find("_to_") != std::string::npos ? "sure: column " + qw->file_name
                                                                        : "a guess: the names do not state it",
                        true, qw->file_name.find("_to_") != std::string::npos ? Known::File : Known::Default);
        study.found("reference.quaternion", enu ? "sensor_to_enu" : "body_to_ned",
                    qw->file_name.find("_to_") != std::string::npos ? 0.95 : 0.5, "column " + qw->file_name);
    }
    if (autopilot) {
        file.problem(Level::Warning,
                     "the columns call themselves an onboard or AHRS estimate: not truth, the attitude may be off by degrees",
                     "read errors against it as differences between two estimates");
    }
    if (autopilot && !attitude) {
        study.draft.note("reference",
                         "left out: the autopilot's position follows the receiver; withheld fixes are a better test");
        study.draft.leave_out("reference");
        return;
    }
    place_in_time(study, file);
    if (!study.reference.empty() && study.mounting.forward_from == ForwardFrom::Travel && study.still.any()) {
        // Level at rest from the accelerometers compared with the log's roll and pitch.
        const Eigen::Vector3d f_b = study.mounting.C_bs * study.still.f;
        const double roll_deg = std::atan2(-f_b.y(), -f_b.z()) * 57.29577951308232,
                     pitch_deg = std::atan2(f_b.x(), std::hypot(f_b.y(), f_b.z())) * 57.29577951308232;
        study.found("rest.level", fmt::format("roll {:.1f}, pitch {:.1f} deg", roll_deg, pitch_deg), 0.8,
                    "accelerometers at rest, axes as found");
    }
}

}  // namespace schuler::inspect::detail
