// Text tables and settings: recognised if no format with a signature matches.
#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/formats.h"
#include "schuler/io/solution/kml.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/fixed_point.h"
#include "schuler/io/text/number.h"

#include <algorithm>

namespace schuler::io {
namespace {

/// Ten columns without names, as in KF-GINS truth files: time, latitude, longitude, height, velocity NED, roll, pitch, heading.
std::string kfgins_text(std::span<const SolutionRow> rows) {
    std::string out;
    char cell[widest_number];
    for (const SolutionRow& r : rows) {
        out.append(cell, put_seconds(cell, r.time.ns));
        const auto add = [&]<int Decimals>(double x) {
            out += ' ';
            const char* end = put_fixed<Decimals>(cell, x);
            out.append(cell == end ? std::string_view("nan") : std::string_view(cell, static_cast<std::size_t>(end - cell)));
        };
        add.operator()<11>(r.position.lat / units::deg);
        add.operator()<11>(r.position.lon / units::deg);
        add.operator()<5>(r.position.h);
        for (int i = 0; i < 3; ++i) add.operator()<6>(r.v_eb_n[i]);
        for (int i = 0; i < 3; ++i) add.operator()<8>(r.rpy[i] / units::deg);
        out += '\n';
    }
    return out;
}

bool is_text(const FileHead& head) { return !head.folder && !head.bytes.empty() && head.bytes.find('\0') == std::string::npos; }

/// A section of a data set, and a file in it.
bool names_logs(std::string_view text) {
    bool section = false;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string line(trimmed(text.substr(0, end)));
        if (line == "[imu]" || line == "[gnss]") section = true;
        else if (line.starts_with('[')) section = false;
        else if (section && line.starts_with("file") && line.find("= \"") != std::string::npos) return true;
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return false;
}

}  // namespace

extern const Format toml_format, kml_format, kfgins_table_format, csv_format;

const Format toml_format = {.name = "dataset_toml",
                            .title = "Data set or settings",
                            .extensions = ".toml",
                            .holds = "a `dataset.toml`, or settings for `--config`",
                            .time = "-",
                            .recognise = [](const FileHead& head) {
                                return head.extension == ".toml" || (head.extension.empty() && names_logs(head.bytes));
                            }};

const Format kml_format = {.name = "kml",
                           .title = "KML",
                           .extensions = ".kml",
                           .holds = "-",
                           .time = "",
                           .write = [](const std::filesystem::path& path, std::span<const SolutionRow> rows,
                                       const std::string& title) { write_track_kml(path, rows, title); }};

const Format kfgins_table_format = {
    .name = "kf-gins",
    .title = "KF-GINS text",
    .extensions = ".txt .nav",
    .holds =
        "tables of numbers without a header: increments (7 to 9 columns), fixes (7 or 13), truth (10); recognised by their values with the tables of text",
    .time = "seconds of the GPS week",
    .write = [](const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
        write_file(path, kfgins_text(rows));
    }};

const Format csv_format = {
    .name = "csv",
    .title = "Table of text",
    .extensions = ".csv .txt .dat .tsv",
    .holds =
        "one instrument a file, or an IMU with its fixes, columns by their names (below): EuRoC, VectorNav, ulog2csv and mavlogdump tables among them; commas, semicolons, tabs, bars or "
        "blanks, decimal commas, a line of units, `.gz`",
    .time = "as its column says: seconds, milli-, micro- or nanoseconds; seconds of the week; UTC",
    .recognise = is_text,
    .write = [](const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
        write_solution_csv(path, rows);
    }};

}  // namespace schuler::io
