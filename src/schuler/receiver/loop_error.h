// Uncertainty of what a channel's loops deliver, from the equations of the loops: acquisition, noise that changes, lost signals.
#pragma once

#include "schuler/receiver/loops.h"

#include <Eigen/Core>

namespace schuler::receiver {

/// Phase jitter, one sigma with a third of the dynamic stress added, up to which a loop with a two-quadrant arctangent is taken to
/// follow the phase: a third of the 45 degrees to the limit of its discriminator [Kaplan2017]. Cycles.
inline constexpr double phase_threshold = 15.0 / 360.0;

/// A carrier discriminator linearised about the signal (quasi-linear: mean and variance of the output).
struct DiscriminatorResponse {
    double slope;     ///< of the mean output over the error
    double variance;  ///< of the output, cycles^2 or Hz^2
};
/// Costas arctangent at `snr` = C/N0 T. The angle of a constant vector in Gaussian noise has the density exp(-snr) / pi at +-90 degrees, together, where the output jumps by
/// half a cycle: the slope is 1 - exp(-snr). Without a signal the output is uniform, 1/48 cycles^2; with one its variance is that of
/// the closed formulas with squaring loss [Kaplan2017].
[[nodiscard]] DiscriminatorResponse phase_detector(double snr);

/// Frequency discriminator of two prompts of `interval` s each at `snr` = C/N0 interval: variance in Hz^2 [Kaplan2017]. `range`: it
/// delivers values within +-range Hz, uniform without a signal; the slope is about that of two independent angles.
[[nodiscard]] DiscriminatorResponse frequency_detector(double snr, double interval, double range);

/// One mode of tracking as a linear system in the errors of the replica, replica minus signal, from update to update. Built from the
/// loop filters themselves by applying them to unit errors, so that it is the sampled loop that is described and not its continuous
/// design.
class LoopModel {
public:
    enum Index {
        phase,         ///< cycles, at the update
        command,       ///< Hz, commanded carrier frequency until the next update
        frequency,     ///< Hz, memory of the carrier loop
        acceleration,  ///< Hz/s, likewise
        measured,      ///< cycles, the last measured phase, of which an assisting frequency loop uses the change
        code,          ///< chips, at the update
        code_command,  ///< chips/s, commanded in addition to the carrier's
        code_rate,     ///< chips/s, memory of the code loop
        settled,       ///< Hz, averaged frequency, stored for reacquisition
        size
    };
    using Vector = Eigen::Matrix<double, size, 1>;
    using Matrix = Eigen::Matrix<double, size, size>;
    enum class Carrier { Phase, Frequency, Held };

    /// `interval`: s between updates; `chips_per_cycle`: SignalStructure::chips_per_cycle().
    LoopModel(Carrier kind, const CarrierLoop& carrier_loop, const CodeLoop& code_loop, double interval, double chips_per_cycle);

private:
    friend class LoopError;
    Matrix free_;                                      ///< transition with the outputs of the discriminators zero
    Eigen::Matrix<double, 1, size> sees_, sees_code_;  ///< what the discriminators measure: mean errors of an interval
    Vector input_, input_code_;                        ///< effect of one cycle (hertz) or chip of output
};

/// Outputs of the discriminators of an interval: slope relative to the design, and variance of the noise.
struct DiscriminatorNoise {
    double carrier_slope = 1.0, carrier_variance = 0.0;  ///< cycles^2; of frequency loops Hz^2
    double code_slope = 1.0, code_variance = 0.0;        ///< chips^2
    double walk = 0.0;                                   ///< cycles^2, random walk of the phase in the interval
};

/// One sigma of a replica after a search: a uniform error within the cells of half a chip and 100 Hz.
struct ReplicaUncertainty {
    double code = 0.1443;     ///< chips
    double frequency = 28.9;  ///< Hz
};

/// Covariance of the errors of one channel, propagated beside its loops with what is available in the receiver itself: the size of a search
/// cell, its loop filters, and the strength of the signal as it estimates it. In the steady state this is the thermal jitter of the closed
/// formulas; after a start or a change of loops it contains what is left of the initial errors; without a signal the loops integrate
/// noise, and the covariance grows as they drift away.
class LoopError {
public:
    /// After a search.
    void start(const ReplicaUncertainty& found);
    /// The phase loop closes: the phase is known only to be within half a cycle.
    void close_phase();
    /// The loops' memories are replaced by the settled frequency and no acceleration.
    void return_to_settled();
    /// The code loop's memory is cleared.
    void clear_code_rate();
    /// The settled frequency follows that of the loop by this share.
    void settle(double share);
    /// The loop's frequency is taken for settled.
    void take_for_settled();
    /// The frequency was found to be off: square of the error, Hz^2.
    void astray(double square);
    /// The held carrier is no better than this, Hz^2: the rate of an aid.
    void hold(double variance);
    /// One update.
    void update(const LoopModel& model, const DiscriminatorNoise& noise);

    /// Variances: of the phase, cycles^2, of the commanded frequency, Hz^2, and of the code, chips^2.
    [[nodiscard]] double phase_variance() const { return P_(LoopModel::phase, LoopModel::phase); }
    [[nodiscard]] double frequency_variance() const { return P_(LoopModel::command, LoopModel::command); }
    [[nodiscard]] double code_variance() const { return P_(LoopModel::code, LoopModel::code); }
    /// Variance of the loop's frequency relative to the settled one, Hz^2.
    [[nodiscard]] double unsettled_variance() const;
    /// Variance of the output of the carrier's discriminator at the last update, cycles^2 or Hz^2.
    [[nodiscard]] double output_variance() const { return output_; }

private:
    void replace(LoopModel::Index state, LoopModel::Index by);
    void clear(LoopModel::Index state, double variance = 0.0);

    LoopModel::Matrix P_ = LoopModel::Matrix::Zero();
    double output_ = 0.0;
};

/// Dynamic stress of a phase loop, measured: the part of its discriminator's outputs that exceeds what their noise explains. A
/// third-order loop lags by jerk / w^3 under a jerk [Kaplan2017]; its frequency is wrong only while this lag changes.
class PhaseStress {
public:
    /// Bandwidth in Hz, s between updates; `clock`: cycles^2, variance of the outputs by the oscillator, which changes as slowly as the
    /// loop allows.
    PhaseStress(double bandwidth, double interval, double clock);
    void restart() { square_ = expected_ = mean_ = earlier_ = changes_ = 0.0; }
    /// An output of the discriminator, cycles, and its variance without stress, cycles^2.
    void add(double output, double variance);
    /// Phase error by which the loop lags, cycles, one sigma; 0 while noise explains the outputs.
    [[nodiscard]] double phase() const;
    /// Frequency error that goes with it, Hz, one sigma, from the change of the mean output over the loop's memory; likewise.
    [[nodiscard]] double frequency() const;

private:
    double rate_, gain_, clock_;  ///< 1/s; of an output in the means; cycles^2
    double difference_ = 0.0;     ///< variance of the difference of the means for unit white outputs
    double square_ = 0.0, expected_ = 0.0;
    double mean_ = 0.0, earlier_ = 0.0;  ///< cycles: mean output, and the mean of that mean
    double changes_ = 0.0;               ///< cycles^2, mean square of their difference
};

}  // namespace schuler::receiver
