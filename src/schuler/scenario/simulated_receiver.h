// A receiver at correlator level on a simulated flight: autonomous, or in the loop of the navigation filter.
#pragma once

#include "schuler/filter/update/receiver_in_loop.h"
#include "schuler/gnss/satellite_source.h"
#include "schuler/scenario/simulated_dataset.h"
#include "schuler/settings/scenario/scenario.h"

#include <array>
#include <memory>
#include <optional>
#include <vector>

namespace schuler::scenario {

/// The signals of a scenario with [receiver], its path and its orbits. Immutable.
class SimulatedSky final : public receiver::SignalField {
public:
    /// For a scenario accepted by check_receiver(). @throws Error(Input) if no satellite is ever in view.
    explicit SimulatedSky(const settings::ScenarioConfig& scenario);

    [[nodiscard]] std::size_t size() const override { return signals_.size(); }
    [[nodiscard]] receiver::SignalStructure structure(std::size_t signal) const override;
    [[nodiscard]] receiver::LineOfSight motion(std::size_t signal, double t) const override;
    [[nodiscard]] double cn0(std::size_t signal, double t) const override { return signals_.cn0(signal, t); }
    [[nodiscard]] bool in_view(std::size_t signal, double t) const override { return signals_.in_view(signal, t); }

    [[nodiscard]] const sim::Signals& signals() const { return signals_; }
    /// Specific force, body axes, m/s^2, to 0.1 m/s^2: the acceleration acting on an oscillator.
    [[nodiscard]] Eigen::Vector3d force(double t) const;
    /// Seconds of the scenario.
    [[nodiscard]] double seconds(Time t) const { return (t - frame_.origin).seconds(); }
    [[nodiscard]] Time time(double t) const { return frame_.origin + Duration::from_seconds(t); }
    /// The satellite state at transmission time `t`.
    [[nodiscard]] std::optional<gnss::SatelliteState> satellite(std::size_t signal, double t) const;

    [[nodiscard]] const settings::ReceiverScenarioConfig& settings() const { return settings_; }
    [[nodiscard]] const sim::RangingScenario& frame() const { return frame_; }

private:
    settings::ReceiverScenarioConfig settings_;
    sim::RangingScenario frame_;
    sim::RangingSettings ranging_;
    std::unique_ptr<const sim::TruthPath> path_;
    sim::Signals signals_;
    gnss::BroadcastSource orbits_;
};

class SimulatedReceiver {
public:
    SimulatedReceiver(const SimulatedSky& sky, receiver::Guidance guidance);

    /// Implements fusion::ReceiverInLoop.
    void run(const fusion::ReceiverAiding& aiding, Time until, RangingLog& log);
    /// The whole flight without guidance.
    [[nodiscard]] RangingLog run_alone();
    [[nodiscard]] double rate_span() const { return rate_span_; }  ///< s, sensor::RangingErrorModel::rate_span
    [[nodiscard]] const std::vector<ReceiverRow>& rows() const { return rows_; }

private:
    void begin(double t);
    void listen(double until, RangingLog& log);
    void measure(RangingLog& log);
    void note();
    [[nodiscard]] bool partly_exact() const { return sky_.settings().exact_channels || sky_.settings().exact_clock; }
    /// Removes the errors that the scenario switches off; `t`: true time of the measurement.
    void make_exact(receiver::BankMeasurement& m, double t) const;
    /// m/s, mean of the last `span` s of the oscillator, or of as many as there are.
    [[nodiscard]] double clock_drift(double span) const;

    const SimulatedSky& sky_;
    receiver::BankSettings settings_;
    double interval_;  ///< s between epochs
    double rate_span_;
    std::optional<receiver::Bank> bank_;
    std::vector<receiver::Prediction> predictions_;
    std::vector<receiver::BankMeasurement> measured_;
    std::vector<ReceiverRow> rows_;
    std::array<double, 1024> clocks_{};  ///< m, of the last code periods, by their number
    std::int64_t ticks_ = 0;             ///< kept so far
};

}  // namespace schuler::scenario
