// The receiver's own solution as a result: the baseline for any coupling.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"

namespace schuler::solution {

/// The fixes outside outages as solution rows at their time of validity, at the antenna; attitude NaN.
[[nodiscard]] fusion::Result gnss_solution(const Recording& recording, const fusion::Settings& settings);

}  // namespace schuler::solution
