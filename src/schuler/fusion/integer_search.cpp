#include "schuler/fusion/integer_search.h"

#include "schuler/core/samples.h"
#include "schuler/ppk/integers.h"

#include <algorithm>
#include <vector>

namespace schuler::fusion {

void PpkIntegerSearch::search(std::span<const filter::FloatAmbiguity> floats, const filter::AmbiguityVector& value,
                              const filter::AmbiguityMatrix& P, filter::FoundIntegers& out) const {
    const auto n = static_cast<Eigen::Index>(floats.size());
    std::vector<ppk::WholeState> whole;
    for (Eigen::Index i = 0; i < n; ++i) {
        const filter::FloatAmbiguity& a = floats[static_cast<std::size_t>(i)];
        // the satellite's name only tells the satellites of several carriers apart
        constexpr int numbers = static_cast<int>(gnss::numbers_per_system);
        const gnss::SatelliteId id{static_cast<gnss::System>(a.source / numbers), static_cast<std::uint8_t>(a.source % numbers)};
        whole.push_back({id, a.group, i, a.wavelength, a.halves, a.elevation, a.repeated, a.trusted});
    }
    const ppk::IntegerTrial trial = ppk::fix_integers(value, P, whole, n, settings_);
    out = {};
    out.ratio = trial.ratio;
    if (!trial.fix) return;
    out.found = true;
    out.all = trial.fix->count == trial.fix->ambiguities;
    out.value = filter::AmbiguityVector::Constant(n, not_given);
    for (const Eigen::Index i : trial.fix->states) out.value(i) = value(i) + trial.fix->correction(i);
}

}  // namespace schuler::fusion
