// The walk along the timeline: increments, events, constraints, outputs. One code for the forward filter, for start-up trials and
// for the smoother's replays; who wants to know what happens observes it.
#pragma once

#include "schuler/fusion/aid/aid.h"
#include "schuler/fusion/gate.h"
#include "schuler/fusion/inertial_filter.h"
#include "schuler/fusion/integrity.h"
#include "schuler/fusion/result.h"
#include "schuler/fusion/settings.h"
#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace schuler::fusion {

/// Standard deviations used for each fix: the log's, or the defaults; resolved once, so that replays agree.
struct FixNoise {
    Eigen::Vector3d position;          ///< m, NED
    Eigen::Vector3d velocity;          ///< m/s, NED
    Eigen::Vector3d white_position;    ///< m, NED: what is left of it where its slow part is a state
    Eigen::Vector3d white_velocity;    ///< m/s, NED
};

/// What one run has in common for all its passes; read only.
struct RunData {
    const Recording* recording = nullptr;
    ImuTimeline imu;
    std::vector<Event> events;
    StillReport still;
    std::vector<FixNoise> fix_noise;     ///< one per fix of the recording
    double declination = 0.0;            ///< rad
    GateLimits gates;
    std::array<double, 4> slow_limits{}; ///< of the slow-ramp test by degrees of freedom
};

/// Does the body move like a wheeled vehicle? Direction of motion in body axes while GNSS keeps the velocity good.
struct WheelEvidence {
    enum class Verdict : std::uint8_t { Open, Wheels, NoWheels };
    Verdict verdict = Verdict::Open;
    int n = 0;
    double turned = 0.0;                                    ///< rad, total turn during the observation
    double mean_side = 0.0, mean_down = 0.0;                ///< tangents of the direction of motion
    double m2_side = 0.0, m2_down = 0.0;                    ///< sums of squared deviations

    /// Takes one direction; decides after a minute of motion with at least a quarter turn.
    void add(const Eigen::Vector3d& v_b, double turn, double interval);
    [[nodiscard]] double std_side() const { return std::sqrt(m2_side / std::max(1, n - 1)); }
    [[nodiscard]] double std_down() const { return std::sqrt(m2_down / std::max(1, n - 1)); }
};

/// A fix that is used in parts until the next one (LooseKind::Aggressive). Carried on by the inertial motion since, it differs from the
/// estimate by the innovation at its time less what the corrections since have become: no inertial motion is needed explicitly.
template <int N>
struct CarriedFix {
    Measurement<N> measurement;          ///< at the time of the fix; its variance is that of one part
    Eigen::Matrix<double, N, 1> corrected = Eigen::Matrix<double, N, 1>::Zero();   ///< sum of the corrections since, propagated
    int left = 0;                        ///< parts
    Time stamp{}, next{};
    Duration every{1'000'000'000};
};

/// A place on the walk with everything needed to go on from there; plain and copyable.
template <class Frame, int N>
struct Walk {
    InertialFilter<Frame, N> filter;
    std::size_t increment = 0;           ///< next to be consumed
    std::size_t event = 0;
    std::size_t still = 0;
    std::size_t bridge = 0;
    std::size_t outputs = 0;             ///< number of outputs made
    Time next_output{};
    Time next_constraint{};
    Time next_feedback{};                ///< of the mixed loop
    Duration feedback_period{};
    std::array<GateState, 9> gates{};    ///< by Channel::gate()
    WheelEvidence wheels;
    Time last_still{INT64_MIN / 2};
    std::array<CarriedFix<N>, 2> carried{};         ///< position, velocity: Aggressive
    std::array<std::optional<Time>, 9> corrected{}; ///< by Channel::gate(), when last: Separate
    std::array<ChannelHealth, 2> health{};          ///< position, velocity: integrity
    std::vector<Shadow<Frame, N>> shadows;          ///< two, or none where slow ramps are not looked for
};

/// A channel has a gate of its own: one a kind, and one more where a height or a vertical velocity comes with an age of its own, for
/// a good height must not excuse a bad position.
struct Channel {
    AidKind kind;
    bool vertical_only = false;

