// The GNSS section: fixes, standard deviations, heights, velocities, outliers.
#include "schuler/inspect/detail/study.h"

#include "schuler/core/units.h"
#include "schuler/inspect/detail/robust.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/fix_codes.h"
#include "schuler/io/text/idle_velocities.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace schuler::inspect::detail {
namespace {

/// Given codes that the log does not have: perhaps a slip of the pen.
void check_given_codes(Study& study) {
    const LoadedFile& file = *study.gnss_file;
    std::string absent, present;
    for (const auto& [code, fix] : study.given.fix_codes)
        if (!file.fix_codes.contains(code)) absent += (absent.empty() ? "" : ", ") + code;
    for (const auto& [code, fix] : file.fix_codes) present += (present.empty() ? "" : ", ") + code;
    if (absent.empty() || !io::stream_path(file.path).stream.empty()) return;
    study.doubts.push_back(fmt::format("gnss.fix_codes: {} {} not occur in {}, {}", absent,
                                       absent.find(',') == std::string::npos ? "does" : "do", file.report.path,
                                       present.empty() ? "which has no column of the fix" : "which has " + present));
    study.problem(Level::Warning, study.doubts.back(), "leave them out, or give the codes of the log");
}

void judge_fix(Study& study) {
    LoadedFile& file = *study.gnss_file;
    check_given_codes(study);
    if (file.fix.empty()) return;
    std::map<std::string, std::size_t> counts;
    for (const FixType fix : file.fix) ++counts[std::string(io::name_of(fix))];
    std::string text;
    for (const auto& [name, n] : counts) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", n, name);
    std::map<std::string, std::string> codes;
    for (const auto& [code, fix] : file.fix_codes)
        if (fix != FixType::Unknown && !io::fix_from_word(code)) codes[code] = io::name_of(fix);
    if (!codes.empty())
        study.states("gnss.fix_codes", codes, text + "; codes read as " + file.fix_table,
                     file.fix_by_evidence ? Known::Found : Known::File);
    study.found("gnss.fix", text, 0.9, "codes read as " + file.fix_table);
    study.draft.note("gnss",
                     fmt::format("fixes: {} (codes read as {}; other meanings: fix_codes = {{ ... }})", text, file.fix_table));
    const auto none = std::count(file.fix.begin(), file.fix.end(), FixType::None);
    if (none > 0) file.problem(Level::Info, fmt::format("{} epochs without a fix are left out", none), "");
}

double low_of(const std::vector<double>& values) { return quantile(values, 0.0); }

void judge_sigma(Study& study) {
    LoadedFile& file = *study.gnss_file;
    const auto judge = [&](std::initializer_list<const char*> names, const char* what, const char* defaults) {
        const char* column = nullptr;
        for (const char* name : names) {
            if (column == nullptr && file.has(name)) column = name;
        }
        if (column == nullptr) {
            file.problem(Level::Info, fmt::format("no standard deviations of the {}", what),
                         fmt::format("defaults are used ({}); set {} if you know better", defaults, defaults));
            return;
        }
        const std::vector<double>& s = file[column];
        const auto useless = std::count_if(s.begin(), s.end(), [](double v) { return !(v > 0.0); });
        if (useless > 0) {
            file.problem(Level::Warning,
                         fmt::format("{} of {} standard deviations of the {} are missing or zero", useless, s.size(), what),
                         fmt::format("defaults are used for them ({})", defaults));
        }
        if (low_of(s) > 0.0)
            study.states(std::string("gnss.stated_std_") + (std::string_view(what) == "position" ? "m" : "velocity_m_s"),
                         median(s), std::string("column ") + column + ", the median");
        const double low = quantile(s, 0.0), high = quantile(s, 1.0);
        if (low > 0.0 && low == high && s.size() > 20) {
            file.problem(Level::Info,
                         fmt::format("the standard deviation of the {} is always {:.3g}: set, not measured", what, low), "");
        } else if (low > 0.0) {
            study.found(fmt::format("gnss.std_{}", what), fmt::format("{:.3g} (median), {:.3g} to {:.3g}", median(s), low, high),
                        1.0, "as the log states");
        }
    };
    judge({"std_n_m", "std_h_m"}, "position", "default_std_m");
    if (study.gnss.has_velocity()) judge({"std_vn_m_s", "std_vel_m_s"}, "velocity", "default_std_velocity_m_s");
}

void judge_height(Study& study) {
    LoadedFile& file = *study.gnss_file;
    const io::ColumnMatch* height = file.plan.find("height_m");
    if (!file.has("height_m")) {
        file.problem(Level::Error, "no height column: GNSS rows need one", "name it: [gnss] columns = { height_m = \"NAME\" }");
        return;
    }
    const io::HeightKind kind = height != nullptr ? height->height : io::HeightKind::Ellipsoidal;
    const std::string name = height != nullptr ? height->file_name : "height_m";
    if (kind == io::HeightKind::Relative || kind == io::HeightKind::Autopilot) {
        study.draft.set("gnss", "height", std::string("relative"), "likely: column " + name, true, Known::File);
        study.found("gnss.height", "relative", 0.9, "the name of column " + name);
        file.problem(Level::Warning,
                     fmt::format("{} is not a height of GNSS: relative heights of autopilots come from their barometer", name),
                     "do not use it as an independent check of the barometer or of vertical accuracy; log the "
                     "receiver's own height if you can");
    } else if (kind == io::HeightKind::Msl) {
        study.draft.set("gnss", "height", std::string("msl"),
                        "sure: column " + name + "; undulation_m = ... would make it ellipsoidal", true, Known::File);
        study.found("gnss.height", "msl", 0.95, "the name of column " + name);
    } else {
        const bool stated =
            kind == io::HeightKind::Ellipsoidal || file.report.kind.starts_with("kfgins") || file.report.kind == "rtklib_pos";
        study.draft.set("gnss", "height", std::string("ellipsoidal"),
                        stated ? "likely: by the format or name"
                               : "probably: column " + name + " does not state it; receivers often log \"msl\"",
                        true, stated ? Known::File : Known::Default);
        study.found("gnss.height", "ellipsoidal", stated ? 0.9 : 0.6,
                    stated ? "by the format or name" : "column " + name + " does not state the surface it refers to");
    }
    const io::ColumnPlan& plan = file.plan;
    for (const std::string& other : plan.unused) {
        const std::vector<std::string> words = io::words_of_name(other);
        const bool is_height = std::find(words.begin(), words.end(), "height") != words.end() ||
                               std::find(words.begin(), words.end(), "alt") != words.end();
        if (is_height)
            study.draft.note("gnss", fmt::format("another height is there: columns = {{ height_m = {} }}", toml_text(other)));
    }
}

// Smallest step of a logged coordinate, m.
double resolution(const std::vector<double>& degrees) {
    std::vector<double> values = degrees;
    std::erase_if(values, [](double v) { return !std::isfinite(v); });
    std::sort(values.begin(), values.end());
    double smallest = 1e9;
    std::size_t steps = 0;
    for (std::size_t i = 1; i < values.size(); ++i) {
        const double step = values[i] - values[i - 1];
        if (step <= 1e-11) continue;
        smallest = std::min(smallest, step);
        ++steps;
    }
    return steps < 5 ? 0.0 : smallest * units::deg * 6.371e6;
}

void judge_motion_content(Study& study) {
    LoadedFile& file = *study.gnss_file;
    const GnssSeries& gnss = study.gnss;
    if (gnss.size() < 3) return;
    if (!gnss.has_velocity()) {
        file.problem(Level::Info, "no velocities: heading and latency show less clearly",
                     "log the receiver's Doppler velocity too (vel_n_m_s, vel_e_m_s, vel_d_m_s)");
    }
    std::vector<double> speeds, misses;
    double path = 0.0;
    std::size_t repeated = 0, moving = 0;
    for (std::size_t k = 0; k < gnss.size(); ++k) {
        speeds.push_back(gnss.speed(k));
        if (k == 0) continue;
        const Eigen::Vector3d step = gnss.p[k] - gnss.p[k - 1];
        path += std::min(step.head<2>().norm(), 3.0 * (gnss.t[k] - gnss.t[k - 1]) * std::max(1.0, speeds.back()));
        if (speeds.back() > 1.0) {
            ++moving;
            if (step.head<2>().norm() == 0.0) ++repeated;
        }
        if (gnss.has_velocity())
            misses.push_back((step - 0.5 * (gnss.t[k] - gnss.t[k - 1]) * (gnss.v[k] + gnss.v[k - 1])).head<2>().norm());
    }
    study.found("gnss.speed", fmt::format("{:.1f} m/s at most, about {:.2f} km travelled", quantile(speeds, 0.998), path * 1e-3),
                0.9, "GNSS velocity or displacement");
    if (repeated * 10 > moving && moving > 20) {
        file.problem(Level::Warning, fmt::format("{} of {} moving epochs repeat the position before", repeated, moving),
                     "the position is logged faster than it is computed: log at the receiver's own rate");
    }
    if (!misses.empty()) {
        const double limit = std::max(5.0, 10.0 * quantile(misses, 0.9));
        const auto jumps = std::count_if(misses.begin(), misses.end(), [&](double m) { return m > limit; });
        if (jumps > 0) {
            file.problem(Level::Warning,
                         fmt::format("{} position jumps of more than {:.1f} m against the velocity", jumps, limit),
                         "nothing to do: the filter's gate rejects outliers; look at the antenna's view of the sky");
        }
    }
    const double grain = std::max(resolution(file["lat_deg"]), resolution(file["lon_deg"]));
    if (grain > 0.05) {
        file.problem(Level::Info, fmt::format("positions are written in steps of {:.2f} m", grain),
                     "write latitude and longitude with 8 decimals or more");
    }
}

}  // namespace

