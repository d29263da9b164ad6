// Acceptance of samples by a stream: rejected and pending samples. Members of StreamTimeline.

#include "schuler/filter/stream/stream_timeline.h"

#include "schuler/core/least_sigmas.h"
#include "schuler/filter/update/range_update.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <tuple>

namespace schuler::filter {

using Eigen::Vector3d;

namespace {

constexpr double most_age = 10.0;  // s, of a part of a fix at its stamp

// Limits beyond any vehicle or instrument.
constexpr std::int64_t most_ns = 4'000'000'000'000'000'000;  // a century either way, so that differences of times are times
bool is_bad(Time time) { return time.ns > most_ns || time.ns < -most_ns; }
bool is_bad(double value, double most) { return !(std::abs(value) <= most); }
bool is_bad_if_stated(double value, double most) { return !std::isnan(value) && is_bad(value, most); }
/// Zero: none is stated.
bool is_bad_sigma(double sigma, double least) { return !std::isnan(sigma) && sigma != 0.0 && !(sigma >= least && sigma <= 1e6); }
bool has_bad(const Vector3d& v, double most) {
    return is_bad_if_stated(v.x(), most) || is_bad_if_stated(v.y(), most) || is_bad_if_stated(v.z(), most);
}
bool has_bad_sigma(const Vector3d& v, double least) {
    return is_bad_sigma(v.x(), least) || is_bad_sigma(v.y(), least) || is_bad_sigma(v.z(), least);
}

bool is_bad(const GnssFix& f) {
    constexpr double most_height = 1e6, most_speed = 1e4;  // m, m/s
    const Geodetic& p = f.position;
    if (is_bad_if_stated(p.lat, 0.5 * std::numbers::pi) || is_bad_if_stated(p.lon, 2.0 * std::numbers::pi) ||
        is_bad_if_stated(p.h, most_height))
        return true;
    if (is_bad(f.time) || (p.lat == 0.0 && p.lon == 0.0)) return true;  // output of receivers without a position
    return has_bad(f.velocity_n, most_speed) || has_bad_sigma(f.std_position, least_sigma::position) ||
           has_bad_sigma(f.std_velocity, least_sigma::velocity) || is_bad(f.position_age, most_age) ||
           is_bad(f.velocity_age, most_age);
}

bool is_bad(const RangeSample& s, std::size_t sources) {
    constexpr double far = 1e8, fast = 1e5;  // m, m/s
    return s.source >= sources || is_bad(s.tx.r.norm(), far) || is_bad_if_stated(s.pseudorange, far) ||
           is_bad_if_stated(s.range_rate, fast) || has_bad(s.tx_velocity, fast) || is_bad_sigma(s.std, least_sigma::range) ||
           is_bad_sigma(s.std_rate, least_sigma::range_rate) || is_bad(s.tx_clock, 1.0) || is_bad(s.tx_clock_rate, 1.0) ||
           is_bad(s.variance, 1e12);
}

}  // namespace

FeedStatus StreamTimeline::count(Source source, FeedStatus status) {
    ++counters.by_status[static_cast<std::size_t>(source)][static_cast<std::size_t>(status)];
    return status;
}

FeedStatus StreamTimeline::feed(const ImuSample& sample) {
    const bool rates = settings_.filter.imu.kind == ImuKind::Rates;
    const double per_second = rates ? 1.0 : 1.0 / settings_.imu_interval;
    constexpr double most_rate = 200.0, most_force = 1e5;  // rad/s, m/s^2
    const double scale2 = per_second * per_second;
    if (is_bad(sample.time) || is_bad(sample.gyro.squaredNorm() * scale2, most_rate * most_rate) ||
        is_bad(sample.accel.squaredNorm() * scale2, most_force * most_force))
        return count(Source::Imu, FeedStatus::BadValue);
    const auto refuse = [&](FeedStatus status) {
        const double step = (sample.time - memory.stranger).seconds();
        memory.strangers = memory.strangers > 0 && step > 0.0 && step < 20.0 * settings_.imu_interval ? memory.strangers + 1 : 1;
        memory.stranger = sample.time;
        return count(Source::Imu, status);
    };
    if (memory.any_imu) {
        const Duration ahead = sample.time - memory.newest;
        if (ahead > longest_hole_) return refuse(FeedStatus::TooFarAhead);
        if (-ahead > lag_ || sample.time < memory.last_settled) return refuse(FeedStatus::Late);
        if (sample.time == memory.last_settled || imu_.has(imu_store_, sample.time))
            return count(Source::Imu, FeedStatus::Duplicate);
        if (imu_.full()) return count(Source::Imu, FeedStatus::Full);
    }
    memory.strangers = 0;
    if (!imu_.insert(imu_store_, sample)) {
        ++counters.reordered[static_cast<std::size_t>(Source::Imu)];
        memory.order_changed = true;
    }
    memory.newest = memory.any_imu ? std::max(memory.newest, sample.time) : sample.time;
    memory.any_imu = true;
    return count(Source::Imu, FeedStatus::Taken);
}

FeedStatus StreamTimeline::check_time(Time valid) const {
    if (!memory.any_imu) return FeedStatus::Taken;
    const Duration ahead = valid - memory.newest;
    if (ahead.seconds() > most_ahead) return FeedStatus::TooFarAhead;
    return -ahead > lag_ ? FeedStatus::Late : FeedStatus::Taken;
}

template <class Sample>
FeedStatus StreamTimeline::feed(Source source, const Sample& sample, Time valid, detail::SamplePool<Sample>& pool,
                                std::vector<Sample>& store) {
    FeedStatus status = check_time(valid);
    if (status == FeedStatus::Taken && sample.time < memory.released[static_cast<std::size_t>(source)]) status = FeedStatus::Late;
    if (status == FeedStatus::Taken &&
        (sample.time == memory.released[static_cast<std::size_t>(source)] || pool.has(store, sample.time)))
        status = FeedStatus::Duplicate;
    if (status != FeedStatus::Taken) return count(source, status);
    if (pool.full() && !memory.any_imu && !pool.empty())
        pool.let_go(pool.take());  // no reference time yet: the latest samples are kept
    if (pool.full()) return count(source, store.empty() ? FeedStatus::NotUsed : FeedStatus::Full);
    if (!pool.insert(store, sample)) ++counters.reordered[static_cast<std::size_t>(source)];
    return count(source, FeedStatus::Taken);
}

FeedStatus StreamTimeline::feed(const GnssFix& fix) {
    if (is_bad(fix)) return count(Source::Gnss, FeedStatus::BadValue);
    return feed(Source::Gnss, fix, fix.time - events_.oldest_age(fix), gnss_, recording_.gnss);
}
template <class Sample>
FeedStatus StreamTimeline::take(const Sample& s, bool used, bool bad) {
    auto& pending = std::get<Pending<Sample>>(pending_);
    const Instrument<Sample>& instrument = pending.instrument;
    if (!used) return count(instrument.source, FeedStatus::NotUsed);
    if (bad || is_bad(s.time)) return count(instrument.source, FeedStatus::BadValue);
    return feed(instrument.source, s, s.time, pending.pool, recording_.*instrument.log);
}
FeedStatus StreamTimeline::feed(const BaroSample& s) { return take(s, settings_.filter.baro.use, is_bad(s.height, 1e5)); }
FeedStatus StreamTimeline::feed(const MagSample& s) {
    return take(s, settings_.filter.mag.use, is_bad(s.field_b.norm(), 1e6) || !(s.field_b.norm() > 0.0));
}
FeedStatus StreamTimeline::feed(const OdometerSample& s) {
    return take(s, settings_.filter.odometer.use, is_bad(s.speed, 1e3) || is_bad_sigma(s.std, least_sigma::velocity));
}
FeedStatus StreamTimeline::feed(const HeadingSample& s) {
    return take(s, settings_.filter.heading.use,
                is_bad(s.heading, 4.0 * std::numbers::pi) || is_bad_sigma(s.std, least_sigma::heading));
}
FeedStatus StreamTimeline::feed(const GaugeSample& s) {
    return take(s, settings_.filter.gauges.use, has_bad(s.height, 1e5) || !s.height.array().isFinite().any());
}
FeedStatus StreamTimeline::feed(const BodyVelocitySample& s) {
    return take(s, settings_.filter.log.use, is_bad(s.velocity_b.norm(), 1e3));
}

FeedStatus StreamTimeline::feed(Time time, std::span<const RangeSample> samples) {
    RangingLog& log = recording_.ranges;
    if (!uses_ranges(settings_.filter.coupling) || log.samples.empty()) return count(Source::Ranges, FeedStatus::NotUsed);
    if (is_bad(time) || samples.empty() || samples.size() > RangeEpochWork::most ||
        std::ranges::any_of(samples, [&](const RangeSample& s) { return is_bad(s, log.sources.size()); }))
        return count(Source::Ranges, FeedStatus::BadValue);
    FeedStatus status = check_time(time);
    const auto at = std::ranges::upper_bound(log.epochs, time, {}, &RangeEpoch::time);
    if (status == FeedStatus::Taken && at != log.epochs.begin() && std::prev(at)->time == time) status = FeedStatus::Duplicate;
    if (status == FeedStatus::Taken && free_ranges_.empty() && !memory.any_imu) {
        free_ranges_.push_back(static_cast<std::uint32_t>(log.epochs.front().first / RangeEpochWork::most));
        log.epochs.erase(log.epochs.begin());
        return feed(time, samples);
    }
    if (status == FeedStatus::Taken && free_ranges_.empty()) status = FeedStatus::Full;
    if (status != FeedStatus::Taken) return count(Source::Ranges, status);
    if (at != log.epochs.end()) ++counters.reordered[static_cast<std::size_t>(Source::Ranges)];
    const std::size_t first = free_ranges_.back() * RangeEpochWork::most;
    free_ranges_.pop_back();
    std::ranges::copy(samples, log.samples.begin() + static_cast<std::ptrdiff_t>(first));
    log.epochs.insert(at, RangeEpoch{time, first, samples.size()});
    return count(Source::Ranges, FeedStatus::Taken);
}

std::optional<std::uint16_t> StreamTimeline::range_source(std::string_view name, bool station) {
    std::vector<RangeSource>& sources = recording_.ranges.sources;
    for (std::size_t i = 0; i < sources.size(); ++i)
        if (sources[i].name == name && sources[i].station == station) return static_cast<std::uint16_t>(i);
    constexpr std::size_t longest_name = 15;  // fits in a string without allocation
    if (sources.size() == sources.capacity() || name.size() > longest_name) return std::nullopt;
    sources.push_back({std::string(name), station});
    return static_cast<std::uint16_t>(sources.size() - 1);
}

}  // namespace schuler::filter
