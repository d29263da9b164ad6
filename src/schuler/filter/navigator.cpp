#include "schuler/filter/navigator.h"

#include "schuler/filter/detail/navigator_engine.h"

#include <cmath>
#include <numbers>
#include <utility>

namespace schuler::filter {

namespace {

struct Refusal {
    MakeStatus status = MakeStatus::Made;
    const char *key = "", *reason = "";
};

bool is_sigma(const Eigen::Vector3d& sigma, double most) { return (sigma.array() >= 0.0).all() && (sigma.array() <= most).all(); }

/// An impossible start, or one whose covariance would overflow.
Refusal unusable(const Start& start) {
    using enum MakeStatus;
    const Geodetic& p = start.nav.position;
    if (!(std::abs(p.lat) <= 0.5 * std::numbers::pi && std::abs(p.lon) <= 2.0 * std::numbers::pi && std::abs(p.h) <= 1e6))
        return {BadSettings, "start.nav.position", "the position of the start is not on or near the Earth"};
    if (!(start.nav.v_eb_n.norm() <= 1e4))
        return {BadSettings, "start.nav.v_eb_n", "the velocity of the start is to be below 10 km/s"};
    if (!(std::abs(start.nav.q_nb.norm() - 1.0) < 1e-6))
        return {BadSettings, "start.nav.q_nb", "the quaternion of the start is to have a norm of one"};
    if (!is_sigma(start.std_position, 1e7)) return {BadSettings, "start.std_position", "a sigma is to be from 0 to 10 000 km"};
    if (!is_sigma(start.std_velocity, 1e4)) return {BadSettings, "start.std_velocity", "a sigma is to be from 0 to 10 km/s"};
    if (!is_sigma(start.std_rpy, 10.0)) return {BadSettings, "start.std_rpy", "a sigma is to be from 0 to 10 rad"};
    if (!is_sigma(start.std_gyro_bias, 10.0)) return {BadSettings, "start.std_gyro_bias", "a sigma is to be from 0 to 10 rad/s"};
    if (!is_sigma(start.std_accel_bias, 1e3))
        return {BadSettings, "start.std_accel_bias", "a sigma is to be from 0 to 1000 m/s^2"};
    return {};
}

/// Probabilities without quantiles.
Refusal unusable_probability(const Settings& s) {
    using enum MakeStatus;
    const auto is_usable = [](double p) { return 1.0 - p > 0.0 && 1.0 - p < 1.0; };  // neither is one nor rounds to one
    if (!(s.constraints.gate_probability == 0.0 || is_usable(s.constraints.gate_probability)))
        return {BadSettings, "filter.gate_probability", "the probability is to be from 0 to below 1"};
    if (s.integrity.use && !is_usable(s.integrity.false_alarm))
        return {BadSettings, "filter.integrity.false_alarm", "the probability is to be between 0 and 1"};
    const ProtectionSettings& p = s.ranging.protection;
    if (p.use && !(is_usable(p.false_alarm) && is_usable(2.0 * p.missed_detection) && is_usable(p.fault_free)))
        return {BadSettings, "filter.protection", "the probabilities are to be between 0 and 1, missed_detection below 0.5"};
    return {};
}

/// Settings not available for a stream.
Refusal unusable(const NavigatorSettings& n) {
    using enum MakeStatus;
    const Settings& s = n.filter;
    if (!(n.imu_interval >= 1e-4 && n.imu_interval <= 0.2))
        return {BadSettings, "imu_interval", "the interval of the IMU is to be from 0.1 ms to 0.2 s"};
    if (!(n.lag >= 0.0 && n.lag <= 10.0)) return {BadSettings, "lag", "the lag is to be from 0 to 10 s"};
    if (!(n.still_delay >= 0.0 && n.still_delay <= 5.0)) return {BadSettings, "still_delay", "the delay is to be from 0 to 5 s"};
    if (!(n.longest_hole >= n.imu_interval && n.longest_hole <= 60.0))
        return {BadSettings, "longest_hole", "the longest hole is to be below 60 s"};
    const FeedRates& r = n.rates;
    for (const double rate : {r.gnss, r.baro, r.mag, r.odometer, r.heading, r.gauges, r.log, r.ranges})
        if (!(rate >= 0.0 && rate <= 1e4)) return {BadSettings, "rates", "a rate is to be from 0 to 10 kHz"};
    if (r.gauge_count < 0 || r.gauge_count > 3) return {BadSettings, "rates.gauge_count", "there are to be three gauges at most"};
    if ((r.gauges > 0.0) != (r.gauge_count > 0))
        return {BadSettings, "rates.gauges", "the rate of the gauges and their number do not fit"};
    if (r.range_sources > 4096) return {BadSettings, "rates.range_sources", "there are to be 4096 sources of ranges at most"};
    if (!(s.gnss.lever_arm_b.norm() < 1000.0)) return {BadSettings, "gnss.lever_arm_m", "the lever arm is to be below 1000 m"};
    if (!(std::abs(s.gnss.latency) < 10.0)) return {BadSettings, "gnss.latency_s", "the latency is to be below 10 s"};
    const double velocity = s.gnss.velocity_latency.value_or(s.gnss.latency);
    for (const double latency : {s.gnss.latency, velocity, s.gnss.height_latency.value_or(s.gnss.latency),
                                 s.gnss.velocity_down_latency.value_or(velocity)})
        if (!(latency <= n.lag))
            return {BadSettings, "lag", "the receiver's latency is longer than the lag: every fix would be late"};
    if (!(s.output_rate >= 0.0)) return {BadSettings, "output_rate", "the output rate is negative"};
    if (s.coupling == Coupling::Intermediate || s.coupling == Coupling::Deep)
        return {NotForStreams, "filter.scheme", "its second filter or receiver cannot be fed sample by sample: choose tight"};
    if (uses_ranges(s.coupling) && !(r.ranges > 0.0))
        return {BadSettings, "rates.ranges", "the coupling takes ranges and their rate is zero"};
    if (s.smooth) return {NotForStreams, "filter.smooth", "the smoother needs the whole log"};
    if (!s.outages.empty()) return {NotForStreams, "outages", "outages are made of whole logs"};
    if (s.start || s.stop) return {NotForStreams, "start", "spans of time are those of whole logs"};
    if (s.imu.estimate_mounting) return {NotForStreams, "imu.mounting", "the mounting is found from whole logs: give it"};
    if (s.imu.estimate_noise) return {NotForStreams, "imu.estimate_noise", "the noise is found from whole logs: give it"};
    if (s.gnss.estimate_latency) return {NotForStreams, "gnss.latency_s", "the latency is found from whole logs: give it"};
    if (s.backward) return {NotForStreams, "filter.backward", "a filter backward in time needs the whole log"};
    if (!s.output_lever_arm_b.isZero(0.0) || !s.output_instants.empty())
        return {NotForStreams, s.output_instants.empty() ? "output.lever_arm_m" : "output.events",
                "the solution at other points and instants is that of a batch"};
    if (s.state_rows || s.covariance_rows) return {NotForStreams, "outputs", "rows of all states are those of a batch"};
    if (const Refusal refusal = unusable_probability(s); refusal.status != Made) return refusal;
    if (!layout_with(s, detail::instruments_of(r)).fits())
        return {
            TooManyStates, "filter.misalignments",
            "the filter would have too many states: leave out misalignments, scale factors, the lever arm or the receiver's slow errors"};
    return n.start ? unusable(*n.start) : Refusal{};
}

}  // namespace

Navigator::Navigator(std::unique_ptr<detail::NavigatorEngine> engine) : engine_(std::move(engine)) {}
Navigator::~Navigator() = default;
Navigator::Navigator(Navigator&&) noexcept = default;
Navigator& Navigator::operator=(Navigator&&) noexcept = default;

NavigatorMade Navigator::make(const NavigatorSettings& settings) {
    NavigatorMade made;
    if (const Refusal refusal = unusable(settings); refusal.status != MakeStatus::Made) {
        made.status = refusal.status;
        made.key = refusal.key;
        made.reason = refusal.reason;
        return made;
    }
    NavigatorSettings adjusted = settings;
    if (adjusted.filter.coupling == Coupling::Separate) adjusted.filter.loop = Loop::Closed;  // the corrections are the coupling
    made.navigator.emplace(Navigator(detail::make_engine(adjusted)));
    return made;
}

FeedStatus Navigator::feed(const ImuSample& sample) { return engine_->feed(sample); }
FeedStatus Navigator::feed(const GnssFix& fix) { return engine_->feed(Source::Gnss, fix); }
FeedStatus Navigator::feed(const BaroSample& sample) { return engine_->feed(Source::Baro, sample); }
FeedStatus Navigator::feed(const MagSample& sample) { return engine_->feed(Source::Mag, sample); }
FeedStatus Navigator::feed(const OdometerSample& sample) { return engine_->feed(Source::Odometer, sample); }
FeedStatus Navigator::feed(const HeadingSample& sample) { return engine_->feed(Source::Heading, sample); }
FeedStatus Navigator::feed(const GaugeSample& sample) { return engine_->feed(Source::Gauges, sample); }
FeedStatus Navigator::feed(const BodyVelocitySample& sample) { return engine_->feed(Source::Log, sample); }
FeedStatus Navigator::feed(Time time, std::span<const RangeSample> samples) { return engine_->feed(time, samples); }
std::optional<std::uint16_t> Navigator::range_source(std::string_view name, bool station) {
    return engine_->stream.range_source(name, station);
}

Phase Navigator::phase() const { return engine_->phase; }
std::optional<NavigatorState> Navigator::state() { return engine_->state(); }
std::optional<NavigatorState> Navigator::lagged() const { return engine_->lagged(); }
std::optional<SensorErrorRow> Navigator::sensor_errors() const { return engine_->sensor_errors(); }
const Layout& Navigator::layout() const { return engine_->model().layout; }

std::optional<NavigatorEvent> Navigator::poll() { return engine_->events.pop(); }
std::optional<SolutionRow> Navigator::poll_row() { return engine_->rows.pop(); }
const FeedCounters& Navigator::counters() const { return engine_->stream.counters; }

std::size_t Navigator::save(std::span<std::byte> bytes) const { return engine_->save(bytes); }
std::vector<std::byte> Navigator::save() const {
    std::vector<std::byte> bytes(engine_->save({}));
    (void)engine_->save(bytes);
    return bytes;
}
RestoreStatus Navigator::restore(std::span<const std::byte> bytes) { return engine_->restore(bytes); }
void Navigator::restart() { engine_->restart(); }

}  // namespace schuler::filter
