// What speaks against a solution.
#include "schuler/solution/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace schuler::solution {
namespace {

using fusion::MeasurementKind;
using fusion::MeasurementStatus;

bool contradicted(MeasurementKind kind, int accepted, int refused, int withheld = 0) {
    ResultBundle b;
    b.result.counters.gnss_accepted = 100;
    const auto put = [&](int count, MeasurementStatus status) {
        for (int i = 0; i < count; ++i) {
            fusion::MeasurementRecord r;
            r.kind = kind;
            r.status = status;
            b.result.measurements.push_back(r);
        }
    };
    put(accepted, MeasurementStatus::Accepted);
    put(refused, MeasurementStatus::Rejected);
    put(withheld, MeasurementStatus::Withheld);
    const std::vector<Concern> concerns = evidence_of(b, {});
    return std::ranges::find(concerns, "instrument.refused", &Concern::id) != concerns.end();
}

/// A heading that is always refused leaves open whether the instrument or the solution is wrong.
TEST(Evidence, AnInstrumentThatIsMostlyRefusedContradicts) {
    for (const MeasurementKind kind :
         {MeasurementKind::Heading, MeasurementKind::Mag, MeasurementKind::Baro, MeasurementKind::Odometer}) {
        EXPECT_TRUE(contradicted(kind, 0, 38));
        EXPECT_TRUE(contradicted(kind, 18, 20));
        EXPECT_FALSE(contradicted(kind, 20, 18));
        EXPECT_FALSE(contradicted(kind, 0, 9));
        EXPECT_FALSE(contradicted(kind, 20, 18, 40));
    }
    EXPECT_FALSE(contradicted(MeasurementKind::Nonholonomic, 0, 38));  // a constraint of the vehicle is no instrument
    EXPECT_EQ(gravity_of("instrument.refused"), Gravity::Care);
}

/// Fixes every second with a silence from 30 s on; the first one after it moves the position, which is known to a metre then.
bool doubted_after(double silence, double moved, MeasurementStatus in_silence = MeasurementStatus::Excluded) {
    ResultBundle b;
    b.result.counters.gnss_accepted = 100;
    for (int t = 0; t <= 100; ++t) {
        SolutionRow row;
        row.time = Time::from_seconds(t);
        row.std_position.setConstant(1.0);
        b.result.forward.rows.push_back(row);
        fusion::MeasurementRecord r;
        r.kind = MeasurementKind::GnssPosition;
        r.time = r.stamp = row.time;
        r.sigma.setConstant(20.0);
        r.status = MeasurementStatus::Accepted;
        const bool silent = t > 30 && t < 30.0 + silence;
        if (silent && in_silence == MeasurementStatus::Excluded) continue;
        if (silent) r.status = in_silence;
        if (t > 30) r.innovation.x() = t < 31.0 + silence ? moved : 0.1;
        b.result.measurements.push_back(r);
    }
    const std::vector<Concern> concerns = evidence_of(b, {});
    return std::ranges::find(concerns, "gnss.found_again", &Concern::id) != concerns.end();
}

TEST(Evidence, AFixThatNothingForetoldIsDoubted) {
    EXPECT_TRUE(doubted_after(15.0, 20.0));
    EXPECT_FALSE(doubted_after(15.0, 4.0));                                // within what the solution claims
    EXPECT_FALSE(doubted_after(3.0, 20.0));                                // hardly silent
    EXPECT_FALSE(doubted_after(15.0, 20.0, MeasurementStatus::Withheld));  // by the user, who has the fixes
    EXPECT_EQ(gravity_of("gnss.found_again"), Gravity::Care);
}

/// The concern that a self-check leads to, all of whose epochs and windows are inside, with this noise in force.
std::string concern_of_self_check(double noise, bool in_force, double error = 1.0) {
    ResultBundle b;
    b.self_check.emplace();
    b.self_check->length = 15.0;
    b.self_check->tried = NoiseScale{.gyro = 1.0, .accel = noise};
    b.self_check->widened = in_force;
    Coverage& c = b.self_check->coverage;
    c.epochs = c.horizontal = c.vertical = {.epochs = 200, .inside = 200};
    c.windows = c.held = {.epochs = 20, .inside = 20};
    c.end_rms = error;
    c.sigma_rms = 1.0;
    for (const Concern& concern : evidence_of(b, {}))
        if (concern.id.starts_with("self_check") || concern.id == "evidence.self_check") return concern.id;
    return {};
}

/// Noise that was increased as far as allowed may still be too small, however few windows show it.
TEST(Evidence, NoiseAtItsLimitIsAReasonForCare) {
    EXPECT_EQ(concern_of_self_check(NoiseScale::most, true), "self_check.low");
    EXPECT_EQ(concern_of_self_check(9.0, true), "evidence.self_check");
    EXPECT_EQ(concern_of_self_check(NoiseScale::most, false), "evidence.self_check");  // tried, and not needed
    EXPECT_EQ(concern_of_self_check(1.0, false, 2.5), "self_check.growth");
    EXPECT_EQ(gravity_of("self_check.low"), Gravity::Care);
}

}  // namespace
}  // namespace schuler::solution
