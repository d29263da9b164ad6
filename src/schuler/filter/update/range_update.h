// One epoch of ranges in the filter: rows, the test of each range against the inertial prediction, exclusion, update.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/filter/integrity/fault_watch.h"
#include "schuler/filter/measurement/range.h"
#include "schuler/filter/ranging_settings.h"
#include "schuler/filter/states/inertial_filter.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace schuler::filter {

/// Limits of the tests, from a single probability of rejecting a good measurement.
struct RangeTest {
    double single = 0.0;             ///< of a squared normalised innovation
    std::array<double, 65> whole{};  ///< of their sum, by their number
    double watch = 0.0;              ///< of the fault watch, 0: none
    double recovery_time = 10.0;     ///< s after which the slow error of a persistently disagreeing source is opened

    RangeTest() = default;
    /// probability 0: everything is accepted.
    RangeTest(double probability, double recovery_time_);
};

/// One scalar of an epoch.
struct RangeScalar {
    int source = 0;  ///< index into RangingLog::sources
    bool station = false, is_rate = false, use = true;
    bool phase_change = false;  ///< a rate from the phases of a log
    int slot = -1;              ///< state of the slow error of the source's range
    double innovation = 0.0;    ///< computed minus measured, m or m/s
    double variance = 1.0;      ///< of its white noise
    double distance = 0.0;      ///< m
    double sequential = 0.0;    ///< normalised innovation after the preceding ones of the epoch; white in the absence of faults
    double s = 1.0;             ///< variance of that innovation
    estim::Row row;             ///< in the filter's own errors
};

/// Memory for one epoch, kept between epochs to avoid allocation.
struct RangeEpochWork {
    static constexpr std::size_t most = 64;  ///< scalars of an epoch; further sources are ignored
    std::array<RangeScalar, most> scalars;
    std::size_t count = 0;
    int excluded = 0;       ///< scalars
    bool withheld = false;  ///< the satellites', by an outage
    bool clock_jump = false;
    int alarm = -1;       ///< source found faulty by the fault watch at this epoch
    int disagreeing = 0;  ///< consecutive epochs in which most ranges were excluded
    Time disagreeing_since{};

    [[nodiscard]] std::span<RangeScalar> all() { return {scalars.data(), count}; }
    [[nodiscard]] std::span<const RangeScalar> all() const { return {scalars.data(), count}; }
};

/// State of a run's ranges; plain and copyable.
struct RangeTracking {
    /// The slot of a source: a state of each of the layout's source blocks.
    struct Slot {
        int source = -1;  ///< index into RangingLog::sources; -1: free
        bool station = false;
        Time last{};                    ///< time of its last measurement
        std::optional<Time> doubted{};  ///< of the first rejection since the last acceptance
    };
    std::array<Slot, Layout::slots> slots{};
    /// A carrier whose phase errors are states: two, of which `end` belongs to the phase at the end of its last rate.
    struct Phase {
        int source = -1;            ///< index into RangingLog::sources; -1: free
        Time last{};                ///< time of that phase
        int end = 0, begin = 0;     ///< states of the ends of the last rate
        Ecef tx_end{}, tx_begin{};  ///< the transmitter at those times; not finite: unknown
    };
    std::array<Phase, 12> phases{};
    /// A state of the layout's ambiguities.
    struct Ambiguity {
        int source = -1;  ///< index into RangingLog::sources; -1: free
        std::uint8_t carrier = 0;
        int arc = 0;
        Time seen{};
        std::optional<Time> used{};                                 ///< of its last phase in the filter
        bool jumped = false;                                        ///< begun by a phase that did not fit: perhaps half cycles
        bool trusted = false;                                       ///< among the integers last found
        bool held = false;                                          ///< its integer is used by the filter
        double integer = std::numeric_limits<double>::quiet_NaN();  ///< m, last found: differences within a group matter
    };
    std::array<Ambiguity, Layout::most_ambiguities> ambiguities{};
    int same_integers = 0;  ///< epochs in a row with the same integers
    Time same_since{};
    Eigen::Vector3d cloned_velocity = Eigen::Vector3d::Zero();  ///< m/s, Earth-fixed, of the antenna then
    std::optional<Time> cloned{};  ///< time at which the antenna was in the position of the layout's antenna block
    FaultWatch watch;
    RangeEpochWork work;
};

