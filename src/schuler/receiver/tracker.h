// Classical tracking of one signal: code and carrier loops, their lock detectors, and help from an inertial system.
#pragma once

#include "schuler/receiver/discriminators.h"
#include "schuler/receiver/lock.h"
#include "schuler/receiver/loops.h"

#include <array>
#include <optional>

namespace schuler::receiver {

struct TrackingSettings {
    double pll_bandwidth = 15.0;  ///< Hz
    double fll_bandwidth = 0.0;   ///< Hz, frequency loop that goes on assisting the phase loop
    double dll_bandwidth = 0.5;   ///< Hz, carrier-aided
    int integration = 10;         ///< code periods a coherent sum, a divisor of the symbol
    double spacing = 0.5;         ///< chips, early to late
    CodeDiscriminator discriminator = CodeDiscriminator::EarlyLatePower;
    double pull_in_fll = 8.0;     ///< Hz, on single code periods, after a start without known symbols
    double pull_in_dll = 2.0;     ///< Hz
    double pull_in_time = 0.5;    ///< s, of each step of pulling in
    double sync_time = 1.0;       ///< s of listening for the message's symbols
    double code_only_dll = 0.1;   ///< Hz, code loop on inertial aid while the carrier is lost
    double phase_lock = 0.4;      ///< of the phase lock detector
    double phase_patience = 0.5;  ///< s below it before the phase counts as lost
    double retry_db = 24.0;       ///< dB-Hz from which a lost carrier is tried again
    double code_lost_db = 12.0;   ///< dB-Hz below which the code counts as lost
    double code_patience = 5.0;   ///< s below it

    /// Throws Error(Input) naming the setting.
    void check(const SignalStructure& signal) const;
};

enum class TrackState {
    Idle,
    PullIn,    ///< frequency and code loops
    Phase,     ///< phase loop locked or locking
    CodeOnly,  ///< carrier lost, code loop goes on with the inertial rate
    Lost,      ///< nothing followed: search
};

/// One channel. The owner forms correlators of each code period with replica() and gives them to step(), which returns nothing
/// and leaves the replica for the next period. Allocates nothing after construction.
///
/// With an aid, the inertial pseudorange rate is fed forward to the carrier at every code period and the loops, as narrow as
/// their settings say, follow only what is left of it: clock drift and the errors of the navigation. The code loop is aided by
/// the carrier while that is followed and by the inertial rate when it is lost [PaperA:1.1].
class Tracker {
public:
    Tracker(const SignalStructure& signal, const CorrelationPeak& peak, const TrackingSettings& settings);

    /// From a search. `dumps_into_symbol`: known when time is known to much better than a code period, as after a short outage;
    /// then the carrier is pulled in over half symbols, which needs 10 dB less.
    void start(const Replica& replica, std::optional<int> dumps_into_symbol = {});
    /// Ends the code period just correlated; `aid` is the inertial pseudorange motion at this moment, null without one.
    void step(const Correlators& dump, const LineOfSight* aid = nullptr);
    /// Lets `dt` s pass without a dump, or takes them back: dumps of samples begin where the code does, not every millisecond.
    void pass(double dt) { replica_ = replica_.after(dt); }

    [[nodiscard]] const Replica& replica() const { return replica_; }
    /// Pseudorange, m, its rate and acceleration as they are followed, at this moment. A frequency that is commanded is right in the
    /// middle of the time for which it stays: by the aid a code period, by the loop an update. The replica's own is that much early.
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
    int symbol_;  ///< code periods a symbol
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
    std::complex<double> slip_ = 0.0, last_ = 0.0;  ///< turn of the prompts of single code periods while the phase locks
    int dump_ = 0;
    int attempts_ = 0, escapes_ = 0;
    double time_in_mode_ = 0.0, unlocked_ = 0.0, weak_ = 0.0;
    double loop_frequency_ = 0.0, code_rate_ = 0.0;  ///< commands beyond the aids, Hz and chips/s
    double settled_ = 0.0;                           ///< Hz, loop frequency while locked, slowly averaged
    bool aided_ = false;
    LineOfSight aid_{};
};

}  // namespace schuler::receiver
