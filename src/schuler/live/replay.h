// A data set's own samples through a real connection, as lines of JSON in the order of time.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/live/endpoint.h"

#include <cstddef>
#include <functional>

namespace schuler::live {

struct ReplayRequest {
    Endpoint to;
    double speed = 1.0;  ///< times real time; 0: as fast as the reader takes them
    std::function<void(double)> progress{};
};

/// Waits for a reader (10 s at most; of tcp-listen as long as it takes), and for it to take every line. Returns lines sent.
/// @throws Error(Computation) where there is no reader or it goes away
std::size_t replay(const Recording& recording, const ReplayRequest& request);

}  // namespace schuler::live
