// Tables 2 and 3 of paper C: right to the printed digits but for the places that the errata name, and those are found.
#include "schuler/theory/paper_c_tables.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

namespace schuler::theory {
namespace {

TEST(PaperCTables, OnlyTheKnownMisprintsAreMarked) {
    const std::vector<std::tuple<std::string, int, std::string, std::string, double>> known{
        {"", 0, "initial dphi, dlambda", "8.97e-6", 8.995437e-6},
        {"fighter", 0, "period of mu", "84.6", 84.361768},
        {"fighter", 3, "dlambda(3600 s)", "1.87", 1.8564425824},
        {"fighter", 3, "amplitude of dlambda", "1.57e-7", 1.55715397782e-7},
        {"ship", 1, "dlambda(3600 s)", "-1.39e-6", -1.38465945547e-4},
        {"ship", 3, "dvH(3600 s)", "-1.3e-3", -0.0134264198239}};
    std::size_t found = 0;
    for (const PaperEntry& e : paper_tables()) {
        const auto it = std::ranges::find_if(known, [&](const auto& k) {
            return std::get<0>(k) == e.vehicle && std::get<1>(k) == e.set && std::get<2>(k) == e.quantity &&
                   std::get<3>(k) == e.printed;
        });
        EXPECT_EQ(e.agrees, it == known.end())
            << e.vehicle << " " << e.set << " " << e.quantity << ": " << e.printed << ", right " << e.right;
        if (it == known.end()) continue;
        ++found;
        EXPECT_NEAR(e.right, std::get<4>(*it), 1e-6 * std::abs(e.right)) << e.quantity;
    }
    EXPECT_EQ(found, known.size());
    EXPECT_EQ(paper_tables().size(), 1U + 3U + 14U + 84U);
}

TEST(PaperCTables, HalfAUnitOfTheLastDigit) {
    const auto expect = [](const std::string& text, double value, double half) {
        const PrintedNumber n = printed_number(text);
        EXPECT_DOUBLE_EQ(n.value, value) << text;
        EXPECT_NEAR(n.half_unit, half, 1e-12 * half) << text;
    };
    expect("-1.2e-3", -0.0012, 5e-5);
    expect("258", 258.0, 0.5);
    expect("0.03", 0.03, 0.005);
    expect("9e-6", 9e-6, 5e-7);
    EXPECT_THROW((void)printed_number("pi/2"), Error);
}

}  // namespace
}  // namespace schuler::theory
