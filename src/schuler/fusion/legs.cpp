#include "schuler/fusion/legs.h"

#include "schuler/core/units.h"
#include "schuler/earth/earth.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace schuler::fusion {
namespace {

/// The samples from `from` to before `to`; logs need not be in order of time.
template <class Sample>
std::vector<Sample> within(const std::vector<Sample>& log, Time from, Time to) {
    std::vector<Sample> part;
    std::ranges::copy_if(log, std::back_inserter(part), [&](const Sample& s) { return s.time >= from && s.time < to; });
    return part;
}

RangingLog within(const RangingLog& log, Time from, Time to) {
    RangingLog part{log.sources, within(log.epochs, from, to), {}};
    for (RangeEpoch& e : part.epochs) {
        const std::span<const RangeSample> samples = log.of(e);
        e.first = static_cast<decltype(e.first)>(part.samples.size());
        part.samples.insert(part.samples.end(), samples.begin(), samples.end());
    }
    return part;
}

template <class Row>
void join(std::vector<Row>& all, std::vector<Row>& more) {
    all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

void join(Trajectory& all, Trajectory& more, bool same_states) {
    join(all.rows, more.rows);
    join(all.point, more.point);
    join(all.instants, more.instants);
    join(all.sensor_errors, more.sensor_errors);
    join(all.states, more.states);
    join(all.outage_epochs, more.outage_epochs);
    join(all.protection, more.protection);
    if (!same_states) return;
    join(all.parameters, more.parameters);
    join(all.covariances, more.covariances);
}

}  // namespace

std::vector<Time> leg_starts(const Recording& recording) {
    std::vector<Time> starts;
    for (const ImuSample& s : recording.imu) {
        if (starts.empty()) {
            starts.push_back(s.time);
        } else if (const Time before = (&s - 1)->time; (s.time - before).seconds() > longest_bridge) {
            starts.push_back(s.time);
        }
    }
    return starts;
}

Recording part_of(const Recording& recording, Time from, Time to) {
    Recording out;
    out.imu = within(recording.imu, from, to);
    out.gnss = within(recording.gnss, from, to);
    out.baro = within(recording.baro, from, to);
    out.mag = within(recording.mag, from, to);
    out.odometer = within(recording.odometer, from, to);
    out.heading = within(recording.heading, from, to);
    out.gauges = within(recording.gauges, from, to);
    out.body_velocity = within(recording.body_velocity, from, to);
    out.ranges = within(recording.ranges, from, to);
    return out;
}

Recording leg_of(const Recording& recording, const std::vector<Time>& starts, std::size_t leg) {
    const auto last_before = [&](Time start) {
        const auto it = std::ranges::lower_bound(recording.imu, start, {}, &ImuSample::time);
        return std::prev(it)->time;
    };
    const auto middle = [&](std::size_t k) {
        const Time before = last_before(starts[k]);
        return before + Duration::from_seconds(0.5 * (starts[k] - before).seconds());
    };
    const Time from = leg == 0 ? Time{INT64_MIN} : middle(leg), to = leg + 1 == starts.size() ? Time{INT64_MAX} : middle(leg + 1);
    return part_of(recording, from, to);
}

Settings continued(const Settings& settings, const Result& before, const Recording& leg, double seconds) {
    Settings next = before.findings.in_force ? *before.findings.in_force : settings;
    next.initial = {};
    for (Outage& o : next.outages) o.start -= seconds;
    if (!before.forward.sensor_errors.empty()) {
        const SensorErrorRow& e = before.forward.sensor_errors.back();
        next.initial.gyro_bias = e.gyro_bias;
        next.initial.accel_bias = e.accel_bias;
    }
    if (settings.vehicle != VehicleKind::Car || before.forward.rows.empty() || leg.gnss.empty()) return next;
    const SolutionRow& last = before.forward.rows.back();
    const auto moved = earth::ned_difference(settings.earth, leg.gnss.front().position, last.position);
    constexpr double near = 10.0, parked = 0.5, turned = 5.0 * units::deg;   // m, m/s, rad
    const double sigma = last.std_position.head<2>().norm();
    if (!(moved.head<2>().norm() < near + 3.0 * sigma) || sigma > near || last.v_eb_n.norm() > parked || last.std_rpy.z() > turned) return next;
    next.initial.rpy.z() = last.rpy.z();
    next.initial.std_rpy.z() = std::hypot(last.std_rpy.z(), turned);
    return next;
}

void append(Result& all, Result&& leg) {
    const bool same = std::ranges::equal(all.states, leg.states, [](const LayoutBlock& a, const LayoutBlock& b) {
        return a.name == b.name && a.offset == b.offset && a.size == b.size;
    });
    join(all.forward, leg.forward, same);
    join(all.receiver, leg.receiver, same);
    join(all.smoothed, leg.smoothed, same);
    join(all.cross_checks, leg.cross_checks);
    join(all.backward, leg.backward);
    join(all.aids, leg.aids);
    join(all.alerts, leg.alerts);
    Counters& n = all.counters;
    const Counters& m = leg.counters;
    n.imu_epochs += m.imu_epochs;
    n.imu_gaps += m.imu_gaps;
    n.imu_duplicates += m.imu_duplicates;
    n.longest_imu_gap = std::max(n.longest_imu_gap, m.longest_imu_gap);
    n.gnss_epochs += m.gnss_epochs;
    n.gnss_accepted += m.gnss_accepted;
    n.gnss_rejected += m.gnss_rejected;
    n.gnss_withheld += m.gnss_withheld;
    all.filter_seconds += leg.filter_seconds;
    join(all.legs, leg.legs);
}

}  // namespace schuler::fusion
