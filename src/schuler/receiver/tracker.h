// Classical tracking of one signal: code and carrier loops, their lock detectors, and inertial aiding.
#pragma once

#include "schuler/receiver/discriminators.h"
#include "schuler/receiver/lock.h"
#include "schuler/receiver/loop_error.h"
#include "schuler/receiver/loops.h"

#include <array>
#include <optional>

namespace schuler::receiver {

struct TrackingSettings {
    double pll_bandwidth = 15.0;  ///< Hz
    double fll_bandwidth = 0.0;   ///< Hz, frequency loop that permanently assists the phase loop
    double dll_bandwidth = 0.5;   ///< Hz, carrier-aided
    int integration = 10;         ///< code periods per coherent sum, a divisor of the symbol
    double spacing = 0.5;         ///< chips, early to late
    CodeDiscriminator discriminator = CodeDiscriminator::EarlyLatePower;
    double pull_in_fll = 8.0;     ///< Hz, on single code periods, after a start without known symbols
    double pull_in_dll = 2.0;     ///< Hz
    double pull_in_time = 0.5;    ///< s, of each pull-in step
    double sync_time = 1.0;       ///< s of observation to find the message's symbols
    double code_only_dll = 0.1;   ///< Hz, code loop with inertial aiding while the carrier is lost
    double phase_lock = 0.4;      ///< of the phase lock detector
    double phase_patience = 0.5;  ///< s below it after which the phase is lost
    double retry_db = 24.0;       ///< dB-Hz above which a lost carrier is tried again
    double code_lost_db = 12.0;   ///< dB-Hz below which the code is lost
    double code_patience = 5.0;   ///< duration below it, s

    /// Throws Error(Input) that names the setting.
    void check(const SignalStructure& signal) const;
};

enum class TrackState {
    Idle,
    PullIn,    ///< frequency and code loops
    Phase,     ///< phase loop locked or locking
    CodeOnly,  ///< carrier lost, code loop continues with the inertial rate
    Lost,      ///< nothing tracked: search
};

/// One channel. The owner forms correlators of each code period with replica() and passes them to step(), which returns nothing
/// and leaves the replica for the next period. Allocates nothing after construction.
///
/// With an aid, the inertial pseudorange rate is fed forward to the carrier at every code period and the loops, as narrow as set,
/// track only the remainder: clock drift and navigation errors. The code loop is aided by the carrier while it is tracked and by
/// the inertial rate when it is lost [PaperA:1.1].
class Tracker {
public:
    /// `clock_h0`: s, white frequency noise of the receiver's oscillator, as its maker states it (OscillatorSettings::h0).
    Tracker(const SignalStructure& signal, const CorrelationPeak& peak, const TrackingSettings& settings, double clock_h0 = 0.0);

    /// Start after a search. `dumps_into_symbol`: given if time is known much better than a code period, as after a short outage;
    /// the carrier is then pulled in over half symbols, which requires 10 dB less.
    void start(const Replica& replica, std::optional<int> dumps_into_symbol = {}, const ReplicaUncertainty& uncertainty = {});
    /// Ends the code period just correlated; `aid` is the inertial pseudorange motion at this instant, null if there is none.
    /// `std_rate`: m/s, one sigma of its rate.
    void step(const Correlators& dump, const LineOfSight* aid = nullptr, double std_rate = 0.0);
    /// Advances by `dt` s without a dump, possibly negative: dumps of samples start with the code, not at every millisecond.
    void pass(double dt) { replica_ = replica_.after(dt); }

