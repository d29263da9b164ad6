// Sigmas that a log states and no instrument has.
#include "schuler/dataset/stated_sigmas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace schuler::dataset {
namespace {

Recording of_headings(std::size_t rows, double sigma) {
    Recording r;
    for (std::size_t i = 0; i < rows; ++i) r.heading.push_back({Time::from_seconds(static_cast<double>(i)), 1.0, sigma});
    return r;
}

std::string text_of(const WarningLog& warnings, const std::string& key) {
    const auto it = std::ranges::find(warnings.topics(), key);
    return it == warnings.topics().end() ? std::string()
                                         : warnings.summary()[static_cast<std::size_t>(it - warnings.topics().begin())];
}

TEST(StatedSigmas, ThatNoInstrumentHasAreNoSigmas) {
    Recording r = of_headings(100, 0.01);
    r.heading[3].std = 1e-9;
    r.heading[4].std = 0.0;
    r.heading[5].std = -1.0;
    r.heading[6].std = not_given;
    r.odometer.push_back({Time{}, 10.0, 1e-12});
    r.ranges.samples.resize(2);
    r.ranges.samples[0].std = 1e-9;
    r.ranges.samples[0].std_rate = 1e-9;
    r.ranges.samples[1].std = 0.3;
    r.ranges.samples[1].std_rate = 0.01;
    WarningLog warnings;
    check_stated_sigmas(r, warnings);
    for (const std::size_t i : {3u, 4u, 5u, 6u}) EXPECT_TRUE(std::isnan(r.heading[i].std)) << i;
    EXPECT_EQ(r.heading[7].std, 0.01);
    EXPECT_TRUE(std::isnan(r.odometer[0].std));
    EXPECT_TRUE(std::isnan(r.ranges.samples[0].std) && std::isnan(r.ranges.samples[0].std_rate));
    EXPECT_EQ(r.ranges.samples[1].std, 0.3);
    EXPECT_EQ(r.ranges.samples[1].std_rate, 0.01);
    EXPECT_NE(text_of(warnings, "heading.std").find("3 of 100 headings"), std::string::npos) << text_of(warnings, "heading.std");
    for (const char* key : {"odometer.std", "ranges.std", "ranges.std_rate"}) EXPECT_FALSE(text_of(warnings, key).empty()) << key;
    EXPECT_TRUE(text_of(warnings, "heading.std_low").empty());
}

TEST(StatedSigmas, AFewFarBelowTheOthersDoNotOutweighThem) {
    Recording r = of_headings(1000, 0.01);
    for (std::size_t i = 0; i < 30; ++i) r.heading[i].std = 2e-5;
    WarningLog warnings;
    check_stated_sigmas(r, warnings);
    EXPECT_EQ(r.heading[0].std, 0.005);
    EXPECT_EQ(r.heading[30].std, 0.01);
    EXPECT_NE(text_of(warnings, "heading.std_low").find("30 of 1000 headings"), std::string::npos);
    // a fifth of the log is no exception: two antennas with and without fixed integers
    Recording fixed = of_headings(1000, 0.05);
    for (std::size_t i = 0; i < 200; ++i) fixed.heading[i].std = 0.001;
    WarningLog none;
    check_stated_sigmas(fixed, none);
    EXPECT_EQ(fixed.heading[0].std, 0.001);
    EXPECT_TRUE(none.empty());
}

}  // namespace
}  // namespace schuler::dataset
