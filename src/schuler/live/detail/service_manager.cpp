#include "schuler/live/detail/service_manager.h"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace schuler::live::detail {
namespace {

/// A whole number of the environment, 0 if there is none.
std::int64_t whole_number_of(const char* name) {
    const char* text = std::getenv(name);
    std::int64_t value = 0;
    if (text != nullptr) std::from_chars(text, text + std::strlen(text), value);
    return value;
}

}  // namespace

ServiceManager::ServiceManager(const std::string& place, double watchdog) : watchdog_(watchdog) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (place.empty() || (place.front() != '/' && place.front() != '@') || place.size() >= sizeof address.sun_path) return;
    place.copy(address.sun_path, place.size());
    if (place.front() == '@') address.sun_path[0] = '\0';
    Descriptor fd(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
    const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + place.size());
    if (fd.open() && connect(fd.get(), reinterpret_cast<const sockaddr*>(&address), size) == 0) socket_ = std::move(fd);
}

ServiceManager ServiceManager::of_environment() {
    const char* place = std::getenv("NOTIFY_SOCKET");
    const std::int64_t process = whole_number_of("WATCHDOG_PID");  // it may be meant for a parent of this process
    const bool for_this = process == 0 || process == getpid();
    return {place != nullptr ? place : "", for_this ? 1e-6 * static_cast<double>(whole_number_of("WATCHDOG_USEC")) : 0.0};
}

void ServiceManager::turned(double now, const std::string& status) {
    if (!socket_.open()) return;
    if (watchdog_ > 0.0 && now >= next_) {
        send("WATCHDOG=1");
        next_ = now + 0.5 * watchdog_;
    }
    if (status != status_ && now >= next_status_) {
        send("STATUS=" + status);
        status_ = status;
        next_status_ = now + 1.0;
    }
}

void ServiceManager::ready() {
    if (!std::exchange(ready_, true)) send("READY=1");
}

void ServiceManager::stopping() {
    if (!std::exchange(stopping_, true)) send("STOPPING=1");
}

void ServiceManager::send(const std::string& text) const {
    if (socket_.open()) (void)::send(socket_.get(), text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

}  // namespace schuler::live::detail
