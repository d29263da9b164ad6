// Paper D's experiments over geometries and seeds against the reference simulation (math.md 5.5).
#include "schuler/study/triad/triad.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

namespace schuler::study {
namespace {

/// The predicted errors depend on geometry alone and must agree closely; the observed ones within what 48 runs can tell. Slow: 48
/// runs of each case.
TEST(TriadSlow, AgreesWithTheReferenceSimulation) {
    struct Expected {
        double predicted, end;
    };
    const std::map<std::string, Expected> cases{
        {"a 4 SV nav", {2.614, 2.3}},        {"b 3 SV nav", {14.00, 18.0}},      {"c 2 SV nav", {29.36, 49.0}},
        {"d 4 stations nav", {4.977, 5.7}},  {"e 2 SV+2 st. nav", {7.520, 8.3}}, {"e stations on at 300 s nav", {8.651, 8.8}},
        {"f all in view nav", {2.166, 1.9}}, {"c 2 SV tac", {157.3, 253.0}},     {"e stations on at 300 s tac", {16.92, 9.8}}};
    std::map<std::string, TriadStatistics> found;
    for (const TriadCase& which : triad_cases()) {
        const auto expected = cases.find(which.name);
        if (expected == cases.end()) continue;
        std::vector<TriadRun> runs;
        for (std::size_t k = 0; k < 48; ++k) runs.push_back(run_triad(which, k, 1));
        const TriadStatistics s = found[which.name] = statistics_of(runs);
        EXPECT_NEAR(s.predicted, expected->second.predicted, 0.03 * expected->second.predicted) << which.name;
        EXPECT_NEAR(s.pooled, s.predicted, 0.2 * s.predicted) << which.name;
        EXPECT_GT(s.nees3, 0.78) << which.name;
        EXPECT_LT(s.nees3, 1.24) << which.name;
        EXPECT_GT(s.nees9, 0.87) << which.name;
        EXPECT_LT(s.nees9, 1.14) << which.name;
    }
    ASSERT_EQ(found.size(), cases.size());
    const auto pooled = [&](const char* name) { return found.at(name).pooled; };
    EXPECT_LE(pooled("f all in view nav"), pooled("a 4 SV nav"));
    EXPECT_LT(pooled("a 4 SV nav"), pooled("e 2 SV+2 st. nav"));
    EXPECT_LT(pooled("e 2 SV+2 st. nav"), pooled("b 3 SV nav"));
    EXPECT_LT(pooled("b 3 SV nav"), pooled("c 2 SV nav"));
    const double ratio = found.at("c 2 SV nav").end / found.at("e 2 SV+2 st. nav").end;
    EXPECT_GT(ratio, 3.5);
    EXPECT_LT(ratio, 7.5);
    const TriadStatistics& on = found.at("e stations on at 300 s nav");
    EXPECT_LT(on.at_330, on.at_300 / 1.5);
}

/// Runs whose horizontal errors stay the same have closed forms: with one set geometries scatter, with several only noise does.
TEST(Triad, StandardErrorIsThatOfSamplingTheRunsThatScatter) {
    const auto of = [](double horizontal) {
        TriadRun r{};
        r.horizontal.fill(horizontal);
        return r;
    };
    std::vector<TriadRun> one, two;
    for (std::size_t k = 0; k < triad_geometries; ++k) one.push_back(of(k % 2 == 0 ? 3.0 : 4.0));
    // squares 9 and 16 in equal shares: deviation 3.5, pooled sqrt(12.5); d sqrt(m) = dm / (2 sqrt(m))
    EXPECT_NEAR(standard_error_of_a_set(one), 3.5 / std::sqrt(48.0) / (2.0 * std::sqrt(12.5)), 0.004);
    two = one;
    two.insert(two.end(), one.begin(), one.end());
    EXPECT_LT(standard_error_of_a_set(two), 1e-6) << "both runs of each geometry are alike";
    for (std::size_t k = 0; k < triad_geometries; ++k) two[triad_geometries + k] = of(k % 2 == 0 ? 4.0 : 3.0);
    EXPECT_NEAR(standard_error_of_a_set(two), std::sqrt(2.0) * 3.5 / std::sqrt(48.0) / (2.0 * std::sqrt(12.5)), 0.006);
}

/// The same, quick: four geometries, ordering and prediction of one case.
TEST(Triad, TwoStationsReplaceTwoSatellites) {
    std::vector<TriadRun> without, with;
    for (const TriadCase& which : triad_cases()) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (which.name == "c 2 SV nav") without.push_back(run_triad(which, k, 1));
            if (which.name == "e 2 SV+2 st. nav") with.push_back(run_triad(which, k, 1));
        }
    }
    const TriadStatistics c = statistics_of(without), e = statistics_of(with);
    EXPECT_GT(c.predicted_end, 3.0 * e.predicted_end);
    EXPECT_NEAR(e.predicted, 8.7, 0.3);
    EXPECT_NEAR(c.predicted, 31.2, 0.9);
}

}  // namespace
}  // namespace schuler::study
