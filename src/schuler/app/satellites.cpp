#include "schuler/app/satellites.h"

#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/dataset/recognise.h"
#include "schuler/dataset/satellite_views.h"
#include "schuler/io/own_files.h"
#include "schuler/io/staged_folder.h"
#include "schuler/report/carrier.h"
#include "schuler/report/outputs.h"
#include "schuler/report/report.h"
#include "schuler/report/satellite_views.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

namespace schuler::app {
namespace {

/// Seconds after the first epoch. There is no data set axis if only raw measurements are read.
std::optional<double> after_first(const std::optional<settings::RunTime>& t, const char* key) {
    if (!t) return std::nullopt;
    if (t->absolute)
        throw input_error("abs: needs the data set's own axis of time, which raw measurements do not have", {{}, 0, 0, key},
                          "give seconds after the first epoch");
    return t->seconds;
}

}  // namespace

report::Outcome gnss_dataset(const SatellitesRequest& request) {
    const settings::ProcessRequest& common = request.common;
    const settings::Dataset dataset = settings::open_dataset(common.input, dataset::Needs::Satellites, common.over({}));
    const settings::Config config = settings::config_from(dataset.settings);
    const std::string name = config.name.empty() ? dataset.name : config.name;
    const dataset::ViewSpan span{after_first(config.run.start, "run.start_s"), after_first(config.run.stop, "run.stop_s")};
    if (span.start && span.stop && *span.stop <= *span.start)
        throw input_error("the end is not after the start", {{}, 0, 0, "run.stop_s"},
                          "give a later --stop or an earlier --start");
    report::Outcome out;
    out.notice = dataset.inferred_toml;
    out.folder = common.folder_for(name);
    for (const char* file : {"gnss.csv", "satellites.csv", "residuals.csv", "carrier.csv", "report.html", "summary.json"})
        io::check_overwrite(out.folder / file);
    WarningLog warnings;
    const dataset::SatelliteViews views =
        dataset::satellite_views(dataset.folder, config, span, request.missed_detection, common.progress, warnings);
    const report::SatelliteReportInput input{.name = name,
                                             .version = common.version,
                                             .views = &views,
                                             .false_alarm = config.raw.solver.false_alarm,
                                             .missed_detection = request.missed_detection,
                                             .warnings = warnings.summary()};
    io::StagedFolder stage(out.folder);
    const auto write = [&](const char* file, const std::string& text) {
        report::write_text(stage.path() / file, text);
        out.files.push_back(stage.final_path(file));
    };
    write("gnss.csv", report::gnss_csv(views));
    write("satellites.csv", report::satellites_csv(views));
    write("residuals.csv", report::residuals_csv(views));
    if (views.carrier) write("carrier.csv", report::carrier_csv(*views.carrier));
    write("report.html", report::render(report::satellite_page(input)));
    out.json = report::satellite_json(input);
    write("summary.json", out.json);
    stage.publish();
    out.tables = report::satellite_text(input);
    out.warnings = input.warnings;
    out.usable = std::ranges::any_of(
        views.epochs, [](const gnss::EpochView& e) { return e.solution.status == gnss::SinglePointStatus::Solved; });
    if (!out.usable) out.verdict = "no epoch has a solution: satellites.csv states the reason for every satellite";
    return out;
}

}  // namespace schuler::app
