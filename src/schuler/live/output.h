// A destination of messages that never blocks on a reader: data not accepted are queued, and beyond a limit the oldest are
// dropped and counted.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/live/endpoint.h"
#include "schuler/live/input.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::live {

struct OutputLimits {
    std::size_t queue = 1 << 20;  ///< bytes queued for one reader
    std::size_t rotate = 0;       ///< bytes after which a file is restarted; 0: never
    int keep = 5;                 ///< number of older files kept, NAME.1 is the newest
};

class Output {
public:
    Output(Endpoint endpoint, const OutputLimits& limits, std::function<void(const std::string&)> tell);
    ~Output();
    Output(Output&&) noexcept;
    Output& operator=(Output&&) = delete;

    /// Sent to every reader before the first message: the header of a table, with its line end.
    void greet(std::string text);
    /// Written at the end of every file. Such files are not appended to: an existing one is kept as an older file.
    void end_files_with(std::string text);
    void tend(double now);
    /// One message with its line end. Sent immediately if possible.
    void send(std::string_view message, double now);
    /// For shared memory instead of messages.
    void store(const SolutionRow& row);
    /// Ends a file.
    void close(double now);
    void interests(std::vector<Interest>& out) const;
    /// To be called when one of its descriptors is ready.
    void ready(int fd, double now);

    [[nodiscard]] std::size_t dropped() const;  ///< number of messages
    [[nodiscard]] std::size_t readers() const;
    [[nodiscard]] bool broken() const;  ///< standard output was closed

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace schuler::live
