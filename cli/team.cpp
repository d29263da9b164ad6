#include "team.h"

#include "schuler/core/error.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <thread>

#ifdef SCHULER_MPI
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <mpi.h>
#endif

namespace schuler::cli {
namespace {

/// Number of processes according to mpirun or srun; 0: not started by them.
int processes_told() {
    for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "MPI_LOCALNRANKS"}) {
        const char* text = std::getenv(name);
        if (text == nullptr) continue;
        int n = 0;
        const std::string_view word(text);
        std::from_chars(word.data(), word.data() + word.size(), n);
        return n;
    }
    return 0;
}

}  // namespace

void let_the_first_tell(const Team* team) {
    if (team != nullptr && team->rank() != 0) std::this_thread::sleep_for(std::chrono::seconds(2));
}

#ifdef SCHULER_MPI
namespace {

constexpr int ask_tag = 1, span_tag = 2, size_tag = 3, bytes_tag = 4;
constexpr std::uint64_t piece = std::uint64_t{1} << 28U;  ///< bytes, upper limit of one message

/// Spans are requested and answered in messages of 8 and 16 bytes.
class MpiTeam : public Team {
public:
    MpiTeam() {
        int level = 0;
        MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level);
        MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
        MPI_Comm_size(MPI_COMM_WORLD, &size_);
        if (level < MPI_THREAD_SERIALIZED)
            throw input_error("this MPI cannot be used by a program with threads", {},
                              "use OpenMPI or MPICH as Debian builds them");
    }
    ~MpiTeam() override { MPI_Finalize(); }
    [[nodiscard]] int rank() const override { return rank_; }
    [[nodiscard]] int size() const override { return size_; }

    void serve(const std::function<WorkSpan()>& source) override {
        for (int told = 0; told < size_ - 1;) {
            int there = 0;
            MPI_Status status;
            MPI_Iprobe(MPI_ANY_SOURCE, ask_tag, MPI_COMM_WORLD, &there, &status);
            if (there == 0) {  // leaves the processor to the runs
                std::this_thread::sleep_for(std::chrono::microseconds(200));
                continue;
            }
            std::uint64_t nothing = 0;
            MPI_Recv(&nothing, 1, MPI_UINT64_T, status.MPI_SOURCE, ask_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
            const WorkSpan span = source();
            const std::array<std::uint64_t, 2> answer{span.first, span.count};
            MPI_Send(answer.data(), 2, MPI_UINT64_T, status.MPI_SOURCE, span_tag, MPI_COMM_WORLD);
            told += span.count == 0 ? 1 : 0;
        }
    }
    WorkSpan ask() override {
        if (ended_) return {};
        const std::uint64_t nothing = 0;
        std::array<std::uint64_t, 2> answer{};
        MPI_Send(&nothing, 1, MPI_UINT64_T, 0, ask_tag, MPI_COMM_WORLD);
        MPI_Recv(answer.data(), 2, MPI_UINT64_T, 0, span_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        ended_ = answer[1] == 0;
        return {answer[0], answer[1]};
    }
    std::string combined(std::string mine, const std::function<std::string(std::string, std::string)>& combine) override {
        for (int step = 1; step < size_; step *= 2) {
            if (rank_ % (2 * step) != 0) {
                send(mine, rank_ - step);
                return {};
            }
            if (rank_ + step < size_) mine = combine(std::move(mine), receive(rank_ + step));
        }
        return mine;
    }
    void wait() override { MPI_Barrier(MPI_COMM_WORLD); }

private:
    static void send(const std::string& bytes, int to) {
        const std::uint64_t size = bytes.size();
        MPI_Send(&size, 1, MPI_UINT64_T, to, size_tag, MPI_COMM_WORLD);
        for (std::uint64_t at = 0; at < size; at += piece)
            MPI_Send(bytes.data() + at, static_cast<int>(std::min(piece, size - at)), MPI_CHAR, to, bytes_tag, MPI_COMM_WORLD);
    }
    static std::string receive(int from) {
        std::uint64_t size = 0;
        MPI_Recv(&size, 1, MPI_UINT64_T, from, size_tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        std::string bytes(size, '\0');
        for (std::uint64_t at = 0; at < size; at += piece)
            MPI_Recv(bytes.data() + at, static_cast<int>(std::min(piece, size - at)), MPI_CHAR, from, bytes_tag, MPI_COMM_WORLD,
                     MPI_STATUS_IGNORE);
        return bytes;
    }

    int rank_ = 0, size_ = 1;
    bool ended_ = false;
};

}  // namespace

std::shared_ptr<Team> team_of_processes() {
    if (processes_told() < 2) return nullptr;
    return std::make_shared<MpiTeam>();
}

void end_team(const Team& /*team*/, int status) { MPI_Abort(MPI_COMM_WORLD, status); }
#else
std::shared_ptr<Team> team_of_processes() {
    if (processes_told() < 2) return nullptr;
    throw input_error("was started as several processes, and is built without MPI", {},
                      "configure with -DSCHULER_MPI=ON, or start it without mpirun");
}

void end_team(const Team& /*team*/, int /*status*/) {}
#endif

}  // namespace schuler::cli