void judge_idle_velocity(Study& study) {
    if (study.gnss_file == nullptr) return;
    LoadedFile& file = *study.gnss_file;
    constexpr std::array<const char*, 3> names{"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"};
    if (!file.has(names[0]) || !file.has(names[1]) || !file.has("lat_deg") || !file.has("lon_deg") ||
        !io::has_idle_velocities(gnss_fixes(file)))
        return;
    for (const char* name : names) file.columns.erase(name);
    study.idle_velocity = true;
    file.problem(Level::Warning, "the velocities are always zero, although the positions travel",
                 "they are not used; log the receiver's Doppler velocity, or leave the columns out");
}

void judge_gnss(Study& study) {
    if (study.gnss_file == nullptr || study.gnss_file->computed) return;
    study.draft.set("gnss", "file", study.gnss_file->report.path, fmt::format("{:.3g} Hz", study.gnss_file->report.rate_hz));
    draft_parts(study, "gnss", *study.gnss_file);
    draft_columns(study, "gnss", *study.gnss_file, study.gnss_units);
    if (study.idle_velocity) {
        const std::string why = "the velocities of the log are always zero, although the positions travel";
        study.draft.set("gnss", "use_velocity", false, "sure: " + why, true, Known::Found);
        study.doubts.push_back(fmt::format("{}: {}; they are not used", study.gnss_file->report.path, why));
    }
    if (!study.velocity_left_out.empty()) {
        study.draft.set("gnss", "use_velocity", false, "sure: " + study.velocity_left_out, true, Known::Found);
        study.doubts.push_back(fmt::format("{}: {}; they are not used", study.gnss_file->report.path, study.velocity_left_out));
    }
    judge_fix(study);
    judge_sigma(study);
    judge_height(study);
    judge_motion_content(study);
    study.draft.set("gnss", "lever_arm_m", std::vector<double>(3, 0.0),
                    "not in the data: measure from the IMU to the antenna, forward, right, down", true, Known::Default);
}

}  // namespace schuler::inspect::detail
