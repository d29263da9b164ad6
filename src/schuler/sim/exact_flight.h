// The part of a simulation in which no random number enters, computed once for the many flights of a campaign.
#pragma once

#include "schuler/sim/inverse_imu.h"
#include "schuler/sim/simulate.h"

#include <cstddef>
#include <memory>
#include <vector>

namespace schuler::sim {

/// The increments of a perfect inertial unit along a path, and the motion at the epochs of the reference: by far most of the time of a
/// simulation. The numbers are those that `simulate` computes without it, to the last bit. Immutable: any number of threads may read it.
class ExactFlight {
public:
    /// Of the path, the Earth, the duration and the rates of a scenario, which must be valid; all else in it does not matter.
    explicit ExactFlight(const Scenario& scenario);

    /// True if the other scenario has the same path, Earth, duration and rates, so that these numbers are its own.
    [[nodiscard]] bool is_of(const Scenario& scenario) const;

    /// Increment of sample k, over (k / rate, (k + 1) / rate] seconds from the start.
    [[nodiscard]] const ExactIncrement& increment(std::size_t k) const { return increments_[k]; }
    /// Motion at epoch k of the reference, k / reference_rate seconds from the start.
    [[nodiscard]] const Kinematics& reference(std::size_t k) const { return reference_[k]; }

private:
    PathSettings path_;
    earth::Earth earth_;
    double duration_, rate_, reference_rate_;  // s, Hz, Hz
    std::vector<ExactIncrement> increments_;
    std::vector<Kinematics> reference_;
};

/// As simulate(scenario), with the numbers of `flown` if that is its flight; of another flight, and null, it makes no use.
[[nodiscard]] SimulatedData simulate(const Scenario& scenario, const ExactFlight* flown);

/// The exact flight of a scenario, or null: it would need more than about 100 MB, or the scenario is not valid, which the simulation itself
/// reports.
[[nodiscard]] std::shared_ptr<const ExactFlight> exact_flight(const Scenario& scenario);

/// Number of samples of the unit, and of epochs of the reference, in a scenario.
[[nodiscard]] std::size_t imu_samples(const Scenario& scenario);
[[nodiscard]] std::size_t reference_epochs(const Scenario& scenario);

}  // namespace schuler::sim
