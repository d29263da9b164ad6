#include "schuler/gravimetry/discretize.h"

namespace schuler::gravimetry {

DiscreteStep discretized(const StateMatrix& F, const NoiseMatrix& G, double dt) {
    const StateMatrix X = dt * F;
    StateMatrix X2, X3;
    X2.noalias() = X * X;
    X3.noalias() = X2 * X;
    DiscreteStep step;
    step.Phi = StateMatrix::Identity() + X + 0.5 * X2 + X3 / 6.0;
    NoiseMatrix PhiG;
    PhiG.noalias() = step.Phi * G;
    step.Q.noalias() = 0.5 * dt * (G * G.transpose());
    step.Q.noalias() += 0.5 * dt * (PhiG * PhiG.transpose());
    return step;
}

}  // namespace schuler::gravimetry
