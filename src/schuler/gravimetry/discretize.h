// From F and G to one step of covariance propagation.
#pragma once

#include "schuler/gravimetry/model.h"

namespace schuler::gravimetry {

struct DiscreteStep {
    StateMatrix Phi;
    StateMatrix Q;
};

/// Phi = exp(F dt) to third order, Q = (Phi G G^T Phi^T + G G^T) dt/2; F and G are means over the step. At dt = 1 s the next term
/// is below 1e-9 of the sum.
[[nodiscard]] DiscreteStep discretized(const StateMatrix& F, const NoiseMatrix& G, double dt);

}  // namespace schuler::gravimetry
