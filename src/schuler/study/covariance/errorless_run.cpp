#include "schuler/study/covariance/errorless_run.h"

#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/tune.h"
#include "schuler/solution/fuse.h"
#include "schuler/study/studies.h"

#include <algorithm>

namespace schuler::study {

ErrorlessRun::ErrorlessRun(const settings::ScenarioConfig& scenario, const settings::SettingList& over, double rate,
                           const sim::ExactFlight* flown) {
    settings::ScenarioConfig exact = without_errors(scenario);
    exact.sim.imu.rate = std::min(exact.sim.imu.rate, rate);
    exact.sim.reference_rate = slow_reference;
    WarningLog unheard;
    bundle = solution::simulated_bundle(exact, over, unheard, &scenario, flown);
    settings = bundle.data.config.filter;
    settings.output_rate = 1.0;
    settings.gnss.estimate_latency = settings.gnss.estimate_std = settings.imu.estimate_noise = settings.imu.estimate_mounting =
        false;
}

void ErrorlessRun::prepare() {
    WarningLog unheard;
    const Recording& recording = bundle.data.recording;
    data.recording = &recording;
    data.imu = fusion::make_imu_timeline(recording.imu, settings.imu, unheard);
    data.origin = bundle.data.origin;
    filter::set_limits(data, settings);
    data.events = fusion::make_events(recording, settings, data.origin, unheard);
    data.fix_noise = fusion::fix_noise(recording, settings.gnss, unheard);
    data.still = fusion::find_still(data.imu, recording, data.events, settings);
    fusion::Findings findings;
    start = fusion::find_start(data, settings, findings, unheard);
}

filter::InertialModel ErrorlessRun::model() const {
    return filter::make_model(settings, filter::make_layout(settings, bundle.data.recording));
}

Error unfollowed(const std::string& why) {
    return input_error("the covariance cannot be followed: " + why, {.file = {}, .key = "filter"},
                       "choose --set filter.scheme=loose with the usual gains");
}

}  // namespace schuler::study
