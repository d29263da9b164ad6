// Handling of the estimated errors by an error-state filter.
#pragma once

namespace schuler::estim {

/// Feedback of the estimated errors: to the mechanization after every update (Closed); never, the estimates correcting only a
/// copy (Open); or at intervals, with a corrected copy in between (Mixed).
enum class Loop { Closed, Open, Mixed };

}  // namespace schuler::estim
