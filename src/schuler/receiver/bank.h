// All channels of a receiver at correlator level with their oscillator: reception, tracking, loss, search and measurement.
#pragma once

#include "schuler/receiver/correlator.h"
#include "schuler/receiver/loop_theory.h"
#include "schuler/receiver/oscillator.h"
#include "schuler/receiver/rate_span.h"
#include "schuler/receiver/search.h"
#include "schuler/receiver/tracker.h"

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace schuler::receiver {

/// Signals at the antenna, without the receiver's clock error. Times are seconds of the scenario.
class SignalField {
public:
    virtual ~SignalField() = default;
    [[nodiscard]] virtual std::size_t size() const = 0;
    [[nodiscard]] virtual SignalStructure structure(std::size_t signal) const = 0;
    [[nodiscard]] virtual LineOfSight motion(std::size_t signal, double t) const = 0;
    [[nodiscard]] virtual double cn0(std::size_t signal, double t) const = 0;    ///< Hz; 0: no signal
    [[nodiscard]] virtual bool in_view(std::size_t signal, double t) const = 0;  ///< according to the almanac
};

/// Information supplied by the navigation to the channels (paper A, 1.1).
enum class Guidance {
    None,        ///< none: an autonomous receiver
    Loops,       ///< inertial rates to narrow loops; code tracking with them when the carrier is lost; aided search
    Generators,  ///< the navigation solution commands code and carrier: deep
};

struct BankSettings {
    Guidance guidance = Guidance::None;
    TrackingSettings alone;  ///< loops without aiding
    TrackingSettings aided;  ///< and with aiding
    SearchSettings search{.coherent = 5, .noncoherent = 10};
    SearchSettings aided_search{.coherent = 10, .noncoherent = 10};
    DeepSettings deep;
    double front_end = std::numeric_limits<double>::infinity();  ///< Hz, two-sided band
    double hot_range = 3000.0, hot_rate = 60.0;  ///< m, m/s: one sigma of the receiver's own prediction of a lost signal
    OscillatorSettings oscillator;

    BankSettings() { aided.pll_bandwidth = 3.0, aided.integration = 20; }
};

/// Signal prediction from the navigation, including its estimate of the receiver clock.
struct Prediction {
    LineOfSight motion;
    double std_range = 0.0, std_rate = 0.0;  ///< one sigma, m, m/s
    double drift = 0.0;  ///< m/s, clock part of motion.rate: loops estimate it themselves, because this estimate jumps
};

/// Measurement of one signal: pseudorange and its rate now, including the receiver clock.
struct BankMeasurement {
    std::size_t signal = 0;
    double range = 0.0, range_variance = 0.0;  ///< m, m^2
    /// m/s, current, or by phase the mean over the last rate_span; infinite variance: none.
    double rate = 0.0, rate_variance = std::numeric_limits<double>::infinity();
    double rate_span = 0.0;       ///< s; the white frequency noise of the oscillator contributes as to a mean over this time
    double phase_variance = 0.0;  ///< m^2, of the phases at the ends of the interval of a rate by phase; 0: not by phase
    bool phase_goes_on = false;   ///< its initial phase is the final one of the signal's last rate
    double cn0 = 0.0;             ///< Hz, estimated
};

/// s; averaging time for the white frequency noise of the oscillator common to the rates of one instant while channels track their
/// carriers. Larger than BankMeasurement::rate_span, because the averaging intervals of the channels do not end simultaneously.
[[nodiscard]] double shared_rate_span(const BankSettings& settings);

enum class ChannelState { Idle, Searching, PullIn, Phase, CodeOnly, Deep, DeepCoherent };

/// Allocates nothing after construction except in measure().
class Bank {
public:
    /// The field is held by reference; `start` is now(). Throws Error(Input) that names the invalid setting.
    Bank(const SignalField& field, const BankSettings& settings, std::uint64_t seed, double start = 0.0);

    /// One prediction per signal, for the time `t`.
    void guide(std::span<const Prediction> predictions, double t);
    /// Advances one code period. `f_b`: specific force on the oscillator, m/s^2.
    void step(const Eigen::Vector3d& f_b);
    /// All tracked signals at the instant when the receiver's clock showed now(); for deep channels, the data not yet delivered.
    /// `interval`: s since the last call.
    void measure(std::vector<BankMeasurement>& out, double interval);

    [[nodiscard]] double now() const { return static_cast<double>(ticks_) * period; }  ///< s
    [[nodiscard]] ChannelState state(std::size_t signal) const;
    [[nodiscard]] double clock() const { return clock_; }  ///< c times the oscillator's offset, m: truth, for evaluation

    static constexpr double period = 1e-3;  ///< s, of every code here

private:
    struct Channel {
        Channel(const SignalStructure& signal_, const BankSettings& settings, std::uint64_t seed, std::size_t number);

        SignalStructure signal;
        CorrelationPeak peak;
        CorrelatorModel model;
        math::Random noise, message;
        Tracker tracker;
        DeepChannel deep;
        std::optional<Search> search;
        int symbol, phase;  ///< code periods per symbol; within this one
        int sign = 1;
        int wait = 0;          ///< code periods until the end of the dwell
        bool found = false;    ///< in that dwell
        bool running = false;  ///< deep: the generators are running
        bool fresh = false;
        ChannelMeasurement measured;
        LineOfSight expected;  ///< deep: at the end of that symbol
        double at = 0.0;       ///< s, its time
        RateSpan span;         ///< deep
    };
    bool search(std::size_t i, const LineOfSight& truth, double cn0);
    void step_alone(std::size_t i, const LineOfSight& truth, double cn0, bool view);
    void step_deep(std::size_t i, const LineOfSight& truth, double cn0, bool view);
    [[nodiscard]] Search new_search(std::size_t i, const LineOfSight& truth);
    [[nodiscard]] LineOfSight predicted(std::size_t i, double t) const;

    const SignalField& field_;
    BankSettings settings_;
    math::Random oscillator_noise_;
    Oscillator oscillator_;
    std::vector<Channel> channels_;
    std::vector<Prediction> predictions_;
    double guided_at_ = 0.0;
    std::int64_t ticks_ = 0;
    double clock_ = 0.0;
    theory::PllResponse response_;  ///< of the guided loops
};

}  // namespace schuler::receiver
