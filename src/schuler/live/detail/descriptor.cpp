#include "schuler/live/detail/descriptor.h"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <memory>
#include <system_error>

namespace schuler::live::detail {
namespace {

struct FreeAddresses {
    void operator()(addrinfo* list) const { freeaddrinfo(list); }
};
using Addresses = std::unique_ptr<addrinfo, FreeAddresses>;

Addresses addresses_of(const Endpoint& e, int kind, bool passive, std::string& reason) {
    addrinfo hints{};
    hints.ai_family = AF_UNSPEC;
    hints.ai_socktype = kind;
    hints.ai_flags = passive ? AI_PASSIVE : 0;
    addrinfo* list = nullptr;
    if (const int code = getaddrinfo(e.host.empty() ? nullptr : e.host.c_str(), e.port.c_str(), &hints, &list); code != 0) {
        reason = gai_strerror(code);
        return nullptr;
    }
    return Addresses(list);
}

Descriptor socket_of(const addrinfo& a) {
    return Descriptor(socket(a.ai_family, a.ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, a.ai_protocol));
}

void send_at_once(int fd) {
    const int on = 1;
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
}

}  // namespace

void Descriptor::reset(int fd) {
    if (fd_ >= 0) close(fd_);
    fd_ = fd;
}

std::string text_of_errno(int code) { return std::generic_category().message(code); }

Opened open_tcp(const Endpoint& e) {
    Opened out;
    const Addresses list = addresses_of(e, SOCK_STREAM, false, out.reason);
    for (const addrinfo* a = list.get(); a != nullptr; a = a->ai_next) {
        Descriptor fd = socket_of(*a);
        if (!fd.open()) continue;
        send_at_once(fd.get());
        const bool done = connect(fd.get(), a->ai_addr, a->ai_addrlen) == 0;
        if (!done && errno != EINPROGRESS) {
            out.reason = text_of_errno(errno);
            continue;
        }
        out.fd = std::move(fd);
        out.pending = !done;
        return out;
    }
    return out;
}

Opened listen_tcp(const Endpoint& e) {
    Opened out;
    const Addresses list = addresses_of(e, SOCK_STREAM, true, out.reason);
    for (const addrinfo* a = list.get(); a != nullptr; a = a->ai_next) {
        Descriptor fd = socket_of(*a);
        const int on = 1;
        if (!fd.open()) continue;
        (void)setsockopt(fd.get(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
        if (bind(fd.get(), a->ai_addr, a->ai_addrlen) == 0 && listen(fd.get(), 8) == 0) {
            out.fd = std::move(fd);
            return out;
        }
        out.reason = text_of_errno(errno);
    }
    return out;
}

Opened open_udp(const Endpoint& e, bool receive) {
    Opened out;
    const Addresses list = addresses_of(e, SOCK_DGRAM, receive, out.reason);
    for (const addrinfo* a = list.get(); a != nullptr; a = a->ai_next) {
        Descriptor fd = socket_of(*a);
        if (!fd.open()) continue;
        if ((receive ? bind(fd.get(), a->ai_addr, a->ai_addrlen) : connect(fd.get(), a->ai_addr, a->ai_addrlen)) == 0) {
            out.fd = std::move(fd);
            return out;
        }
        out.reason = text_of_errno(errno);
    }
    return out;
}

Opened open_serial(const Endpoint& e) {
    Opened out;
    Descriptor fd(open(e.path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    if (!fd.open()) {
        out.reason = text_of_errno(errno);
        return out;
    }
    constexpr std::array speeds{std::pair{4800, B4800},      std::pair{9600, B9600},     std::pair{19200, B19200},
                                std::pair{38400, B38400},    std::pair{57600, B57600},   std::pair{115200, B115200},
                                std::pair{230400, B230400},  std::pair{460800, B460800}, std::pair{921600, B921600},
                                std::pair{1000000, B1000000}};
    termios port{};
    if (isatty(fd.get()) != 0 && tcgetattr(fd.get(), &port) == 0) {
        cfmakeraw(&port);
        port.c_cflag |= CLOCAL | CREAD;
        bool known = false;
        for (const auto& [baud, code] : speeds) {
            if (baud != e.baud) continue;
            known = cfsetspeed(&port, code) == 0;
        }
        if (!known || tcsetattr(fd.get(), TCSANOW, &port) != 0) {
            out.reason = "the port does not take this baud rate";
            return out;
        }
    }
    out.fd = std::move(fd);
    return out;
}

Opened accept_client(int listener) {
    Opened out;
    out.fd.reset(accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (out.fd.open()) send_at_once(out.fd.get());
    return out;
}

std::string failure_of_connection(int fd) {
    int code = 0;
    socklen_t size = sizeof code;
    if (getsockopt(fd, SOL_SOCKET, SO_ERROR, &code, &size) != 0) code = errno;
    return code == 0 ? std::string() : text_of_errno(code);
}

}  // namespace schuler::live::detail
