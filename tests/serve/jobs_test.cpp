#include "serve/jobs.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <string>
#include <thread>

namespace schuler::serve {
namespace {

JobOrder shell(const std::string& id, const std::string& script) {
    JobOrder order;
    order.id = id;
    order.program = "/bin/sh";
    order.arguments = {"-c", script};
    return order;
}

/// "do not use" is exit status 1: the result is there all the same, and is shown with its reasons.
TEST(Jobs, AResultNotToBeUsedIsDone) {
    const test::TemporaryFolder folder("results");
    Jobs jobs(2);
    const auto ends = [&](const std::string& id, const std::string& script, const std::filesystem::path& result, bool keep) {
        JobOrder order = shell(id, script);
        order.result = result;
        order.keep_output = keep;
        order.confinement.writable = {folder.path()};
        EXPECT_TRUE(jobs.start(std::move(order)));
        return jobs.wait(id).state;
    };
    const std::filesystem::path file = folder.path() / "summary.json";
    EXPECT_EQ(ends("none", "exit 1", file, false), JobState::Failed);
    EXPECT_EQ(ends("written", "echo {} >'" + file.string() + "'; exit 1", file, false), JobState::Done);
    EXPECT_EQ(ends("unusable input", "exit 2", file, false), JobState::Failed) << "though the file is there";
    EXPECT_EQ(ends("printed", "echo {}; exit 1", {}, true), JobState::Done);
    EXPECT_EQ(ends("nothing printed", "exit 1", {}, true), JobState::Failed);
}

TEST(Jobs, StageAndTimeOfAJobAreTold) {
    Jobs jobs(1);
    ASSERT_TRUE(jobs.start(shell(
        "one", "echo stage filtering >&2; echo 'stage of an unknown kind' >&2; sleep 0.4; echo progress 0.5 >&2; sleep 60")));
    std::uint64_t version = 0;
    JobReport last;
    for (int i = 0; i < 100 && last.progress == 0.0; ++i)
        for (const JobReport& r : jobs.changes(version)) last = r;
    EXPECT_EQ(last.stage, "filtering");
    EXPECT_EQ(last.progress, 0.5);
    EXPECT_GE(last.spent_s, 0.4) << "from the start of the process, whoever asks";
    EXPECT_LT(last.spent_s, 30.0);
    EXPECT_GE(jobs.report("one")->spent_s, last.spent_s);
    EXPECT_EQ(jobs.report("one")->log, "stage of an unknown kind\n");
    EXPECT_TRUE(jobs.cancel("one"));
    EXPECT_EQ(jobs.wait("one").state, JobState::Cancelled);
}

TEST(JobsThreads, ManyJobsEndAsTheyShould) {
    std::atomic<int> told{0};
    Jobs jobs(3, [&](const JobReport&) { ++told; });
    std::atomic<bool> over{false};
    std::atomic<int> seen{0};
    std::thread watcher([&] {
        for (std::uint64_t version = 0; !over;) seen += static_cast<int>(jobs.changes(version).size());
    });
    for (int i = 0; i < 12; ++i) {
        const std::string number = std::to_string(i);
        const char* scripts[] = {"echo progress 0.5 >&2; echo line; exit 0", "echo 'schuler: a.csv:3: wrong' >&2; exit 2",
                                 "kill -SEGV $$", "sleep 60"};
        ASSERT_TRUE(jobs.start(shell(number, scripts[i % 4])));
    }
    EXPECT_FALSE(jobs.start(shell("11", "true"))) << "an id at work is not given twice";
    for (int i = 3; i < 12; i += 4) EXPECT_TRUE(jobs.cancel(std::to_string(i)));
    for (int i = 0; i < 12; ++i) {
        const JobReport r = jobs.wait(std::to_string(i));
        const JobState wanted[] = {JobState::Done, JobState::Failed, JobState::Failed, JobState::Cancelled};
        EXPECT_EQ(r.state, wanted[i % 4]) << i << " " << r.message;
        switch (i % 4) {
            case 0: EXPECT_EQ(r.log, "line\n"); break;
            case 1:
                EXPECT_EQ(r.message, "a.csv:3: wrong");
                EXPECT_EQ(r.exit_status, 2);
                break;
            case 2: EXPECT_NE(r.message.find("signal"), std::string::npos) << r.message; break;
            default: break;
        }
    }
    over = true;
    watcher.join();
    EXPECT_GE(told, 9) << "those that were cancelled while they waited have nothing to tell";
    EXPECT_GE(seen, 12);
    EXPECT_TRUE(jobs.forget("0"));
    EXPECT_FALSE(jobs.report("0").has_value());
}

TEST(JobsThreads, OutputIsKeptApartAndTimeIsLimited) {
    Jobs jobs(1);
    JobOrder order = shell("talk", "echo result; echo note >&2");
    order.keep_output = order.aside = true;
    jobs.start(order);
    const JobReport talk = jobs.wait("talk");
    EXPECT_EQ(talk.output, "result\n");
    EXPECT_EQ(talk.log, "note\n");
    std::uint64_t version = 0;
    EXPECT_TRUE(jobs.changes(version).empty()) << "jobs aside are not told to watchers";
    EXPECT_EQ(version, jobs.version()) << "nor do they wake them again and again";
    order = shell("slow", "sleep 60");
    order.limit_s = 0.2;
    jobs.start(order);
    EXPECT_EQ(jobs.wait("slow").message, "took too long and was ended");
}

TEST(Confine, TheChildReadsAndWritesOnlyItsFolders) {
    if (!can_confine()) GTEST_SKIP() << "this kernel has no Landlock";
    const test::TemporaryFolder folder("confine");
    for (const char* name : {"in", "out", "else"}) std::filesystem::create_directory(folder.path() / name);
    std::ofstream(folder.path() / "in/a") << "a";
    std::ofstream(folder.path() / "else/b") << "secret";
    const std::string root = folder.path().string();
    Jobs jobs(1);
    const auto state = [&](const std::string& script) {
        JobOrder order = shell("x", "cd /; " + script);
        order.confinement = {{folder.path() / "in"}, {folder.path() / "out"}};
        jobs.start(order);
        return jobs.wait("x").state;
    };
    EXPECT_EQ(state("cat " + root + "/in/a"), JobState::Done);
    EXPECT_EQ(state("echo x > " + root + "/out/c && mv " + root + "/out/c " + root + "/out/d"), JobState::Done);
    EXPECT_EQ(state("cat " + root + "/else/b"), JobState::Failed);
    EXPECT_EQ(state("echo x > " + root + "/in/c"), JobState::Failed);
    EXPECT_EQ(state("echo x > " + root + "/else/c"), JobState::Failed);
    EXPECT_EQ(state("ls /etc"), JobState::Failed);
}

}  // namespace
}  // namespace schuler::serve
