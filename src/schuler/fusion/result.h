// Results of processing one data set.
#pragma once

#include "schuler/filter/result.h"

namespace schuler::fusion {

using namespace filter;  // NOLINT: a run's result is that of its filter

}  // namespace schuler::fusion
