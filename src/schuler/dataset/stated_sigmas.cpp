#include "schuler/dataset/stated_sigmas.h"

#include "schuler/core/least_sigmas.h"
#include "schuler/core/units.h"
#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::dataset {
namespace {

/// Sigmas of an instrument, and how to name them.
struct Stated {
    std::string_view rows;       ///< whose they are
    std::string_view unit;       ///< in which they are written
    double in_si;                ///< of that unit
    double least;                ///< SI
    std::string_view key, used;  ///< of the warning; what is used instead
};

bool is_below(double sigma, double least) { return std::isfinite(sigma) && sigma < least; }

/// Removes sigmas that no such instrument has.
template <class Samples>
void remove_absurd(Samples& samples, double Samples::value_type::*sigma, const Stated& what, WarningLog& warnings) {
    std::size_t absurd = 0;
    for (auto& s : samples) {
        if (!is_below(s.*sigma, what.least)) continue;
        s.*sigma = not_given;
        ++absurd;
    }
    if (absurd > 0)
        warnings.add(std::string(what.key),
                     fmt::format("{} of {} {} state a sigma below {:.2g} {}, which no such instrument has: {}", absurd,
                                 samples.size(), what.rows, what.least / what.in_si, what.unit, what.used));
}

/// Raises sigmas far below the usual ones of the log.
template <class Sample>
void raise_rare(std::vector<Sample>& samples, const Stated& what, WarningLog& warnings) {
    constexpr std::size_t fewest = 20;
    constexpr double share = 0.1, below = 0.5;
    std::vector<double> sigmas;
    for (const Sample& s : samples)
        if (std::isfinite(s.std)) sigmas.push_back(s.std);
    if (sigmas.size() < fewest) return;
    const double least = below * math::quantile(std::move(sigmas), share);
    std::size_t raised = 0;
    for (Sample& s : samples) {
        if (!is_below(s.std, least)) continue;
        s.std = least;
        ++raised;
    }
    if (raised > 0)
        warnings.add(
            fmt::format("{}_low", what.key),
            fmt::format("{} of {} {} state a sigma below {:.2g} {}, half of what nine tenths of them exceed: this is used",
                        raised, samples.size(), what.rows, least / what.in_si, what.unit));
}

}  // namespace

void check_stated_sigmas(Recording& recording, WarningLog& warnings) {
    const Stated heading{"headings", "deg", units::deg, least_sigma::heading, "heading.std", "heading.std_deg is used"};
    const Stated speed{"speeds of the odometer", "m/s", 1.0, least_sigma::velocity, "odometer.std", "odometer.std_m_s is used"};
    const Stated range{"pseudoranges", "m", 1.0, least_sigma::range, "ranges.std", "that of the settings is used"};
    const Stated rate{"range rates", "m/s", 1.0, least_sigma::range_rate, "ranges.std_rate", "that of the settings is used"};
    remove_absurd(recording.heading, &HeadingSample::std, heading, warnings);
    raise_rare(recording.heading, heading, warnings);
    remove_absurd(recording.odometer, &OdometerSample::std, speed, warnings);
    raise_rare(recording.odometer, speed, warnings);
    remove_absurd(recording.ranges.samples, &RangeSample::std, range, warnings);
    remove_absurd(recording.ranges.samples, &RangeSample::std_rate, rate, warnings);
}

}  // namespace schuler::dataset
