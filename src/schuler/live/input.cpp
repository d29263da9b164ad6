#include "schuler/live/input.h"

#include "schuler/live/detail/descriptor.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <utility>

namespace schuler::live {

using detail::Descriptor;

struct Input::State {
    static constexpr double first_wait = 0.25, longest_wait = 30.0;  ///< s before reopening, doubled each time
    Endpoint endpoint;
    std::function<void(const std::string&)> tell;
    Descriptor listener{}, fd{};
    bool pending = false, finished = false, told = false;
    double next = 0.0, wait = first_wait;
    std::size_t connections = 0;

    void failed(const std::string& reason, double now) {
        fd.reset();
        pending = false;
        if (!told) tell(fmt::format("{}: {}; tried again", endpoint.text, reason));
        told = true;  // until it is established
        next = now + wait;
        wait = std::min(2.0 * wait, longest_wait);
    }

    void stands() {
        pending = told = false;
        wait = first_wait;
        ++connections;
        tell(fmt::format("{}: connected", endpoint.text));
        if (endpoint.medium != Medium::Gpsd) return;
        constexpr std::string_view watch = "?WATCH={\"enable\":true,\"json\":true};\n";
        (void)send(fd.get(), watch.data(), watch.size(), MSG_NOSIGNAL);
    }

    void open_due(double now) {
        detail::Opened o;
        switch (endpoint.medium) {
            case Medium::Tcp:
            case Medium::Gpsd: o = detail::open_tcp(endpoint); break;
            case Medium::TcpListen: o = detail::listen_tcp(endpoint); break;
            case Medium::Udp: o = detail::open_udp(endpoint, true); break;
            case Medium::Serial: o = detail::open_serial(endpoint); break;
            case Medium::Standard: o.fd.reset(dup(0)); break;
            case Medium::File:
                o.fd.reset(open(endpoint.path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
                if (!o.fd.open()) o.reason = detail::text_of_errno(errno);
                break;
            case Medium::Shared: break;  // an output only
        }
        if (!o.fd.open()) return failed(o.reason.empty() ? "cannot be opened" : o.reason, now);
        if (endpoint.medium == Medium::TcpListen) {
            listener = std::move(o.fd);
            told = false;
            return;
        }
        fd = std::move(o.fd);
        pending = o.pending;
        if (!pending) stands();
    }
};

Input::Input(Endpoint endpoint, std::function<void(const std::string&)> tell)
    : state_(std::make_unique<State>(State{.endpoint = std::move(endpoint), .tell = std::move(tell)})) {}
Input::~Input() = default;
Input::Input(Input&&) noexcept = default;

void Input::tend(double now) {
    State& s = *state_;
    if (s.finished || s.fd.open() || s.listener.open() || now < s.next) return;
    s.open_due(now);
}

Interest Input::interest() const {
    const State& s = *state_;
    if (s.fd.open()) return {s.fd.get(), !s.pending, s.pending};
    return {s.listener.get(), s.listener.open(), false};
}

std::size_t Input::read(std::string& bytes, double now) {
    State& s = *state_;
    if (!s.fd.open()) {
        if (!s.listener.open()) return 0;
        detail::Opened client = detail::accept_client(s.listener.get());
        if (client.fd.open()) {
            s.fd = std::move(client.fd);
            s.stands();
        }
        return 0;
    }
    if (s.pending) {
        const std::string reason = detail::failure_of_connection(s.fd.get());
        if (reason.empty()) s.stands();
        else s.failed(reason, now);
        return 0;
    }
    std::array<char, 65536> block;
    const ssize_t got = ::read(s.fd.get(), block.data(), block.size());
    if (got > 0) {
        bytes.append(block.data(), static_cast<std::size_t>(got));
        return static_cast<std::size_t>(got);
    }
    if (got < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return 0;
    const int code = got < 0 ? errno : 0;
    if (s.endpoint.medium == Medium::Udp && code != 0) return 0;
    if (code == 0 && (s.endpoint.medium == Medium::Standard || s.endpoint.medium == Medium::File)) {
        s.fd.reset();
        s.finished = true;
        s.tell(fmt::format("{}: at its end", s.endpoint.text));
    } else if (s.listener.open()) {  // waits for the next client
        s.fd.reset();
        s.tell(fmt::format("{}: the connection was closed", s.endpoint.text));
    } else {
        s.failed(code == 0 ? "the connection was closed" : detail::text_of_errno(code), now);
    }
    return 0;
}

bool Input::connected() const { return state_->fd.open() && !state_->pending; }
bool Input::stands() const { return connected() || state_->listener.open() || state_->finished; }
bool Input::finished() const { return state_->finished; }
std::size_t Input::reconnections() const { return state_->connections > 0 ? state_->connections - 1 : 0; }
const Endpoint& Input::endpoint() const { return state_->endpoint; }

}  // namespace schuler::live
