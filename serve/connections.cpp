#include "serve/connections.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>

namespace schuler::serve {

void Connections::accepted() {
    const std::lock_guard lock(mutex_);
    if (++count_ <= most_) return;
    const auto oldest = std::ranges::find_if(open_, [](const Entry& e) { return e.stranger && !e.shut; });
    if (oldest == open_.end()) return;  // everybody has the token: the new one waits
    shutdown(oldest->fd, SHUT_RDWR);    // its thread sees the end of it
    oldest->shut = true;
}

void Connections::trust() {
    const std::lock_guard lock(mutex_);
    for (Entry& e : open_)
        if (e.thread == std::this_thread::get_id()) e.stranger = false;
}

void Connections::end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    for (Entry& e : open_) shutdown(e.fd, SHUT_RDWR);
}

Connections::Open::Open(Connections& all, int fd) : all_(all) {
    const std::lock_guard lock(all_.mutex_);
    entry_ = all_.open_.insert(all_.open_.end(), {.fd = fd, .thread = std::this_thread::get_id()});
    if (all_.ended_) shutdown(fd, SHUT_RDWR);
}

Connections::Open::~Open() {
    const std::lock_guard lock(all_.mutex_);
    shutdown(fd(), SHUT_RDWR);
    close(fd());  // under the lock: nobody shuts down another connection that has the same number
    all_.open_.erase(entry_);
    --all_.count_;
}

bool Connections::Open::ready(short events, double seconds) const {
    pollfd one{fd(), events, 0};
    const int timeout_ms = static_cast<int>(1e3 * std::max(seconds, 0.0));
    int found = 0;
    while ((found = poll(&one, 1, timeout_ms)) < 0 && errno == EINTR) {}
    return found > 0;
}

ssize_t Connections::Open::read(char* to, std::size_t size) {
    constexpr std::string_view head_end = "\r\n\r\n";
    const bool in_head = ends_ < static_cast<int>(head_end.size());
    double wait = read_time;
    if (in_head) {
        wait = head_time - std::chrono::duration<double>(Clock::now() - begin_).count();
        if (got_ >= head_bytes) return -1;
        size = std::min(size, head_bytes - got_);
    }
    if (!ready(POLLIN, wait)) return -1;
    ssize_t got = 0;
    while ((got = recv(fd(), to, size, 0)) < 0 && errno == EINTR) {}
    if (got <= 0) return got;
    got_ += static_cast<std::size_t>(got);
    for (const char c : std::string_view(to, static_cast<std::size_t>(got))) {
        if (ends_ == static_cast<int>(head_end.size())) break;
        ends_ = c == head_end[static_cast<std::size_t>(ends_)] ? ends_ + 1 : c == '\r' ? 1 : 0;
    }
    return got;
}

ssize_t Connections::Open::write(const char* from, std::size_t size) const {
    if (!ready(POLLOUT, write_time)) return -1;
    ssize_t sent = 0;
    while ((sent = send(fd(), from, size, MSG_NOSIGNAL)) < 0 && errno == EINTR) {}
    return sent;
}

}  // namespace schuler::serve
