// A byte source read without blocking, and reopened with increasing delays after a failure.
#pragma once

#include "schuler/live/endpoint.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace schuler::live {

/// Events that a loop waits for.
struct Interest {
    int fd = -1;
    bool read = false, write = false;
};

class Input {
public:
    /// `tell` is called when connections are made and lost, with one sentence each.
    Input(Endpoint endpoint, std::function<void(const std::string&)> tell);
    ~Input();
    Input(Input&&) noexcept;
    Input& operator=(Input&&) = delete;

    /// Opens connections that are due, by a monotonic clock in seconds.
    void tend(double now);
    [[nodiscard]] Interest interest() const;
    /// To be called when the descriptor is ready: appends the available data (at most 64 KB). Returns the number of bytes read.
    std::size_t read(std::string& bytes, double now);

    [[nodiscard]] bool connected() const;
    /// Data can come: connected, waiting for a client, or at its end.
    [[nodiscard]] bool stands() const;
    /// End of a file or of standard input: no more data will arrive.
    [[nodiscard]] bool finished() const;
    /// Number of reconnections.
    [[nodiscard]] std::size_t reconnections() const;
    [[nodiscard]] const Endpoint& endpoint() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace schuler::live
