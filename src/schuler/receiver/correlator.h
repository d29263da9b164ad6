// Physical model of the early, prompt and late correlators of one channel: the output of a hardware correlator, without samples.
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
    double phase = 0.0;      ///< rad, at the middle of the dump
    double frequency = 0.0;  ///< Hz, mean
};

/// Complex outputs I + jQ. Scale: white noise without band limit has unit variance in I and in Q for any dump length, so an
/// aligned prompt has I = sqrt(2 C/N0 T).
struct Correlators {
    std::complex<double> early, prompt, late;
};

/// The commanded generators of one channel: phases increase with time as those of the received signal, that is, opposite to the
/// range.
struct Replica {
    double code_phase = 0.0;         ///< chips, replica minus a code transmitted at range zero: -range / chip length when aligned
    double code_rate = 0.0;          ///< chips/s beyond the nominal rate
    double carrier_phase = 0.0;      ///< cycles, likewise
    double carrier_frequency = 0.0;  ///< Hz of Doppler

    /// The same generators after `dt` s.
    [[nodiscard]] Replica after(double dt) const;
};

/// The replica of a signal moving as `truth`, and conversely the pseudorange and its rate represented by a replica (not from the
/// carrier phase, which is ambiguous).
[[nodiscard]] Replica aligned_replica(const SignalStructure& signal, const LineOfSight& truth);
[[nodiscard]] LineOfSight followed(const SignalStructure& signal, const Replica& replica);

/// The error of a replica over the next `duration` s relative to a signal moving as `truth` (both at the start of the dump).
[[nodiscard]] ReplicaError replica_error(const SignalStructure& signal, const Replica& replica, const LineOfSight& truth,
                                         double duration);

/// Correlator outputs of one signal [Groves2013][Kaplan2017]: amplitude sqrt(2 C/N0 T) R(tau) sinc(df T) sign e^{-j phi}, noise
/// of the three taps correlated according to front end and spacing. The change of frequency within a dump is neglected: for 20 g
/// this costs 0.2 dB in 20 ms and nothing in 1 ms.
class CorrelatorModel {
public:
    /// @param spacing early to late, chips, in (0, 2). Throws Error(Input) otherwise.
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
