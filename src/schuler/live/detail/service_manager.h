// Notifications of a live run to a service manager (sd_notify(3) of systemd): a datagram each.
#pragma once

#include "schuler/live/detail/descriptor.h"

#include <string>

namespace schuler::live::detail {

/// Without a socket of a manager nothing is sent. Never waits: what the manager does not take is lost.
class ServiceManager {
public:
    /// `place`: path of the manager's socket, or '@' and the name of an abstract one; empty: none. `watchdog`: s, within which it expects
    /// a notification; 0: none.
    ServiceManager(const std::string& place, double watchdog);
    /// NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID of the environment.
    [[nodiscard]] static ServiceManager of_environment();

    [[nodiscard]] bool present() const { return socket_.open(); }
    /// To be called in every turn of the loop: says that it turns, twice within the time of the watchdog. `status` is sent when it is
    /// another one, once a second at most.
    void turned(double now, const std::string& status);
    void ready();     ///< once
    void stopping();  ///< once

private:
    void send(const std::string& text) const;

    Descriptor socket_;
    double watchdog_ = 0.0, next_ = 0.0, next_status_ = 0.0;
    bool ready_ = false, stopping_ = false;
    std::string status_;
};

}  // namespace schuler::live::detail
