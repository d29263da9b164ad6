#include "schuler/app/dataset.h"

#include "schuler/app/carrier_phase.h"
#include "schuler/app/load_ranges.h"
#include "schuler/app/raw_gnss.h"
#include "schuler/core/units.h"
#include "schuler/dataset/clock_steps.h"
#include "schuler/earth/atmosphere.h"
#include "schuler/io/csv_aids.h"
#include "schuler/io/csv_events.h"
#include "schuler/io/csv_recording.h"
#include "schuler/io/kfgins.h"
#include "schuler/io/nmea.h"
#include "schuler/io/rtklib_pos.h"
#include "schuler/io/table.h"
#include "schuler/io/ubx.h"
#include "schuler/math/quantile.h"
#include "schuler/math/rotation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <optional>

namespace schuler::app {
namespace {

namespace fs = std::filesystem;

/// A table of numbers without names, as KF-GINS writes them, that the settings do not explain column by column.
bool is_bare_table(const io::TextInput& input, const FileSource& source, int columns) {
    if (!source.columns.empty()) return false;
    const io::TableLayout layout = io::inspect_table(input);
    return layout.names.empty() && layout.data_columns == columns;
}

io::CsvOptions csv_options(const FileSource& source, const Config& config) {
    io::CsvOptions o;
    o.columns = source.columns;
    o.scale = source.scale;
    o.fix_codes = config.fix_codes;
    o.time_offset = Duration::from_seconds(source.time_offset);
    if (config.quaternion == Quaternion::SensorToEnu) o.quaternion = "sensor_to_enu";
    // body to sensor: the axes, then the mounting
    const Eigen::Matrix3d C_bs = math::dcm_from_rpy(config.filter.imu.mounting_rpy) * config.filter.imu.C_bs;
    o.C_sb = C_bs.transpose();
    return o;
}

void read_imu(const fs::path& folder, LoadedDataset& out, WarningLog& warnings) {
    Config& c = out.config;
    if (c.imu.file.empty() && c.scheme == Scheme::Gnss) return;
    if (c.imu.file.empty()) {
        throw input_error("no IMU file", {{}, 0, 0, "imu.file"},
                          "name it in dataset.toml: [imu] file = \"imu.csv\", or choose --scheme gnss");
    }
    const io::TextInput input(resolved(folder, c.imu.file, "imu.file"));
    if (is_bare_table(input, c.imu, 7)) {
        out.recording.imu = io::read_kfgins_imu(input, warnings, Duration::from_seconds(c.imu.time_offset)).samples;
        c.filter.imu.kind = ImuKind::Increments;
        return;
    }
    io::ImuTable table = io::read_imu_csv(input, csv_options(c.imu, c), warnings);
    out.recording.imu = std::move(table.samples);
    c.filter.imu.kind = table.kind;
}

void settle_height_kind(io::HeightKind found, Config& c) {
    const bool sea_level = found == io::HeightKind::Msl || found == io::HeightKind::Autopilot;
    if (sea_level && c.filter.gnss.height == fusion::HeightKind::Ellipsoidal) c.filter.gnss.height = fusion::HeightKind::Msl;
}

std::vector<GnssFix> shifted(std::vector<GnssFix> fixes, Duration by) {
    for (GnssFix& f : fixes) f.time = f.time + by;
    return fixes;
}

/// First and last time of the log that says what the data set's own axis is: the IMU's, or the reference where there is none.
struct OwnAxis {
    double first, last;
};
std::optional<OwnAxis> own_axis(const Recording& r) {
    if (!r.imu.empty()) return OwnAxis{r.imu.front().time.seconds(), r.imu.back().time.seconds()};
    if (!r.reference.empty()) return OwnAxis{r.reference.front().time.seconds(), r.reference.back().time.seconds()};
    return std::nullopt;
}

/// GPS time of zero on the data set's own axis, for files that carry dates where the other logs do not. Zero where they do.
Duration axis_zero(const TimeConfig& time, Time first_fix, const OwnAxis& axis) {
    const double first = axis.first, last = axis.last;
    const std::int64_t utc = (first_fix.ns / 1'000'000'000) - gps_minus_utc(first_fix.ns / 1'000'000'000);
    const Duration leap = time.scale == TimeScale::Utc ? Duration{gps_minus_utc(utc) * std::int64_t{1'000'000'000}} : Duration{};
    constexpr double dated = 1e8, day = 86'400.0, week = 7 * day;
    if (time.scale == TimeScale::Utc && first > 1e9) return leap + Duration{-unix_time_of_gps_epoch * std::int64_t{1'000'000'000}};
    if (first > dated) return leap;
    if (time.week) return Time::from_gps(*time.week, 0.0) - Time{} + leap;
    if (!time.date.empty()) {
        Calendar c{0, 0, 0, 0, 0, 0.0};
        std::sscanf(time.date.c_str(), "%d-%d-%d", &c.year, &c.month, &c.day);
        return gps_from_calendar(c) - Time{} + leap;
    }
    // whole weeks lie between, or whole days where the log cannot be seconds of a week
    const double unit = time.scale == TimeScale::Utc && last < day + 3600.0 ? day : week;
    return Duration::from_seconds(std::floor(first_fix.seconds() / unit) * unit) + leap;
}

/// Dated fixes on the data set's own axis.
std::vector<GnssFix> on_own_axis(std::vector<GnssFix> fixes, const Config& c, const Recording& recording, Duration offset) {
    const auto axis = own_axis(recording);
    if (fixes.empty() || !axis) return fixes;
    const Time first = fixes.front().time;
    return shifted(std::move(fixes), offset + -axis_zero(c.time, first, *axis));
}

void read_gnss(const fs::path& folder, LoadedDataset& out, WarningLog& warnings) {
    Config& c = out.config;
    const Duration offset = Duration::from_seconds(c.gnss.time_offset);
    if (!c.base.observations.empty() && c.gnss.file.empty()) {
        if (c.raw.observations.empty())
            throw input_error("a base station needs the rover's raw measurements", {{}, 0, 0, "base.observations"},
                              "name them: [gnss] observations = \"rover.obs\"");
        out.carrier = carrier_phase(folder, c, warnings);
        out.carrier.fixes = on_own_axis(std::move(out.carrier.fixes), c, out.recording, offset);
        out.recording.gnss = out.carrier.fixes;
        return;
    }
    if (c.gnss.file.empty() && !c.raw.observations.empty()) {
        out.recording.gnss = on_own_axis(fixes_from_raw(folder, c.raw, warnings), c, out.recording, offset);
        return;
    }
    if (c.gnss.file.empty()) return;
    const io::TextInput input(resolved(folder, c.gnss.file, "gnss.file"));
    if (io::is_ubx(input)) {
        io::UbxLog log = io::read_ubx(input, warnings);
        if (log.fixes.empty())
            throw input_error("has no fix of the receiver itself (NAV-PVT)", {c.gnss.file, 0, 0, "gnss.file"},
                              "its raw measurements are used as [gnss] observations");
        out.recording.gnss = on_own_axis(std::move(log.fixes), c, out.recording, offset);
        return;
    }
    if (is_bare_table(input, c.gnss, 7) || is_bare_table(input, c.gnss, 13)) {
        out.recording.gnss = io::read_kfgins_gnss(input, warnings, offset).fixes;
        return;
    }
    if (io::is_rtklib_pos(input)) {
        io::RtklibPos pos = io::read_rtklib_pos(input, warnings);
        out.recording.gnss = on_own_axis(std::move(pos.fixes), c, out.recording, offset);
        settle_height_kind(pos.height, c);
        return;
    }
    if (io::is_nmea(input)) {
        io::NmeaLog log = io::read_nmea(input, warnings);
        out.recording.gnss = log.has_date ? on_own_axis(std::move(log.fixes), c, out.recording, offset)
                                          : shifted(std::move(log.fixes), offset);
        settle_height_kind(log.height, c);
        return;
    }
    io::GnssTable table = io::read_gnss_csv(input, csv_options(c.gnss, c), warnings);
    out.recording.gnss = std::move(table.fixes);
    settle_height_kind(table.height, c);
}

/// Ranges, and fixes from them where there are no others.
void read_ranges(const fs::path& folder, LoadedDataset& out, WarningLog& warnings) {
    Config& c = out.config;
    const bool csv = !c.ranges.file.empty();
    if (!csv && (c.raw.observations.empty() || (c.scheme != Scheme::Tight && c.scheme != Scheme::Medium))) return;
    RangingLog& log = out.recording.ranges;
    log = csv ? ranges_from_csv(folder, c, warnings) : ranges_from_raw(folder, c, out.given, warnings);
    const auto axis = own_axis(out.recording);
    if (!csv && !log.empty() && axis) {
        const Duration shift = Duration::from_seconds(c.gnss.time_offset) + -axis_zero(c.time, log.epochs.front().time, *axis);
        for (RangeEpoch& e : log.epochs) e.time = e.time + shift;
    }
    if (out.recording.gnss.empty() && c.gnss.file.empty()) take_fixes_from_ranges(out);
}

/// Heights above mean sea level become ellipsoidal where the undulation is known.
void settle_heights(LoadedDataset& out, WarningLog& warnings) {
    Config& c = out.config;
    out.logged_height = c.filter.gnss.height;
    if (c.filter.gnss.height != fusion::HeightKind::Msl || out.recording.gnss.empty()) return;
    if (c.undulation) {
        for (GnssFix& f : out.recording.gnss) f.position.h += *c.undulation;
        c.filter.gnss.height = fusion::HeightKind::Ellipsoidal;
        return;
    }
    warnings.add("gnss.height.msl",
                 "heights are above mean sea level and are used as they are; give gnss.undulation_m for ellipsoidal ones");
}

void read_others(const fs::path& folder, LoadedDataset& out, WarningLog& warnings) {
    Config& c = out.config;
    if (!c.baro.file.empty()) {
        out.recording.baro =
            io::read_baro_csv(resolved(folder, c.baro.file, "baro.file"), csv_options(c.baro, c), warnings).samples;
    }
    if (!c.mag.file.empty()) {
        out.recording.mag = io::read_mag_csv(resolved(folder, c.mag.file, "mag.file"), csv_options(c.mag, c), warnings).samples;
        if (!c.mag_axes.empty()) {
            const Eigen::Matrix3d C_imu_mag = c.filter.imu.C_bs.transpose() * axes_from_text(c.mag_axes);
            for (MagSample& m : out.recording.mag) m.field_b = C_imu_mag * m.field_b;
        }
    }
    const auto moved = [](auto samples, const FileSource& source) {
        for (auto& sample : samples) sample.time = sample.time + Duration::from_seconds(source.time_offset);
        return samples;
    };
    if (!c.odometer.file.empty())
        out.recording.odometer =
            moved(io::read_odometer_csv(io::TextInput(resolved(folder, c.odometer.file, "odometer.file"))), c.odometer);
    if (!c.heading.file.empty())
        out.recording.heading = moved(io::read_compass_csv(io::TextInput(resolved(folder, c.heading.file, "heading.file"))), c.heading);
    if (!c.aids.gauges.file.empty())
        out.recording.gauges = io::read_gauges_csv(io::TextInput(resolved(folder, c.aids.gauges.file, "gauges.file")));
    if (!c.aids.log.file.empty())
        out.recording.body_velocity = io::read_log_csv(io::TextInput(resolved(folder, c.aids.log.file, "log.file")));
    if (!c.aids.compass.file.empty()) {
        if (!c.heading.file.empty())
            throw input_error("there are two headings, of [heading] and of [compass]", {{}, 0, 0, "compass.file"}, "leave out one of them");
        out.recording.heading = io::read_compass_csv(io::TextInput(resolved(folder, c.aids.compass.file, "compass.file")));
    }
    if (!c.reference.file.empty()) {
        out.recording.reference = read_reference(resolved(folder, c.reference.file, "reference.file"), c.reference, c, warnings);
    }
}

/// Instants at which the solution is wanted, in order.
void settle_events(LoadedDataset& out, const fs::path& folder) {
    Config& c = out.config;
    if (!c.output.events.empty()) out.events = io::read_events_csv(io::TextInput(resolved(folder, c.output.events, "output.events")));
    std::ranges::stable_sort(out.events, {}, &NamedInstant::time);
    c.filter.output_instants.clear();
    for (const NamedInstant& e : out.events) c.filter.output_instants.push_back(e.time);
}

/// Where seconds of the week begin anew in one log, those that begin after that instant follow it into the next week.
void settle_rollover(Recording& r) {
    constexpr double week = 604'800.0;
    bool rolled = false;
    const auto each_log = [&r](auto visit) {
        visit(r.imu);
        visit(r.gnss);
        visit(r.baro);
        visit(r.mag);
        visit(r.odometer);
        visit(r.heading);
        visit(r.gauges);
        visit(r.body_velocity);
        visit(r.reference);
    };
    each_log([&](const auto& log) {
        rolled = rolled || (!log.empty() && log.front().time.seconds() < week && log.front().time.seconds() > 0.5 * week &&
                            log.back().time.seconds() >= week && log.back().time.seconds() < 1.5 * week);
    });
    if (!rolled) return;
    each_log([&](auto& log) {
        if (log.empty() || log.back().time.seconds() > 0.5 * week) return;
        for (auto& sample : log) sample.time = sample.time + Duration::from_seconds(week);
    });
}

/// The clock of the IMU and of what was logged with it ran fast: their seconds as the receiver's clock tells them, from the IMU's first.
void settle_drift(Recording& r, double drift) {
    if (drift == 0.0 || r.imu.empty()) return;
    const Time from = r.imu.front().time;
    const auto each = [&](auto& log) {
        for (auto& sample : log) sample.time = sample.time + Duration::from_seconds(-drift * (sample.time - from).seconds());
    };
    each(r.imu);
    each(r.baro);
    each(r.mag);
    each(r.odometer);
    each(r.gauges);
    each(r.body_velocity);
}

/// Gravity must show in the accelerometers: a wrong unit is said before a filter makes nonsense of it.
void check_gravity(const LoadedDataset& data, const fs::path& folder) {
    const std::vector<ImuSample>& imu = data.recording.imu;
    if (imu.size() < 100) return;
    std::vector<double> norms;
    const std::size_t stride = std::max<std::size_t>(1, imu.size() / 5000);
    for (std::size_t i = stride; i < imu.size(); i += stride) {
        const double dt = data.config.filter.imu.kind == ImuKind::Rates ? 1.0 : (imu[i].time - imu[i - 1].time).seconds();
        if (dt > 0.0 && imu[i].accel.allFinite()) norms.push_back(imu[i].accel.norm() / dt);
    }
    const double size = math::median(std::move(norms));
    if (std::isnan(size) || (size > 0.6 * units::g0 && size < 1.7 * units::g0)) return;
    blame_the_imu_log(folder, data.config);
    throw input_error(fmt::format("the accelerometers show {:.4g} m/s2 (median norm), not gravity", size),
                      {data.config.imu.file, 0, 0, "imu.scale"},
                      "check the unit of these columns and [imu] scale; data without gravity cannot be used");
}

Time absolute(const RunTime& t, Time origin) {
    const Time base = t.absolute ? Time{} : origin;
    return base + Duration::from_seconds(t.seconds);
}

void settle_times(LoadedDataset& out) {
    const Recording& r = out.recording;
    if (r.imu.empty() && (out.config.scheme != Scheme::Gnss || r.gnss.empty()))
        throw input_error("the IMU log has no usable row", {out.config.imu.file, 0, 0, {}},
                          "check its columns with `schuler inspect`");
    out.origin = r.gnss.empty() ? r.imu.front().time : r.gnss.front().time;
    fusion::Settings& f = out.config.filter;
    const RunConfig& run = out.config.run;
    if (run.start) f.start = absolute(*run.start, out.origin);
    if (run.stop) f.stop = absolute(*run.stop, out.origin);
    if (f.start && f.stop && *f.stop <= *f.start) {
        throw input_error("the end of the run is not after its start", {{}, 0, 0, "run.stop_s"},
                          "give a later --stop or an earlier --start");
    }
    f.outages.clear();
    for (const OutageSpan& o : run.outages) {
        const double start = o.absolute ? (Time::from_seconds(o.start) - out.origin).seconds() : o.start;
        f.outages.push_back({start, o.duration});
    }
    if (!std::isnan(out.config.initial_time)) f.initial.time = Time::from_seconds(out.config.initial_time);
}

}  // namespace

std::vector<ReferenceSample> read_reference(const fs::path& file, const FileSource& source, const Config& config,
                                            WarningLog& warnings) {
    const io::TextInput input(file);
    if (!is_bare_table(input, source, 10)) return io::read_reference_csv(input, csv_options(source, config), warnings).samples;
    FileSource named = source;
    const char* names[] = {"time_s",    "lat_deg",   "lon_deg",  "height_m",  "vel_n_m_s",
                           "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg", "heading_deg"};
    for (int i = 0; i < 10; ++i) named.columns[names[i]] = fmt::format("#{}", i + 1);
    return io::read_reference_csv(input, csv_options(named, config), warnings).samples;
}

namespace {

/// Pressures as heights of the standard atmosphere, where the log has no heights.
void settle_pressures(LoadedDataset& d) {
    for (BaroSample& b : d.recording.baro) {
        if (std::isfinite(b.height) || !std::isfinite(b.pressure)) continue;
        b.height = earth::geometric_from_geopotential(earth::geopotential_height_from_pressure(b.pressure, d.config.sea_level_pressure));
    }
}

/// What is believed of gauges, log and compass: the filter has it where it has the samples.
void believe_aids(Config& c) {
    const AidsConfig& aids = c.aids;
    c.filter.gauges.std = aids.gauges.white;
    c.filter.gauges.level_std = aids.gauges.bias;
    std::ranges::copy(aids.gauges.lever_arms_b, c.filter.gauges.lever_arms_b.begin());
    c.filter.log = {.std = aids.log.white,
                    .scale_std = aids.log.scale,
                    .misalignment_std = aids.log.misalignment,
                    .lever_arm_b = aids.log.lever_arm_b};
    if (aids.compass.file.empty()) return;
    c.filter.heading.std = aids.compass.white;
    c.filter.heading.offset_std = aids.compass.bias;
}

/// Near the poles the geographic frame is of no use: the Earth-fixed one is taken where none is given.
void choose_mechanization(LoadedDataset& data) {
    // there the geographic frame turns too fast beneath a vehicle: tan(lat) v / R
    constexpr double polar_latitude = 85.0 * units::deg;
    const auto polar = [](const GnssFix& fix) { return std::abs(fix.position.lat) > polar_latitude; };
    if (data.given.contains("filter.mechanization") || std::ranges::none_of(data.recording.gnss, polar)) return;
    data.config.filter.mechanization = fusion::Mechanization::Ecef;
    Fact& fact = data.facts.emplace_back();
    fact.key = "filter.mechanization";
    fact.value = std::string("ecef");
    fact.note = "fixes within 5 deg of a pole";
}

}  // namespace

LoadedDataset settled_dataset(Recording recording, const Config& config, WarningLog& warnings, std::set<std::string> given) {
    LoadedDataset out;
    out.given = std::move(given);
    out.recording = std::move(recording);
    out.config = config;
    believe_aids(out.config);
    if (out.recording.gnss.empty() && !out.recording.ranges.empty()) take_fixes_from_ranges(out);
    settle_pressures(out);
    settle_heights(out, warnings);
    settle_times(out);
    settle_events(out, {});
    return out;
}

LoadedDataset load_dataset(const Dataset& dataset, const Config& config, WarningLog& warnings) {
    const auto begin = std::chrono::steady_clock::now();
    LoadedDataset out;
    out.config = config;
    out.given = dataset.given;
    out.facts = dataset.facts;
    believe_aids(out.config);
    read_imu(dataset.folder, out, warnings);
    read_others(dataset.folder, out, warnings);
    read_gnss(dataset.folder, out, warnings);
    read_ranges(dataset.folder, out, warnings);
    settle_rollover(out.recording);
    dataset::put_clock_steps_back(out.recording, dataset.report.clock_steps);
    settle_drift(out.recording, out.config.clock_drift);
    settle_pressures(out);
    settle_heights(out, warnings);
    settle_times(out);
    settle_events(out, dataset.folder);
    check_gravity(out, dataset.folder);
    choose_mechanization(out);
    for (const std::string& doubt : dataset.doubts) warnings.add(doubt, doubt);
    for (const inspect::Contradiction& c : dataset.contradictions)
        warnings.add("contradiction." + c.key, fmt::format("the data contradict {}: {}; {}", c.key, c.text,
                                                            !c.refuted ? std::string("the given value is used")
                                                            : c.better ? fmt::format("{} is used", to_text(*c.better))
                                                                       : std::string("it is left out")));
    out.read_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return out;
}

}  // namespace schuler::app
