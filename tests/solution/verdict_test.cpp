// The word that follows from what is known of a run.
#include "schuler/solution/verdict.h"

#include <gtest/gtest.h>

namespace schuler::solution {
namespace {

TEST(Verdict, TheGravestConcernDecides) {
    const Concern good{"evidence.self_check", "covered"}, note{"gnss.std", "defaults"}, care{"imu.hole", "a hole"},
        bad{"gnss.rejected", "refused"};
    EXPECT_EQ(word_of(verdict_of({good, note}).word), "trustworthy");
    EXPECT_EQ(verdict_of({good, note}).reasons, std::vector<std::string>{"covered"});
    EXPECT_EQ(word_of(verdict_of({good, care}).word), "care");
    const SolutionVerdict worst = verdict_of({care, good, bad, note});
    EXPECT_EQ(word_of(worst.word), "do not use");
    EXPECT_EQ(worst.reasons, (std::vector<std::string>{"refused", "a hole"}));
    EXPECT_EQ(line_of(worst), "do not use: refused; a hole");
}

// Silence is no evidence.
TEST(Verdict, NothingIsTrustedWithoutEvidence) {
    EXPECT_EQ(verdict_of({}).word, Gravity::Care);
    EXPECT_EQ(verdict_of({{"gnss.std", "defaults"}}).word, Gravity::Care);
    EXPECT_FALSE(verdict_of({}).reasons.empty());
}

TEST(Verdict, TopicsAreFoundByWhatTheyBeginWith) {
    EXPECT_EQ(gravity_of("ranges.fault.G05"), Gravity::Care);
    EXPECT_EQ(gravity_of("contradiction.imu.axes"), Gravity::Care);
    EXPECT_EQ(gravity_of("self_check.widened"), Gravity::None);
    EXPECT_EQ(gravity_of("a file: something was taken with a grain of salt"), Gravity::None);
    EXPECT_EQ(words_of(Gravity::Care), "usable with care");
}

}  // namespace
}  // namespace schuler::solution
