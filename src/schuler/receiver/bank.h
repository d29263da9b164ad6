// All channels of a receiver at correlator level with their oscillator: what is heard, followed, lost, searched and measured.
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

/// What arrives at the antenna, the receiver's own clock left out. Times are seconds of the scenario.
class SignalField {
public:
    virtual ~SignalField() = default;
    [[nodiscard]] virtual std::size_t size() const = 0;
    [[nodiscard]] virtual SignalStructure structure(std::size_t signal) const = 0;
    [[nodiscard]] virtual LineOfSight motion(std::size_t signal, double t) const = 0;
    [[nodiscard]] virtual double cn0(std::size_t signal, double t) const = 0;    ///< Hz; 0: nothing arrives
    [[nodiscard]] virtual bool in_view(std::size_t signal, double t) const = 0;  ///< by almanac
};

/// What the navigation has to say to the channels (paper A, 1.1).
enum class Guidance {
    None,        ///< nothing: a receiver on its own
    Loops,       ///< inertial rates to the loops, which are narrow; code on them when the carrier is lost; aided search
    Generators,  ///< the navigation solution commands code and carrier: deep
};

struct BankSettings {
    Guidance guidance = Guidance::None;
    TrackingSettings alone;  ///< loops without an aid
    TrackingSettings aided;  ///< and with it
    SearchSettings search{.coherent = 5, .noncoherent = 10};
    SearchSettings aided_search{.coherent = 10, .noncoherent = 10};
    DeepSettings deep;
    double front_end = std::numeric_limits<double>::infinity();  ///< Hz, two-sided band
    double hot_range = 3000.0, hot_rate = 60.0;  ///< m, m/s: one sigma of what a receiver alone knows of a signal it has lost
    OscillatorSettings oscillator;

    BankSettings() { aided.pll_bandwidth = 3.0, aided.integration = 20; }
};

/// Where the navigation expects a signal, its estimate of the receiver's clock included.
struct Prediction {
    LineOfSight motion;
    double std_range = 0.0, std_rate = 0.0;  ///< one sigma, m, m/s
    double drift = 0.0;  ///< m/s, the clock's part of motion.rate: loops keep it themselves, for its estimate jumps
};

/// One signal measured: pseudorange and its rate now, receiver's clock included.
struct BankMeasurement {
    std::size_t signal = 0;
    double range = 0.0, range_variance = 0.0;  ///< m, m^2
    /// m/s, of now, or by phase the mean over the last rate_span; infinite variance: none.
    double rate = 0.0, rate_variance = std::numeric_limits<double>::infinity();
    double rate_span = 0.0;       ///< s; the oscillator's white frequency noise is in the rate as in a mean over so long
    double phase_variance = 0.0;  ///< m^2, of the phases at the ends of the span whose change is the rate; 0: it is none
    bool phase_goes_on = false;   ///< the phase at its begin is that of the end of the signal's last rate
    double cn0 = 0.0;             ///< Hz, as estimated
};

/// s; what the rates of one instant have of the oscillator's white frequency noise in common is that in a mean over so long, while channels
/// follow their carriers. More than BankMeasurement::rate_span: what each channel is a mean over does not end at once.
[[nodiscard]] double shared_rate_span(const BankSettings& settings);

enum class ChannelState { Idle, Searching, PullIn, Phase, CodeOnly, Deep, DeepCoherent };

/// Allocates nothing after construction but for measure().
class Bank {
public:
    /// The field is referred to; `start` is now(). Throws Error(Input) naming the setting that is unusable.
    Bank(const SignalField& field, const BankSettings& settings, std::uint64_t seed, double start = 0.0);

    /// One prediction a signal, for the time `t`.
    void guide(std::span<const Prediction> predictions, double t);
    /// One code period. `f_b`: specific force on the oscillator, m/s^2.
    void step(const Eigen::Vector3d& f_b);
    /// Everything that is followed, at the moment when the receiver's clock showed now(); deep channels: what has not been given
    /// before. `interval`: s since the last time.
    void measure(std::vector<BankMeasurement>& out, double interval);

    [[nodiscard]] double now() const { return static_cast<double>(ticks_) * period; }  ///< s
    [[nodiscard]] ChannelState state(std::size_t signal) const;
    [[nodiscard]] double clock() const { return clock_; }  ///< c times the oscillator's offset, m: truth, for judging

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
        int symbol, phase;  ///< code periods a symbol; of this one
        int sign = 1;
        int wait = 0;          ///< code periods until the dwell ends
        bool found = false;    ///< by that dwell
        bool running = false;  ///< deep: the generators run
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
    theory::PllResponse response_;  ///< of the loops that are guided so
};

}  // namespace schuler::receiver
