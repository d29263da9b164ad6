// Slips of several phases at once: what is said to be continuous is continuous, or nothing is said.
#include "schuler/ppk/phase_steps.h"

#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <set>

namespace schuler::ppk {
namespace {

constexpr double wavelength = 0.1903, noise = 0.003;

/// An epoch of one receiver with one phase of each satellite, some of which have slipped by whole cycles.
struct MadeUpSteps {
    std::vector<PhaseStep> steps;
    std::vector<int> slips;

    MadeUpSteps(math::Random& random, std::size_t satellites, std::size_t slipped, bool all_alike, double doppler) {
        const Eigen::Vector3d displacement = 5.0 * random.normal3(), unforeseen = 0.3 * doppler * random.normal3();
        const double clock = 100.0 * random.normal();
        for (std::size_t i = 0; i < satellites; ++i) {
            Eigen::Vector3d u = random.normal3().normalized();
            u.z() = std::abs(u.z()) + 0.1;
            u.normalize();
            int slip = 0;
            if (i < slipped)
                slip = all_alike ? 1 : (random.uniform() < 0.5 ? -1 : 1) * (1 + static_cast<int>(3.0 * random.uniform()));
            const double error = noise * random.normal() + wavelength * slip;
            steps.push_back({i, u.dot(displacement) + clock + error, u, noise, 0.02 + 6.0 * noise,
                             u.dot(unforeseen) + 0.2 * clock + doppler * random.normal() + error});
            slips.push_back(slip);
        }
    }
    [[nodiscard]] std::vector<char> all() const { return std::vector<char>(steps.size(), 1); }
};

struct Tally {
    int cases = 0, undecided = 0, wrong = 0;
};

/// `doppler`: m, error of the mean of two Dopplers over the interval.
Tally tally(std::uint64_t seed, std::size_t satellites, std::size_t slipped, bool all_alike, double doppler) {
    math::Random random(seed, "slips");
    PhaseContinuity continuity;
    for (int i = 0; i < 60; ++i) {
        const MadeUpSteps quiet(random, satellites, 0, false, doppler);
        EXPECT_EQ(continuity.kept(quiet.steps, 1.0), quiet.all());
    }
    Tally t;
    for (int i = 0; i < 60; ++i) {
        const MadeUpSteps epoch(random, satellites, slipped, all_alike, doppler);
        const auto inside = *continuity.kept(epoch.steps, 1.0);
        ++t.cases;
        std::set<int> kept;
        for (std::size_t k = 0; k < satellites; ++k)
            if (inside[k] != 0) kept.insert(epoch.slips[k]);
        t.undecided += kept.empty() ? 1 : 0;
        t.wrong += kept.size() > 1 ? 1 : 0;
    }
    return t;
}

TEST(PhaseSteps, WithoutSlipsNothingIsLost) {
    for (const std::size_t satellites : {6U, 9U, 18U}) EXPECT_EQ(tally(3, satellites, 0, false, 0.05).undecided, 0);
}

TEST(PhaseSteps, WhatIsKeptHasNotSlipped) {
    // by least absolute residuals a seventh (18 satellites) to four fifths (8 that slip alike) are wrong
    for (const std::size_t satellites : {8U, 13U, 18U})
        for (const double doppler : {0.01, 0.3})
            for (const bool all_alike : {false, true}) {
                Tally sum;
                for (std::size_t slipped = 1; slipped <= satellites / 2; ++slipped) {
                    const Tally t = tally(17 + slipped, satellites, slipped, all_alike, doppler);
                    sum.cases += t.cases, sum.wrong += t.wrong;
                }
                // several of eight that slip alike leave too little to tell them by
                EXPECT_LE(sum.wrong, sum.cases / (satellites > 8 ? 60 : 20)) << satellites << ' ' << doppler << ' ' << all_alike;
            }
}

TEST(PhaseSteps, GoodDopplersAndManySatellitesDecide) {
    EXPECT_LE(tally(5, 13, 1, false, 0.3).undecided, 3);
    EXPECT_LE(tally(5, 13, 5, false, 0.01).undecided, 12);  // of sixty
    EXPECT_LE(tally(5, 8, 1, false, 0.01).undecided, 5);
    EXPECT_GE(tally(5, 8, 3, true, 1.0).undecided, 48);
}

}  // namespace
}  // namespace schuler::ppk
