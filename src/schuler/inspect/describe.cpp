#include "schuler/inspect/detail/draft.h"
#include "schuler/inspect/inspect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::inspect {
namespace {

std::string file_line(const FileReport& file, std::size_t width) {
    std::string line = fmt::format("  {} {:<{}}  {:<11}", file.chosen ? "*" : " ", file.path, width, file.kind);
    if (file.rows == 0) return line;
    line += fmt::format(" {:>8} rows {:>8.4g} Hz  {:.2f} to {:.2f} s ({:.1f} s)", file.rows, file.rate_hz, file.start_s,
                        file.stop_s, file.stop_s - file.start_s);
    if (file.gaps > 0) line += fmt::format(", {} gap{}", file.gaps, file.gaps == 1 ? "" : "s");
    if (file.duplicates > 0) line += fmt::format(", {} duplicate{}", file.duplicates, file.duplicates == 1 ? "" : "s");
    return line;
}

std::string problem_line(const Problem& problem, const std::string& where) {
    std::string line =
        fmt::format("  {:<8} {}{}", std::string(name_of(problem.level)) + ":", where.empty() ? "" : where + ": ", problem.text);
    if (!problem.hint.empty()) line += fmt::format("\n           -> {}", problem.hint);
    return line;
}

}  // namespace

std::string describe(const InspectReport& report) {
    std::string out = fmt::format("{}\n\nFiles (* used)\n", report.path);
    std::size_t width = 8, key_width = 8;
    for (const FileReport& file : report.files) width = std::max(width, file.path.size());
    for (const FileReport& file : report.files) {
        out += file_line(file, width) + "\n";
        for (const std::string& line : file.contents) out += "      " + line + "\n";
    }
    if (report.files.empty()) out += "  none\n";

    if (!report.findings.empty()) out += "\nFound in the data\n";
    for (const Finding& f : report.findings) key_width = std::max(key_width, f.key.size());
    for (const Finding& f : report.findings) {
        out += fmt::format("  {:<{}}  {}\n  {:<{}}    {}: {}\n", f.key, key_width, f.value, "", key_width,
                           detail::how_sure(f.confidence), f.why);
    }
    std::string problems;
    for (const Level level : {Level::Error, Level::Warning, Level::Info}) {
        for (const Problem& p : report.problems) problems += p.level == level ? problem_line(p, "") + "\n" : "";
        for (const FileReport& file : report.files) {
            for (const Problem& p : file.problems) problems += p.level == level ? problem_line(p, file.path) + "\n" : "";
        }
    }
    if (!problems.empty()) out += "\nNotes\n" + problems;
    if (!report.dataset_toml.empty()) out += "\ndataset.toml to start from\n\n" + report.dataset_toml;
    return out;
}

}  // namespace schuler::inspect
