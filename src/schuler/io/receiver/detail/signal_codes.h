// Numbers of signals in receivers' own protocols.
#pragma once

#include "schuler/gnss/satellite.h"

#include <algorithm>
#include <optional>
#include <span>

namespace schuler::io::detail {

/// What a receiver's protocol means by a number, which each satellite system counts for itself.
struct SignalCode {
    gnss::System system;
    unsigned number;
    gnss::Signal signal;
};

/// The signal of that number; none where the table does not have it.
[[nodiscard]] inline std::optional<gnss::Signal> signal_of(std::span<const SignalCode> table, gnss::System system,
                                                           unsigned number) {
    const auto at = std::ranges::find_if(table, [&](const SignalCode& c) { return c.system == system && c.number == number; });
    return at == table.end() ? std::nullopt : std::optional<gnss::Signal>(at->signal);
}

}  // namespace schuler::io::detail
