#include "schuler/filter/update/reversed.h"

#include "schuler/filter/measurement/instruments.h"
#include "schuler/filter/update/pass.h"

#include <algorithm>
#include <array>
#include <utility>

namespace schuler::filter {
namespace {

using filter::reversed;

template <class Sample>
std::vector<Sample> reversed(std::vector<Sample> samples) {
    for (Sample& s : samples) s.time = reversed(s.time);
    std::ranges::reverse(samples);
    return samples;
}

/// Data that measurements refer to, in the order of tau. Ranges keep their velocities: RangeUpdate handles the time reversal.
Recording reversed(const Recording& r) {
    Recording out;
    out.gnss = reversed(r.gnss);
    for_each_instrument([&](const auto& instrument) {
        out.*instrument.log = reversed(r.*instrument.log);
        for (auto& sample : out.*instrument.log) instrument.reverse(sample);
    });
    out.ranges = r.ranges;
    out.ranges.epochs = reversed(std::move(out.ranges.epochs));
    for (GnssFix& f : out.gnss) f.velocity_n = -f.velocity_n;
    return out;
}

/// Samples of the channel referred to by events of this kind.
std::size_t samples_of(const Recording& r, MeasurementKind kind) {
    std::size_t n = is_part_of_fix(kind) ? r.gnss.size() : 0;
    for_each_instrument([&](const auto& instrument) {
        if (instrument.kind == kind) n = (r.*instrument.log).size();
    });
    return n;
}

std::vector<Event> reversed(const std::vector<Event>& events, const Recording& recording) {
    std::vector<Event> out(events.rbegin(), events.rend());
    std::array<bool, Channel::count * 8> changed{};  // by kind and components
    for (Event& e : out) {
        e.valid = reversed(e.valid);
        e.stamp = reversed(e.stamp);
        e.index = samples_of(recording, e.kind) - 1 - e.index;
        e.outage = -1;
        e.outage_end = false;
        // the first fix with another set of satellites becomes the last one with its own
        std::swap(e.constellation_change, changed[static_cast<std::size_t>(e.kind) * 8 + e.components]);
    }
    return out;
}

/// Increments from `first` to `last`, in reverse order.
ImuTimeline reversed(const ImuTimeline& imu, std::size_t first, std::size_t last) {
    ImuTimeline out;
    out.median_dt = imu.median_dt;
    out.increments.reserve(last - first + 1);
    for (std::size_t i = last + 1; i-- > first;) {
        const ImuIncrement& inc = imu.increments[i];
        const Time begin = i > 0 ? imu.increments[i - 1].time : inc.time - Duration::from_seconds(inc.dt);
        out.increments.push_back({reversed(begin), inc.dt, -inc.dtheta, inc.dv});
    }
    for (auto b = imu.bridges.rbegin(); b != imu.bridges.rend(); ++b)
        if (b->last >= first && b->first <= last)
            out.bridges.push_back({last - std::min(b->last, last), last - std::max(b->first, first), b->noise});
    return out;
}

StillReport reversed(const StillReport& still) {
    StillReport out = still;
    std::ranges::reverse(out.windows);
    for (StillWindow& w : out.windows) {
        w.end = reversed(w.end - Duration::from_seconds(w.length));
        w.mean_rate_b = -w.mean_rate_b;
    }
    return out;
}

}  // namespace

Settings reversed(Settings settings) {
    settings.earth.ellipsoid.w_ie = -settings.earth.ellipsoid.w_ie;
    for (Outage& o : settings.outages) o.start = -(o.start + o.duration);
    settings.smooth = settings.state_rows = settings.covariance_rows = false;
    return settings;
}

ReversedData reversed(const RunData& data, std::size_t first, std::size_t last) {
    ReversedData out{std::make_unique<const Recording>(reversed(*data.recording)), {}};
    RunData& run = out.data;
    run.recording = out.recording.get();
    run.imu = reversed(data.imu, first, last);
    run.events = reversed(data.events, *data.recording);
    run.still = reversed(data.still);
    run.fix_noise.assign(data.fix_noise.rbegin(), data.fix_noise.rend());
    run.declination = data.declination;
    run.gates = data.gates;
    run.slow_limits = data.slow_limits;
    run.origin = reversed(data.origin);
    run.backward = true;
    return out;
}

estim::StateVector signs_in_reversed_time(const Layout& layout) {
    estim::StateVector signs = estim::StateVector::Ones(layout.size);
    const auto change = [&](int first, int states) {
        if (first >= 0) signs.segment(first, states).setConstant(-1.0);
    };
    change(Layout::velocity, 3);
    change(Layout::gyro_bias, 3);
    change(layout.gnss_velocity, 3);
    change(layout.gnss_latency, 1);
    change(layout.gnss_velocity_latency, 1);
    change(layout.gravity_slope, 3);
    change(layout.drift, 1);
    change(layout.rate_noise, 1);
    return signs;
}

}  // namespace schuler::filter
