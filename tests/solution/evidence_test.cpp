// What speaks against a solution.
#include "schuler/solution/evidence.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace schuler::solution {
namespace {

using fusion::AidKind;
using fusion::AidStatus;

bool contradicted(AidKind kind, int accepted, int refused, int withheld = 0) {
    ResultBundle b;
    b.result.counters.gnss_accepted = 100;
    const auto put = [&](int count, AidStatus status) {
        for (int i = 0; i < count; ++i) {
            fusion::AidRecord r;
            r.kind = kind;
            r.status = status;
            b.result.aids.push_back(r);
        }
    };
    put(accepted, AidStatus::Accepted);
    put(refused, AidStatus::Rejected);
    put(withheld, AidStatus::Withheld);
    const std::vector<Concern> concerns = evidence_of(b, {});
    return std::ranges::find(concerns, "instrument.refused", &Concern::id) != concerns.end();
}

/// A heading that is always refused leaves open whether the instrument or the solution is wrong.
TEST(Evidence, AnInstrumentThatIsMostlyRefusedContradicts) {
    for (const AidKind kind : {AidKind::Heading, AidKind::Mag, AidKind::Baro, AidKind::Odometer}) {
        EXPECT_TRUE(contradicted(kind, 0, 38));
        EXPECT_TRUE(contradicted(kind, 18, 20));
        EXPECT_FALSE(contradicted(kind, 20, 18));
        EXPECT_FALSE(contradicted(kind, 0, 9));
        EXPECT_FALSE(contradicted(kind, 20, 18, 40));
    }
    EXPECT_FALSE(contradicted(AidKind::Nonholonomic, 0, 38));  // a constraint of the vehicle is no instrument
    EXPECT_EQ(gravity_of("instrument.refused"), Gravity::Care);
}

}  // namespace
}  // namespace schuler::solution
