// The run of a filter along the timeline: increments, measurements, constraints, outputs. One code for every coupling, for the forward filter, for
// start-up trials and for the smoother's replays; who wants to know what happens observes it.
#pragma once

#include "schuler/filter/integrity/gate.h"
#include "schuler/filter/integrity/integrity.h"
#include "schuler/filter/integrity/refused_fixes.h"
#include "schuler/filter/measurement/measurement.h"
#include "schuler/filter/result.h"
#include "schuler/filter/settings.h"
#include "schuler/filter/states/inertial_filter.h"
#include "schuler/filter/update/at_most_one.h"
#include "schuler/filter/update/range_update.h"
#include "schuler/filter/update/timeline.h"
#include "schuler/filter/update/vibration.h"
#include "schuler/filter/update/wheel_evidence.h"

#include <array>
#include <optional>
#include <vector>

namespace schuler::filter {

/// A fix that is used in parts until the next one (LooseKind::Aggressive). Carried on by the inertial motion since, it has the errors of
/// that motion in it: it is a measurement of the error at its own time, `rows` times the error of now (docs/estimation.md).
struct CarriedFix {
    Measurement measurement;          ///< at the time of the fix; its variance is that of one part
    StateVector corrected;            ///< sum of the corrections since, propagated
    std::array<StateVector, 3> rows;  ///< of the measurement in the errors of now
    int left = 0;                     ///< parts
    Time stamp{}, next{};
    Duration every{1'000'000'000};
};

/// A channel has a gate of its own: one a kind, and one more where a height or a vertical velocity comes with an age of its own, for
/// a good height must not excuse a bad position.
struct Channel {
    static constexpr std::size_t count = measurement_kinds + 2;

    AidKind kind;
    bool vertical_only = false;
    std::uint8_t components = 7;

    Channel(AidKind kind_, std::uint8_t components_ = 7)
        : kind(kind_), vertical_only(components_ == 4), components(components_) {}
    [[nodiscard]] std::size_t gate() const {
        const auto k = static_cast<std::size_t>(kind);
        return vertical_only && k < 2 ? measurement_kinds + k : k;
    }
    /// Of a receiver's position or velocity: its place in FilterRun::fixes.
    [[nodiscard]] std::size_t fix() const { return (kind == AidKind::GnssVelocity ? 1u : 0u) + (vertical_only ? 2u : 0u); }
};

/// "The navigation was wrong": its covariance is opened at the end of an increment by what the refused fixes say.
struct Opening {
    std::size_t increment = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< innovation NED, m; zero where no position is refused
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< likewise, m/s
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();      ///< of the position's, m/s
    double span = 1.0;                                   ///< s since the last fix that fitted
    double bias_jump = 0.0;  ///< a bias may have jumped by what explains the innovation, up to so many tenths of a rad/s
};

/// Whether the filter asks who is wrong when fixes are refused.
enum class Rivalry {
    None,     ///< consistent refused fixes win in the end: trials of a start
    Contest,  ///< two hypotheses go side by side until the data decide
    Decided   ///< the openings that a contest ended with are told: the smoother's pass
};

/// Where the computation lost its numbers.
struct Divergence {
    Time time{};
    AidKind kind = AidKind::GnssPosition;  ///< the channel that showed it
};

template <class Frame>
struct Rival;

/// State of a run of the filter along the data, with everything needed to go on from there; copyable.
template <class Frame>
struct FilterRun {
    InertialFilter<Frame> filter;
    std::size_t increment = 0;         ///< next to be consumed
    std::size_t event = 0, epoch = 0;  ///< next measurement, next epoch of ranges
    std::size_t still = 0;
    std::size_t bridge = 0;
    std::size_t instant = 0;  ///< next of RunData::instants
    std::size_t outputs = 0;  ///< number of outputs made
    Time next_output{};
    Time next_constraint{};
    Time next_feedback{};  ///< of the mixed loop
    Duration feedback_period{};
    std::array<GateState, Channel::count> gates{};  ///< by Channel::gate()
    WheelEvidence wheels;
    Vibration vibration;
    Time last_still{INT64_MIN / 2};
    std::array<CarriedFix, 2> carried{};                          ///< position, velocity: Aggressive
    std::array<std::optional<Time>, Channel::count> corrected{};  ///< by Channel::gate(), when last: Separate
    std::array<ChannelHealth, 2> health{};                        ///< position, velocity: integrity
    std::vector<Shadow<Frame>> shadows;                           ///< two, or none where slow ramps are not looked for
    RangeTracking ranges;

