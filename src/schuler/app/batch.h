// `schuler batch`: many data sets processed as by `process`, and one table of all results.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/request.h"

#include <string>
#include <vector>

namespace schuler::app {

struct BatchRequest {
    settings::ProcessRequest common;  ///< its input is not used; its output is the common folder
    std::vector<std::string> inputs;  ///< lists (text files of paths), data sets, or folders of data sets
    int jobs = 0;
    bool resume = false;  ///< keep finished results of an interrupted batch
};

/// @throws Error(Input) if there is no data set, or the folder cannot be written
[[nodiscard]] report::Outcome process_batch(const BatchRequest& request);

}  // namespace schuler::app
