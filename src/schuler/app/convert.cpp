#include "schuler/app/convert_raw.h"
#include "schuler/app/trajectory_clock.h"
#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/dataset/trajectory_file.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/formats.h"
#include "schuler/io/own_files.h"
#include "schuler/report/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

std::string formats_to_write() {
    std::string names;
    for (const io::Format* format : io::formats())
        if (format->write != nullptr) names += fmt::format("{}{}", names.empty() ? "" : ", ", format->name);
    return names;
}

const io::Format& wanted_format(const fs::path& out, const std::string& name) {
    const io::Format* format = name.empty() ? io::format_to_write(out) : io::format_named(name);
    if (format != nullptr && format->write != nullptr) return *format;
    throw input_error(name.empty()        ? fmt::format("the format of \"{}\" is not known by its name", out.string())
                      : format != nullptr ? fmt::format("\"{}\" is read only", name)
                                          : fmt::format("unknown format \"{}\"", name),
                      {name.empty() ? "" : "--to", 0, 0, {}},
                      fmt::format("use --to {} for solutions, rinex-obs or rinex-nav for raw measurements", formats_to_write()));
}

/// Instruments of a log as tables: a named one, or all of them into a folder. Empty if a trajectory is requested.
std::optional<report::Outcome> convert_streams(const fs::path& in, const fs::path& out, const std::string& name) {
    const io::StreamPath where = io::stream_path(in);
    const bool into_folder = name.empty() && !out.has_extension();
    const bool table = name == "csv" || (name.empty() && out.extension() == ".csv");
    if (!into_folder && (!table || where.stream.empty())) return std::nullopt;
    const io::Format* format = io::format_of(where.file);
    if (into_folder && (format == nullptr || format->read == nullptr)) {
        std::error_code ec;
        const std::string what = fs::is_directory(where.file, ec) ? "is a folder"
                                 : fs::is_empty(where.file, ec)   ? "is empty"
                                                                  : "is no log of several instruments that is recognised";
        throw input_error(fmt::format("{}, and \"{}\" names no file to write", what, out.string()), {in.string(), 0, 0, {}},
                          "give one log, and the name of a file with an extension (track.gpx) or --to FORMAT");
    }
    if (format == nullptr || format->read == nullptr) return std::nullopt;
    WarningLog warnings;
    const io::StreamLog log = format->read(io::TextInput(where.file), warnings);
    if (!where.stream.empty()) (void)io::stream_of_log(log, where);
    report::Outcome outcome;
    std::error_code ec;
    if (into_folder) fs::create_directories(out, ec);
    for (const io::Stream& stream : log.streams) {
        if (!where.stream.empty() && stream.name != where.stream) continue;
        const fs::path file = into_folder ? out / (stream.name + ".csv") : out;
        io::write_file(file, io::table_text(stream, log.clock));
        outcome.tables += fmt::format("{}: {} rows of {}\n", stream.name, stream.rows(), stream.source);
        outcome.files.push_back(file);
    }
    outcome.warnings = warnings.summary();
    return outcome;
}

}  // namespace

report::Outcome convert_file(const fs::path& in, const fs::path& out, const std::string& format) {
    std::error_code ec;
    if (fs::equivalent(in, out, ec))
        throw input_error("is the file to be converted and the one to be written", {out.string(), 0, 0, {}},
                          "give the result another name");
    if (!fs::is_directory(out, ec)) io::check_overwrite(out);
    if (auto raw = convert_raw(in, out, format)) return std::move(*raw);
    if (!fs::exists(io::stream_path(in).file, ec)) throw input_error("no such file", {in.string(), 0, 0, {}}, "check the path");
    if (auto streams = convert_streams(in, out, format)) return std::move(*streams);
    const io::Format& wanted = wanted_format(out, format);
    WarningLog warnings;
    dataset::Trajectory trajectory = dataset::read_trajectory(in, warnings);
    const bool holds_anything = wanted.name == "csv" || wanted.name == "hdf5" || wanted.name == "mat";
    // Tables keep the times of the file, unless its format is one of another clock than theirs; all other formats have dates.
    if ((!holds_anything || trajectory.clock == io::Clock::Unix) && counts_from_1970(trajectory, in)) to_gps_time(trajectory);
    const std::vector<SolutionRow>& rows = trajectory.rows;
    if (!holds_anything && std::ranges::none_of(rows, [](const SolutionRow& r) {
            return std::isfinite(r.position.lat) && std::isfinite(r.position.lon);
        }))
        throw input_error(fmt::format("has no positions to write as {}", wanted.title), {in.string(), 0, 0, {}},
                          "write csv, hdf5 or mat");
    wanted.write(out, rows, in.stem().string());
    report::Outcome outcome;
    outcome.tables =
        fmt::format("{} rows from {:.3f} to {:.3f} s\n", rows.size(), rows.front().time.seconds(), rows.back().time.seconds());
    outcome.warnings = warnings.summary();
    outcome.files.push_back(out);
    return outcome;
}

}  // namespace schuler::app
