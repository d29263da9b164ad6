// The Kalman filter of a baseline: position, velocity, air and ambiguities from double differences of code and phase.
#pragma once

#include "schuler/estim/block_update.h"
#include "schuler/ppk/differences.h"
#include "schuler/ppk/integers.h"
#include "schuler/ppk/solution.h"

#include <Eigen/Core>

#include <map>
#include <optional>
#include <vector>

namespace schuler::ppk {

/// Goes from epoch to epoch, forwards or backwards in time. States are position, velocity, the zenith delay's difference, and for each
/// satellite and carrier the ambiguity of the single difference (m), of which the double differences see differences only; on long baselines
/// the ionosphere of each satellite. Integers are searched at every epoch, and fed back as soft constraints once all of them were the same
/// ten epochs in a row.
class BaselineFilter {
public:
    /// The station and the plan are kept by reference.
    BaselineFilter(const Settings& settings, const SignalPlan& plan, const BaseStation& station, bool estimate_ionosphere);

    EpochSolution step(const TrackedEpoch& rover);

private:
    static constexpr Eigen::Index leading = 7;  ///< position, velocity, zenith delay

    /// A state beside the first ones.
    struct Entry {
        bool ionosphere = false;
        SatelliteId id;
        std::uint8_t slot = 0;
        int rover_arc = 0, base_arc = 0;
        Time seen;
        std::optional<Time> phase;   ///< last time a phase was used with it
        bool trusted = false;        ///< among the integers that held last
        bool broken = false;         ///< no whole number, as others that are showed
        bool jumped = false;         ///< begun anew because the phase did not fit
        double integer = not_given;  ///< m, with the integers that held last; only differences within a group mean something
    };
    /// A row of the epoch: one difference less its reference.
    struct RowOf {
        std::size_t of, reference;
        bool phase;
    };
    /// By how much variances are larger than they are taken for, or smaller where that is beyond doubt: a mean over some minutes of squares
    /// that ought to be one. Never below `least`.
    class Scale {
    public:
        explicit Scale(double least) : least_(least) {}
        void add(double squares, double dof, double dt);
        [[nodiscard]] double value() const { return value_; }

    private:
        double least_, mean_ = 1, weight_ = 0, value_ = 1;
    };
    /// What the rows are for: the filter, to which errors that last count for less with each epoch; tests of single measurements; the position
    /// of the epoch by its phases alone.
    enum class Weighting { Filter, Single, Phases };
    struct Suspect {
        std::size_t difference = 0;
        bool phase = false;
        double size = 0;  ///< sigmas
    };
    struct Rows {
        std::vector<RowOf> of;
        Eigen::MatrixXd H, R;
        Eigen::VectorXd z;
    };

    [[nodiscard]] Entry& entry_of(std::size_t difference) {
        return entries_[static_cast<std::size_t>(ambiguity_[difference] - leading)];
    }
    [[nodiscard]] const Entry& entry_of(std::size_t difference) const {
        return entries_[static_cast<std::size_t>(ambiguity_[difference] - leading)];
    }
    void predict(double dt);
    void begin_at(const TrackedEpoch& rover);
    void settle_states(const TrackedEpoch& rover, Time before);
    void forget(Time tag, Time before);
    [[nodiscard]] double first_ambiguity(const Difference& d) const;
    void restart(std::size_t difference);
    [[nodiscard]] double lasting_code(const Difference& d, Time tag) const;
    [[nodiscard]] double lasting_phase(std::size_t difference, Time tag) const;
    [[nodiscard]] Rows rows(Time tag, Weighting weighting, const Eigen::VectorXd& x) const;
    double place(Time tag, const Eigen::VectorXd& x, const Eigen::MatrixXd& P, EpochSolution& out) const;
    [[nodiscard]] Suspect worst(const estim::BlockUpdate& block, const Rows& rows) const;
    bool reject_misfits(Time tag, EpochSolution& out);
    void judge_codes(double dt);
    bool update(Time tag, double dt, EpochSolution& out);
    void use_velocity(const TrackedEpoch& rover);
    void use_integers(Time tag, double dt, EpochSolution& out);
    void hold(const IntegerFix& fix);
    [[nodiscard]] EpochSolution single(const TrackedEpoch& rover) const;
    void look_at_signals(const Eigen::VectorXd& x, bool integers, EpochSolution& out) const;

    Settings settings_;
    const SignalPlan& plan_;
    const BaseStation& station_;
    bool ionosphere_;
    bool begun_ = false;
    Time tag_;
    Eigen::VectorXd x_;  ///< the position as it is, the others as the filter has them
    Eigen::MatrixXd P_;
    std::vector<Entry> entries_;  ///< states from `leading` on
    // of the epoch
    std::vector<Difference> differences_;
    std::vector<Eigen::Index> ambiguity_, delay_;  ///< states of each difference; -1: none
    std::vector<bool> code_out_;
    std::map<int, double> offsets_;
    Scale code_scale_{0.25}, phase_scale_{1.0};
    std::map<std::pair<SatelliteId, std::uint8_t>, Time> code_;  ///< when a signal's code was last used
    int same_integers_ = 0;                                      ///< epochs in a row
    Ecef linearised_;                                            ///< where the differences were computed
    double baseline_ = 0;
};

}  // namespace schuler::ppk
