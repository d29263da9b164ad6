#include "schuler/core/error.h"
#include "schuler/core/log.h"

#include <gtest/gtest.h>

#include <string>

namespace schuler {
namespace {

TEST(Error, OneLineWithPlaceAndRemedy) {
    const Error e = input_error("not a number: \"x\"", {"imu.csv", 7, 0, "gyro_x"}, "remove the row");
    EXPECT_EQ(e.kind(), ErrorKind::Input);
    EXPECT_STREQ(e.what(), "imu.csv:7: gyro_x: not a number: \"x\"; remove the row");
    EXPECT_EQ(e.reason(), "not a number: \"x\"");
    EXPECT_EQ(e.hint(), "remove the row");
    EXPECT_EQ(e.place().line, 7);
}

TEST(Error, PartsThatAreUnknownAreLeftOut) {
    EXPECT_STREQ(input_error("empty").what(), "empty");
    EXPECT_STREQ(input_error("empty", {"a.csv"}).what(), "a.csv: empty");
    const Error e = computation_error("no fix", "look at the sky");
    EXPECT_EQ(e.kind(), ErrorKind::Computation);
    EXPECT_STREQ(e.what(), "no fix; look at the sky");
}

TEST(WarningLog, OncePerTopicWithItsCount) {
    WarningLog log;
    EXPECT_TRUE(log.empty());
    log.add("b", "first of b");
    log.add("a", "only a");
    log.add("b", "second of b", 3);
    EXPECT_EQ(log.count("b"), 4u);
    EXPECT_EQ(log.count("c"), 0u);
    ASSERT_EQ(log.topics(), (std::vector<std::string>{"b", "a"}));
    EXPECT_EQ(log.summary().front(), "first of b (4 times)");
    EXPECT_EQ(log.summary().back(), "only a");
}

}  // namespace
}  // namespace schuler
