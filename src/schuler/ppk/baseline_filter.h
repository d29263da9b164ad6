// The Kalman filter of a baseline: position, velocity, atmosphere and ambiguities from double differences of code and phase.
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

/// Processes epochs forward or backward in time. States are position, velocity, differential zenith delay, and for each satellite
/// and carrier the single-difference ambiguity (m), of which only differences enter the double differences; on long baselines
/// also the ionosphere of each satellite. Integers are searched at every epoch, and fed back as soft constraints once all of them
/// have been the same for ten consecutive epochs.
class BaselineFilter {
public:
    /// The station and the plan are held by reference.
    BaselineFilter(const Settings& settings, const SignalPlan& plan, const BaseStation& station, bool estimate_ionosphere);

    EpochSolution step(const TrackedEpoch& rover);

private:
    static constexpr Eigen::Index leading = 7;  ///< position, velocity, zenith delay

    /// A state other than the leading ones.
    struct Entry {
        bool ionosphere = false;
        SatelliteId id;
        std::uint8_t slot = 0;
        int rover_arc = 0, base_arc = 0;
        Time seen;
        std::optional<Time> phase;   ///< last time it was used with a phase
        bool trusted = false;        ///< among the integers of the last valid fix
        bool broken = false;         ///< not an integer, unlike the others
        bool jumped = false;         ///< reset because the phase did not fit
        double integer = not_given;  ///< m, with the integers of the last valid fix; only differences within a group have meaning
    };
    /// A row of the epoch: one difference minus its reference.
    struct RowOf {
        std::size_t of, reference;
        bool phase;
    };
    /// Factor on the assumed variances, below one only if beyond doubt: a mean over some minutes of squares with unit
    /// expectation. Never below `least`.
    class Scale {
    public:
        explicit Scale(double least) : least_(least) {}
        void add(double squares, double dof, double dt);
        [[nodiscard]] double value() const { return value_; }

    private:
        double least_, mean_ = 1, weight_ = 0, value_ = 1;
    };
    /// Purpose of the weights: the filter, where persistent errors receive less weight with each epoch; tests of single
    /// measurements; the position of the epoch from its phases alone.
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
    void follow_ionosphere(const Eigen::VectorXd& x, double dt);
    void hold(const IntegerFix& fix);
    [[nodiscard]] EpochSolution single(const TrackedEpoch& rover) const;
    void look_at_signals(const Eigen::VectorXd& x, bool integers, EpochSolution& out) const;

    Settings settings_;
    const SignalPlan& plan_;
    const BaseStation& station_;
    bool ionosphere_;
    bool begun_ = false;
    Time tag_;
    Eigen::VectorXd x_;  ///< position absolute, the other states as in the filter
    Eigen::MatrixXd P_;
    std::vector<Entry> entries_;  ///< states from index `leading` on
    // of the current epoch
    std::vector<Difference> differences_;
    std::vector<Eigen::Index> ambiguity_, delay_;  ///< states of each difference; -1: none
    std::vector<bool> code_out_;
    std::map<int, double> offsets_;
    Scale code_scale_{0.25}, phase_scale_{1.0};
    /// Vertical ionospheric delay on L1, rover minus base, beyond the models.
    struct Vertical {
        double mean = 0, weight = 0;     ///< m, 1/m^2: over some minutes
        double value = 0, variance = 0;  ///< m, m^2: what is used of it
    } vertical_;
    std::map<std::pair<SatelliteId, std::uint8_t>, Time> code_;  ///< last use of a signal's code
    int same_integers_ = 0;                                      ///< consecutive epochs
    Ecef linearised_;                                            ///< position at which the differences were computed
    double baseline_ = 0;
};

}  // namespace schuler::ppk