/// What became of an epoch's carrier phases.
struct CarrierUse {
    int phases = 0;      ///< used
    int slipped = 0;     ///< whose ambiguity began anew
    int doubted = 0;     ///< 1: the prediction contradicted most of them and was opened
    int whole = 0;       ///< ambiguities of them that may be integers
    int held = 0;        ///< with a fixed integer
    double ratio = 0.0;  ///< of the last search; 0: none
};

/// Observer of an update with ranges, for stepping back over it later.
struct RangeListener {
    virtual ~RangeListener() = default;
    /// A state was reassigned to another source.
    virtual void renewed(int state) = 0;
    /// Three states became the combinations `rows` of the others.
    virtual void cloned(int first, const std::array<estim::Row, 3>& rows) = 0;
    virtual void scalar(const estim::RowUpdate& update) = 0;
};

/// Index of a satellite system's offset in the layout's intersystem block, -1 for GPS and those that share its clock.
[[nodiscard]] int intersystem_of(const RangeSource& source);

/// Ranges in a filter whose layout has a clock. References are held. `backward`: the filter's time, velocities, rates and the
/// Earth rotation are reversed (filter/update/reversed.h), those of the ranges are not.
template <class Frame>
class RangeUpdate {
public:
    /// `jitter`: s, of the time of fixes by the clock of the IMU, if known to be more than settings.timing_std.
    RangeUpdate(const InertialModel& model, const RangingFilterSettings& settings, const Eigen::Vector3d& lever_arm_b,
                const RangeTest& test, bool backward = false, double jitter = 0.0)
        : model_(model),
          settings_(settings),
          lever_arm_b_(lever_arm_b),
          test_(test),
          backward_(backward),
          timing_std_(std::max(settings.timing_std, jitter)) {}

    /// Fraction of the variance of a phase-derived rate not shared with the phases at its ends: a measurement without its own noise
    /// would make the covariance singular. A larger value would represent a random walk between the phases, which does not exist.
    static constexpr double unshared = 1e-6;

    /// `listener` may be null. Updates the filter with an epoch at its own time (after propagate_covariance). All scalars are
    /// used in sequence; if the sum of squares or one of them exceeds its limit, the epoch is undone and each scalar is tested
    /// against all the others and the inertial prediction (w_i = (S^-1 z)_i / sqrt((S^-1)_ii), normal without faults), the worst
    /// is excluded, and so on until the rest agree: single and multiple faults. A jump of the receiver's clock, common to all
    /// ranges, is followed. With a fault watch, a source found faulty raises an alarm: the effect of the fault on the estimate is
    /// removed, and the source is excluded until it agrees again. Returns the number of scalars used.
    int operator()(InertialFilter<Frame>& filter, RangeTracking& tracking, const RangingLog& log,
                   std::span<const RangeSample> samples, RangeListener* listener) const;

    /// Carrier phases relative to a base, of an epoch whose ranges have been used: their ambiguities are states. A phase that
    /// contradicts the others and the prediction has slipped, and its ambiguity begins anew. Integers that are found several times in a
    /// row are used by the filter. The scalars of the epoch are then those of the phases.
    CarrierUse use_carriers(InertialFilter<Frame>& filter, RangeTracking& tracking, const RangingLog& log,
                            const RangeEpoch& epoch, RangeListener* listener) const;

    /// Fills the scalars of an epoch for an estimate: that of `filter` corrected by `dx`. Rows refer to the current errors of the
    /// filter, so that innovation = row . error + noise to first order about the corrected estimate (an iterated update).
    void make_scalars(InertialFilter<Frame>& filter, RangeTracking& tracking, const RangingLog& log,
                      std::span<const RangeSample> samples, const StateVector& dx, RangeListener* listener) const;

