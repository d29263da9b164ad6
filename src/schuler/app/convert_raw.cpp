#include "schuler/app/convert_raw.h"

#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/rinex/rinex_write.h"
#include "schuler/report/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

/// "rinex-obs", "rinex-nav" or empty, from the file name ending: .23o and .23O are observations of 2023.
std::string format_of(const fs::path& file) {
    std::string e = file.extension().string();
    std::ranges::transform(e, e.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool dated = e.size() == 4 && std::isdigit(static_cast<unsigned char>(e[1])) != 0 &&
                       std::isdigit(static_cast<unsigned char>(e[2])) != 0;
    if (e == ".obs" || e == ".rnx" || (dated && e[3] == 'o')) return "rinex-obs";
    if (e == ".nav" || (dated && std::string("nglpq").find(e[3]) != std::string::npos)) return "rinex-nav";
    return {};
}

}  // namespace

std::optional<report::Outcome> convert_raw(const fs::path& in, const fs::path& out, const std::string& format) {
    const std::string wanted = format.empty() ? format_of(out) : format;
    if (wanted != "rinex-obs" && wanted != "rinex-nav") return std::nullopt;
    WarningLog warnings;
    const io::RawInput raw = io::read_raw_input(in, {}, warnings);
    report::Outcome outcome;
    if (wanted == "rinex-obs") {
        if (raw.observations.epochs.empty())
            throw input_error("has no raw measurements", {in.string(), 0, 0, {}},
                              "log RXM-RAWX (u-blox), MSM4 to MSM7 (RTCM 3) or RANGE (NovAtel)");
        io::write_file(out, io::rinex_observations_text(raw.observations));
        outcome.tables =
            fmt::format("{} epochs, {} measurements\n", raw.observations.epochs.size(), raw.observations.observations.size());
    } else {
        if (raw.navigation.size() == 0)
            throw input_error("has no ephemerides", {in.string(), 0, 0, {}},
                              "log RXM-SFRBX (u-blox), 1019, 1020, 1045, 1046 (RTCM 3) or RAWEPHEM (NovAtel)");
        io::write_file(out, io::rinex_navigation_text(raw.navigation));
        outcome.tables = fmt::format("{} ephemerides\n", raw.navigation.size());
    }
    outcome.warnings = warnings.summary();
    outcome.files.push_back(out);
    return outcome;
}

}  // namespace schuler::app
