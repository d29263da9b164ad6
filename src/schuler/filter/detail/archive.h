// Serialisation of a navigator: one function per type for both directions. A structured binding names every member, so that the
// code does not compile if a new member is omitted here.
#pragma once

#include "schuler/filter/stream/start_up.h"
#include "schuler/filter/stream/stream_timeline.h"
#include "schuler/filter/update/pass.h"

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace schuler::filter::detail {

/// Measures, writes or reads. Nothing is allocated as long as vectors have the capacity; reading never exceeds it.
class Archive {
public:
    enum class Way : std::uint8_t { Measure, Write, Read };

    Archive(Way way, std::span<std::byte> bytes) : way_(way), bytes_(bytes) {}

    template <class... Types>
    void operator()(Types&... parts) {
        (archive(*this, parts), ...);  // found by argument-dependent lookup
    }
    void raw(void* data, std::size_t n) {
        if (way_ != Way::Measure && good && bytes_.size() - at < n) good = false;
        if (good && n > 0) {
            if (way_ == Way::Write) std::memcpy(bytes_.data() + at, data, n);
            if (way_ == Way::Read) std::memcpy(data, bytes_.data() + at, n);
        }
        at += n;
    }
    [[nodiscard]] bool reads() const { return way_ == Way::Read; }

    std::size_t at = 0;
    bool good = true;

private:
    Way way_;
    std::span<std::byte> bytes_;
};

template <class T>
    requires std::is_arithmetic_v<T> || std::is_enum_v<T>
void archive(Archive& a, T& x) {
    a.raw(&x, sizeof x);
}

template <class Derived>
void archive(Archive& a, Eigen::PlainObjectBase<Derived>& m) {
    auto rows = static_cast<std::int32_t>(m.rows()), columns = static_cast<std::int32_t>(m.cols());
    if constexpr (Derived::SizeAtCompileTime == Eigen::Dynamic) {
        a(rows, columns);
        const bool fits =
            rows >= 0 && columns >= 0 && rows <= Derived::MaxRowsAtCompileTime && columns <= Derived::MaxColsAtCompileTime;
        if (!fits) a.good = false;
        if (a.reads() && a.good) m.resize(rows, columns);
    }
    if (a.good) a.raw(m.data(), static_cast<std::size_t>(m.size()) * sizeof(typename Derived::Scalar));
}
inline void archive(Archive& a, Eigen::Quaterniond& q) { a(q.coeffs()); }

template <class T, std::size_t N>
void archive(Archive& a, std::array<T, N>& list) {
    for (T& x : list) a(x);
}

template <class T>
void archive(Archive& a, std::optional<T>& x) {
    bool has = x.has_value();
    a(has);
    if (a.reads() && !has) x.reset();
    if (a.reads() && has && !x) x.emplace();
    if (x) a(*x);
}

template <class T>
void archive(Archive& a, std::vector<T>& list) {
    auto n = static_cast<std::uint64_t>(list.size());
    a(n);
    if (a.reads()) {
        if (!a.good || n > list.capacity()) {
            a.good = false;
            return;
        }
        list.resize(n);
    }
    for (T& x : list) a(x);
}

inline void archive(Archive& a, std::string& text) {
    auto n = static_cast<std::uint64_t>(text.size());
    a(n);
    if (a.reads()) {
        if (!a.good || n > text.capacity()) {
            a.good = false;
            return;
        }
        text.resize(n);
    }
    a.raw(text.data(), text.size());
}

#define SCHULER_ARCHIVED(Type, ...)                \
    inline void archive(Archive& a, Type& whole) { \
        auto& [__VA_ARGS__] = whole;               \
        a(__VA_ARGS__);                            \
    }
#define SCHULER_ARCHIVED_IN_FRAME(Type, ...)       \
    template <class Frame>                         \
    void archive(Archive& a, Type<Frame>& whole) { \
        auto& [__VA_ARGS__] = whole;               \
        a(__VA_ARGS__);                            \
    }

SCHULER_ARCHIVED(Time, ns)
SCHULER_ARCHIVED(Duration, ns)
SCHULER_ARCHIVED(Geodetic, lat, lon, h)
SCHULER_ARCHIVED(Ecef, r)
SCHULER_ARCHIVED(NavState, time, position, v, q)
SCHULER_ARCHIVED(NavStateEcef, time, position, v, q)
SCHULER_ARCHIVED(ImuSample, time, gyro, accel)
SCHULER_ARCHIVED(ImuIncrement, time, dt, dtheta, dv)
SCHULER_ARCHIVED(GnssFix, time, position, velocity, std_position, std_velocity, fix, satellites, position_age, velocity_age,
                 lasting)
SCHULER_ARCHIVED(BaroSample, time, height, pressure)
SCHULER_ARCHIVED(MagSample, time, field)
SCHULER_ARCHIVED(OdometerSample, time, speed, std)
SCHULER_ARCHIVED(HeadingSample, time, heading, std)
SCHULER_ARCHIVED(GaugeSample, time, height)
SCHULER_ARCHIVED(BodyVelocitySample, time, velocity)
SCHULER_ARCHIVED(RangeSource, name, station)
SCHULER_ARCHIVED(RangeSample, source, range, rate, std, std_rate, phase_std, phase_span, doppler_rate, phase_goes_on, cn0, tx,
                 velocity, clock, clock_rate, frequency, variance, noise, differential)
SCHULER_ARCHIVED(RangeEpoch, time, first, count, first_carrier, carriers)
SCHULER_ARCHIVED(SolutionRow, time, position, v, rpy, std_position, std_velocity, std_rpy)

SCHULER_ARCHIVED(BridgeNoise, gyro, accel, standing)
SCHULER_ARCHIVED(Bridge, first, last, noise)
SCHULER_ARCHIVED(Event, valid, stamp, kind, components, withheld, outage, outage_end, change, index)
SCHULER_ARCHIVED(StillWindow, end, length, rate, force)
SCHULER_ARCHIVED(FixNoise, position, velocity, white_position, white_velocity)
SCHULER_ARCHIVED(StillSlot, end, dt, n, rate, force, rate2, force2, rate_std, force_std, rate_norm, speed)
SCHULER_ARCHIVED(IntervalMaker::Memory, begun, sample, end)
SCHULER_ARCHIVED(HangWatch::Memory, begun, gyro, accel, gyro_run, accel_run, samples, fresh, repeats)
SCHULER_ARCHIVED(Agitation, rate2, force2)
SCHULER_ARCHIVED(RecentMotion::Motion, rate, force)
SCHULER_ARCHIVED(RecentMotion::Memory, last, next, filled, rate, force, rate2, force2, sum, seconds)
SCHULER_ARCHIVED(EventMaker::Memory, any, fix, position, satellites, change, baro, mag, odometer, height, repeated)
SCHULER_ARCHIVED(FeedCounters, by_status, reordered, holes, restarts, events_lost, rows_lost)
SCHULER_ARCHIVED(NavigatorEvent, time, kind, phase, source, status, measurement, measurement_status, test, seconds)
SCHULER_ARCHIVED(StreamTimeline::Memory, any_imu, newest, last_settled, released, stranger, strangers, has_before, before,
                 slots_start, first_slot, current_slot, next_judged, moved, has_precise, precise, precise_time, order_changed)
SCHULER_ARCHIVED(StartUp::Fit, since, N, y, sum2, rows, v_w, p_w, has_origin, origin)
SCHULER_ARCHIVED(StartUp::Memory, any, now, first, last, recent_dv, recent_time, still, still_end, rate, force, level, at_rest,
                 q_wb, std_level, gyro_bias, std_gyro_bias, rest_bias, fit, has_position, has_velocity, position, position_time,
                 std_position, velocity, std_velocity, has_height, velocity_given, velocity_time, has_heading, by_mag, by_sensor,
                 psi, std_heading, tilt, std_tilt)

template <class Sample>
void archive(Archive& a, SamplePool<Sample>& pool) {
    a(pool.memory.order, pool.memory.free, pool.memory.uses, pool.memory.first);
}

SCHULER_ARCHIVED(GatheredMotion, time, distance, force, force2, acceleration, rotation, turn, turn2, v_g, p_g, gain_turn,
                 gain_v_g, gain_p_g, gain_v_a, gain_p_a, gyro, accel)
SCHULER_ARCHIVED(StateProcess, decay, psd)
SCHULER_ARCHIVED(Corrections, antenna_moved, arm_turned, velocity, latency)
SCHULER_ARCHIVED(Withheld, change, limit, covered, noise)
SCHULER_ARCHIVED(RecentChange, mean, square, derivative_square)
SCHULER_ARCHIVED(RecentMean, lags, lag)
SCHULER_ARCHIVED(SustainedForce, now, mean, time)
SCHULER_ARCHIVED_IN_FRAME(InertialFilter, nav, parameters, error, P, gathered, used, C, previous, w_ib_b, mean_rate, recent_rate,
                          force_change, last_force, mean_force, recent_force, sustained_force, corrections, withheld, cached_time,
                          cached_diagonal, cached_q, slot_process)
SCHULER_ARCHIVED(estim::Row, head, index, value, count)
SCHULER_ARCHIVED(Measurement, dof, rows, innovation, variance)
SCHULER_ARCHIVED(CarriedFix, measurement, corrected, rows, left, stamp, next, every)
SCHULER_ARCHIVED(GateState, run, since, last, innovation, rate)
SCHULER_ARCHIVED(Vibration, gyro_psd, accel_psd, samples, rate, force, rate_step, force_step)
SCHULER_ARCHIVED(WheelEvidence, verdict, n, turned, mean_side, mean_down, m2_side, m2_down)
SCHULER_ARCHIVED(ChannelHealth, excluded, together, used, agrees, seen, failed_run, slow_run, fault, faulty, returned, sum, count)
inline void archive(Archive& a, SecondOrder& errors) { errors.archive(a); }
SCHULER_ARCHIVED_IN_FRAME(Shadow, filter, second_order, since, alive)
SCHULER_ARCHIVED(RangeTracking::Slot, source, station, last, doubted)
SCHULER_ARCHIVED(FaultHypothesis, source, growing, since, response, information, evidence)
SCHULER_ARCHIVED(WithoutSource, source, since, offset, excess, score, weight)
SCHULER_ARCHIVED(LeftOutSource, source, since, ranges, rates, range, rate)
SCHULER_ARCHIVED(FaultWatch, on, all, growing, without, left_out)
inline void archive(Archive& a, RangeEpochWork& work) {  // the rest is recomputed at each epoch
    auto& [scalars, count, excluded, withheld, clock_jump, alarm, disagreeing, disagreeing_since] = work;
    a(excluded, withheld, clock_jump, alarm, disagreeing, disagreeing_since);
    if (a.reads()) count = 0;
}
SCHULER_ARCHIVED(RangeTracking::Phase, source, last, end, begin, tx_end, tx_begin)
SCHULER_ARCHIVED(RangeTracking::Ambiguity, source, carrier, arc, seen, used, jumped, trusted, held, integer)
SCHULER_ARCHIVED(RangeTracking, slots, phases, ambiguities, same_integers, same_since, cloned_velocity, cloned, watch, work)
SCHULER_ARCHIVED(Opening, increment, position, velocity, rate, span, bias_jump, part)
inline void archive(Archive& a, RefusedRun& run) { run.archive(a); }
SCHULER_ARCHIVED(FixLevels, two, at_other, other, here, there, unsure, used, anew, innovation, sigma, here_anew)
SCHULER_ARCHIVED(FixChannel, run, levels, fitted, innovation, sigma, fits, sum)
template <class T>
void archive(Archive& a, AtMostOne<T>& one) {
    bool used = !one.empty();
    a(used);
    one.clear();
    if (!used) return;
    a(one.room());
    one.use();
}
template <class Frame>
void archive(Archive& a, FilterRun<Frame>& run) {  // a diverged run is not saved
    auto& [filter, increment, event, epoch, still, bridge, instant, outputs, next_output, next_constraint, next_feedback,
           feedback_period, gates, wheels, vibration, last_still, carried, corrected, health, shadows, second_order, unjudged,
           ranges, undecided_heading, refused_heading, fixes, suspect, wanted, openings, sides_changed, rival, challenged,
           diverged] = run;
    a(filter, increment, event, epoch, still, bridge, instant, outputs, next_output, next_constraint, next_feedback,
      feedback_period, gates, wheels, vibration, last_still, carried, corrected, health, shadows, second_order, unjudged, ranges,
      undecided_heading, refused_heading, fixes, suspect, wanted, openings, sides_changed, rival, challenged);
    if (a.reads()) diverged.reset();
}
SCHULER_ARCHIVED_IN_FRAME(Rival, run, since, challenger, explained, accepted, refused, in_row, attempts, patience, opening)

#undef SCHULER_ARCHIVED
#undef SCHULER_ARCHIVED_IN_FRAME

}  // namespace schuler::filter::detail
