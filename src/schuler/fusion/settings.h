// Everything a run can be given: its settings.
#pragma once

#include "schuler/filter/settings.h"

namespace schuler::fusion {

using namespace filter;  // NOLINT: a run's settings are those of its filter, and what the start-up adds to them

}  // namespace schuler::fusion
