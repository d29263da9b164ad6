// The run of a filter along the timeline: increments, measurements, constraints, outputs. The same code for every coupling, for
// the forward filter, for start-up trials and for the smoother's replays; observers are notified of each step.
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

/// A fix used in parts until the next one (LooseKind::Aggressive). Extrapolated with the inertial motion, it contains the errors
/// of that motion: it is a measurement of the error at its own time, `rows` times the current error (docs/estimation.md).
struct CarriedFix {
    Measurement measurement;          ///< at the time of the fix; its variance is that of one part
    StateVector corrected;            ///< sum of the corrections since then, propagated
    std::array<StateVector, 3> rows;  ///< of the measurement in terms of the current errors
    int left = 0;                     ///< number of remaining parts
    Time stamp{}, next{};
    Duration every{1'000'000'000};
};

/// A channel with its own gate: one per kind, and an additional one if height or vertical velocity have a separate age, because a
/// good height must not excuse a bad position.
struct Channel {
    static constexpr std::size_t count = measurement_kinds + 2;

    MeasurementKind kind;
    bool vertical_only = false;
    std::uint8_t components = 7;

    Channel(MeasurementKind kind_, std::uint8_t components_ = 7)
        : kind(kind_), vertical_only(components_ == 4), components(components_) {}
    [[nodiscard]] std::size_t gate() const {
        const auto k = static_cast<std::size_t>(kind);
        return vertical_only && k < 2 ? measurement_kinds + k : k;
    }
    /// For a receiver's position or velocity: its place in FilterRun::fixes.
    [[nodiscard]] std::size_t fix() const {
        return (kind == MeasurementKind::GnssVelocity ? 1u : 0u) + (vertical_only ? 2u : 0u);
    }
};

/// The hypothesis that the navigation was wrong: its covariance is increased at the end of an increment by the refused fixes.
struct Opening {
    std::size_t increment = 0;
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< innovation NED, m; zero if no position was refused
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< likewise, m/s
    Eigen::Vector3d rate = Eigen::Vector3d::Zero();      ///< of the position's, m/s
    double span = 1.0;                                   ///< s since the last accepted fix
    double bias_jump = 0.0;  ///< a bias may have changed to explain the innovation, by at most this many tenths of a rad/s
    /// For the smoother: fraction of an error that arose gradually during `span`; zero: the whole error at once, at its end.
    double part = 0.0;
};

/// Whether competing hypotheses are formed when fixes are refused.
enum class Rivalry {
    None,     ///< consistent refused fixes are finally accepted: trials of noise and mounting
    Contest,  ///< two hypotheses run in parallel until the data decide
    Decided   ///< the openings determined by a contest are given: the smoother's pass
};

/// Where the computation produced invalid numbers.
struct Divergence {
    Time time{};
    MeasurementKind kind = MeasurementKind::GnssPosition;  ///< the channel in which it was detected
};

template <class Frame>
struct Rival;

/// Complete and copyable state of a run of the filter along the data, sufficient to continue from there.
template <class Frame>
struct FilterRun {
    InertialFilter<Frame> filter;
    std::size_t increment = 0;         ///< next to be processed
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
    std::vector<Shadow<Frame>> shadows;                           ///< two, or none if slow ramps are not monitored
    SecondOrder second_order;                                     ///< integrity in the uncoupled scheme
    bool unjudged = false;                                        ///< ... whose tilt is too uncertain to judge a fix
    RangeTracking ranges;

    double undecided_heading = 0.0;     ///< rad, Start::undecided_heading
    double refused_heading = 0.0;       ///< rad, by which a heading sensor consistently differs and is refused
    std::array<FixChannel, 4> fixes{};  ///< position, velocity, and the vertical ones if they have a separate age
    std::optional<Time> suspect;        ///< time of the last bridged inertial data
    std::optional<Opening> wanted;      ///< a rival to be created at the end of this increment
    std::vector<Opening> openings;      ///< the hypothesis represented by this run
    int sides_changed = 0;              ///< number of accepted rivals
    AtMostOne<Rival<Frame>> rival;
    bool challenged_by_fixes = true;       ///< false for a rival
    std::optional<Divergence> diverged{};  ///< the run ended here because the filter state became invalid

