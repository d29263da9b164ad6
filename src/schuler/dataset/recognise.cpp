#include "schuler/dataset/recognise.h"

#include "schuler/core/error.h"
#include "schuler/dataset/raw_observations.h"
#include "schuler/io/text/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>
#include <string_view>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

/// Why a log has no IMU: its reader says so, or it is a trajectory, in a frame of its own or on the Earth.
void refuse_without_imu(const fs::path& folder, const inspect::InspectReport& report) {
    for (const inspect::FileReport& file : report.files)
        for (const inspect::Problem& p : file.problems)
            if (const std::size_t at = p.text.find("the raw IMU logs are"); at != std::string::npos)
                throw input_error(p.text.substr(at), {(folder / file.path).string(), 0, 0, {}}, p.hint);
    const auto trajectory = std::ranges::find_if(report.files, [](const inspect::FileReport& file) {
        return file.kind == "trajectory" || file.kind == "reference" || file.kind == "kfgins_reference";
    });
    if (trajectory == report.files.end()) return;
    throw input_error("is a trajectory (attitude and position), no log of an IMU",
                      {(folder / trajectory->path).string(), 0, 0, {}},
                      "give the log of the IMU itself: angular rates and accelerations");
}

/// No log of this kind was recognised: reports the most informative finding about a candidate file.
[[noreturn]] void throw_missing(const fs::path& path, const inspect::InspectReport& report, std::string_view kind) {
    std::error_code ec;
    const fs::path folder = fs::is_directory(path, ec) ? path : path.parent_path();
    for (const inspect::FileReport& file : report.files) {
        const bool unread = file.rows == 0 && file.contents.empty();  // of a known format, but damaged
        const auto solution = std::ranges::find_if(
            file.problems, [](const inspect::Problem& p) { return p.text.find("not taken for fixes") != std::string::npos; });
        if (kind == "gnss" && solution != file.problems.end())
            throw input_error(solution->text, {(folder / file.path).string(), 0, 0, {}}, solution->hint);
        if (file.chosen || (file.kind != "unknown" && file.kind != kind && !unread)) continue;
        for (const inspect::Problem& problem : file.problems) {
            if (problem.level == inspect::Level::Info) continue;
            throw input_error(problem.text, {(folder / file.path).string(), 0, 0, {}}, problem.hint);
        }
    }
    if (fs::is_directory(folder / fmt::format("{}.csv", kind), ec)) {
        throw input_error("this is a folder, not a file", {(folder / fmt::format("{}.csv", kind)).string(), 0, 0, {}},
                          "put the log itself there, or name it in a dataset.toml");
    }
    const bool imu = kind == "imu";
    if (imu) refuse_without_imu(folder, report);
    throw input_error(fmt::format("no {} log was recognised in it", imu ? "IMU" : "GNSS"), {path.string(), 0, 0, {}},
                      imu ? "name the columns time_s, gyro_x_rad_s, ..., accel_x_m_s2, ..., or map them in a dataset.toml"
                          : "give the folder that holds both logs, or a dataset.toml with [initial] to navigate without GNSS");
}

/// True if the log was found: "imu.file" or "gnss.file" of the inferred settings.
bool recognised(const inspect::InspectReport& report, std::string_view key) {
    return std::ranges::find(report.facts, key, &Fact::key) != report.facts.end();
}

/// A table of fixes that cannot be used, for a known reason.
bool is_broken_gnss(const inspect::FileReport& file) {
    return !file.chosen && (file.kind == "gnss" || file.resembles == "gnss") &&
           std::ranges::any_of(file.problems, [](const inspect::Problem& p) { return p.level != inspect::Level::Info; });
}

std::vector<std::string> doubts_of(const inspect::InspectReport& report) {
    std::vector<std::string> doubts = report.doubts;
    for (const inspect::FileReport& file : report.files) {
        if (!file.chosen) continue;
        for (const inspect::Problem& problem : file.problems) {
            if (problem.level != inspect::Level::Error) continue;
            // A hint that is a setting is what the run uses; any other is advice.
            const bool setting = problem.hint.starts_with("[");
            const char* link = problem.hint.empty() ? "" : setting ? "; taken with " : "; ";
            doubts.push_back(fmt::format("{}: {}{}{}", file.path, problem.text, link, problem.hint));
        }
    }
    return doubts;
}

/// Tables beside raw measurements that are of no use as they are, and could be the log of an IMU: the solution is that of the
/// satellites alone, which nobody asked for.
std::vector<std::string> unused_tables(const inspect::InspectReport& report) {
    std::vector<std::string> doubts;
    for (const inspect::FileReport& file : report.files) {
        const auto inertial = [](const std::string& name) {
            const std::vector<std::string> words = io::words_of_name(name);
            return std::ranges::any_of(words, [](const std::string& w) {
                return w.starts_with("acc") || w.starts_with("gyr") || w == "imu" || w == "omega" || w == "ins";
            });
        };
        const bool table = !file.resembles.empty() || std::ranges::any_of(file.columns, inertial) ||
                           (file.columns.size() >= 4 && inertial(fs::path(file.path).filename().string()));
        const bool damaged = file.rows == 0 && file.contents.empty() && file.kind == "unknown" &&
                             std::ranges::any_of(file.problems, [](const auto& p) { return p.level == inspect::Level::Error; });
        if (file.chosen || file.kind != "unknown" || !(table || damaged) || file.problems.empty()) continue;
        const auto worst = std::ranges::max_element(file.problems, {}, &inspect::Problem::level);
        doubts.push_back(
            fmt::format("no IMU log was recognised: the solution is that of the satellites alone; {} is not used: {}{}{}",
                        file.path, worst->text, worst->hint.empty() ? "" : "; ", worst->hint));
    }
    return doubts;
}

}  // namespace

