// What a receiver's own record says of its faults: values that hang, positions that stray.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/settings.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace schuler::fusion {

/// Fixes whose position or velocity hangs at that of a fix before.
struct FrozenFixes {
    std::vector<bool> position, velocity;  ///< one a fix; empty where there is none
    std::size_t positions = 0, velocities = 0;
    std::optional<Time> first;

    [[nodiscard]] bool any() const { return first.has_value(); }
};

/// Looks for fixes that repeat to the last digit while the receiver itself says motion. A receiver at rest repeats too (it holds its position,
/// or its digits are coarse), so a repetition is not enough: over the run (three fixes and 2 s or more)
/// - positions: the stated velocities lead away from them, or they end with a leap that the track after it does not explain; velocities that
///   repeat along with them hang too;
/// - velocities: the positions go elsewhere than they lead.
/// "Away" is beyond five sigma of the positions, three of their digits and 0.3 m/s, at least 5 m. A log in which that is usual (more than a
/// third of its fixes, or more than twenty runs) holds its values by custom, and none is named.
[[nodiscard]] FrozenFixes frozen_fixes(const std::vector<GnssFix>& fixes, const earth::Earth& earth);

/// Positions that wandered off the way of the receiver's own velocities and leapt back to it within two minutes, one a fix: what the
/// velocities say of the whole way closes, so that the positions in between were wrong. Velocities that lie for a while, and positions that
/// stay away, do not close: then both stay suspects, and none is named. Nor is another level that is only jumped to and back from: the filter
/// that walks along tells it. The way before and after is held by four of five fixes; the leap is beyond five sigma (stated, or as the log
/// scatters) and 3 m. None where a third of the fixes would be, or more than twenty runs.
[[nodiscard]] std::vector<bool> strayed_positions(const std::vector<GnssFix>& fixes, const earth::Earth& earth);

/// What of a log's fixes is left out for what later ones say of them, which a stream cannot know.
struct FixScreen {
    std::vector<bool> position{}, velocity{};  ///< true: left out; one a fix, or empty where nothing is
    std::vector<bool> height{};                ///< likewise, of the position and the velocity

    /// The fix without what is left out, which is NaN.
    [[nodiscard]] GnssFix without(const GnssFix& fix, std::size_t index) const;
};

/// Both looks at a log, with a warning each for what they find. Velocities that the filter does not use (gnss.use_velocity) are no witnesses;
/// positions that strayed are left out only where the filter may refuse fixes by its gates, which integrity control replaces.
/// origin: zero of the times in the warnings.
[[nodiscard]] FixScreen screen_fixes(const std::vector<GnssFix>& fixes, const Settings& settings, Time origin,
                                     WarningLog& warnings);

}  // namespace schuler::fusion
