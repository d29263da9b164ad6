// Steps that the filter was not told of, in the innovations: made by hand, and of a whole survey.
#include "schuler/gravimetry/innovation_runs.h"

#include "gravimetry/prepared_survey.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

namespace schuler::gravimetry {
namespace {

using filter::MeasurementKind;
using filter::MeasurementRecord;
using filter::MeasurementStatus;

/// `n` independent innovations of unit variance a channel; the down position has `mean` in [begin, end).
std::vector<MeasurementRecord> innovations(std::size_t n, std::uint64_t seed, double mean, std::size_t begin,
                                           std::size_t end = SIZE_MAX) {
    math::Random random(seed, "innovations");
    std::vector<MeasurementRecord> out;
    for (std::size_t i = 0; i < n; ++i) {
        for (const MeasurementKind kind : {MeasurementKind::GnssPosition, MeasurementKind::GnssVelocity}) {
            MeasurementRecord a{};
            a.time = Time{static_cast<std::int64_t>(i) * 1'000'000'000};
            a.kind = kind;
            a.status = MeasurementStatus::Accepted;
            a.dof = 3;
            a.sigma.setConstant(2.0);
            a.innovation = 2.0 * random.normal3();
            if (kind == MeasurementKind::GnssPosition && i >= begin && i < end) a.innovation.z() += 2.0 * mean;
            out.push_back(a);
        }
    }
    return out;
}

TEST(InnovationRuns, OfAConsistentFilterAreSeldomCalledBiased) {
    int called = 0;
    constexpr int surveys = 1000;
    for (int seed = 1; seed <= surveys; ++seed) {
        const InnovationRun run = most_biased_run(innovations(600, static_cast<std::uint64_t>(seed), 0.0, 0), Time{0});
        EXPECT_GT(run.tests, 100U);
        called += run.significant() ? 1 : 0;
    }
    // one expected at most (Bonferroni); five or more of a Poisson number with mean one: 4e-3
    EXPECT_LT(called, 5);
}

TEST(InnovationRuns, NameTheChannelAndTheTime) {
    const InnovationRun run = most_biased_run(innovations(1000, 7, 1.0, 640, 704), Time{0});
    EXPECT_TRUE(run.significant());
    EXPECT_EQ(run.kind, MeasurementKind::GnssPosition);
    EXPECT_EQ(run.axis, 2);
    EXPECT_GE(run.from.ns, 576'000'000'000);
    EXPECT_LE(run.to.ns, 768'000'000'000);
    EXPECT_FALSE(run.throughout);
    // neither what comes before the filter has settled, nor refused fixes
    EXPECT_FALSE(most_biased_run(innovations(600, 7, 5.0, 0), Time{601'000'000'000}).significant());
    std::vector<MeasurementRecord> refused = innovations(600, 7, 5.0, 0);
    for (MeasurementRecord& a : refused) a.status = MeasurementStatus::Rejected;
    EXPECT_EQ(most_biased_run(refused, Time{0}).tests, 0U);
}

/// At rest for 50 min with paper E's instruments; the vertical disturbance steps by half a milligal after half of it.
InnovationRun survey_with_step(bool stepped, bool declared, std::uint64_t seed) {
    sim::Scenario s;
    s.seed = seed;
    s.duration = 3000.0;
    s.path = sim::StaticPath{{55.8114694 * units::deg, 37.4998612 * units::deg, 164.15}};
    s.reference_rate = 1.0;
    s.imu.rate = 2.0;
    s.imu.errors.gyro_turn_on_bias = 4.8e-8;
    s.imu.errors.gyro_noise = 4.8e-8 / std::sqrt(2.0);
    s.imu.errors.accel_turn_on_bias = 1e-6;
    s.imu.errors.accel_noise = 1e-6 / std::sqrt(2.0);
    s.gnss.white_position.setConstant(0.05);
    s.gnss.white_velocity.setConstant(0.05);
    constexpr double middle = 1500.0;
    if (stepped) s.anomaly = {{sim::AnomalyPart::Kind::Step, {0.0, 0.0, 0.5 * units::mgal}, middle, 1.0, true}};
    test::Beliefs b;
    b.settings.imu.errors = s.imu.errors;
    const sim::SimulatedData data = sim::simulate(s);
    const NavState nav = test::erring_start(s, data, b);
    const test::Prepared survey(s, data, b, nav);
    SurveyOptions options{.smooth = false};
    if (declared) options.steps = {nav.time + Duration::from_seconds(middle)};
    return most_biased_run(survey.run(options).measurements, nav.time + Duration::from_seconds(300.0));
}

TEST(InnovationRuns, ShowAStepThatTheFilterWasNotToldOf) {
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const InnovationRun untold = survey_with_step(true, false, seed);
        EXPECT_TRUE(untold.significant()) << untold.probability;
        EXPECT_EQ(untold.axis, 2);
        EXPECT_FALSE(survey_with_step(true, true, seed).significant()) << seed;
        EXPECT_FALSE(survey_with_step(false, false, seed).significant()) << seed;
    }
}

}  // namespace
}  // namespace schuler::gravimetry
