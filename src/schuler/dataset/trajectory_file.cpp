#include "schuler/dataset/trajectory_file.h"

#include "schuler/io/nmea.h"
#include "schuler/io/rtklib_pos.h"
#include "schuler/io/solution_csv.h"
#include "schuler/io/table.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::dataset {

namespace fs = std::filesystem;

bool is_bare_table(const io::TextInput& input, const io::CsvOptions& options, int columns) {
    if (!options.columns.empty()) return false;
    const io::TableLayout layout = io::inspect_table(input);
    return layout.names.empty() && layout.data_columns == columns;
}

std::vector<ReferenceSample> read_reference(const fs::path& file, io::CsvOptions options, WarningLog& warnings) {
    const io::TextInput input(file);
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

bool has_sigmas(const io::TextInput& input) {
    const io::TableLayout layout = io::inspect_table(input);
    return std::ranges::find(layout.names, "std_n_m") != layout.names.end();
}

std::vector<SolutionRow> read_rows(const fs::path& file, WarningLog& warnings) {
    const io::TextInput input(file);
    if (io::is_rtklib_pos(input)) return rows_of(io::read_rtklib_pos(input, warnings).fixes);
    if (io::is_nmea(input)) return rows_of(io::read_nmea(input, warnings).fixes);
    if (has_sigmas(input)) return io::read_solution_csv(input, warnings);
    std::vector<SolutionRow> rows;
    for (const ReferenceSample& s : read_reference(file, {}, warnings)) {
        rows.push_back({s.time, s.position, s.velocity_n, s.rpy, not_given3(), not_given3(), not_given3()});
    }
    return rows;
}

}  // namespace

std::vector<SolutionRow> read_trajectory(const fs::path& file, WarningLog& warnings) {
    std::error_code ec;
    fs::path path = file;
    if (!fs::exists(path, ec)) throw input_error("no such file", {path.string(), 0, 0, {}}, "check the path");
    if (fs::is_directory(path, ec)) {
        path /= "solution.csv";
        if (!fs::exists(path, ec))
            throw input_error("is a directory without solution.csv", {file.string(), 0, 0, {}},
                              "name the file of the trajectory");
    }
    std::vector<SolutionRow> rows = read_rows(path, warnings);
    if (rows.empty()) throw input_error("has no usable row", {path.string(), 0, 0, {}}, "`schuler inspect` shows what is in it");
    return rows;
}

}  // namespace schuler::dataset
