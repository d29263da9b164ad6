// What an error-state filter does with the errors it has estimated.
#pragma once

namespace schuler::estim {

/// Feedback of the estimated errors: to the mechanization after every update (Closed), never, the estimates correcting a
/// copy (Open), or now and then, a copy in between (Mixed).
enum class Loop { Closed, Open, Mixed };

}  // namespace schuler::estim
