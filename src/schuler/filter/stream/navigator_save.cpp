// Saving and restoring a navigator: header, checksum, parts. Members of NavigatorEngine.

#include "schuler/filter/detail/archive.h"
#include "schuler/filter/detail/navigator_engine.h"

#include <cmath>
#include <cstring>
#include <optional>

namespace schuler::filter::detail {

namespace {

struct Fnv {
    std::uint64_t hash = 14695981039346656037ULL;
    void add(std::span<const std::byte> bytes) {
        for (const std::byte b : bytes) hash = (hash ^ static_cast<std::uint64_t>(b)) * 1099511628211ULL;
    }
    template <class T>
    void number(const T& x) {
        add(std::as_bytes(std::span(&x, 1)));
    }
};

/// Precedes the parts of a navigator.
struct Header {
    static constexpr std::uint64_t its_name = 0x56414e4c55484353;  // "SCHULNAV"
    static constexpr std::uint64_t its_version = 20;
    std::uint64_t name = its_name, version = its_version, settings = 0, size = 0, checksum = 0;
};

}  // namespace

/// Distinguishes settings by their effect on the filter.
std::uint64_t NavigatorEngine::fingerprint() const {
    Fnv f;
    const InertialModel& m = model();
    const Settings& s = settings.filter;
    for (const LayoutBlock& b : m.layout.blocks()) {
        f.add(std::as_bytes(std::span(b.name)));
        f.number(b.offset);
    }
    for (const StateProcess& p : m.process) {
        f.number(p.decay);
        f.number(p.psd);
    }
    const GnssSettings& g = s.gnss;
    const FeedRates& r = settings.rates;
    const auto latency = [](std::optional<double> x) { return x.value_or(-1.0); };
    // clang-format off
    const double numbers[] = {m.gyro_psd, m.accel_psd, m.gyro_gain, m.accel_gain, m.gyro_g, m.gyro_vibration, m.accel_vibration, m.clock_psd, m.drift_psd,
                              settings.lag, settings.imu_interval, settings.still_delay, settings.longest_hole,
                              settings.still.force_std, settings.still.rate_std,
                              g.latency, latency(g.velocity_latency), latency(g.height_latency), latency(g.velocity_down_latency), latency(g.jitter),
                              g.lever_arm_std, g.std_scale, g.velocity_std_scale, g.consider_errors ? 1.0 : 0.0, s.baro.std, s.mag.heading_std, s.odometer.std, s.heading.std,
                              s.constraints.gate_probability, s.constraints.constraint_rate, s.output_rate,
                              s.constraints.zero_velocity_std, s.constraints.zero_rate_std, s.constraints.nonholonomic_std_lateral, s.constraints.nonholonomic_std_vertical,
                              s.constraints.floor_position, s.constraints.floor_velocity, s.constraints.floor_attitude, s.constraints.floor_gyro_bias, s.constraints.floor_accel_bias,
                              s.constraints.recovery_time, static_cast<double>(s.constraints.recovery_count), s.feedback_period.value_or(-1.0), s.feedback_attitude,
                              s.separate.restart_period, s.separate.position_time, s.separate.velocity_time, s.separate.baro_time,
                              s.integrity.accel_limit, s.integrity.trace_ratio, s.integrity.window, s.integrity.false_alarm,
                              static_cast<double>(s.integrity.slow_count), s.integrity.readmission_time,
                              s.ranging.protection.missed_detection, s.ranging.protection.false_alarm, s.ranging.protection.fault_free,
                              s.ranging.receiver_acceleration, s.imu.mounting_std, s.imu.found_mounting_std, s.imu.gap_factor,
                              std::isfinite(s.mag.declination) ? s.mag.declination : 10.0, s.mag.bias_std, s.mag.deviation_std, s.mag.used_disturbance(), s.baro.bias_std, s.odometer.scale_std,
                              s.heading.offset_std, s.gauges.level_std, s.log.scale_std, s.log.misalignment_std,
                              s.earth.ellipsoid.a, s.earth.ellipsoid.f, s.earth.ellipsoid.gm, s.earth.ellipsoid.w_ie,
                              r.gnss, r.baro, r.mag, r.odometer, r.heading, r.gauges, r.log, r.ranges, s.gauges.std, s.log.std};
    // clang-format on
    for (const double x : numbers) f.number(x);
    const std::array<Eigen::Vector3d, 3>& gauges = s.gauges.lever_arms_b;
    for (const Eigen::Vector3d& v :
         {g.lever_arm_b, g.found_lever_arm_std, s.imu.mounting_rpy, g.default_std_position, g.default_std_velocity,
          g.std_floor_position, s.log.lever_arm_b, gauges[0], gauges[1], gauges[2]})
        for (int i = 0; i < 3; ++i) f.number(v(i));
    for (int i = 0; i < 9; ++i) f.number(s.imu.C_bs(i));
    const int choices[] = {static_cast<int>(s.mechanization),
                           static_cast<int>(s.loop),
                           static_cast<int>(s.coupling),
                           static_cast<int>(s.loose_kind),
                           static_cast<int>(s.vehicle),
                           static_cast<int>(s.imu.kind),
                           static_cast<int>(s.imu.stamp),
                           s.aggressive_parts,
                           s.integrity.use,
                           s.ranging.protection.use,
                           s.constraints.zero_velocity,
                           s.constraints.nonholonomic,
                           s.constraints.nonholonomic_auto,
                           s.heading.by_course,
                           s.output_at_antenna,
                           g.use_velocity,
                           s.ranging.use_rates,
                           s.ranging.use_stations,
                           static_cast<int>(s.earth.gravity)};
    for (const int x : choices) f.number(x);
    f.number(settings.rates.range_sources);
    return f.hash;
}

void NavigatorEngine::archive_all(Archive& a) {
    a(phase, given_, baro_height_, start_up.memory);
    stream.archive(a);
    a(events.memory.all, events.memory.first, events.memory.count, rows.memory.all, rows.memory.first, rows.memory.count);
    archive_run(a);
}

std::size_t NavigatorEngine::save(std::span<std::byte> bytes) const {
    auto& self = const_cast<NavigatorEngine&>(*this);  // one function for both directions; writing changes nothing
    Archive measure(Archive::Way::Measure, {});
    self.archive_all(measure);
    const std::size_t size = sizeof(Header) + measure.at;
    if (bytes.size() < size) return size;
    const std::span<std::byte> payload = bytes.subspan(sizeof(Header), measure.at);
    Archive write(Archive::Way::Write, payload);
    self.archive_all(write);
    Header header;
    header.settings = fingerprint();
    header.size = measure.at;
    Fnv f;
    f.add(payload);
    header.checksum = f.hash;
    std::memcpy(bytes.data(), &header, sizeof header);
    return size;
}

RestoreStatus NavigatorEngine::restore(std::span<const std::byte> bytes) {
    Header header;
    if (bytes.size() < sizeof header) return RestoreStatus::TooShort;
    std::memcpy(&header, bytes.data(), sizeof header);
    if (header.name != Header::its_name) return RestoreStatus::Foreign;
    if (header.version != Header::its_version) return RestoreStatus::OtherVersion;
    if (header.settings != fingerprint()) return RestoreStatus::OtherSettings;
    if (bytes.size() - sizeof header < header.size) return RestoreStatus::TooShort;
    const std::span<const std::byte> payload = bytes.subspan(sizeof header, header.size);
    Fnv f;
    f.add(payload);
    if (f.hash != header.checksum) return RestoreStatus::Damaged;
    Archive read(Archive::Way::Read, {const_cast<std::byte*>(payload.data()), payload.size()});
    archive_all(read);
    if (read.good && read.at == payload.size()) return RestoreStatus::Restored;
    restart();  // valid checksum but inconsistent content: from a machine of another kind
    return RestoreStatus::Damaged;
}

}  // namespace schuler::filter::detail
