// Detection of receiver faults from its own data: frozen values, straying positions.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/settings.h"

#include <cstddef>
#include <optional>
#include <vector>

namespace schuler::fusion {

/// Fixes whose position or velocity is frozen at that of a previous fix.
struct FrozenFixes {
    std::vector<bool> position, velocity;  ///< one per fix; empty if there is none
    std::size_t positions = 0, velocities = 0;
    std::optional<Time> first;

    [[nodiscard]] bool any() const { return first.has_value(); }
};

/// Finds fixes that repeat to the last digit while the receiver's other data indicate motion. A receiver at rest repeats too (it
/// holds its position, or its digits are coarse), so repetition alone is not sufficient. Over the run (three fixes and 2 s or more)
/// - positions: the stated velocities lead away from them, or they end with a jump not explained by the subsequent track; velocities that
///   repeat together with them are frozen as well;
/// - velocities: the positions move differently from the velocities.
/// "Away" is beyond five sigma of the positions, three of their digits and 0.3 m/s, at least 5 m. In a log where this is common
/// (more than a third of its fixes, or more than twenty runs), holding values is normal operation and none is reported.
[[nodiscard]] FrozenFixes frozen_fixes(const std::vector<GnssFix>& fixes, const earth::Earth& earth);

/// True if the log writes one number as the height of all its fixes, although it travels and states vertical velocities.
[[nodiscard]] bool has_idle_heights(const std::vector<GnssFix>& fixes, const earth::Earth& earth);

/// Positions that departed from the path integrated from the receiver's own velocities and jumped back to it within two minutes, one
/// per fix: the velocities are consistent over the whole path, so the positions in between were wrong. If velocities are wrong for a
/// while, or positions do not return, the path does not close: both remain suspect, and none is reported. Nor is a mere jump to another
/// level and back, which the filter detects. The path before and after must be supported by four of five fixes; the jump exceeds five
/// sigma (as stated, or from the scatter of the log) and 3 m. No result if it affected a third of the fixes, or more than twenty runs.
[[nodiscard]] std::vector<bool> strayed_positions(const std::vector<GnssFix>& fixes, const earth::Earth& earth);

/// Likewise, horizontally or vertically, and also where they only moved to another level and back: three fixes and 2 s or more, one
/// flag per fix. Such a string is no noise of the receiver, however large the noise is taken.
[[nodiscard]] std::vector<bool> displaced_positions(const std::vector<GnssFix>& fixes, const earth::Earth& earth);

/// Parts of a log's fixes that are excluded because of later fixes, which a stream does not have.
struct FixScreen {
    std::vector<bool> position{}, velocity{};  ///< true: excluded; one per fix, or empty if nothing is
    std::vector<bool> height{};                ///< likewise, of the position and the velocity
    bool no_heights = false;                   ///< the heights of all positions are excluded

    /// The fix with the excluded parts set to NaN.
    [[nodiscard]] GnssFix without(const GnssFix& fix, std::size_t index) const;
};

/// Applies these tests to a log, with one warning each for their findings. Velocities not used by the filter (gnss.use_velocity)
/// are no evidence; straying positions are excluded only if the filter may reject fixes by its gates, which integrity control
/// replaces. origin: zero of the times in the warnings.
[[nodiscard]] FixScreen screen_fixes(const std::vector<GnssFix>& fixes, const Settings& settings, Time origin,
                                     WarningLog& warnings);

}  // namespace schuler::fusion
