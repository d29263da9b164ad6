// A base station for carrier-phase positions, as a user gives it.
#pragma once

#include "schuler/core/position.h"
#include "schuler/ppk/settings.h"

#include <optional>
#include <string>
#include <vector>

namespace schuler::app {

struct BaseConfig {
    std::vector<std::string> observations;       ///< files; empty: there is no base
    std::optional<Ecef> position;                ///< of its antenna; nothing: the header's
    bool position_is_geodetic = true;            ///< as it was written
    ppk::Settings settings;
};

}  // namespace schuler::app
