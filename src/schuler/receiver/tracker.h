// Classical tracking of one signal: code and carrier loops, their lock detectors, and inertial aiding.
#pragma once

#include "schuler/receiver/discriminators.h"
#include "schuler/receiver/lock.h"
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
    Tracker(const SignalStructure& signal, const CorrelationPeak& peak, const TrackingSettings& settings);

    /// Start after a search. `dumps_into_symbol`: given if time is known much better than a code period, as after a short outage;
    /// the carrier is then pulled in over half symbols, which requires 10 dB less.
    void start(const Replica& replica, std::optional<int> dumps_into_symbol = {});
    /// Ends the code period just correlated; `aid` is the inertial pseudorange motion at this instant, null if there is none.
    void step(const Correlators& dump, const LineOfSight* aid = nullptr);
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
    Cn0Estimator cn0_;
    PhaseLockDetector lock_;
    SymbolSync sync_;

    Replica replica_;
    Mode mode_ = Mode::Idle;
    Sums sums_;
    std::complex<double> before_ = 0.0;             ///< prompt of the last update, for the assisting frequency loop
    std::complex<double> slip_ = 0.0, last_ = 0.0;  ///< rotation of the prompts of single code periods while the phase is locking
    int dump_ = 0;
    int attempts_ = 0, escapes_ = 0;
    double time_in_mode_ = 0.0, unlocked_ = 0.0, weak_ = 0.0;
    double loop_frequency_ = 0.0, code_rate_ = 0.0;  ///< commands in addition to the aids, Hz and chips/s
    double settled_ = 0.0;                           ///< Hz, loop frequency while locked, slowly averaged
    bool aided_ = false;
    LineOfSight aid_{};
};

}  // namespace schuler::receiver
