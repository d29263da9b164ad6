// Which of several receivers is the one to be located.
#include "schuler/dataset/raw_observations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

std::string header_line(const std::string& text, const std::string& label) {
    std::string line = text;
    line.resize(60, ' ');
    return line + label + "\n";
}

class RawObservationsTest : public testing::Test {
protected:
    void SetUp() override {
        folder_ = fs::path(testing::TempDir()) /
                  (std::string("schuler_raw_") + testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::remove_all(folder_);
        fs::create_directories(folder_);
        std::ofstream(folder_ / "day.nav") << header_line("     3.04           N: GNSS NAV DATA    G: GPS",
                                                          "RINEX VERSION / TYPE");
    }
    void TearDown() override { fs::remove_all(folder_); }

    void observations(const std::string& name, const std::string& marker_type = {}) const {
        std::ofstream out(folder_ / name);
        out << header_line("     3.04           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE");
        if (!marker_type.empty()) out << header_line(marker_type, "MARKER TYPE");
        out << header_line("", "END OF HEADER");
    }
    [[nodiscard]] std::string taken() const {
        const RawObservations raw = raw_observations(folder_);
        const auto it = std::ranges::find(raw.facts, "gnss.observations", &Fact::key);
        return it == raw.facts.end() ? "(none)" : to_text(it->value);
    }

    fs::path folder_;
};

TEST_F(RawObservationsTest, TheHeaderSaysWhichOneMoves) {
    observations("a.obs", "GEODETIC");
    observations("b.obs", "AIRBORNE");
    EXPECT_EQ(taken(), "\"b.obs\"");
}

TEST_F(RawObservationsTest, ElseTheNameDoes) {
    observations("base.obs");
    observations("rover.obs");
    EXPECT_EQ(taken(), "\"rover.obs\"");
}

TEST_F(RawObservationsTest, ElseTheFirstIsTakenAndTheOthersAreNamed) {
    observations("0759.obs");
    observations("3040.obs");
    EXPECT_EQ(taken(), "\"0759.obs\"");
    EXPECT_NE(raw_observations(folder_).dataset_toml.find("# or observations = \"3040.obs\""), std::string::npos);
    EXPECT_NE(raw_observations(folder_).dataset_toml.find("# [base]\n# observations = \"3040.obs\""), std::string::npos);
}

TEST_F(RawObservationsTest, NothingWithoutEphemerides) {
    fs::remove(folder_ / "day.nav");
    observations("rover.obs");
    EXPECT_EQ(taken(), "(none)");
}

}  // namespace
}  // namespace schuler::dataset
