// One channel of a deeply coupled receiver: generators commanded by the navigation solution, correlator outputs condensed into
// residuals.
#pragma once

#include "schuler/receiver/discriminators.h"
#include "schuler/receiver/lock.h"

#include <Eigen/Core>

#include <optional>

namespace schuler::receiver {

enum class Prefilter {
    Noncoherent,  ///< powers and products of successive sums: insensitive to phase, usable at very low C/N0
    Coherent,     ///< a small filter tracks the phase about the navigation's prediction; otherwise as Noncoherent
};

struct DeepSettings {
    Prefilter prefilter = Prefilter::Coherent;
    double spacing = 0.5;       ///< chips, early to late
    double cn0_time = 1.0;      ///< s, time constant of the C/N0 estimate
    double lowest_db = 12.0;    ///< dB-Hz below which a channel gives no measurement
    double acceleration = 0.2;  ///< m/s^2/sqrt(Hz), uncertainty of the line-of-sight acceleration in the navigation
    double followed = 0.3;      ///< rad, largest one sigma of a phase considered tracked

    /// Throws Error(Input) that names the setting.
    void check() const;
};

/// Output of one channel to the navigation filter after each symbol: predicted minus received pseudorange and rate, that is,
/// estimate minus truth along this line of sight, mean over the symbol. Residuals of different symbols have independent
/// noise.
struct ChannelMeasurement {
    enum class Status { NoSignal, Noncoherent, Coherent } status = Status::NoSignal;
    double range = 0.0;           ///< m
    double range_variance = 0.0;  ///< m^2
    double rate = 0.0;            ///< m/s
    double rate_variance = 0.0;   ///< (m/s)^2
    double carrier = 0.0;  ///< m, integral of the rate up to the symbol's end by the phase, with any constant; coherent only
    double carrier_variance = 0.0;  ///< m^2
    double cn0 = 0.0;               ///< Hz
    double duration = 0.0;          ///< s
};

/// Linear within half a chip and a quarter of the inverse symbol duration (12 Hz for GPS): the navigation must be more accurate
/// than that. Allocates nothing after construction.
class DeepChannel {
public:
    DeepChannel(const SignalStructure& signal, const CorrelationPeak& peak, const DeepSettings& settings);

    /// Sets the replica to `predicted`, the first dump being `dumps_into_symbol` into its symbol. A signal too weak to be
    /// detected in one symbol is observed for half of cn0_time before the first measurement.
    void start(const LineOfSight& predicted, int dumps_into_symbol);
    /// The current pseudorange predicted by the navigation, clock included, with one sigma of its rate, m/s. Only between
    /// symbols: after a step that returned a measurement.
    void command(const LineOfSight& predicted, double std_rate);
    /// The same within a symbol: the carrier phase remains continuous.
    void steer(const LineOfSight& predicted);
    /// Ends the code period just correlated with replica(); returns a measurement at the end of each symbol.
    std::optional<ChannelMeasurement> step(const Correlators& dump);

    [[nodiscard]] const Replica& replica() const { return replica_; }
    [[nodiscard]] const LineOfSight& predicted() const { return predicted_; }
    /// The carrier generated so far, m of range, with an arbitrary constant.
    [[nodiscard]] double generated() const { return -signal_.wavelength() * replica_.carrier_phase; }

private:
    void place();
    [[nodiscard]] ChannelMeasurement finish();
    void measure(ChannelMeasurement& out) const;
    void follow(ChannelMeasurement& out);
    void judge_power(double both);
    void follow_phase(std::complex<double> half);

    SignalStructure signal_;
    DeepSettings settings_;
    CodeError code_error_;
    double peak_, slope_, noise_, period_;
    int symbol_;
    Cn0Estimator cn0_, quick_;  ///< the second over a tenth of the time: detects changes of signal strength

    Replica replica_;
    LineOfSight predicted_;
    int dump_ = 0;
    int counted_ = 0;         ///< dumps of this symbol
    double std_rate_ = 0.0;   ///< m/s
    double turns_ = 0.0;      ///< rad removed from carrier_
    double agreement_ = 0.0;  ///< mean cosine of the rotation between the halves of a symbol
    double listened_ = 0.0;   ///< s
    double steady_ = 0.0;     ///< s since the last step of signal strength
    Correlators halves_[2]{};
    /// Phase (rad) and frequency (Hz) of replica minus signal at the end of the last half symbol.
    Eigen::Vector2d carrier_ = Eigen::Vector2d::Zero();
    Eigen::Matrix2d P_ = Eigen::Matrix2d::Identity();
    Eigen::Matrix2d scatter_ = Eigen::Matrix2d::Identity();  ///< part of P_ due to the noise of the sums
};

}  // namespace schuler::receiver
