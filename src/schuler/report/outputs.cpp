#include "schuler/report/outputs.h"

#include "schuler/io/atomic_file.h"
#include "schuler/io/own_files.h"
#include "schuler/io/solution/kml.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/csv/csv_events.h"
#include "schuler/report/carrier.h"
#include "schuler/report/run_mat.h"
#include "schuler/report/states_csv.h"
#include "schuler/settings/config/config.h"
#include "schuler/solution/bundle.h"
#include "schuler/solution/events.h"

#include <algorithm>
#include <cmath>

namespace schuler::report {

std::vector<SolutionRow> decimated(std::vector<SolutionRow> rows, double rate) {
    if (!(rate > 0.0)) return rows;
    const Duration period = Duration::from_seconds(1.0 / rate);
    std::int64_t last = INT64_MIN;
    std::size_t kept = 0;
    for (const SolutionRow& r : rows) {
        const std::int64_t number = period_number(r.time, period);
        if (number == last) continue;
        last = number;
        rows[kept++] = r;
    }
    rows.resize(kept);
    return rows;
}

void write_text(const std::filesystem::path& file, const std::string& text) { io::write_file(file, text); }

void make_folder(const std::filesystem::path& folder) {
    std::error_code ec;
    std::filesystem::create_directories(folder, ec);
    if (ec)
        throw input_error(fmt::format("the folder cannot be made: {}", ec.message()), {folder.string(), 0, 0, {}},
                          "give another one with -o");
}

void check_overwrite_of_outputs(const std::filesystem::path& folder) {
    for (const char* name :
         {"solution.csv", "point.csv", "events.csv", "carrier.csv", "ambiguities.csv", "protection.csv", "receiver.csv",
          "states.csv", "run.h5", "run.mat", "report.html", "track.kml", "config.toml", "summary.json"})
        io::check_overwrite(folder / name);
}

std::vector<std::filesystem::path> write_outputs(solution::ResultBundle& b, const std::filesystem::path& folder, bool streamed) {
    make_folder(folder);
    const settings::Config& c = b.data.config;
    std::vector<std::filesystem::path> written;
    const auto add = [&](const char* name) -> const std::filesystem::path& { return written.emplace_back(folder / name); };
    if (c.output.wants("solution")) {
        const std::filesystem::path& file = add("solution.csv");
        const bool of_phases = c.scheme == settings::Scheme::Gnss && !b.data.carrier.epochs.empty();
        if (of_phases) write_text(file, solution_csv_with_quality(b.solution().rows, b.data.carrier, c.filter.gnss.latency));
        else if (!streamed) io::write_solution_csv(file, b.solution().rows, b.result.legs);
    }
    if (!b.solution().point.empty()) io::write_solution_csv(add("point.csv"), b.solution().point, b.result.legs);
    if (!b.data.events.empty() && c.scheme != settings::Scheme::Gnss) {
        const solution::EventRows events = solution::event_rows(b);
        io::write_events_csv(add("events.csv"), events.events, events.rows);
    }
    if (!b.data.carrier.epochs.empty()) write_text(add("carrier.csv"), carrier_csv(b.data.carrier));
    if (!b.result.forward.carriers.empty()) write_text(add("ambiguities.csv"), ambiguities_csv(b));
    if (!b.result.forward.protection.empty()) write_text(add("protection.csv"), protection_csv(b));
    if (!b.result.cross_checks.empty()) write_text(add("receiver.csv"), receiver_csv(b));
    if (c.output.wants("states") && !b.solution().parameters.empty())
        write_text(add("states.csv"), states_csv(b.result.states, b.solution().parameters));
    if (c.output.wants("h5") || c.filter.covariance_rows) write_run_h5(add("run.h5"), b);
    if (c.output.wants("mat")) write_run_mat(add("run.mat"), b);
    if (c.output.wants("report")) io::write_file(add("report.html"), report_html(b));
    if (c.output.wants("kml")) io::write_track_kml(add("track.kml"), b.solution().rows, b.name);
    if (c.output.wants("config")) io::write_file(add("config.toml"), b.config_toml);
    return written;
}

}  // namespace schuler::report
