// Results appear together: whatever is killed, where the last file is, all others are of the same result, and none of another.
#include "schuler/io/staged_folder.h"

#include "schuler/core/error.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/own_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <system_error>

namespace schuler::io {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::Pair;
using Contents = std::map<std::string, std::string>;

class Staged : public ::testing::Test {
protected:
    Staged() { fs::create_directories(folder); }
    ~Staged() override { fs::remove_all(folder); }

    void publish(const Contents& files, const std::string& last = "summary.json") const {
        StagedFolder stage(folder);
        for (const auto& [name, text] : files) write_file(stage.path() / name, text);
        stage.publish(last);
    }
    [[nodiscard]] Contents now() const {
        Contents out;
        for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
            const std::string name = entry.path().filename().string();
            if (!entry.is_regular_file() || name.front() == '.') continue;
            std::ifstream in(entry.path());
            out[name] = {std::istreambuf_iterator<char>(in), {}};
        }
        return out;
    }

    const fs::path folder = fs::temp_directory_path() / ("schuler-staged-" + std::to_string(getpid()));
};

TEST_F(Staged, TheOlderResultGoesWithAllItsFiles) {
    publish({{"solution.csv", "1"}, {"states.csv", "1"}, {"report.html", "1"}, {"summary.json", "1"}});
    publish({{"solution.csv", "2"}, {"summary.json", "2"}});
    EXPECT_THAT(now(), ElementsAre(Pair("solution.csv", "2"), Pair("summary.json", "2")));
    publish({{"solution.csv", "3"}});
    EXPECT_THAT(now(), ElementsAre(Pair("solution.csv", "3"))) << "a result without a summary leaves no other's";
}

TEST_F(Staged, FilesOfTheUserAndOfOtherKindsStay) {
    publish({{"imu.csv", "log"}, {"dataset.toml", "d"}}, "dataset.toml");
    publish({{"report.html", "1"}, {"states.csv", "1"}, {"summary.json", "1"}});
    std::ofstream(folder / "notes.txt") << "mine";
    std::ofstream(folder / "report.html") << "mine now";
    publish({{"solution.csv", "2"}, {"summary.json", "2"}});
    EXPECT_THAT(now(), ElementsAre(Pair("dataset.toml", "d"), Pair("imu.csv", "log"), Pair("notes.txt", "mine"),
                                   Pair("report.html", "mine now"), Pair("solution.csv", "2"), Pair("summary.json", "2")));
    std::ofstream(folder / "solution.csv") << "mine too";
    EXPECT_THROW(publish({{"solution.csv", "3"}, {"summary.json", "3"}}), Error);
    EXPECT_EQ(now().at("summary.json"), "2") << "nothing is removed where something is refused";
    publish({{"imu.csv", "log 2"}, {"dataset.toml", "d2"}}, "dataset.toml");
    EXPECT_EQ(now().at("imu.csv"), "log 2");
}

TEST_F(Staged, FilesThatAreNoResultComeBesideIt) {
    publish({{"solution.csv", "1"}, {"summary.json", "1"}});
    publish({{"report.html", "of inspect"}}, "");
    EXPECT_THAT(now(), ElementsAre(Pair("report.html", "of inspect"), Pair("solution.csv", "1"), Pair("summary.json", "1")));
}

/// Results in turn: of every third there are other files, and all files of one hold its number.
[[noreturn]] void publish_without_end(const fs::path& folder, int first) {
    for (int number = first;; ++number) {
        StagedFolder stage(folder);
        const std::string text = std::to_string(number);
        for (int k = 0; k < 6; ++k)
            write_file(stage.path() / ("part" + std::to_string(k) + "-" + std::to_string(number % 3) + ".csv"), text);
        write_file(stage.path() / "solution.csv", text);
        write_file(stage.path() / "summary.json", text);
        stage.publish();
    }
}

TEST_F(Staged, KilledAnywhereItLeavesNoMixture) {
    using Clock = std::chrono::steady_clock;
    std::mt19937 random(5);
    std::uniform_int_distribution<int> microseconds(0, 1500);
    const auto list_size = [&] {
        std::error_code ec;
        const auto size = fs::file_size(folder / own_files_list, ec);
        return ec ? 0 : size;
    };
    int whole = 0, unfinished = 0;
    for (int kill_number = 0; kill_number < 120; ++kill_number) {
        // a complete older result, of other names than the next one
        Contents older{{"solution.csv", "older"}, {"summary.json", "older"}};
        for (int k = 0; k < 6; ++k) older["part" + std::to_string(k) + "-older.csv"] = "older";
        publish(older);
        const auto before = list_size();
        const pid_t child = fork();
        ASSERT_GE(child, 0);
        if (child == 0) {
            try {
                publish_without_end(folder, 1000 * (kill_number + 1));
            } catch (...) {
                _exit(1);
            }
        }
        // The list grows when the moving begins: most kills elsewhere would hit the writing, where nothing can be seen. Not slept: too coarse.
        while (list_size() == before && waitpid(child, nullptr, WNOHANG) == 0) {}
        const auto until = Clock::now() + std::chrono::microseconds(microseconds(random));
        while (Clock::now() < until) {}
        kill(child, SIGKILL);
        int status = 0;
        ASSERT_EQ(waitpid(child, &status, 0), child) << "it refuses what the one before left";
        ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL);
        const Contents files = now();
        if (!files.contains("summary.json")) {
            ++unfinished;
            continue;
        }
        ++whole;
        const std::string& number = files.at("summary.json");
        EXPECT_EQ(files.size(), 8U) << number;
        for (const auto& [name, text] : files) EXPECT_EQ(text, number) << name;
        if (HasFailure()) return;
    }
    std::printf("%d kills left a whole result, %d none\n", whole, unfinished);
    EXPECT_GT(unfinished, 20) << "few kills came while files were moved";
    // what was left behind is in nobody's way
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
        if (entry.is_directory()) fs::remove_all(entry.path());
    publish({{"solution.csv", "end"}, {"summary.json", "end"}});
    EXPECT_THAT(now(), ElementsAre(Pair("solution.csv", "end"), Pair("summary.json", "end")));
}

}  // namespace
}  // namespace schuler::io
