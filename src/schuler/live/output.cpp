#include "schuler/live/output.h"

#include "schuler/live/detail/descriptor.h"
#include "schuler/live/detail/shared_memory.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <deque>
#include <filesystem>
#include <system_error>
#include <utility>

namespace schuler::live {

using detail::Descriptor;

namespace {

/// Messages queued for one reader.
struct Reader {
    Descriptor fd{};
    bool pending = false;  ///< connection in progress
    bool greeted = true;   ///< false: the greeting is the first in the queue
    std::deque<std::string> queue{};
    std::size_t bytes = 0, sent = 0;  ///< queued; sent part of the first message
};

enum class Took { All, Waits, Broken };

/// Sends as much as the reader accepts now.
Took pour(Reader& r, Medium medium) {
    constexpr std::size_t atomic = 4096;  // a ready pipe accepts this much without blocking
    while (!r.queue.empty()) {
        const std::string& first = r.queue.front();
        const char* from = first.data() + r.sent;
        const std::size_t left = first.size() - r.sent;
        ssize_t done = 0;
        if (medium == Medium::Standard) {
            pollfd ready{r.fd.get(), POLLOUT, 0};
            if (poll(&ready, 1, 0) != 1 || (ready.revents & POLLOUT) == 0)
                return (ready.revents & (POLLERR | POLLNVAL)) != 0 ? Took::Broken : Took::Waits;
            done = write(r.fd.get(), from, std::min(left, atomic));
        } else if (medium == Medium::File || medium == Medium::Serial) {
            done = write(r.fd.get(), from, left);
        } else {
            done = ::send(r.fd.get(), from, left, MSG_NOSIGNAL | MSG_DONTWAIT);
        }
        if (done < 0) {
            if (errno == EINTR) continue;
            if (errno == EAGAIN || errno == EWOULDBLOCK) return Took::Waits;
            if (medium != Medium::Udp) return Took::Broken;
            done = static_cast<ssize_t>(left);  // no receiver: the datagram is lost
        }
        r.sent += static_cast<std::size_t>(done);
        if (r.sent < first.size()) continue;
        r.bytes -= first.size();
        r.queue.pop_front();
        r.sent = 0;
        r.greeted = true;
    }
    return Took::All;
}

}  // namespace

struct Output::State {
    static constexpr double first_wait = 0.25, longest_wait = 30.0;  ///< s before reopening
    Endpoint endpoint;
    OutputLimits limits;
    std::function<void(const std::string&)> tell;
    std::string greeting{}, ending{};
    detail::SharedMemory shared{};
    Descriptor listener{};
    std::vector<Reader> readers{};
    double next = 0.0, wait = first_wait;
    bool told = false, broken = false;
    std::size_t dropped = 0, written = 0;

    void push(Reader& r, std::string_view message) {
        r.queue.emplace_back(message);
        r.bytes += message.size();
        // a partly sent message must be completed, and the rest means nothing without the greeting
        const std::size_t first = r.sent > 0 || !r.greeted ? 1 : 0;
        while (r.bytes > limits.queue && r.queue.size() > first + 1) {
            r.bytes -= r.queue[first].size();
            r.queue.erase(r.queue.begin() + static_cast<std::ptrdiff_t>(first));
            if (dropped++ == 0)
                tell(fmt::format("{}: a reader does not keep up: the oldest messages are dropped", endpoint.text));
        }
    }

    void add(Descriptor fd, bool pending, bool greeted = true) {
        Reader& r = readers.emplace_back();
        r.fd = std::move(fd);
        // pending data must be queued here, where the oldest can be dropped, not in the system
        const int small = 65536;
        if (endpoint.medium != Medium::Standard)  // that one is not of this program alone
            (void)setsockopt(r.fd.get(), SOL_SOCKET, SO_SNDBUF, &small, sizeof small);
        r.pending = pending;
        if (greeted && !greeting.empty()) {
            push(r, greeting);
            r.greeted = false;
        }
        told = false;
        wait = first_wait;
    }

    void failed(const std::string& reason, double now) {
        if (!told) tell(fmt::format("{}: {}; tried again", endpoint.text, reason));
        told = true;
        next = now + wait;
        wait = std::min(2.0 * wait, longest_wait);
    }

