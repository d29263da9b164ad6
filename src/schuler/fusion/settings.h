// The settings of a run.
#pragma once

#include "schuler/filter/settings.h"

namespace schuler::fusion {

using namespace filter;  // NOLINT: a run's settings are those of its filter, extended by the start-up

}  // namespace schuler::fusion
