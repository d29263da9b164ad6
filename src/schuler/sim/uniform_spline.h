// Quintic B-spline on equidistant knots: four times continuously differentiable, exact on straight lines and standstills.
#pragma once

#include "schuler/sim/jet.h"

#include <vector>

namespace schuler::sim {

/// The curve that smooths control values given at x = 0, h, 2h, ... (it does not pass through them): a straight line where six
/// neighbours are collinear, constant where six are equal, monotone where they are. Outside it is continued by the first and last
/// values.
class UniformSpline {
public:
    UniformSpline(double spacing, std::vector<double> controls);

    /// Taylor series to fourth order about x.
    [[nodiscard]] Jet<4> at(double x) const;

private:
    double spacing_;
    std::vector<double> controls_;
};

}  // namespace schuler::sim
