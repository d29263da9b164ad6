#include "schuler/receiver/ca_code.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

namespace schuler::receiver {

namespace {

/// Stages of the second register whose sum delays it for each satellite [ISGPS200:table 3-Ia].
// clang-format off
constexpr std::array<std::array<int, 2>, 32> phase_selection{{{2, 6},  {3, 7}, {4, 8}, {5, 9},  {1, 9}, {2, 10}, {1, 8}, {2, 9},
                                                              {3, 10}, {2, 3}, {3, 4}, {5, 6},  {6, 7}, {7, 8},  {8, 9}, {9, 10},
                                                              {1, 4},  {2, 5}, {3, 6}, {4, 7},  {5, 8}, {6, 9},  {1, 3}, {4, 6},
                                                              {5, 7},  {6, 8}, {7, 9}, {8, 10}, {1, 6}, {2, 7},  {3, 8}, {4, 9}}};
// clang-format on

/// A ten-stage register, initially all ones; stage 1 is the input.
struct Register {
    std::uint32_t bits = 0x3ff;
    [[nodiscard]] std::uint32_t stage(int i) const { return bits >> (i - 1) & 1U; }
    void shift(std::uint32_t in) { bits = (bits << 1 | in) & 0x3ffU; }
};

}  // namespace

CaCode ca_code(int prn) {
    if (prn < 1 || prn > 32) throw input_error(fmt::format("GPS satellite {} has no C/A code here", prn), {}, "give 1 to 32");
    const auto& taps = phase_selection[static_cast<std::size_t>(prn - 1)];
    Register g1, g2;
    CaCode out{};
    for (std::int8_t& chip : out) {
        const std::uint32_t bit = g1.stage(10) ^ g2.stage(taps[0]) ^ g2.stage(taps[1]);
        chip = static_cast<std::int8_t>(bit == 0 ? 1 : -1);
        g1.shift(g1.stage(3) ^ g1.stage(10));
        g2.shift(g2.stage(2) ^ g2.stage(3) ^ g2.stage(6) ^ g2.stage(8) ^ g2.stage(9) ^ g2.stage(10));
    }
    return out;
}

}  // namespace schuler::receiver
