// The state in shared memory: what is read is whole while it is written; objects of others stay as they are.
#include "schuler/live/detail/shared_memory.h"
#include "schuler/core/units.h"
#include "schuler/live/shared_state.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <stop_token>
#include <string>
#include <thread>

namespace schuler::live {
namespace {

std::string name_for(const char* what) { return "schuler-test-" + std::to_string(getpid()) + "-" + what; }

/// A reader's mapping.
class Mapped {
public:
    explicit Mapped(const std::string& name) {
        const int fd = shm_open(("/" + name).c_str(), O_RDONLY, 0);
        if (fd < 0) return;
        void* at = mmap(nullptr, sizeof(schuler_shared_state), PROT_READ, MAP_SHARED, fd, 0);
        close(fd);
        if (at != MAP_FAILED) state = static_cast<const schuler_shared_state*>(at);
    }
    ~Mapped() {
        if (state != nullptr) munmap(const_cast<schuler_shared_state*>(state), sizeof *state);
    }
    const schuler_shared_state* state = nullptr;
};

/// All numbers of a row are the same.
SolutionRow row_of(double x) {
    const Eigen::Vector3d v = Eigen::Vector3d::Constant(x);
    return {Time{static_cast<std::int64_t>(x)}, {x * units::deg, x * units::deg, x}, v, units::deg * v, v, v, units::deg * v};
}

TEST(SharedMemory, IsWholeWhileItIsWritten) {
    const std::string name = name_for("whole");
    detail::SharedMemory memory;
    ASSERT_EQ(memory.open(name), "");
    const Mapped mapped(name);
    ASSERT_NE(mapped.state, nullptr);
    schuler_shared_state copy{};
    EXPECT_EQ(schuler_shared_read(mapped.state, &copy), 0) << "nothing has been written";
    const std::jthread writer([&](const std::stop_token& stop) {
        for (double x = 1.0; !stop.stop_requested(); x += 1.0) memory.store(row_of(x));
    });
    std::uint64_t last = 0;
    int reads = 0;
    while (reads < 20'000) {
        if (schuler_shared_read(mapped.state, &copy) != 1) continue;
        ++reads;
        const auto x = static_cast<double>(copy.time_ns);
        ASSERT_EQ(copy.velocity[0], x);
        ASSERT_EQ(copy.std_velocity[2], x);
        ASSERT_NEAR(copy.std_attitude[2], x, 1e-9 * x);
        ASSERT_EQ(static_cast<double>(copy.count), x);
        ASSERT_GE(copy.count, last);
        last = copy.count;
    }
    // Two members alone are read faster than all are written: between their writes the sequence has to be odd.
    const volatile schuler_shared_state& shared = *mapped.state;
    int probes = 0;
    for (int i = 0; i < 3'000'000; ++i) {
        const std::uint64_t before = __atomic_load_n(&mapped.state->sequence, __ATOMIC_ACQUIRE);
        const auto last_member = shared.std_attitude[2];
        __atomic_thread_fence(__ATOMIC_ACQUIRE);
        const std::int64_t first_member = shared.time_ns;
        __atomic_thread_fence(__ATOMIC_ACQUIRE);
        if (before % 2 != 0 || __atomic_load_n(&mapped.state->sequence, __ATOMIC_RELAXED) != before) continue;
        ++probes;
        ASSERT_NEAR(last_member, static_cast<double>(first_member), 1e-6) << probes;
    }
    EXPECT_GT(probes, 1000);
    EXPECT_EQ(copy.running, 1U);
}

TEST(SharedMemory, BelongsToOneWriterAndGoesWithIt) {
    const std::string name = name_for("one");
    {
        detail::SharedMemory memory;
        ASSERT_EQ(memory.open(name), "");
        memory.store(row_of(5.0));
        detail::SharedMemory second;
        EXPECT_NE(second.open(name).find("another run"), std::string::npos);
        const Mapped mapped(name);
        EXPECT_EQ(mapped.state->count, 1U);
    }
    EXPECT_EQ(Mapped(name).state, nullptr);
    const int fd = shm_open(("/" + name).c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_GE(fd, 0);
    const std::string theirs(sizeof(schuler_shared_state), 'x');
    ASSERT_EQ(write(fd, theirs.data(), theirs.size()), static_cast<ssize_t>(theirs.size()));
    {
        detail::SharedMemory memory;
        EXPECT_NE(memory.open(name).find("not of this program"), std::string::npos);
    }
    std::string now(theirs.size(), '\0');
    EXPECT_EQ(pread(fd, now.data(), now.size(), 0), static_cast<ssize_t>(now.size()));
    EXPECT_EQ(now, theirs);
    close(fd);
    shm_unlink(("/" + name).c_str());
}

TEST(SharedMemory, TakesOverWhatAKilledWriterLeft) {
    const std::string name = name_for("left");
    detail::SharedMemory first;
    ASSERT_EQ(first.open(name), "");
    const int fd = shm_open(("/" + name).c_str(), O_RDWR, 0);
    auto* state = static_cast<schuler_shared_state*>(
        mmap(nullptr, sizeof(schuler_shared_state), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0));
    close(fd);
    first.store(row_of(7.0));
    // the object under another name, as a writer that was killed while it wrote would have left it
    const std::string other = name_for("killed");
    const int copy = shm_open(("/" + other).c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_EQ(write(copy, state, sizeof *state), static_cast<ssize_t>(sizeof *state));
    const std::uint64_t odd = state->sequence + 1;
    ASSERT_EQ(pwrite(copy, &odd, sizeof odd, offsetof(schuler_shared_state, sequence)), static_cast<ssize_t>(sizeof odd));
    close(copy);
    munmap(state, sizeof *state);
    detail::SharedMemory memory;
    ASSERT_EQ(memory.open(other), "");
    memory.store(row_of(8.0));
    const Mapped mapped(other);
    schuler_shared_state read{};
    ASSERT_EQ(schuler_shared_read(mapped.state, &read), 1);
    EXPECT_EQ(read.velocity[1], 8.0);
    EXPECT_EQ(read.count, 2U);
}

}  // namespace
}  // namespace schuler::live
