// Integer ambiguities for the tight filter, by the search of carrier-phase positioning.
#pragma once

#include "schuler/filter/integer_search.h"
#include "schuler/ppk/settings.h"

namespace schuler::fusion {

/// ppk::fix_integers with these settings.
class PpkIntegerSearch : public filter::IntegerSearch {
public:
    explicit PpkIntegerSearch(const ppk::IntegerSettings& settings) : settings_(settings) {}
    void search(std::span<const filter::FloatAmbiguity> floats, const filter::AmbiguityVector& value,
                const filter::AmbiguityMatrix& P, filter::FoundIntegers& out) const override;

private:
    ppk::IntegerSettings settings_;
};

}  // namespace schuler::fusion