    /// Covariance of position, velocity and attitude due to undecided hypotheses, local level.
    [[nodiscard]] Matrix9 undecided(const InertialModel& model) const;
    /// Reported covariance of the same quantities.
    [[nodiscard]] Matrix9 covariance(const InertialModel& model) const {
        return reported_covariance(model, filter, undecided(model));
    }
};

/// Noise of a step including the vibration of the unit.
[[nodiscard]] inline BridgeNoise with_vibration(const InertialModel& model, const Vibration& vibration,
                                                const BridgeNoise& noise) {
    return {noise.gyro_psd + model.gyro_vibration * model.gyro_vibration * vibration.gyro_psd,
            noise.accel_psd + model.accel_vibration * model.accel_vibration * vibration.accel_psd, noise.standing};
}

/// The competing hypothesis about refused fixes, a separate run over the same data. A challenger assumes that the navigation was
/// wrong; once it is accepted, the run that refused the fixes continues as rival for a while.
template <class Frame>
struct Rival {
    FilterRun<Frame> run;
    Time since{};
    bool challenger = true;
    bool explained = false;         ///< the inertial log itself shows an event
    int accepted = 0, refused = 0;  ///< fixes since then
    int accepted_in_row = 0;
    int attempts = 0;        ///< previous challengers of the same run
    double patience = 60.0;  ///< s for which it continues after it has lost
    Opening opening;         ///< the opening it started with as a challenger

    /// Starts at `now`; `run` is set by the caller.
    void begin(Time now, bool challenger_, bool explained_, double patience_) {
        since = now;
        challenger = challenger_;
        explained = explained_;
        accepted = refused = accepted_in_row = attempts = 0;
        patience = patience_;
    }
};

/// Base class for observers of a run; its functions do nothing.
template <class Frame>
struct PassObserver : RangeListener {
    using Filter = InertialFilter<Frame>;

    /// True if transitions and scalars are to be recorded, which costs time.
    [[nodiscard]] virtual bool records() const { return false; }
    virtual void step(const estim::Transition&) {}
    /// The covariance was propagated over this many seconds.
    virtual void propagated(const Filter&, double) {}
    void scalar(const estim::RowUpdate&) override {}
    void renewed(int) override {}
    void cloned(int, const std::array<estim::Row, 3>&) override {}
    /// The estimate was corrected in a way not followed by the smoother: by a part of a carried fix, or with consider states.
    virtual void corrected() {}
    /// True if an output at this time requires more of the filter than the nominal state and its local_covariance: its covariance
    /// is then propagated to that time.
    [[nodiscard]] virtual bool wants_all_states(Time) const { return records(); }
    virtual void output(const FilterRun<Frame>&, Time) {}
    /// At RunData::instants[index], with the covariance at that time.
    virtual void instant(const FilterRun<Frame>&, std::size_t /*index*/) {}
    virtual void outage_epoch(const FilterRun<Frame>&, const Event&, const Measurement&, const MeasurementRecord&) {}
    virtual void measurement(const MeasurementRecord&) {}
    /// After the event: the estimate that results from it.
    virtual void measured(const FilterRun<Frame>&, const Event&, const MeasurementRecord&) {}
    virtual void alert(const Alert&) {}
    /// After the update with an epoch of ranges.
    virtual void ranges(const FilterRun<Frame>&, const RangeEpoch&) {}
    /// After the update with its carrier phases.
    virtual void carriers(const FilterRun<Frame>&, const RangeEpoch&, const CarrierUse&) {}
};

/// Runs a filter along the data.
template <class Frame>
class Pass {
public:
    using Observer = PassObserver<Frame>;

    /// `openings`: for Rivalry::Decided.
    Pass(const InertialModel& model, const RunData& data, const Settings& settings, Rivalry rivalry = Rivalry::None,
         std::vector<Opening> openings = {});

