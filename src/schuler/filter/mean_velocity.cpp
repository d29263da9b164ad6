#include "schuler/filter/mean_velocity.h"

#include "schuler/filter/layout.h"

#include <cmath>

namespace schuler::filter {

using estim::StateVector;

void MeanVelocity::begin(Eigen::Index states, const Eigen::Vector3d& from) {
    time = noise = 0.0;
    origin = from;
    carried.setZero();
    for (StateVector& row : rows) row = StateVector::Zero(states);
}

void MeanVelocity::follow(const estim::Transition& phi, double dt, double velocity_walk, double attitude_walk, double force) {
    if (!begun()) return;
    // What has come in u seconds after the beginning is taken for what was there all the time.
    const double u = time + 0.5 * dt;
    noise += u * u * velocity_walk + std::pow(0.5 * force * u * u, 2) * attitude_walk;
    time += dt;
    for (int i = 0; i < 3; ++i) {
        StateVector& row = rows[static_cast<std::size_t>(i)];
        // Between the ends of dt the velocity's error is linear in time: half of dt of each of them.
        row(Layout::velocity + i) += 0.5 * dt;
        row = estim::row_after(phi, row);
        row(Layout::velocity + i) += 0.5 * dt;
    }
}

}  // namespace schuler::filter
