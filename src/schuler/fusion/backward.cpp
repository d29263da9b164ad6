#include "schuler/fusion/backward.h"

#include "schuler/core/units.h"
#include "schuler/filter/outputs.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <array>
#include <utility>

namespace schuler::fusion {

namespace {

constexpr double opening = 10.0;                       ///< times the forward filter's last sigmas
constexpr double widest_attitude = 20.0 * units::deg;  ///< ... but within the range of a linear filter
constexpr Duration spacing{100'000'000};               ///< of the rows

Time turned(Time t) { return Time{-t.ns}; }

template <class Sample>
std::vector<Sample> turned(std::vector<Sample> samples) {
    for (Sample& s : samples) s.time = turned(s.time);
    std::ranges::reverse(samples);
    return samples;
}

/// Data that measurements refer to, in the order of tau. Ranges keep their velocities: RangeUpdate handles the time reversal.
Recording turned(const Recording& r) {
    Recording out;
    out.gnss = turned(r.gnss);
    out.baro = turned(r.baro);
    out.mag = turned(r.mag);
    out.odometer = turned(r.odometer);
    out.heading = turned(r.heading);
    out.gauges = turned(r.gauges);
    out.body_velocity = turned(r.body_velocity);
    out.ranges = r.ranges;
    out.ranges.epochs = turned(std::move(out.ranges.epochs));
    for (GnssFix& f : out.gnss) f.velocity_n = -f.velocity_n;
    for (OdometerSample& s : out.odometer) s.speed = -s.speed;
    for (BodyVelocitySample& s : out.body_velocity) s.velocity_b = -s.velocity_b;
    return out;
}

/// Samples of the channel referred to by events of this kind.
std::size_t samples_of(const Recording& r, AidKind kind) {
    switch (kind) {  // complete, so that the compiler reports a new kind
        case AidKind::GnssPosition:
        case AidKind::GnssVelocity: return r.gnss.size();
        case AidKind::Baro: return r.baro.size();
        case AidKind::Mag: return r.mag.size();
        case AidKind::Odometer: return r.odometer.size();
        case AidKind::Heading: return r.heading.size();
        case AidKind::Gauges: return r.gauges.size();
        case AidKind::BodyVelocity: return r.body_velocity.size();
        case AidKind::ZeroVelocity:
        case AidKind::ZeroRate:
        case AidKind::Nonholonomic:
        case AidKind::Pseudorange:
        case AidKind::RangeRate: break;  // not events of the timeline
    }
    return 0;
}

std::vector<Event> turned(const std::vector<Event>& events, const Recording& recording) {
    std::vector<Event> out(events.rbegin(), events.rend());
    std::array<bool, Channel::count * 8> changed{};  // by kind and components
    for (Event& e : out) {
        e.valid = turned(e.valid);
        e.stamp = turned(e.stamp);
        e.index = samples_of(recording, e.kind) - 1 - e.index;
        e.outage = -1;
        e.outage_end = false;
        // the first fix with another set of satellites becomes the last one with its own
        std::swap(e.constellation_change, changed[static_cast<std::size_t>(e.kind) * 8 + e.components]);
    }
    return out;
}

/// Increments from `first` to `last`, in reverse order.
ImuTimeline turned(const ImuTimeline& imu, std::size_t first, std::size_t last) {
    ImuTimeline out;
    out.median_dt = imu.median_dt;
    out.increments.reserve(last - first + 1);
    for (std::size_t i = last + 1; i-- > first;) {
        const ImuIncrement& inc = imu.increments[i];
        const Time begin = i > 0 ? imu.increments[i - 1].time : inc.time - Duration::from_seconds(inc.dt);
        out.increments.push_back({turned(begin), inc.dt, -inc.dtheta, inc.dv});
    }
    for (auto b = imu.bridges.rbegin(); b != imu.bridges.rend(); ++b)
        if (b->last >= first && b->first <= last)
            out.bridges.push_back({last - std::min(b->last, last), last - std::max(b->first, first), b->noise});
    return out;
}

StillReport turned(const StillReport& still) {
    StillReport out = still;
    std::ranges::reverse(out.windows);
    for (StillWindow& w : out.windows) {
        w.end = turned(w.end - Duration::from_seconds(w.length));
        w.mean_rate_b = -w.mean_rate_b;
    }
    return out;
}

Settings turned(const Settings& settings) {
    Settings out = settings;
    out.earth.ellipsoid.w_ie = -out.earth.ellipsoid.w_ie;
    for (Outage& o : out.outages) o.start = -(o.start + o.duration);
    out.smooth = out.state_rows = out.covariance_rows = false;
    return out;
}

Start start_at(const SolutionRow& row, const SensorErrorRow& errors, const Start& start, double std_mounting) {
    Start out;
    out.nav = {turned(row.time), row.position, -row.v_eb_n, math::quaternion_from_rpy(row.rpy)};
    out.std_position = opening * row.std_position;
    out.std_velocity = opening * row.std_velocity;
    out.std_rpy = (opening * row.std_rpy).cwiseMin(row.std_rpy.cwiseMax(widest_attitude));
    out.gyro_bias = -errors.gyro_bias;
    out.accel_bias = errors.accel_bias;
    out.std_gyro_bias = (opening * errors.std_gyro_bias).cwiseMin(errors.std_gyro_bias.cwiseMax(start.std_gyro_bias));
    out.std_accel_bias = (opening * errors.std_accel_bias).cwiseMin(errors.std_accel_bias.cwiseMax(start.std_accel_bias));
    out.std_mounting = std_mounting;
    out.undecided_heading = start.undecided_heading;
    return out;
}

/// Rows of the instants, in the time of the log.
template <class Frame>
struct BackwardRows : PassObserver<Frame> {
    explicit BackwardRows(const InertialModel& model_) : model(model_) {}
    void instant(const FilterRun<Frame>& run, std::size_t) override {
        NavState nav = run.filter.geographic(model);
        nav.time = turned(nav.time);
        nav.v_eb_n = -nav.v_eb_n;
        rows.push_back(solution_row(nav, run.covariance(model)));
    }
    const InertialModel& model;
    std::vector<SolutionRow> rows;
};

template <class Frame>
std::vector<SolutionRow> run_in(const RunData& data, const Settings& settings, const Start& start) {
    const InertialModel model = make_model(settings, make_layout(settings, *data.recording));
    const Pass<Frame> pass(model, data, settings, Rivalry::Contest);
    FilterRun<Frame> run = first_step<Frame>(model, data, settings, start);
    run.next_output = Time{INT64_MAX};
    BackwardRows<Frame> out(model);
    out.rows.reserve(data.instants.size());
    pass.advance(run, data.imu.increments.size() - 1, out);
    std::ranges::reverse(out.rows);
    return std::move(out.rows);
}

}  // namespace

std::vector<SolutionRow> run_backward(const RunData& data, const Settings& settings, const Start& start,
                                      const Trajectory& forward) {
    const std::vector<ImuIncrement>& increments = data.imu.increments;
    const auto inertial = [&](const SolutionRow& r) {
        return r.time <= increments.back().time && r.rpy.allFinite() && r.std_rpy.allFinite();
    };
    const auto end = std::find_if(forward.rows.rbegin(), forward.rows.rend(), inertial);
    if (end == forward.rows.rend() || forward.sensor_errors.empty()) return {};
    const auto after = std::ranges::upper_bound(increments, end->time, {}, &ImuIncrement::time);
    const auto last = static_cast<std::size_t>(after - increments.begin());  // after the last one
    if (last <= start.increment) return {};

    const Settings back = turned(settings);
    const Recording recording = turned(*data.recording);
    RunData run;
    run.recording = &recording;
    run.imu = turned(data.imu, start.increment, last - 1);
    run.events = turned(data.events, *data.recording);
    run.still = turned(data.still);
    run.fix_noise.assign(data.fix_noise.rbegin(), data.fix_noise.rend());
    run.declination = data.declination;
    run.gates = data.gates;
    run.slow_limits = data.slow_limits;
    run.origin = turned(data.origin);
    run.backward = true;
    for (auto row = end; row != forward.rows.rend(); ++row)
        if (run.instants.empty() || turned(row->time) - run.instants.back() >= spacing) run.instants.push_back(turned(row->time));
    const Start from = start_at(*end, forward.sensor_errors.back(), start, settings.imu.mounting_std);
    return settings.mechanization == Mechanization::Ecef ? run_in<EarthFixedFrame>(run, back, from)
                                                         : run_in<GeographicFrame>(run, back, from);
}

}  // namespace schuler::fusion
