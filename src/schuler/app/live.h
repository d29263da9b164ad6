// `schuler live` and `schuler replay`.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"

#include <filesystem>

namespace schuler::app {

struct LiveRequest {
    std::filesystem::path config;
    settings::SettingList above;
};
/// Runs until stopped. @throws Error
[[nodiscard]] report::Outcome run_live_config(const LiveRequest& request);

struct ReplayDatasetRequest {
    settings::ProcessRequest common;
    std::string to;
    double speed = 1.0;
};
/// Sends the samples of a data set as JSON lines. @throws Error
[[nodiscard]] report::Outcome replay_dataset(const ReplayDatasetRequest& request);

}  // namespace schuler::app
