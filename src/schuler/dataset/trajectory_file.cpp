#include "schuler/dataset/trajectory_file.h"

#include "schuler/core/error.h"
#include "schuler/inspect/inspect.h"
#include "schuler/io/formats.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/solution/kfgins.h"
#include "schuler/io/solution/rtklib_pos.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace schuler::dataset {

namespace fs = std::filesystem;

bool is_bare_table(const io::TextInput& input, const io::CsvOptions& options, int columns) {
    if (!options.columns.empty()) return false;
    const io::TableLayout layout = io::inspect_table(input);
    return layout.names.empty() && layout.data_columns == columns;
}

std::vector<ReferenceSample> read_reference(const io::TextInput& input, io::CsvOptions options, WarningLog& warnings) {
    if (is_bare_table(input, options, 10)) {
        const char* names[] = {"time_s",    "lat_deg",   "lon_deg",  "height_m",  "vel_n_m_s",
                               "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg"};
        for (int i = 0; i < 10; ++i) options.columns[names[i]] = fmt::format("#{}", i + 1);
    }
    return io::read_reference_csv(input, options, warnings).samples;
}

namespace {

std::vector<SolutionRow> rows_of(const std::vector<GnssFix>& fixes) {
    std::vector<SolutionRow> rows;
    for (const GnssFix& f : fixes)
        rows.push_back({f.time, f.position, f.velocity_n, not_given3(), f.std_position, f.std_velocity, not_given3()});
    return rows;
}

std::vector<SolutionRow> rows_of(const std::vector<ReferenceSample>& samples) {
    std::vector<SolutionRow> rows;
    for (const ReferenceSample& s : samples)
        rows.push_back({s.time, s.position, s.velocity_n, s.rpy, not_given3(), not_given3(), not_given3()});
    return rows;
}

/// The stream of a log that is a trajectory: the named one, a solution or a reference with positions, else the fixes.
const io::Stream& trajectory_of(const io::StreamLog& log, const io::StreamPath& where) {
    const auto fits = [&](const io::Stream& s) {
        if (!where.stream.empty()) return s.name == where.stream;
        return s.kind == io::TableKind::Reference && !s.own_frame &&
               std::ranges::any_of(s.columns, [](const auto& c) { return c.name.ends_with("lat_deg"); });
    };
    auto it = std::ranges::find_if(log.streams, fits);
    if (it == log.streams.end()) it = std::ranges::find(log.streams, io::TableKind::Gnss, &io::Stream::kind);
    const auto is_trajectory = [](const io::Stream& s) {
        return !s.own_frame && (s.kind == io::TableKind::Gnss || s.kind == io::TableKind::Reference);
    };
    if (it != log.streams.end() && is_trajectory(*it)) return *it;
    std::string names;
    for (const io::Stream& s : log.streams) names += (names.empty() ? "" : ", ") + s.name;
    throw input_error(it == log.streams.end() || !it->own_frame ? "holds no such trajectory on the Earth"
                                                                : "is a trajectory in a frame of its own, not on the Earth",
                      {where.file.string(), 0, 0, {}},
                      "it holds " + names + "; a stream is named by FILE#STREAM, an instrument converted to a table: --to csv");
}

/// References have no sigmas; those of a solution stand in further columns of its stream.
void add_sigmas(std::vector<SolutionRow>& rows, const io::Stream& stream) {
    if (rows.size() != stream.rows()) return;
    const auto fill = [&](std::array<const char*, 3> names, Eigen::Vector3d SolutionRow::*part) {
        for (int k = 0; k < 3; ++k) {
            const io::Stream::Column* column = stream.find(names[static_cast<std::size_t>(k)]);
            for (std::size_t i = 0; column != nullptr && i < rows.size(); ++i)
                if (rows[i].time.ns == stream.time_ns[i]) (rows[i].*part)(k) = column->values[i];
        }
    };
    fill({"std_n_m", "std_e_m", "std_d_m"}, &SolutionRow::std_position);
    fill({"std_vn_m_s", "std_ve_m_s", "std_vd_m_s"}, &SolutionRow::std_velocity);
}

Trajectory read_stream_rows(const io::StreamPath& where, const io::Format& format, WarningLog& warnings) {
    const io::StreamLog log = format.read(io::TextInput(where.file), warnings);
    const io::Stream& stream = trajectory_of(log, where);
    const std::string text = io::table_text(stream, io::Clock::Boot);  // as columns of a solution
    const io::TextInput table = io::TextInput::memory(text, where.file.string() + "#" + stream.name);
    if (stream.kind == io::TableKind::Gnss) return {rows_of(io::read_gnss_csv(table, {}, warnings).fixes), log.clock};
    if (io::is_solution_csv(table)) return {io::read_solution_csv(table, warnings), log.clock};
    std::vector<SolutionRow> rows = rows_of(read_reference(table, {}, warnings));
    add_sigmas(rows, stream);
    return {std::move(rows), log.clock};
}

/// Fixes in the format of KF-GINS, which have no names: by their values, as samples of an IMU have as many columns.
bool is_kfgins_gnss(const io::TextInput& input, const fs::path& file) {
    if (!is_bare_table(input, {}, 7) && !is_bare_table(input, {}, 13)) return false;
    const inspect::InspectReport report = inspect::inspect(file);
    return !report.files.empty() && report.files.front().kind == "kfgins_gnss";
}

Trajectory read_rows(const fs::path& file, WarningLog& warnings) {
    const io::StreamPath where = io::stream_path(file);
    const io::Format* format = io::format_of(where.file);
    const bool has_reader = format != nullptr && (format->name == "rtklib_pos" || format->name == "nmea");  // read directly below
    if (format != nullptr && format->read != nullptr && !has_reader) return read_stream_rows(where, *format, warnings);
    const io::TextInput input(file);
    if (io::is_rtklib_pos(input)) return {rows_of(io::read_rtklib_pos(input, warnings).fixes), io::Clock::Gps};
    if (io::is_nmea(input)) {
        const io::NmeaLog log = io::read_nmea(input, warnings);
        return {rows_of(log.fixes), log.has_date ? io::Clock::Gps : io::Clock::Boot};
    }
    if (io::is_solution_csv(input)) return {io::read_solution_csv(input, warnings)};
    if (is_kfgins_gnss(input, file)) return {rows_of(io::read_kfgins_gnss(input, warnings).fixes)};
    // fixes have sigmas, which a reference has not
    const io::TableLayout layout = io::inspect_table(input);
    if (!layout.names.empty() && io::guess_table_kind(layout) == io::TableKind::Gnss)
        return {rows_of(io::read_gnss_csv(input, {}, warnings).fixes)};
    return {rows_of(read_reference(input, {}, warnings))};
}

}  // namespace

Trajectory read_trajectory(const fs::path& file, WarningLog& warnings) {
    std::error_code ec;
    fs::path path = file;
    if (!fs::exists(io::stream_path(path).file, ec))
        throw input_error("no such file", {path.string(), 0, 0, {}}, "check the path");
    if (fs::is_directory(path, ec)) {
        path /= "solution.csv";
        if (!fs::exists(path, ec))
            throw input_error("is a directory without solution.csv", {file.string(), 0, 0, {}},
                              "name the file of the trajectory");
    }
    Trajectory trajectory = read_rows(path, warnings);
    if (trajectory.rows.empty())
        throw input_error("has no usable row", {path.string(), 0, 0, {}}, "`schuler inspect` shows what is in it");
    return trajectory;
}

}  // namespace schuler::dataset