    void open_file(double now) {
        Descriptor fd(open(endpoint.path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666));
        struct stat s {};
        if (!fd.open() || fstat(fd.get(), &s) != 0) return failed(detail::text_of_errno(errno), now);
        written = S_ISREG(s.st_mode) ? static_cast<std::size_t>(s.st_size) : 0;
        if (written > 0 && !ending.empty()) {
            put_aside();
            fd.reset(open(endpoint.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
            if (!fd.open()) return failed(detail::text_of_errno(errno), now);
            written = 0;
        }
        add(std::move(fd), false, written == 0);
    }

    void end_file() {
        if (ending.empty()) return;
        for (Reader& r : readers) {
            push(r, ending);
            (void)pour(r, endpoint.medium);
        }
    }

    void rotate(double now) {
        end_file();
        readers.clear();
        put_aside();
        open_file(now);
    }

    /// The file becomes the newest of the older ones.
    void put_aside() const {
        namespace fs = std::filesystem;
        std::error_code ec;
        for (int k = limits.keep; k >= 1; --k) {
            const fs::path from = k == 1 ? fs::path(endpoint.path) : fs::path(fmt::format("{}.{}", endpoint.path, k - 1));
            fs::rename(from, fmt::format("{}.{}", endpoint.path, k), ec);  // a missing file is ignored
        }
        if (limits.keep < 1) fs::remove(endpoint.path, ec);
    }

    void flush(std::size_t k, double now) {
        Reader& r = readers[k];
        if (r.pending || pour(r, endpoint.medium) != Took::Broken) return;
        readers.erase(readers.begin() + static_cast<std::ptrdiff_t>(k));
        broken = broken || endpoint.medium == Medium::Standard;
        if (!listener.open()) failed("the reader is gone", now);
    }
};

Output::Output(Endpoint endpoint, const OutputLimits& limits, std::function<void(const std::string&)> tell)
    : state_(std::make_unique<State>(State{.endpoint = std::move(endpoint), .limits = limits, .tell = std::move(tell)})) {}
Output::~Output() = default;
Output::Output(Output&&) noexcept = default;

void Output::greet(std::string text) { state_->greeting = std::move(text); }
void Output::end_files_with(std::string text) { state_->ending = std::move(text); }
void Output::store(const SolutionRow& row) { state_->shared.store(row); }
void Output::close(double now) {
    if (state_->endpoint.medium != Medium::File) return;
    state_->end_file();
    for (std::size_t k = state_->readers.size(); k-- > 0;) state_->flush(k, now);
    state_->readers.clear();
}

void Output::tend(double now) {
    State& s = *state_;
    if (s.broken || s.listener.open() || !s.readers.empty() || now < s.next) return;
    if (s.endpoint.medium == Medium::File) return s.open_file(now);
    if (s.endpoint.medium == Medium::Shared) {
        if (s.shared.is_open()) return;
        const std::string reason = s.shared.open(s.endpoint.path);
        return reason.empty() ? void() : s.failed(reason, now);
    }
    detail::Opened o;
    switch (s.endpoint.medium) {
        case Medium::TcpListen: o = detail::listen_tcp(s.endpoint); break;
        case Medium::Udp: o = detail::open_udp(s.endpoint, false); break;
        case Medium::Serial: o = detail::open_serial(s.endpoint); break;
        case Medium::Standard:
            o.fd.reset(fcntl(s.endpoint.descriptor, F_DUPFD_CLOEXEC, 3));
            if (!o.fd.open()) o.reason = detail::text_of_errno(errno);
            break;
        default: o = detail::open_tcp(s.endpoint); break;
    }
    if (!o.fd.open()) return s.failed(o.reason.empty() ? "cannot be opened" : o.reason, now);
    if (s.endpoint.medium == Medium::TcpListen) s.listener = std::move(o.fd);
    else s.add(std::move(o.fd), o.pending);
}

void Output::send(std::string_view message, double now) {
    State& s = *state_;
    if (s.endpoint.medium == Medium::File && s.limits.rotate > 0 && s.written > 0 && s.written + message.size() > s.limits.rotate)
        s.rotate(now);
    s.written += message.size();
    for (std::size_t k = s.readers.size(); k-- > 0;) {
        s.push(s.readers[k], message);
        s.flush(k, now);
    }
}

void Output::interests(std::vector<Interest>& out) const {
    if (state_->listener.open()) out.push_back({state_->listener.get(), true, false});
    for (const Reader& r : state_->readers) {
        // the closing of a connection by the other end is detected by reading
        const bool connection = state_->endpoint.medium == Medium::Tcp || state_->endpoint.medium == Medium::TcpListen;
        if (connection || !r.queue.empty()) out.push_back({r.fd.get(), connection && !r.pending, r.pending || !r.queue.empty()});
    }
}

void Output::ready(int fd, double now) {
    State& s = *state_;
    if (fd == s.listener.get()) {
        detail::Opened client = detail::accept_client(fd);
        constexpr std::size_t most = 64;
        if (client.fd.open() && s.readers.size() < most) {
            s.add(std::move(client.fd), false);
            s.flush(s.readers.size() - 1, now);
        }
        return;
    }
    for (std::size_t k = s.readers.size(); k-- > 0;) {
        Reader& r = s.readers[k];
        if (r.fd.get() != fd) continue;
        if (r.pending) {
            const std::string reason = detail::failure_of_connection(fd);
            if (!reason.empty()) {
                s.readers.erase(s.readers.begin() + static_cast<std::ptrdiff_t>(k));
                return s.failed(reason, now);
            }
            r.pending = false;
        } else if (s.endpoint.medium == Medium::Tcp || s.endpoint.medium == Medium::TcpListen) {
            char unread[512];
            if (recv(fd, unread, sizeof unread, MSG_DONTWAIT) == 0) {
                s.readers.erase(s.readers.begin() + static_cast<std::ptrdiff_t>(k));
                if (!s.listener.open()) s.failed("the reader is gone", now);
                return;
            }
        }
        return s.flush(k, now);
    }
}

std::size_t Output::dropped() const { return state_->dropped; }
std::size_t Output::readers() const { return state_->readers.size(); }
bool Output::broken() const { return state_->broken; }

}  // namespace schuler::live
