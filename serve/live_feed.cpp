#include "serve/live_feed.h"

#include "schuler/core/error.h"
#include "schuler/live/endpoint.h"
#include "serve/forms.h"

#include <fcntl.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <thread>

namespace schuler::serve {
namespace {

constexpr int wait_ms = 1000;
constexpr std::size_t longest_line = 65536;

std::string event_text(const char* name, const Json& data) {
    return std::string("event: ") + name + "\ndata: " + data.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n\n";
}

/// Waits until the connection is open. The reason if it is not; empty: it is.
std::string reason_of(int socket) {
    pollfd polled{socket, POLLOUT, 0};
    if (poll(&polled, 1, wait_ms) <= 0) return "no answer";
    int error = 0;
    socklen_t size = sizeof error;
    if (getsockopt(socket, SOL_SOCKET, SO_ERROR, &error, &size) != 0) error = errno;
    return error == 0 ? "" : std::strerror(error);
}

}  // namespace

LiveAddress live_address(const std::string& text) {
    if (text.empty()) return {};
    const live::Endpoint e = live::endpoint_from(text, live::Direction::Out, "--live");
    if (e.medium != live::Medium::Tcp)
        throw input_error("is not an address to connect to", {text, 0, 0, "--live"},
                          "write tcp://HOST:PORT of an [[output]] of `schuler live` with to = \"tcp-listen://:PORT\"");
    return {e.host, e.port};
}

LiveFeed::~LiveFeed() {
    if (socket_ >= 0) close(socket_);
}

std::string LiveFeed::lost(const std::string& why) {
    if (socket_ >= 0) close(socket_);
    socket_ = -1;
    partial_.clear();
    overlong_ = false;
    if (told_) return {};
    told_ = true;
    return event_text("link", {{"connected", false}, {"text", why}, {"address", address_.text()}});
}

std::string LiveFeed::connect_again() {
    addrinfo hints{};
    hints.ai_socktype = SOCK_STREAM;
    addrinfo* found = nullptr;
    if (const int failed = getaddrinfo(address_.host.c_str(), address_.port.c_str(), &hints, &found); failed != 0)
        return lost(gai_strerror(failed));
    std::string why = "no address";
    for (const addrinfo* a = found; a != nullptr; a = a->ai_next) {
        const int s = socket(a->ai_family, a->ai_socktype | SOCK_CLOEXEC | SOCK_NONBLOCK, a->ai_protocol);
        if (s < 0) continue;
        const bool begun = connect(s, a->ai_addr, a->ai_addrlen) == 0 || errno == EINPROGRESS;
        why = begun ? reason_of(s) : std::strerror(errno);
        if (why.empty()) {
            socket_ = s;
            break;
        }
        close(s);
    }
    freeaddrinfo(found);
    if (socket_ < 0) return lost(why);
    told_ = false;
    return event_text("link", {{"connected", true}, {"text", ""}, {"address", address_.text()}});
}

std::string LiveFeed::messages(const char* data, std::size_t size) {
    std::string out;
    for (std::size_t i = 0; i < size; ++i) {
        if (data[i] != '\n') {
            if (partial_.size() < longest_line) partial_ += data[i];
            else overlong_ = true;
            continue;
        }
        // whatever is no message is passed over: another program may listen at this port
        const Json message = overlong_ ? Json(Json::value_t::discarded) : Json::parse(partial_, nullptr, false);
        if (message.is_object()) out += event_text("live", message);
        partial_.clear();
        overlong_ = false;
    }
    return out;
}

std::string LiveFeed::next() {
    if (socket_ < 0) {
        std::string told = connect_again();
        if (socket_ < 0) std::this_thread::sleep_for(std::chrono::milliseconds(wait_ms));
        return told;
    }
    pollfd polled{socket_, POLLIN, 0};
    if (poll(&polled, 1, wait_ms) <= 0) return {};
    char buffer[65536];
    const ssize_t n = recv(socket_, buffer, sizeof buffer, 0);
    if (n < 0 && (errno == EAGAIN || errno == EINTR)) return {};
    if (n <= 0) return lost(n == 0 ? "the program has ended" : std::strerror(errno));
    return messages(buffer, static_cast<std::size_t>(n));
}

}  // namespace schuler::serve
