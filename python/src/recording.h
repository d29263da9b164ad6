// The instruments of a data set in memory, shared between Python views.
#pragma once

#include "arrays.h"

#include "schuler/core/samples.h"

#include <memory>
#include <string>
#include <vector>

namespace schuler::python {

struct SharedRecording {
    std::string name;
    std::shared_ptr<const Recording> recording;
    ImuKind imu_kind = ImuKind::Rates;
    double origin = 0.0;        ///< s, zero of the command line's times
    std::string config_toml;    ///< settings of the data set as completed by loading
    std::string inferred_toml;  ///< the inferred dataset.toml; empty if there is one
    std::vector<std::string> warnings;
};

}  // namespace schuler::python
