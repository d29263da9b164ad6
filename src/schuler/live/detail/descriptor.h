// Operating system descriptors: owned, opened without blocking, private to the room.
#pragma once

#include "schuler/live/endpoint.h"

#include <string>
#include <utility>

namespace schuler::live::detail {

/// Closes the descriptor it owns; -1: none.
class Descriptor {
public:
    Descriptor() = default;
    explicit Descriptor(int fd) : fd_(fd) {}
    ~Descriptor() { reset(); }
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        if (this != &other) reset(std::exchange(other.fd_, -1));
        return *this;
    }
    void reset(int fd = -1);
    [[nodiscard]] int get() const { return fd_; }
    [[nodiscard]] bool open() const { return fd_ >= 0; }

private:
    int fd_ = -1;
};

/// A descriptor, or the reason for its absence. `pending`: connection in progress; writable once it is decided.
struct Opened {
    Descriptor fd;
    bool pending = false;
    std::string reason;
};
[[nodiscard]] Opened open_tcp(const Endpoint& endpoint);
[[nodiscard]] Opened listen_tcp(const Endpoint& endpoint);
/// Bound to receive, or connected to send.
[[nodiscard]] Opened open_udp(const Endpoint& endpoint, bool receive);
[[nodiscard]] Opened open_serial(const Endpoint& endpoint);
[[nodiscard]] Opened accept_client(int listener);
/// Result of a connection that was in progress: empty if it is established.
[[nodiscard]] std::string failure_of_connection(int fd);
[[nodiscard]] std::string text_of_errno(int code);

}  // namespace schuler::live::detail
