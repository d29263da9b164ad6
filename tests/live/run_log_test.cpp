// The log of a live run: standard error by its descriptor, whatever it is; files are started anew.
#include "schuler/live/detail/run_log.h"

#include "schuler/core/error.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>

namespace schuler::live {
namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

/// A folder of its own, gone afterwards.
class LiveLog : public ::testing::Test {
protected:
    LiveLog() { fs::create_directories(folder); }
    ~LiveLog() override { fs::remove_all(folder); }
    fs::path folder = fs::temp_directory_path() / ("schuler-live-log-" + std::to_string(getpid()));
};

/// Standard error is another descriptor during its lifetime.
class InsteadOfStandardError {
public:
    explicit InsteadOfStandardError(int fd) : before_(dup(2)) {
        std::fflush(stderr);
        fd < 0 ? close(2) : dup2(fd, 2);
    }
    ~InsteadOfStandardError() {
        dup2(before_, 2);
        close(before_);
    }
    InsteadOfStandardError(const InsteadOfStandardError&) = delete;
    InsteadOfStandardError& operator=(const InsteadOfStandardError&) = delete;

private:
    int before_;
};

TEST_F(LiveLog, StandardErrorMayBeASocket) {
    int ends[2];
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    {
        const InsteadOfStandardError socket(ends[1]);
        detail::RunLog log("stderr", "live.toml", 0.0);
        log.tell("imu: connected", 0.0);
    }
    close(ends[1]);
    char bytes[64];
    const ssize_t got = read(ends[0], bytes, sizeof bytes);
    EXPECT_EQ(std::string(bytes, static_cast<std::size_t>(std::max<ssize_t>(got, 0))), "imu: connected\n");
    close(ends[0]);
}

TEST_F(LiveLog, StandardErrorIsNotRotated) {
    const fs::path file = folder / "all.txt";
    const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0600);
    ASSERT_GE(fd, 0);
    {
        const InsteadOfStandardError other(fd);
        detail::RunLog log("stderr", "live.toml", 0.0, 100);
        for (int i = 0; i < 50; ++i) log.tell("line " + std::to_string(i), 0.0);
    }
    close(fd);
    const std::string text = text_of(file);
    EXPECT_THAT(text, ::testing::StartsWith("line 0\n"));
    EXPECT_THAT(text, ::testing::EndsWith("line 49\n"));
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
    EXPECT_FALSE(fs::exists("/dev/stderr.1"));
}

/// A journal that reads late: what it does not take at once is queued, and written before the end.
TEST_F(LiveLog, LastLinesReachALateReader) {
    int ends[2];
    ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
    const int small = 4096;
    ASSERT_EQ(setsockopt(ends[1], SOL_SOCKET, SO_SNDBUF, &small, sizeof small), 0);
    std::string heard;
    std::thread reader;
    {
        const InsteadOfStandardError socket(ends[1]);
        detail::RunLog log("stderr", "live.toml", 0.0);
        for (int i = 0; i < 500; ++i) log.tell("line " + std::to_string(i), 0.0);
        reader = std::thread([&] {
            char bytes[4096];
            for (ssize_t got; (got = read(ends[0], bytes, sizeof bytes)) > 0;) heard.append(bytes, static_cast<std::size_t>(got));
        });
    }
    close(ends[1]);
    reader.join();
    close(ends[0]);
    EXPECT_THAT(heard, ::testing::StartsWith("line 0\n"));
    EXPECT_THAT(heard, ::testing::EndsWith("line 499\n"));
    EXPECT_EQ(std::ranges::count(heard, '\n'), 500);
}

TEST_F(LiveLog, AFileIsStartedAnewAndFiveOlderOnesStay) {
    const fs::path file = folder / "live.log";
    detail::RunLog log(file.string(), "live.toml", 0.0, 100);
    for (int i = 100; i < 200; ++i) log.tell("line " + std::to_string(i), 0.0);  // 9 bytes each, 11 a file
    EXPECT_EQ(text_of(file), "line 199\n");
    EXPECT_THAT(text_of(folder / "live.log.1"),
                ::testing::AllOf(::testing::StartsWith("line 188\n"), ::testing::EndsWith("line 198\n")));
    for (int k = 1; k <= 5; ++k) EXPECT_EQ(fs::file_size(folder / ("live.log." + std::to_string(k))), 99U) << k;
    EXPECT_FALSE(fs::exists(folder / "live.log.6"));
}

TEST_F(LiveLog, WhatCannotBeOpenedIsAnError) {
    const auto error_of = [](const std::string& place) -> std::string {
        try {
            detail::RunLog log(place, "live.toml", 0.0);
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::Input);
            return e.what();
        }
        return "";
    };
    EXPECT_THAT(error_of((folder / "missing/live.log").string()),
                ::testing::AllOf(::testing::HasSubstr("live.toml"), ::testing::HasSubstr("live.log"),
                                 ::testing::HasSubstr("No such file")));
    std::string closed;
    {
        const InsteadOfStandardError none(-1);
        closed = error_of("stderr");
    }
    EXPECT_THAT(closed, ::testing::HasSubstr("cannot be opened"));
    EXPECT_EQ(error_of("none"), "");
}

}  // namespace
}  // namespace schuler::live