    /// Slot of a source's slow errors, assigned if it has none: -1 if its kind has no slow error or all slots are in use.
    /// `sigma`, `time`: of that of its range, m, and the time within which it changes, s.
    [[nodiscard]] int slot_of(InertialFilter<Frame>& filter, RangeTracking& tracking, int source, bool station, double sigma,
                              double time, RangeListener* listener) const;

private:
    /// State of an ambiguity, assigned if it has none; -1: all are in use.
    [[nodiscard]] int ambiguity_of(InertialFilter<Frame>& filter, RangeTracking& tracking, const CarrierSample& sample,
                                   RangeListener* listener) const;
    void begin_ambiguity(InertialFilter<Frame>& filter, RangeTracking& tracking, int which, double more,
                         RangeListener* listener) const;
    /// Fills the scalars with phases; RangeScalar::slot is the number of the ambiguity.
    void make_carriers(const InertialFilter<Frame>& filter, RangeTracking& tracking, const RangingLog& log,
                       const RangeEpoch& epoch, const std::array<int, RangeEpochWork::most>& assigned) const;
    [[nodiscard]] int misfits(const InertialFilter<Frame>& filter, RangeEpochWork& work) const;
    void doubt_prediction(InertialFilter<Frame>& filter, const RangeTracking& tracking, const RangeEpochWork& work) const;
    /// Searches integers and fixes them in the filter.
    void find_integers(InertialFilter<Frame>& filter, RangeTracking& tracking, const RangingLog& log, const RangeEpoch& epoch,
                       RangeListener* listener, CarrierUse& use) const;
    [[nodiscard]] const sensor::RangeErrorModel& errors_of(bool station) const {
        return station ? settings_.errors.station : settings_.errors.satellite;
    }
    /// Range rates of this kind of source have slow errors of their own, which are states.
    [[nodiscard]] bool has_slow_rate(bool station) const {
        return model_.layout.source_rate >= 0 && errors_of(station).correlated_rate > 0.0;
    }
    /// The antenna of the estimate less dx; `way` -1: in the time direction of the ranges, for a filter running backward.
    [[nodiscard]] AntennaEstimate antenna(const InertialFilter<Frame>& filter, const StateVector& dx, double way) const;
    [[nodiscard]] double sigma_of(double stated, double model_sigma, bool station, double elevation, double cn0) const;
    /// The states of the phases between which a rate was measured; null if there are none.
    [[nodiscard]] const RangeTracking::Phase* phase_of(InertialFilter<Frame>& filter, RangeTracking& tracking,
                                                       const RangeSample& sample, RangeListener* listener) const;
    /// The rate between two phases, with local-level rows for position and attitude and Earth-fixed rows for the clone.
    struct PhaseRate {
        double rate = 0.0;
        Eigen::Vector3d by_position, by_attitude, by_lever_arm, by_clone;
    };
    /// The antenna position at the start of the interval is known; `now`: the range at its end. `dx`: as in make_scalars.
    [[nodiscard]] PhaseRate phase_rate(const InertialFilter<Frame>& filter, const AntennaEstimate& antenna, const RangeRows& now,
                                       const RangeSample& sample, const RangeTracking::Phase* phase, const StateVector& dx) const;
    /// Stores the current antenna position in the layout's antenna block.
    void clone_antenna(InertialFilter<Frame>& filter, RangeTracking& tracking, RangeListener* listener) const;
    /// Maps the first nine entries of a row from local-level errors to the filter's own.
    [[nodiscard]] Matrix9 local_rows(const NavState& nav) const;
    /// True if the antenna position at the start of a rate's interval is known.
    [[nodiscard]] bool spans_phases(const InertialFilter<Frame>& filter, const RangeTracking& tracking,
                                    const RangeSample& sample) const;
    /// Reassigns a state: an error of variance `variance`, uncorrelated with all others.
    void renew(InertialFilter<Frame>& filter, RangeTracking& tracking, int state, double variance, RangeListener* listener) const;
    bool use_all(const RangeTest& test, estim::EpochUpdate& update, RangeEpochWork& work, StateVector& dx,
                 RangeListener* listener) const;
    [[nodiscard]] bool follow_clock_jump(InertialFilter<Frame>& f, const RangeEpochWork& work) const;
    [[nodiscard]] bool leave_out_worst(const InertialFilter<Frame>& f, RangeEpochWork& work) const;
    [[nodiscard]] bool is_curved(const InertialFilter<Frame>& f, const RangeEpochWork& work) const;
    [[nodiscard]] int doubt_sources(InertialFilter<Frame>& f, RangeTracking& tracking) const;
    void follow_faults(InertialFilter<Frame>& f, RangeTracking& tracking) const;
    void leave_out(InertialFilter<Frame>& f, RangeTracking& tracking, int source, RangeListener* listener) const;
    void follow_left_out(const InertialFilter<Frame>& f, RangeTracking& tracking) const;
    void doubt_the_estimate(InertialFilter<Frame>& f, RangeTracking& tracking) const;

    const InertialModel& model_;
    const RangingFilterSettings& settings_;
    const Eigen::Vector3d& lever_arm_b_;
    const RangeTest& test_;
    bool backward_;
    double timing_std_;
};

}  // namespace schuler::filter
