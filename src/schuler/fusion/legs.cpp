#include "schuler/fusion/legs.h"

#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/filter/measurement/instruments.h"
#include "schuler/math/quantile.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

namespace schuler::fusion {
namespace {

/// The samples in [`from`, `to`); logs need not be in time order.
template <class Sample>
std::vector<Sample> within(const std::vector<Sample>& log, Time from, Time to) {
    std::vector<Sample> part;
    std::ranges::copy_if(log, std::back_inserter(part), [&](const Sample& s) { return s.time >= from && s.time < to; });
    return part;
}

RangingLog within(const RangingLog& log, Time from, Time to) {
    RangingLog part{log.sources, within(log.epochs, from, to), {}, {}, log.to_gps};
    for (RangeEpoch& e : part.epochs) {
        const std::span<const RangeSample> samples = log.of(e);
        e.first = static_cast<decltype(e.first)>(part.samples.size());
        part.samples.insert(part.samples.end(), samples.begin(), samples.end());
        const std::span<const CarrierSample> carriers = log.carriers_of(e);
        e.first_carrier = part.carriers.size();
        part.carriers.insert(part.carriers.end(), carriers.begin(), carriers.end());
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
    join(all.carriers, more.carriers);
    if (!same_states) return;
    join(all.parameters, more.parameters);
    join(all.covariances, more.covariances);
}

/// Evidence in the positions of a log about a gap that the inertial log has as well.
class SetClocks {
public:
    explicit SetClocks(const std::vector<GnssFix>& fixes) {
        for (const GnssFix& f : fixes)
            if (f.fix != FixType::None && std::isfinite(f.position.lat) && std::isfinite(f.position.lon)) fixes_.push_back(&f);
        std::vector<double> steps, off;
        for (std::size_t k = 1; k < fixes_.size(); ++k) steps.push_back(seconds(k));
        if (steps.empty()) return;
        step_ = math::median(std::move(steps));
        for (std::size_t k = 3; k + 2 < fixes_.size(); ++k)
            if (seconds(k) < 1.5 * step_) off.push_back((way(k) - seconds(k) * velocity_around(k)).norm());
        if (!off.empty()) scatter_ = math::median(std::move(off));
    }

    /// True if the distance between the fixes around a gap is that of a usual interval, not that of the whole gap.
    [[nodiscard]] bool at(Time from, Time to) const {
        const auto first = std::ranges::lower_bound(fixes_, from, {}, [](const GnssFix* f) { return f->time; });
        const auto k = static_cast<std::size_t>(first - fixes_.begin());
        if (k < 3 || k + 2 >= fixes_.size()) return false;
        const double hole = seconds(k), step = (to - from).seconds();
        if (hole < step || hole > step + 1.5 * step_) return false;  // not common to both logs
        const Vector2d before = velocity(k - 3, k - 1), after = velocity(k, k + 2), mean = 0.5 * (before + after);
        const double rest = hole - step, sigma = std::max({least_way, scatter_, 0.25 * (after - before).norm() * step_});
        const double as_set = (way(k) - rest * mean).squaredNorm() / (sigma * sigma),
                     as_stamped = (way(k) - hole * mean).squaredNorm() / (sigma * sigma);
        constexpr double beyond_chance = 25.0;  // for a single fix that is off as well
        return as_set < 9.0 && as_stamped - as_set > beyond_chance;
    }

private:
    using Vector2d = Eigen::Vector2d;
    static constexpr double least_way = 0.3;  // m

    [[nodiscard]] double seconds(std::size_t k) const { return (fixes_[k]->time - fixes_[k - 1]->time).seconds(); }
    [[nodiscard]] Vector2d way(std::size_t from, std::size_t to) const {
        return earth::ned_difference(earth::Earth{}, fixes_[to]->position, fixes_[from]->position).head<2>();
    }
    [[nodiscard]] Vector2d way(std::size_t k) const { return way(k - 1, k); }
    /// As stated by the receiver, else from positions.
    [[nodiscard]] Vector2d velocity(std::size_t from, std::size_t to) const {
        const Vector2d sum = fixes_[from]->velocity_n.head<2>() + fixes_[to]->velocity_n.head<2>();
        if (sum.allFinite()) return 0.5 * sum;
        const double span = (fixes_[to]->time - fixes_[from]->time).seconds();
        return span > 0.0 ? Vector2d(way(from, to) / span) : Vector2d::Zero();
    }
    /// Before and after a step.
    [[nodiscard]] Vector2d velocity_around(std::size_t k) const { return 0.5 * (velocity(k - 3, k - 1) + velocity(k, k + 2)); }

    std::vector<const GnssFix*> fixes_;
    double step_ = 0.0, scatter_ = 0.0;  // s, m
};

}  // namespace

std::vector<Time> leg_starts(const Recording& recording) {
    std::vector<Time> starts;
    constexpr double least_set = 0.5;  // s: shorter is a gap that is bridged, whatever its cause
    std::optional<SetClocks> set;
    for (const ImuSample& s : recording.imu) {
        if (starts.empty()) {
            starts.push_back(s.time);
            continue;
        }
        const Time before = (&s - 1)->time;
        const double hole = (s.time - before).seconds();
        if (hole > least_set && hole <= longest_bridge && !set) set.emplace(recording.gnss);
        if (hole > longest_bridge || (hole > least_set && set->at(before, s.time))) starts.push_back(s.time);
    }
    return starts;
}

Recording part_of(const Recording& recording, Time from, Time to) {
    Recording out;
    out.imu = within(recording.imu, from, to);
    out.gnss = within(recording.gnss, from, to);
    filter::for_each_instrument(
        [&](const auto& instrument) { out.*instrument.log = within(recording.*instrument.log, from, to); });
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
    if (before.forward.rows.empty() || leg.imu.empty()) return next;
    if (const SolutionRow& row = before.forward.rows.back(); (leg.imu.front().time - row.time).seconds() < longest_bridge) {
        constexpr double since = 0.5 * units::deg;  // in a step of the IMU
        next.initial.rpy = row.rpy;
        next.initial.std_rpy = (row.std_rpy.array().square() + since * since).sqrt();
        return next;
    }
    if (settings.vehicle != VehicleKind::Car || leg.gnss.empty()) return next;
    const SolutionRow& last = before.forward.rows.back();
    const auto moved = earth::ned_difference(settings.earth, leg.gnss.front().position, last.position);
    constexpr double near = 10.0, parked = 0.5, turned = 5.0 * units::deg;  // m, m/s, rad
    const double sigma = last.std_position.head<2>().norm();
    if (!(moved.head<2>().norm() < near + 3.0 * sigma) || sigma > near || last.v_eb_n.norm() > parked ||
        last.std_rpy.z() > turned)
        return next;
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
    join(all.measurements, leg.measurements);
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
    all.open_attitude = std::max(all.open_attitude, leg.open_attitude);
    join(all.legs, leg.legs);
}

}  // namespace schuler::fusion