    Channel(AidKind kind_, std::uint8_t components = 7) : kind(kind_), vertical_only(components == 4) {}
    [[nodiscard]] std::size_t gate() const {
        const auto k = static_cast<std::size_t>(kind);
        return vertical_only && k < 2 ? 7 + k : k;
    }
};

/// Who wants to know what happens on the walk derives from this; the base does not care.
template <class Frame, int N>
struct PassObserver {
    using Filter = InertialFilter<Frame, N>;

    virtual ~PassObserver() = default;
    virtual void step(const estim::Transition<N>&) {}
    virtual void scalar(const estim::ScalarUpdate<N>&) {}
    virtual void output(const Filter&, Time) {}
    virtual void outage_epoch(const Filter&, const Event&, const LocalMeasurement&, const AidRecord&) {}
    virtual void aid(const AidRecord&) {}
    virtual void alert(const Alert&) {}
};

/// Rows of an aid mapped to the filter's own error states.
template <class Frame, int N>
[[nodiscard]] Measurement<N> to_filter(const InertialModel<N>& model, const InertialFilter<Frame, N>& filter,
                                       const LocalMeasurement& local);

template <class Frame, int N>
[[nodiscard]] Estimate estimate_of(const InertialModel<N>& model, const InertialFilter<Frame, N>& filter);

/// Walks a filter along the data of a run.
template <class Frame, int N>
class ForwardPass {
public:
    using Observer = PassObserver<Frame, N>;

    ForwardPass(const InertialModel<N>& model, const RunData& data, const Settings& settings)
        : model_(model), data_(data), settings_(settings) {}

    /// Consumes increments up to and including index `last`. Throws Error(Computation) where the filter diverges.
    void advance(Walk<Frame, N>& walk, std::size_t last, Observer& observer) const;

private:
    void step(Walk<Frame, N>& walk, const ImuIncrement& increment, const BridgeNoise& noise, Observer& observer) const;
    void meet(Walk<Frame, N>& walk, const Event& event, Observer& observer) const;
    /// The receiver's slow errors jump where the set of satellites changes.
    void change_constellation(Walk<Frame, N>& walk, const Event& event) const;
    void constrain(Walk<Frame, N>& walk, Observer& observer) const;
    AidRecord try_update(Walk<Frame, N>& walk, Channel channel, const LocalMeasurement& local, Time stamp, bool withheld,
                         Observer& observer) const;
    [[nodiscard]] LocalMeasurement measurement_of(const InertialFilter<Frame, N>& filter, const Event& event) const;
    /// Corrects the estimate by an accepted measurement as the coupling wants it. False: it is not used.
    bool use(Walk<Frame, N>& walk, Channel channel, const LocalMeasurement& local, const Measurement<N>& m, Time stamp,
             Observer& observer) const;
    bool use_separately(Walk<Frame, N>& walk, Channel channel, const LocalMeasurement& local, const Measurement<N>& m,
                        Time stamp) const;
    /// The parts of the fixes carried on that are due.
    void carry_on(Walk<Frame, N>& walk, Observer& observer) const;
    /// Integrity of one sub-vector of a fix: whether it may be used.
    AidStatus examine(Walk<Frame, N>& walk, Channel channel, const AidRecord& record, const Examined& examined, Observer& observer) const;
    /// The slow-ramp test of a fix, before its own update.
    void look_back(Walk<Frame, N>& walk, const Event& event, Observer& observer) const;
    void renew_shadows(Walk<Frame, N>& walk) const;
    void observe_wheels(Walk<Frame, N>& walk, const Estimate& e) const;
    void recover(Walk<Frame, N>& walk, Channel channel, const LocalMeasurement& local) const;

    const InertialModel<N>& model_;
    const RunData& data_;
    const Settings& settings_;
};

}  // namespace schuler::fusion
