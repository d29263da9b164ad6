// A damaged run.h5 on the command line: it is read, or refused in a sentence; the HDF5 library does not take the program with it.
#include "schuler/core/error.h"
#include "schuler/core/log.h"
#include "schuler/io/container/hdf5_file.h"
#include "schuler/io/formats.h"

#include "io/io_fixture.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <random>
#include <string>
#include <vector>

namespace schuler::io {
namespace {

class DamagedHdf5 : public test::IoTest {};

/// As `run` writes them: solution and reference with all tables, attributes of every one.
void write_run(const std::filesystem::path& file) {
    Hdf5Writer out(file);
    constexpr std::size_t rows = 300;
    std::vector<std::int64_t> ns;
    for (std::size_t i = 0; i < rows; ++i) ns.push_back(static_cast<std::int64_t>(i) * 10'000'000);
    for (const std::string group : {"/solution/", "/forward/", "/reference/"}) {
        out.integers(group + "time_ns", ns, {{"units", "ns"}});
        for (const char* table : {"position", "velocity", "attitude", "std_position", "std_velocity", "std_attitude"})
            out.table(group + table, std::vector<double>(3 * rows, 1.5), 3, {{"columns", "a,b,c"}, {"units", "m,m,m"}});
    }
    out.attribute("/", "name", "run");
    out.commit();
}

/// Exit status of a process that reads the file: 0 read, 1 refused, 2 another exception; 100 and a signal's number where it was ended by one.
int outcome_of_reading(const std::filesystem::path& file) {
    const pid_t child = fork();
    if (child == 0) {
        const rlimit seconds{10, 10}, none{0, 0};
        setrlimit(RLIMIT_CPU, &seconds);
        setrlimit(RLIMIT_CORE, &none);
        for (const int s : {SIGSEGV, SIGABRT, SIGFPE, SIGBUS}) signal(s, SIG_DFL);
        int status = 0;
        try {
            WarningLog warnings;
            (void)format_named("hdf5")->read(TextInput(file), warnings);
        } catch (const Error& e) {
            status =
                e.kind() == ErrorKind::Input && std::string(e.what()).find(file.filename().string()) != std::string::npos ? 1 : 2;
        } catch (...) {
            status = 2;
        }
        _exit(status);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 100 + WTERMSIG(status);
}

TEST_F(DamagedHdf5, IsReadOrRefused) {
    const std::filesystem::path whole = folder() / "whole.h5", file = folder() / "damaged.h5";
    write_run(whole);
    ASSERT_EQ(outcome_of_reading(whole), 0);
    const std::string bytes = content_of(whole);
    // half of the places anywhere, half beside what is not zero in the first part: headers of groups and tables
    std::vector<std::size_t> places{707}, headers;
    for (std::size_t i = 0; i < bytes.size() && headers.size() < 20'000; ++i)
        if (bytes[i] != 0 && bytes.compare(i & ~std::size_t{7}, 8, "\0\0\0\0\0\0\xf8\x3f", 8) != 0) headers.push_back(i);
    std::mt19937 random(11);
    for (int k = 0; k < 100; ++k) {
        places.push_back(random() % bytes.size());
        places.push_back(headers[random() % headers.size()]);
    }
    int read = 0, refused = 0;
    for (const std::size_t place : places) {
        for (const char change : {'\xff', '\x01'}) {
            std::string damaged = bytes;
            damaged[place] = static_cast<char>(damaged[place] ^ change);
            std::ofstream(file, std::ios::binary) << damaged;
            const int outcome = outcome_of_reading(file);
            ASSERT_LE(outcome, 1) << "byte " << place << " changed by " << int{change};
            ++(outcome == 0 ? read : refused);
        }
    }
    for (const std::size_t size : {std::size_t{0}, std::size_t{8}, std::size_t{700}, bytes.size() / 2, bytes.size() - 1}) {
        std::ofstream(file, std::ios::binary) << bytes.substr(0, size);
        EXPECT_EQ(outcome_of_reading(file), 1) << "cut at " << size;
    }
    std::printf("%d read, %d refused\n", read, refused);
    EXPECT_GT(refused, 20) << "few of the changes matter";
}

}  // namespace
}  // namespace schuler::io
