// Integer ambiguities of carrier phases: what the filter asks for. The search itself is the caller's (fusion/integer_search.h).
#pragma once

#include "schuler/filter/states/layout.h"

#include <Eigen/Core>

#include <span>

namespace schuler::filter {

using AmbiguityVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, Layout::most_ambiguities, 1>;
using AmbiguityMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Layout::most_ambiguities, Layout::most_ambiguities>;

/// A real-valued ambiguity, which is a whole number of wavelengths relative to another of its group (carrier and satellite system).
struct FloatAmbiguity {
    int source = 0, carrier = 0;
    int group = 0;
    double wavelength = 0.0;  ///< m, or half of it
    bool halves = false;
    double elevation = 0.0;  ///< rad
    double repeated = 0.0;   ///< m^2, variance of errors that many epochs have in common
    bool trusted = false;    ///< it was among the last integers found
};

struct FoundIntegers {
    bool found = false;     ///< validated
    bool all = false;       ///< every ambiguity that takes part is an integer, and not only some of their combinations
    AmbiguityVector value;  ///< m, with the integers; NaN: it takes no part
    double ratio = 0.0;     ///< of the second best to the best squared distance
};

class IntegerSearch {
public:
    virtual ~IntegerSearch() = default;
    /// `value` in metres with covariance P, as `floats`. The result for the same arguments is the same.
    virtual void search(std::span<const FloatAmbiguity> floats, const AmbiguityVector& value, const AmbiguityMatrix& P,
                        FoundIntegers& out) const = 0;
};

}  // namespace schuler::filter
