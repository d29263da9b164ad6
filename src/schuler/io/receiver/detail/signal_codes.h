// Signal numbers in receivers' own protocols.
#pragma once

#include "schuler/gnss/satellite.h"

#include <algorithm>
#include <optional>
#include <span>

namespace schuler::io::detail {

/// Meaning of a number in a receiver's protocol, which is specific to each satellite system.
struct SignalCode {
    gnss::System system;
    unsigned number;
    gnss::Signal signal;
};

/// The signal of that number; none if not in the table.
[[nodiscard]] inline std::optional<gnss::Signal> signal_of(std::span<const SignalCode> table, gnss::System system,
                                                           unsigned number) {
    const auto at = std::ranges::find_if(table, [&](const SignalCode& c) { return c.system == system && c.number == number; });
    return at == table.end() ? std::nullopt : std::optional<gnss::Signal>(at->signal);
}

}  // namespace schuler::io::detail