    [[nodiscard]] const Replica& replica() const { return replica_; }
    /// Tracked pseudorange, m, its rate and acceleration at this instant. A commanded frequency is correct at the middle of its
    /// interval: a code period for the aid, an update for the loop. The frequency of the replica itself is earlier by that time.
    [[nodiscard]] LineOfSight motion() const;
    [[nodiscard]] TrackState state() const;
    [[nodiscard]] bool phase_locked() const { return mode_ == Mode::Phase && lock_.value() >= settings_.phase_lock; }
    [[nodiscard]] double phase_lock() const { return lock_.value(); }
    [[nodiscard]] double cn0() const { return cn0_.cn0(); }  ///< Hz
    [[nodiscard]] int dumps_into_symbol() const { return dump_; }

    /// Variance of the code of motion(), chips^2, from the loops' equations and the strength of the signal (loop_error.h).
    [[nodiscard]] double code_variance() const { return error_.code_variance(); }
    /// Jitter of the phase, cycles: noise of loop and oscillator, and a third of the dynamic stress [Kaplan2017].
    [[nodiscard]] double phase_jitter() const;
    /// Variance of the carrier frequency, Hz^2, without the oscillator's noise; infinite while the phase is not followed: beyond
    /// phase_threshold.
    [[nodiscard]] double frequency_variance() const;

private:
    enum class Mode { Idle, Blind, Aligned, Assisted, Phase, CodeOnly, Lost };
    struct Sums {
        Correlators all{};
        std::complex<double> first = 0.0;  ///< prompt of the first half
        int count = 0;
    };

    void enter(Mode mode);
    void fail();
    void update();
    void transitions();
    void command();
    bool leave_false_lock();
    bool slipped_to_false_lock();
    [[nodiscard]] double false_step() const;  ///< Hz, between the frequencies at which the phase loop locks
    void follow_error(double phase, double assumed);
    [[nodiscard]] const LoopModel& model() const;
    [[nodiscard]] int dumps_per_update() const;
    [[nodiscard]] const CarrierLoop& carrier() const;
    [[nodiscard]] std::array<CarrierLoop*, 5> loops() { return {&blind_, &listening_, &aligned_, &assisted_, &phase_}; }
    [[nodiscard]] bool follows() const { return mode_ != Mode::Idle && mode_ != Mode::Lost; }

    SignalStructure signal_;
    TrackingSettings settings_;
    double peak_, period_;
    int symbol_;  ///< code periods per symbol
    CodeError code_error_;
    CarrierLoop blind_, listening_, aligned_, assisted_, phase_;
    CodeLoop code_blind_, code_aligned_, code_phase_, code_only_;
    LoopModel of_blind_, of_listening_, of_aligned_, of_assisted_, of_phase_, of_code_only_;
    LoopError error_;
    PhaseStress stress_;
    double threshold_ = 0.0;    ///< cycles, of phase_jitter()
    double clock_phase_ = 0.0;  ///< cycles^2, of the oscillator
    Cn0Estimator cn0_;
    FadingCn0 fading_;
    PhaseLockDetector lock_;
    SymbolSync sync_;

    Replica replica_;
    Mode mode_ = Mode::Idle;
    Sums sums_;
    std::complex<double> before_ = 0.0;  ///< prompt of the last update, for the assisting frequency loop
    PromptRotation rotation_;
    double opened_ = 0.0, opened_variance_ = 0.0;  ///< Hz, Hz^2, the loop's frequency when it began to lock
    bool anchored_ = false;                        ///< the settled frequency is the signal's
    bool followed_ = false;                        ///< in phase: the jitter is that of a loop that follows
    bool verified_ = false;                        ///< in phase: not half a cycle a sum off
    double std_aid_ = 0.0;                         ///< m/s
    int dump_ = 0;
    int attempts_ = 0, escapes_ = 0;
    double time_in_mode_ = 0.0, unlocked_ = 0.0, weak_ = 0.0;
    double loop_frequency_ = 0.0, code_rate_ = 0.0;  ///< commands in addition to the aids, Hz and chips/s
    double settled_ = 0.0;                           ///< Hz, loop frequency while locked, slowly averaged
    bool aided_ = false;
    LineOfSight aid_{};
};

}  // namespace schuler::receiver
