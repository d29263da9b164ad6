#include "schuler/live/detail/shared_memory.h"

#include "schuler/core/units.h"
#include "schuler/live/detail/descriptor.h"
#include "schuler/live/shared_state.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstddef>
#include <cstring>
#include <utility>

namespace schuler::live::detail {

static_assert(sizeof(schuler_shared_state) == 8 + 4 + 4 + 4 * 8 + 18 * 8, "no padding: readers in other languages count bytes");

namespace {

bool is_ours(const schuler_shared_state& s) { return std::memcmp(s.magic, SCHULER_SHARED_MAGIC, sizeof s.magic) == 0; }

void copy(double (&to)[3], const Eigen::Vector3d& from, double unit = 1.0) {
    for (Eigen::Index i = 0; i < 3; ++i) to[i] = from[i] / unit;
}

}  // namespace

SharedMemory::SharedMemory(SharedMemory&& other) noexcept
    : name_(std::move(other.name_)), lock_(std::exchange(other.lock_, -1)), state_(std::exchange(other.state_, nullptr)) {}

SharedMemory::~SharedMemory() {
    if (state_ == nullptr) return;
    std::atomic_ref(state_->running).store(0, std::memory_order_release);
    munmap(state_, sizeof *state_);
    shm_unlink(name_.c_str());
    close(lock_);
}

std::string SharedMemory::open(const std::string& name) {
    name_ = "/" + name;
    const int fd = shm_open(name_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (fd < 0) return text_of_errno(errno);
    const auto failed = [fd](std::string reason) {
        close(fd);
        return reason;
    };
    struct stat s {};
    if (flock(fd, LOCK_EX | LOCK_NB) != 0) return failed("another run writes it");
    if (fstat(fd, &s) != 0) return failed(text_of_errno(errno));
    const bool fresh = s.st_size == 0;
    if (!fresh && s.st_size != static_cast<off_t>(sizeof(schuler_shared_state)))
        return failed("exists, and is not of this program");
    if (fresh && ftruncate(fd, sizeof(schuler_shared_state)) != 0) return failed(text_of_errno(errno));
    void* at = mmap(nullptr, sizeof(schuler_shared_state), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (at == MAP_FAILED) return failed(text_of_errno(errno));
    auto* state = static_cast<schuler_shared_state*>(at);
    if (!fresh && !is_ours(*state)) {
        munmap(at, sizeof *state);
        return failed("exists, and is not of this program");
    }
    state->size = sizeof *state;
    if (state->sequence % 2 != 0) ++state->sequence;  // its last writer was killed
    std::memcpy(state->magic, SCHULER_SHARED_MAGIC, sizeof state->magic);
    std::atomic_ref(state->running).store(1, std::memory_order_release);
    lock_ = fd;
    state_ = state;
    return {};
}

void SharedMemory::store(const SolutionRow& row) {
    if (state_ == nullptr) return;
    schuler_shared_state& s = *state_;
    const std::atomic_ref<std::uint64_t> sequence(s.sequence);
    const std::uint64_t before = sequence.load(std::memory_order_relaxed);
    sequence.store(before + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    ++s.count;
    s.heartbeat_ns =
        std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch()).count();
    s.time_ns = row.time.ns;
    copy(s.position, {row.position.lat / units::deg, row.position.lon / units::deg, row.position.h});
    copy(s.velocity, row.v_eb_n);
    copy(s.attitude, row.rpy, units::deg);
    copy(s.std_position, row.std_position);
    copy(s.std_velocity, row.std_velocity);
    copy(s.std_attitude, row.std_rpy, units::deg);
    sequence.store(before + 2, std::memory_order_release);
}

}  // namespace schuler::live::detail
