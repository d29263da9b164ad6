// A source of bytes that is read without waiting and opened anew, later and later, when it breaks.
#pragma once

#include "schuler/live/endpoint.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

namespace schuler::live {

/// What a loop waits for.
struct Interest {
    int fd = -1;
    bool read = false, write = false;
};

class Input {
public:
    /// `tell` hears of connections made and lost, in a sentence each.
    Input(Endpoint endpoint, std::function<void(const std::string&)> tell);
    ~Input();
    Input(Input&&) noexcept;
    Input& operator=(Input&&) = delete;

    /// Opens what is due, by a clock of seconds that only goes on.
    void tend(double now);
    [[nodiscard]] Interest interest() const;
    /// To be called when the descriptor is ready: appends what is there (64 KB at most). Returns bytes read.
    std::size_t read(std::string& bytes, double now);

    [[nodiscard]] bool connected() const;
    /// The end of a file or of standard input: nothing more will come.
    [[nodiscard]] bool finished() const;
    /// Times that it was connected anew after it had been.
    [[nodiscard]] std::size_t reconnections() const;
    [[nodiscard]] const Endpoint& endpoint() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace schuler::live
