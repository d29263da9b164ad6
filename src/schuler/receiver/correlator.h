// Early, prompt and late correlators of one channel, from the physics: what a hardware correlator would dump, without samples.
#pragma once

#include "schuler/math/random.h"
#include "schuler/receiver/correlation_peak.h"
#include "schuler/receiver/signal.h"

#include <Eigen/Core>

#include <complex>

namespace schuler::receiver {

/// Replica minus signal over one dump.
struct ReplicaError {
    double code = 0.0;       ///< chips, mean over the dump; positive: the replica is ahead
    double phase = 0.0;      ///< rad, in the middle of the dump
    double frequency = 0.0;  ///< Hz, mean
};

/// Complex outputs I + jQ. Scale: white noise without band limit has unit variance in I and in Q, whatever the dump's length, so
/// an aligned prompt has I = sqrt(2 C/N0 T).
struct Correlators {
    std::complex<double> early, prompt, late;
};

/// The generators of one channel as commanded: phases grow with time as those of the received signal do, that is against the
/// range.
struct Replica {
    double code_phase = 0.0;  ///< chips, of the replica minus a code that left at range zero: -range / chip length when aligned
    double code_rate = 0.0;   ///< chips/s beyond the nominal rate
    double carrier_phase = 0.0;      ///< cycles, likewise
    double carrier_frequency = 0.0;  ///< Hz of Doppler

    /// The same generators `dt` s later.
    [[nodiscard]] Replica after(double dt) const;
};

/// The replica that a signal moving as `truth` calls for, and what a replica says of the pseudorange and its rate (the carrier's
/// phase does not say where it is, so it is left out).
[[nodiscard]] Replica aligned_replica(const SignalStructure& signal, const LineOfSight& truth);
[[nodiscard]] LineOfSight followed(const SignalStructure& signal, const Replica& replica);

/// The error of a replica over the next `duration` s against the signal that moves as `truth` says (both at the dump's start).
[[nodiscard]] ReplicaError replica_error(const SignalStructure& signal, const Replica& replica, const LineOfSight& truth,
                                         double duration);

/// Correlator outputs of one signal [Groves2013][Kaplan2017]: amplitude sqrt(2 C/N0 T) R(tau) sinc(df T) sign e^{-j
/// phi}, noise of the three taps correlated as the front end and their spacing make it. The change of frequency within a dump is
/// left out: of 20 g it costs 0.2 dB in 20 ms and nothing in 1 ms.
class CorrelatorModel {
public:
    /// @param spacing early to late, chips, in (0, 2). Throws Error(Input) outside.
    CorrelatorModel(const CorrelationPeak& peak, double spacing);

    /// Without noise; `cn0` in Hz, `sign` of the navigation message.
    [[nodiscard]] Correlators expected(const ReplicaError& error, double cn0, double duration, int sign) const;
    [[nodiscard]] Correlators dump(const ReplicaError& error, double cn0, double duration, int sign, math::Random& random) const;

    /// Covariance of the noise of early, prompt and late, the same for I and for Q.
    [[nodiscard]] const Eigen::Matrix3d& noise_covariance() const { return covariance_; }
    [[nodiscard]] double spacing() const { return spacing_; }
    [[nodiscard]] const CorrelationPeak& peak() const { return peak_; }

private:
    CorrelationPeak peak_;
    double spacing_;
    Eigen::Matrix3d covariance_, root_;  ///< root_: lower triangular, root_ root_^T = covariance_
};

}  // namespace schuler::receiver