    double undecided_heading = 0.0;     ///< rad, Start::undecided_heading
    std::array<FixChannel, 4> fixes{};  ///< position, velocity, and where the vertical has an age of its own: of that
    std::optional<Time> suspect;        ///< the inertial unit was last bridged
    std::optional<Opening> wanted;      ///< a rival, at the end of this increment
    std::vector<Opening> openings;      ///< the hypothesis that this run is
    int sides_changed = 0;              ///< how often a rival was accepted
    AtMostOne<Rival<Frame>> rival;
    bool challenged_by_fixes = true;       ///< a rival is not
    std::optional<Divergence> diverged{};  ///< the run ends here: the filter is no longer a number

    /// What is not decided between the hypotheses, as a covariance of position, velocity and attitude, local level.
    [[nodiscard]] Matrix9 undecided(const InertialModel& model) const;
    /// Covariance of the same as it is reported.
    [[nodiscard]] Matrix9 covariance(const InertialModel& model) const {
        return reported_covariance(model, filter, undecided(model));
    }
};

/// Noise of a step with what the unit shakes by.
[[nodiscard]] inline BridgeNoise with_vibration(const InertialModel& model, const Vibration& vibration,
                                                const BridgeNoise& noise) {
    return {noise.gyro_psd + model.gyro_vibration * model.gyro_vibration * vibration.gyro_psd,
            noise.accel_psd + model.accel_vibration * model.accel_vibration * vibration.accel_psd, noise.standing};
}

/// The other hypothesis about fixes that were refused, a run of its own over the same data. A challenger says that the navigation was
/// wrong; once it is accepted, the one that refused the fixes goes on as rival for a while.
template <class Frame>
struct Rival {
    FilterRun<Frame> run;
    Time since{};
    bool challenger = true;
    bool explained = false;         ///< the inertial log itself says that something happened
    int accepted = 0, refused = 0;  ///< fixes since then
    int accepted_in_row = 0;
    int attempts = 0;        ///< challengers before it, of the same run
    double patience = 60.0;  ///< s for which it goes on once it has lost
    Opening opening;         ///< with which it was opened as a challenger

    /// From `now` on; `run` is the caller's.
    void begin(Time now, bool challenger_, bool explained_, double patience_) {
        since = now;
        challenger = challenger_;
        explained = explained_;
        accepted = refused = accepted_in_row = attempts = 0;
        patience = patience_;
    }
};

/// Who wants to know what happens on the run derives from this; the base does not care.
template <class Frame>
struct PassObserver : RangeListener {
    using Filter = InertialFilter<Frame>;

    /// Whether transitions and scalars are wanted: recording them costs time.
    [[nodiscard]] virtual bool records() const { return false; }
    virtual void step(const estim::Transition&) {}
    /// The covariance has followed the nominal state over so many seconds.
    virtual void propagated(const Filter&, double) {}
    void scalar(const estim::RowUpdate&) override {}
    void renewed(int) override {}
    void cloned(int, const std::array<estim::Row, 3>&) override {}
    /// The estimate was corrected in a way that the smoother does not follow: by a part of a carried fix, with considered errors.
    virtual void corrected() {}
    /// Whether an output at this time needs more of the filter than the nominal state and its local_covariance: its covariance is then
    /// that of the same time.
    [[nodiscard]] virtual bool wants_all_states(Time) const { return records(); }
    virtual void output(const FilterRun<Frame>&, Time) {}
    /// At RunData::instants[index], with the covariance at that time.
    virtual void instant(const FilterRun<Frame>&, std::size_t /*index*/) {}
    virtual void outage_epoch(const FilterRun<Frame>&, const Event&, const Measurement&, const AidRecord&) {}
    virtual void aid(const AidRecord&) {}
    /// After it: what the estimate has become by an event.
    virtual void measured(const FilterRun<Frame>&, const Event&, const AidRecord&) {}
    virtual void alert(const Alert&) {}
    /// After the update with an epoch of ranges.
    virtual void ranges(const FilterRun<Frame>&, const RangeEpoch&) {}
};

/// Runs a filter along the data.
template <class Frame>
class Pass {
public:
    using Observer = PassObserver<Frame>;

    /// `openings`: with Rivalry::Decided.
    Pass(const InertialModel& model, const RunData& data, const Settings& settings, Rivalry rivalry = Rivalry::None,
         std::vector<Opening> openings = {});

