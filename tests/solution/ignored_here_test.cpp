// What a command line asks for in vain is told first and in full, whatever a file says in vain.
#include "schuler/solution/ignored_here.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace schuler::solution {
namespace {

settings::SettingList typed(std::initializer_list<const char*> keys) {
    settings::SettingList out;
    for (const char* key : keys) out.push_back({key, {true}, {}});
    return out;
}

TEST(IgnoredHere, KeysOfTheCommandLineComeFirstAndAllOfThem) {
    const std::string reason = "there is no filter";
    std::vector<Ignored> ignored;
    for (const char* key : {"baro.a", "baro.b", "baro.c", "baro.d", "baro.e", "filter.loop", "filter.smooth", "mag.use", "mag.x",
                            "vehicle.kind", "zero.use"})
        ignored.push_back({key, reason});
    WarningLog warnings;
    warn_of_ignored_here(ignored, typed({"filter.loop", "zero.use", "filter.smooth", "mag.use", "vehicle.kind", "imu.grade"}),
                         warnings);
    EXPECT_THAT(
        warnings.summary(),
        testing::ElementsAre("filter.loop is given and has no effect: there is no filter",
                             "filter.smooth is given and has no effect: there is no filter",
                             "mag.use is given and has no effect: there is no filter",
                             "vehicle.kind is given and has no effect: there is no filter",
                             "zero.use is given and has no effect: there is no filter",
                             "baro.a, baro.b, baro.c, baro.d and 2 more are given and have no effect: there is no filter"));
}

TEST(IgnoredHere, ASelfCheckThatIsNotMadeIsTold) {
    std::vector<Ignored> ignored;
    add_unmade_check(ignored, typed({"filter.loop"}));
    EXPECT_TRUE(ignored.empty());
    for (int twice = 0; twice < 2; ++twice) add_unmade_check(ignored, typed({"filter.self_check"}));
    ASSERT_EQ(ignored.size(), 1u);
    EXPECT_EQ(ignored.front().key, "filter.self_check");
}

}  // namespace
}  // namespace schuler::solution