    /// Processes increments up to and including index `last`. Throws Error(Computation) if the filter diverges.
    void advance(FilterRun<Frame>& run, std::size_t last, Observer& observer) const;
    /// The same without exceptions. False if the filter diverged: `run.diverged` gives the place; the run is no longer usable.
    [[nodiscard]] bool try_advance(FilterRun<Frame>& run, std::size_t last, Observer& observer) const;
    /// Propagates the covariance, and the run's own record of corrections, to the time of the nominal state.
    void propagate_covariance(FilterRun<Frame>& run, Observer& observer) const;

private:
    void step(FilterRun<Frame>& run, const ImuIncrement& increment, const BridgeNoise& noise, Observer& observer) const;
    // Each of these that updates returns at once if the filter has diverged, and so does its caller: run.diverged.
    /// Processes the measurements due before the end of an increment; returns the remainder of the increment.
    [[nodiscard]] ImuIncrement run_to_events(FilterRun<Frame>& run, ImuIncrement increment, const BridgeNoise& noise,
                                             Observer& observer) const;
    void process(FilterRun<Frame>& run, const Event& event, Observer& observer) const;
    void process(FilterRun<Frame>& run, const RangeEpoch& epoch, Observer& observer) const;
    /// True if the coupling uses measurements of this kind.
    [[nodiscard]] bool uses(MeasurementKind kind) const;
    /// The receiver's slow errors jump when the set of satellites changes.
    void change_constellation(FilterRun<Frame>& run, const Event& event) const;
    void constrain(FilterRun<Frame>& run, Observer& observer) const;
    void stand_still(FilterRun<Frame>& run, Observer& observer) const;
    MeasurementRecord try_update(FilterRun<Frame>& run, Channel channel, const Measurement& local, Time stamp, bool withheld,
                                 Observer& observer) const;
    /// Applies the hypotheses about refused fixes: whether this one is used. `m` may be shifted to the level it belongs to.
    MeasurementStatus judge(FilterRun<Frame>& run, Channel channel, MeasurementRecord& record, Measurement& local, Measurement& m,
                            Observer& observer) const;
    [[nodiscard]] bool contests(MeasurementKind kind) const;
    /// At the end of an increment: propagates the rival and decides between the two if possible.
    void contest(FilterRun<Frame>& run, Observer& observer) const;
    void challenge(FilterRun<Frame>& run) const;
    void change_sides(FilterRun<Frame>& run) const;
    void open(FilterRun<Frame>& run, const Opening& opening) const;
    [[nodiscard]] Measurement measurement_of(const InertialFilter<Frame>& filter, const Event& event) const;
    /// Noise of a fix, m^2 and m^2/s^2; latency: the state of the velocity's, or -1.
    [[nodiscard]] Eigen::Vector3d position_variance(const InertialFilter<Frame>& filter, const Estimate& e,
                                                    const Event& event) const;
    [[nodiscard]] Eigen::Vector3d velocity_variance(const InertialFilter<Frame>& filter, const Estimate& e, const Event& event,
                                                    int latency) const;
    [[nodiscard]] Eigen::Matrix<double, 9, 1> of_latency(const InertialFilter<Frame>& filter, const Estimate& e, int state) const;
    /// Corrects the estimate by an accepted measurement according to the coupling. False: it is not used.
    bool use(FilterRun<Frame>& run, Channel channel, const Measurement& local, const Measurement& m, Time stamp,
             Observer& observer) const;
    bool use_separately(FilterRun<Frame>& run, Channel channel, const Measurement& local, const Measurement& m, Time stamp) const;
    /// Seconds since the last correction of this channel in the uncoupled scheme, 1 before any.
    [[nodiscard]] static double correction_interval(const FilterRun<Frame>& run, Channel channel, Time stamp);
    /// Corrects the filter of the run or a copy of it by gain columns in local-level errors.
    void correct_separately(InertialFilter<Frame>& filter, SecondOrder& second_order, const Measurement& m, Gains gains) const;
    /// The barometer's loop after `dt` seconds.
    void close_baro_loop(InertialFilter<Frame>& filter, SecondOrder& second_order, const Measurement& m, double dt) const;
    /// A barometer's height in the copies without the receiver, as the run used it.
    void use_baro_in_shadows(FilterRun<Frame>& run, const Event& event, double dt) const;
    /// True if the solution of a uncoupled scheme is too tilted to judge fixes; reported the first time.
    bool cannot_judge(FilterRun<Frame>& run, Channel channel, Time stamp, Observer& observer) const;
    /// Updates the filter and the records of its corrections. Returns the estimated error.
    StateVector update(FilterRun<Frame>& run, const Measurement& m, Observer& observer) const;
    /// Propagates a fix used in parts over an interval with this transition.
    void carry(CarriedFix& fix, const estim::Transition& phi) const;
    /// Uses the parts of extrapolated fixes that are due.
    void carry_on(FilterRun<Frame>& run, Observer& observer) const;
    /// Integrity check of one sub-vector of a fix: whether it may be used.
    MeasurementStatus examine(FilterRun<Frame>& run, Channel channel, const MeasurementRecord& record, const Examined& examined,
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
