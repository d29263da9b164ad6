#include "schuler/report/solution_stream.h"

#include "schuler/core/error.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <filesystem>

namespace schuler::report {
namespace {

std::vector<SolutionRow> some_rows(std::size_t n) {
    std::vector<SolutionRow> rows(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double x = static_cast<double>(i);
        rows[i].time = Time{static_cast<std::int64_t>(i) * 5'000'000};
        rows[i].position = {1e-7 * x, 0.5 - 1e-6 * x, 100.0 + 0.01 * x};
        rows[i].v_eb_n = {0.001 * x, -1.0, 0.1};
        rows[i].rpy = {0.01, -0.02, 1e-4 * x};
        rows[i].std_position = rows[i].std_velocity = rows[i].std_rpy = Eigen::Vector3d::Constant(0.1 + 1e-6 * x);
    }
    return rows;
}

TEST(SolutionStreamThreads, GivesTheBytesOfTheWholeTableAtOnce) {
    const test::TemporaryFolder folder("stream");
    const std::vector<SolutionRow> rows = some_rows(60'001);
    io::write_solution_csv(folder.path() / "whole.csv", rows);
    SolutionStream stream(folder.path() / "streamed.csv");
    for (std::size_t at = 0, piece = 1; at < rows.size(); at += piece, piece = piece % 5000 + 613) {
        piece = std::min(piece, rows.size() - at);
        stream.append(std::span(rows).subspan(at, piece));
    }
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "streamed.csv"));
    stream.finish();
    EXPECT_EQ(test::content_of(folder.path() / "streamed.csv"), test::content_of(folder.path() / "whole.csv"));
}

TEST(SolutionStreamThreads, LeavesNothingWithoutItsEnd) {
    const test::TemporaryFolder folder("stream_left");
    {
        SolutionStream stream(folder.path() / "solution.csv");
        stream.append(some_rows(30'000));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(SolutionStreamThreads, AFullDiskIsAnErrorOfTheCallerNotOfTheThread) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
    const std::vector<SolutionRow> rows = some_rows(100'000);
    const auto write = [&] {
        SolutionStream stream("/dev/full");
        for (int i = 0; i < 4; ++i) stream.append(rows);
        stream.finish();
    };
    EXPECT_THROW(write(), Error);
}

}  // namespace
}  // namespace schuler::report
