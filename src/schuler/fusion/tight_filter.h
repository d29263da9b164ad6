// The tightly coupled filter: an inertial filter of fifteen states with the barometer's bias, and beside it the clock and what is wrong
// with ranges slowly. The inertial part is driven at the rate of the increments; the large covariance follows when it is wanted.
#pragma once

#include "schuler/core/ranging.h"
#include "schuler/estim/staged.h"
#include "schuler/fusion/fault_watch.h"
#include "schuler/fusion/inertial_filter.h"
#include "schuler/fusion/ranging_settings.h"

#include <array>
#include <cstddef>
#include <optional>

namespace schuler::fusion {

/// Offsets of its error states (math.md 5.1). Every clock and offset column of a range is +1.
struct TightLayout {
    static constexpr int inertial = 16;          ///< Layout's fifteen and the barometer's bias
    static constexpr int baro_bias = 15;         ///< m
    static constexpr int clock = 16;             ///< c times the receiver's clock error, m
    static constexpr int drift = 17;             ///< its rate, m/s
    static constexpr int network = 18;           ///< stations' common offset, m
    static constexpr int intersystem = 19;       ///< 3, GLONASS, Galileo, BeiDou against GPS's clock, m
    static constexpr int source = 22;            ///< 30 slots: correlated error of a source, m
    static constexpr int slots = 30;
    static constexpr int size = 52;
};

using TightVector = Eigen::Matrix<double, TightLayout::size, 1>;
using TightMatrix = Eigen::Matrix<double, TightLayout::size, TightLayout::size>;

/// What does not change in a run.
struct TightModel {
    InertialModel<TightLayout::inertial> inertial;
    RangingFilterSettings ranging;
    Eigen::Vector3d lever_arm_b = Eigen::Vector3d::Zero();   ///< IMU to antenna, m
    double gyro_gain = 0.0, accel_gain = 0.0;   ///< one sigma of scale factor and misalignment, which have no states here
};

/// A plain copyable struct. The estimate is always fed back (closed loop).
template <class Frame>
struct TightFilter {
    static constexpr int N = TightLayout::size;
    using Inertial = InertialFilter<Frame, TightLayout::inertial>;

    Inertial inertial;                    ///< its P holds the noise gathered since `brought`
    estim::GatheredTransition<TightLayout::inertial> gathered;
    TightVector parameters = TightVector::Zero();   ///< nominal values of the states from 16 on
    TightMatrix P = TightMatrix::Zero();  ///< at `brought`
    Time brought{};
    FaultWatch<TightLayout::size, TightLayout::inertial> watch;

    /// The slot of a source.
    struct Slot {
        int source = -1;                  ///< index into RangingLog::sources; -1: free
        bool station = false;
        Time last{};                      ///< when it was measured last
        std::optional<Time> doubted{};    ///< of the first that was rejected since one was accepted
    };
    std::array<Slot, TightLayout::slots> slots{};
    int used = 24;                        ///< states in use, a multiple of 4

    [[nodiscard]] Time time() const { return inertial.time(); }
    /// Starts the large covariance with that of the inertial states, which then gather.
    void start(const TightModel& model, const Eigen::Matrix<double, TightLayout::inertial, TightLayout::inertial>& P_inertial);
    void propagate(const TightModel& model, const ImuIncrement& increment, const BridgeNoise& bridge);
    /// P and parameters to the time of the inertial state.
    void bring_up(const TightModel& model);
    /// Corrects the estimate by an error (estimate minus truth) that was found.
    void apply(const TightModel& model, const TightVector& dx);
    /// State of a source's slow error, given one where it has none: -1 where its kind has no slow error or all slots are in use.
    [[nodiscard]] int slot_of(const TightModel& model, int source, bool station);

    [[nodiscard]] NavState geographic(const TightModel& model) const { return Frame::geographic(model.inertial.earth, inertial.nav); }
    /// Covariance of position, velocity and attitude in local level; call bring_up first.
    [[nodiscard]] Matrix9 local_covariance(const TightModel& model) const;
};

}  // namespace schuler::fusion
