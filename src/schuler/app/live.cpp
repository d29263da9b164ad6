#include "schuler/app/live.h"

#include "schuler/dataset/recognise.h"
#include "schuler/live/message.h"
#include "schuler/live/replay.h"
#include "schuler/live/run.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/dataset.h"
#include "schuler/settings/magnetometer_axes.h"
#include "schuler/solution/events.h"
#include "schuler/solution/ignored.h"
#include "schuler/solution/loaded_dataset.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::app {

report::Outcome run_live_config(const LiveRequest& request) {
    const live::LiveSettings settings = live::read_live(request.config, request.above);
    const live::LiveReport r = live::run_live(settings, {});
    report::Outcome out;
    // standard output must contain messages only
    if (std::ranges::any_of(settings.outputs,
                            [](const live::OutputSettings& o) { return o.to.medium == live::Medium::Standard; }))
        return out;
    out.tables = fmt::format(
        "{:.1f} s: {} IMU samples, {} fixes, {}; {} unparseable records, {} reconnections, {} messages dropped\n"
        "from a sample's arrival to its message: median {} ms, 99.9 % {} ms\n",
        r.seconds, r.imu, r.fixes, live::name_of(r.phase), r.garbage, r.reconnections, r.dropped,
        report::table_cell(1e3 * r.latency_median), report::table_cell(1e3 * r.latency_999));
    return out;
}

report::Outcome replay_dataset(const ReplayDatasetRequest& request) {
    const live::Endpoint to = live::endpoint_from(request.to, live::Direction::Out, "--to");
    const settings::Dataset dataset = settings::open_dataset(request.common.input, dataset::Needs::Imu, request.common.over({}));
    const settings::Config config = settings::config_from(dataset.settings);
    WarningLog warnings;
    solution::LoadedDataset data = solution::load_dataset(dataset, config, warnings);
    solution::warn_of_ignored(solution::leave_out_chosen(data), warnings);
    if (const auto C_imu_mag = settings::C_imu_mag(data.config))  // axes stated by the instrument itself
        for (MagSample& m : data.recording.mag) m.field_b = C_imu_mag->transpose() * m.field_b;
    report::Outcome out;
    const std::size_t lines =
        live::replay(data.recording, {.to = to, .speed = request.speed, .progress = request.common.progress});
    out.warnings = warnings.summary();
    if (to.medium != live::Medium::Standard) out.tables = fmt::format("{} samples sent to {}\n", lines, to.text);
    return out;
}

}  // namespace schuler::app
