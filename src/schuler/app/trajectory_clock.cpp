#include "schuler/app/trajectory_clock.h"

#include "schuler/inspect/inspect.h"
#include "schuler/io/streams.h"
#include "schuler/settings/toml_file.h"

#include <algorithm>
#include <optional>
#include <string>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

/// time.scale of the config.toml beside the files of a run.
std::optional<std::string> scale_of_run(const fs::path& file) {
    std::error_code ec;
    const fs::path config = (fs::is_directory(file, ec) ? file : file.parent_path()) / "config.toml";
    if (!fs::is_regular_file(config, ec)) return std::nullopt;
    const settings::ValueTable root = settings::read_toml(config);
    const auto time = std::ranges::find(root, "time", &settings::NamedValue::first);
    if (time == root.end() || time->second.table() == nullptr) return std::nullopt;
    const auto scale = std::ranges::find(*time->second.table(), "scale", &settings::NamedValue::first);
    if (scale == time->second.table()->end() || scale->second.text() == nullptr) return std::nullopt;
    return *scale->second.text();
}

}  // namespace

bool counts_from_1970(const dataset::Trajectory& trajectory, const fs::path& file) {
    if (trajectory.clock != io::Clock::Boot) return trajectory.clock == io::Clock::Unix;
    constexpr Time dated{1'000'000'000'000'000'000};
    if (trajectory.rows.front().time < dated) return false;
    const fs::path path = io::stream_path(file).file;
    const std::string name = path.filename().string();
    if (name == "solution.csv" || name == "run.h5" || name == "run.mat" || !path.has_filename() || fs::is_directory(path))
        if (const std::optional<std::string> scale = scale_of_run(path)) return *scale == "utc";
    const inspect::InspectReport report = inspect::inspect(fs::is_directory(path) ? path / "solution.csv" : path);
    return std::ranges::any_of(report.facts,
                               [](const Fact& f) { return f.key == "time.scale" && f.value == FactValue(std::string("utc")); });
}

void to_gps_time(dataset::Trajectory& trajectory) {
    for (SolutionRow& row : trajectory.rows) row.time = gps_from_unix(row.time);
    trajectory.clock = io::Clock::Gps;
}

}  // namespace schuler::app