void add_raw_observations(const fs::path& path, const inspect::Given& given, inspect::InspectReport& report) {
    const bool imu = recognised(report, "imu.file");
    if (recognised(report, "gnss.file") || (!imu && !report.dataset_toml.empty())) return;
    if (std::ranges::any_of(report.files, is_broken_gnss)) return;  // this file was intended
    RawObservations raw = raw_observations(path, !imu);
    if (raw.facts.empty()) return;
    if (imu) {
        std::error_code ec;
        inspect::Given with = given;
        with.computed = computed_fixes(fs::is_directory(path, ec) ? path : path.parent_path(), raw.files);
        if (!with.computed.fixes.empty()) report = inspect::inspect(path, with);
        if (with.computed.fixes.empty() && !(given.has("imu.axes") && given.has("vehicle.kind")))
            report.doubts.emplace_back(
                "the raw measurements give no fixes, which alone show the way forward and the kind of vehicle before the run: the heading is "
                "that of the axes as they are taken; give imu.axes and vehicle.kind");
    }
    report.facts.insert(report.facts.end(), std::make_move_iterator(raw.facts.begin()), std::make_move_iterator(raw.facts.end()));
    if (!report.dataset_toml.empty()) report.dataset_toml += "\n";
    report.dataset_toml += raw.dataset_toml;
}

Recognised recognise(const fs::path& path, Needs needs, const inspect::Given& given) {
    Recognised r;
    if (needs == Needs::Satellites) {  // no other data are required
        if (!given.find_logs) return r;
        RawObservations raw = raw_observations(path);
        if (raw.facts.empty())
            throw input_error(
                "no raw measurements of satellites with ephemerides were recognised in it", {path.string(), 0, 0, {}},
                "name a RINEX, UBX or RTCM 3 log and its navigation files in [gnss] of a dataset.toml; `schuler inspect` lists what was found");
        r.facts = std::move(raw.facts);
        r.dataset_toml = std::move(raw.dataset_toml);
        return r;
    }
    r.report = inspect::inspect(path, given);
    if (!given.find_logs) {
        r.facts = r.report.facts;
        r.doubts = r.report.doubts;
        return r;
    }
    if (needs == Needs::ImuAndGnss && !recognised(r.report, "imu.file")) {
        RawObservations raw = raw_observations(path);
        if (!raw.facts.empty()) {
            r.facts = std::move(raw.facts);
            r.dataset_toml = std::move(raw.dataset_toml);
            r.doubts = unused_tables(r.report);
            return r;
        }
    }
    if (r.report.dataset_toml.empty()) {
        std::string why = "no IMU log was recognised in it";
        std::string hint = "`schuler inspect` lists what was found; write a dataset.toml";
        if (r.report.files.size() == 1) {  // its own error is more informative
            const inspect::FileReport& only = r.report.files.front();
            const auto error = std::ranges::find(only.problems, inspect::Level::Error, &inspect::Problem::level);
            std::error_code ec;
            if (error != only.problems.end())
                throw input_error(error->text, {(fs::is_directory(path, ec) ? path / only.path : path).string(), 0, 0, {}},
                                  error->hint);
        }
        std::error_code ec;
        for (const inspect::FileReport& file : r.report.files) {  // the log that was meant says why it is none
            const auto error = std::ranges::find(file.problems, inspect::Level::Error, &inspect::Problem::level);
            if ((file.kind == "imu" || file.kind == "gnss") && error != file.problems.end())
                throw input_error(error->text, {(fs::is_directory(path, ec) ? path / file.path : path).string(), 0, 0, {}},
                                  error->hint);
        }
        refuse_without_imu(fs::is_directory(path, ec) ? path : path.parent_path(), r.report);
        for (const inspect::FileReport& file : r.report.files) {
            const auto told = std::ranges::find(file.problems, inspect::Level::Warning, &inspect::Problem::level);
            if (file.resembles == "imu" && told != file.problems.end())
                throw input_error(told->text, {(fs::is_directory(path, ec) ? path / file.path : path).string(), 0, 0, {}},
                                  told->hint);
        }
        for (const auto& problem : r.report.problems) {
            if (problem.level != inspect::Level::Error) continue;
            why = problem.text;
            if (!problem.hint.empty()) hint = problem.hint;
        }
        throw input_error(why, {path.string(), 0, 0, {}}, hint);
    }
    if (!recognised(r.report, "imu.file")) throw_missing(path, r.report, "imu");
    if (needs == Needs::ImuAndGnss || needs == Needs::ImuAndStart) add_raw_observations(path, given, r.report);
    if (needs == Needs::ImuAndGnss && !recognised(r.report, "gnss.file") && !recognised(r.report, "gnss.observations"))
        throw_missing(path, r.report, "gnss");
    r.doubts = doubts_of(r.report);
    r.facts = r.report.facts;
    r.dataset_toml = r.report.dataset_toml;
    return r;
}

}  // namespace schuler::dataset
