// Messages of a running `schuler live` (docs/live.md), as server-sent events for the page.
#pragma once

#include <chrono>
#include <string>

namespace schuler::serve {

/// An output of `schuler live` to connect to.
struct LiveAddress {
    std::string host, port;
    [[nodiscard]] bool empty() const { return port.empty(); }
    [[nodiscard]] std::string text() const { return "tcp://" + host + ":" + port; }
};

/// "tcp://HOST:PORT"; an empty text has no address. @throws Error(Input)
[[nodiscard]] LiveAddress live_address(const std::string& text);

/// A connection of its own for every page that listens. It is opened anew when it breaks.
class LiveFeed {
public:
    explicit LiveFeed(LiveAddress address) : address_(std::move(address)) {}
    ~LiveFeed();
    LiveFeed(const LiveFeed&) = delete;
    LiveFeed& operator=(const LiveFeed&) = delete;

    /// Events "live" (a message) and "link" ({connected, text}) since the last call; waits at most a second, "" if nothing happened.
    [[nodiscard]] std::string next();

private:
    [[nodiscard]] std::string connect_again();
    [[nodiscard]] std::string messages(const char* data, std::size_t size);
    [[nodiscard]] std::string lost(const std::string& why);

    LiveAddress address_;
    int socket_ = -1;
    bool told_ = false;  ///< that there is no connection
    std::string partial_;
    bool overlong_ = false;  ///< the rest of a line that is too long is skipped
};

}  // namespace schuler::serve
