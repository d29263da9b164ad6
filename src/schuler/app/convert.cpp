#include "schuler/app/convert_raw.h"
#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/core/units.h"
#include "schuler/dataset/trajectory_file.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/fixed_point.h"
#include "schuler/io/kml.h"
#include "schuler/io/own_files.h"
#include "schuler/io/solution_csv.h"
#include "schuler/report/outcome.h"

#include <fmt/format.h>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

/// Ten columns without names, as KF-GINS's truth: time, latitude, longitude, height, velocity NED, roll, pitch, heading.
std::string kfgins_text(const std::vector<SolutionRow>& rows) {
    std::string out;
    char cell[io::widest_number];
    for (const SolutionRow& r : rows) {
        out.append(cell, io::put_seconds(cell, r.time.ns));
        const auto add = [&]<int Decimals>(double x) {
            out += ' ';
            const char* end = io::put_fixed<Decimals>(cell, x);
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

std::string format_of(const fs::path& file) {
    const std::string extension = file.extension().string();
    if (extension == ".csv") return "csv";
    if (extension == ".kml") return "kml";
    if (extension == ".txt" || extension == ".nav") return "kf-gins";
    return {};
}

}  // namespace

report::Outcome convert_file(const fs::path& in, const fs::path& out, const std::string& format) {
    std::error_code ec;
    if (fs::equivalent(in, out, ec))
        throw input_error("is the file to be converted and the one to be written", {out.string(), 0, 0, {}}, "give the result another name");
    io::check_overwrite(out);
    if (auto raw = convert_raw(in, out, format)) return std::move(*raw);
    const std::string wanted = format.empty() ? format_of(out) : format;
    if (wanted != "csv" && wanted != "kml" && wanted != "kf-gins") {
        throw input_error(format.empty() ? fmt::format("the format of \"{}\" is not known by its name", out.string())
                                         : fmt::format("unknown format \"{}\"", format),
                          {format.empty() ? "" : "--to", 0, 0, {}}, "use --to csv, kml or kf-gins for solutions, rinex-obs or rinex-nav for raw measurements");
    }
    WarningLog warnings;
    const std::vector<SolutionRow> rows = dataset::read_trajectory(in, warnings);
    if (wanted == "csv") io::write_solution_csv(out, rows);
    if (wanted == "kml") io::write_track_kml(out, rows, in.stem().string());
    if (wanted == "kf-gins") io::write_file(out, kfgins_text(rows));
    report::Outcome outcome;
    outcome.tables =
        fmt::format("{} rows from {:.3f} to {:.3f} s\n", rows.size(), rows.front().time.seconds(), rows.back().time.seconds());
    outcome.warnings = warnings.summary();
    outcome.files.push_back(out);
    return outcome;
}

}  // namespace schuler::app
