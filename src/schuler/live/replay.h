// Sends a data set's samples over a real connection, as JSON lines in time order.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/live/endpoint.h"

#include <cstddef>
#include <functional>

namespace schuler::live {

struct ReplayRequest {
    Endpoint to;
    double speed = 1.0;  ///< multiple of real time; 0: as fast as the reader accepts them
    std::function<void(double)> progress{};
};

/// Waits for a reader (at most 10 s; for tcp-listen without limit), and until it has received every line. Returns the number of
/// lines. @throws Error(Computation) if there is no reader or it disconnects
std::size_t replay(const Recording& recording, const ReplayRequest& request);

}  // namespace schuler::live
