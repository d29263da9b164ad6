// What a service manager hears: datagrams to its socket, from a loop that turns.
#include "schuler/live/detail/service_manager.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace schuler::live {
namespace {

using ::testing::ElementsAre;

/// The manager's end; a name that begins with '@' is abstract.
class Manager {
public:
    explicit Manager(const std::string& name) : fd_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        name.copy(address.sun_path, sizeof address.sun_path - 1);
        if (name.front() == '@') address.sun_path[0] = '\0';
        EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&address),
                       static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + name.size())),
                  0);
    }
    ~Manager() { close(fd_); }
    Manager(const Manager&) = delete;
    Manager& operator=(const Manager&) = delete;

    /// What has come since.
    std::vector<std::string> heard() const {
        std::vector<std::string> out;
        char bytes[256];
        for (ssize_t got; (got = recv(fd_, bytes, sizeof bytes, 0)) > 0;) out.emplace_back(bytes, static_cast<std::size_t>(got));
        return out;
    }

private:
    int fd_;
};

std::string abstract_name() { return "@schuler-notify-" + std::to_string(getpid()); }

TEST(ServiceManager, HearsWhatTheLoopSays) {
    const Manager manager(abstract_name());
    detail::ServiceManager run(abstract_name(), 2.0);
    ASSERT_TRUE(run.present());
    run.turned(10.0, "waiting_for_imu");
    EXPECT_THAT(manager.heard(), ElementsAre("WATCHDOG=1", "STATUS=waiting_for_imu"));
    run.ready();
    run.ready();
    run.turned(10.5, "navigating");
    EXPECT_THAT(manager.heard(), ElementsAre("READY=1")) << "half of the watchdog's time is not over, nor the second of a status";
    run.turned(11.0, "navigating");
    EXPECT_THAT(manager.heard(), ElementsAre("WATCHDOG=1", "STATUS=navigating"));
    EXPECT_THAT(manager.heard(), ElementsAre()) << "nothing by itself: a loop that hangs is not heard";
    run.stopping();
    run.stopping();
    EXPECT_THAT(manager.heard(), ElementsAre("STOPPING=1"));
}

TEST(ServiceManager, WithoutAWatchdogOrAManager) {
    const std::string path = (std::filesystem::temp_directory_path() / abstract_name().substr(1)).string();
    {
        const Manager manager(path);
        detail::ServiceManager run(path, 0.0);
        run.turned(10.0, "navigating");
        EXPECT_THAT(manager.heard(), ElementsAre("STATUS=navigating"));
    }
    std::filesystem::remove(path);
    for (const std::string& place : {std::string(), std::string("no/path"), path, "/" + std::string(200, 'x')}) {
        detail::ServiceManager run(place, 2.0);
        EXPECT_FALSE(run.present()) << place;
        run.turned(10.0, "navigating");
        run.ready();
    }
}

TEST(ServiceManager, NeverWaitsForAManagerThatDoesNotRead) {
    const Manager manager(abstract_name());
    detail::ServiceManager run(abstract_name(), 1e-3);
    for (int i = 0; i < 100'000; ++i) run.turned(i, "");
    const std::size_t heard = manager.heard().size();
    EXPECT_GT(heard, 0U);
    EXPECT_LT(heard, 100'000U) << "the queue of the socket is not that long";
}

}  // namespace
}  // namespace schuler::live