    /// Consumes increments up to and including index `last`. Throws Error(Computation) where the filter diverges.
    void advance(FilterRun<Frame>& run, std::size_t last, Observer& observer) const;
    /// The same without exceptions. False where the filter diverged: `run.diverged` tells where, and the run is of no more use.
    [[nodiscard]] bool try_advance(FilterRun<Frame>& run, std::size_t last, Observer& observer) const;
    /// Covariance to the time of the nominal state; the run's own memory of corrections with it.
    void propagate_covariance(FilterRun<Frame>& run, Observer& observer) const;

private:
    void step(FilterRun<Frame>& run, const ImuIncrement& increment, const BridgeNoise& noise, Observer& observer) const;
    // Each of these that updates returns at once where it finds the filter diverged, and its caller after it: run.diverged.
    /// The measurements that are due before the end of an increment; what is left of it is returned.
    [[nodiscard]] ImuIncrement run_to_events(FilterRun<Frame>& run, ImuIncrement increment, const BridgeNoise& noise,
                                             Observer& observer) const;
    void process(FilterRun<Frame>& run, const Event& event, Observer& observer) const;
    void process(FilterRun<Frame>& run, const RangeEpoch& epoch, Observer& observer) const;
    /// Whether the coupling corrects with measurements of this kind.
    [[nodiscard]] bool uses(AidKind kind) const;
    /// The receiver's slow errors jump where the set of satellites changes.
    void change_constellation(FilterRun<Frame>& run, const Event& event) const;
    void constrain(FilterRun<Frame>& run, Observer& observer) const;
    void stand_still(FilterRun<Frame>& run, Observer& observer) const;
    AidRecord try_update(FilterRun<Frame>& run, Channel channel, const Measurement& local, Time stamp, bool withheld,
                         Observer& observer) const;
    /// The hypotheses about refused fixes: whether this one is used. `m` may be moved to the level it belongs to.
    AidStatus judge(FilterRun<Frame>& run, Channel channel, AidRecord& record, Measurement& local, Measurement& m,
                    Observer& observer) const;
    [[nodiscard]] bool contests(AidKind kind) const;
    /// At the end of an increment: the rival follows, and one of the two may win.
    void contest(FilterRun<Frame>& run, Observer& observer) const;
    void challenge(FilterRun<Frame>& run) const;
    void change_sides(FilterRun<Frame>& run) const;
    void open(FilterRun<Frame>& run, const Opening& opening) const;
    [[nodiscard]] Measurement measurement_of(const InertialFilter<Frame>& filter, const Event& event) const;
    [[nodiscard]] Eigen::Matrix<double, 9, 1> of_latency(const InertialFilter<Frame>& filter, const Estimate& e, int state) const;
    /// Corrects the estimate by an accepted measurement as the coupling wants it. False: it is not used.
    bool use(FilterRun<Frame>& run, Channel channel, const Measurement& local, const Measurement& m, Time stamp,
             Observer& observer) const;
    bool use_separately(FilterRun<Frame>& run, Channel channel, const Measurement& local, const Measurement& m, Time stamp) const;
    /// Updates the filter and what remembers its corrections. Returns the error that was found.
    StateVector update(FilterRun<Frame>& run, const Measurement& m, Observer& observer) const;
    /// A fix that is used in parts over a span with this transition.
    void carry(CarriedFix& fix, const estim::Transition& phi) const;
    /// The parts of the fixes carried on that are due.
    void carry_on(FilterRun<Frame>& run, Observer& observer) const;
    /// Integrity of one sub-vector of a fix: whether it may be used.
    AidStatus examine(FilterRun<Frame>& run, Channel channel, const AidRecord& record, const Examined& examined,
                      Observer& observer) const;
    /// The slow-ramp test of a fix, before its own update.
    void look_back(FilterRun<Frame>& run, const Event& event, Observer& observer) const;
    void renew_shadows(FilterRun<Frame>& run) const;
    void observe_wheels(FilterRun<Frame>& run, const Estimate& e) const;
    void recover(FilterRun<Frame>& run, Channel channel, const Measurement& local) const;

    const InertialModel& model_;
    const RunData& data_;
    const Settings& settings_;
    Rivalry rivalry_;
    bool vibrates_;
    std::vector<Opening> openings_;
    RangeTest range_test_;
    RangeUpdate<Frame> update_with_ranges_;
};

}  // namespace schuler::filter
