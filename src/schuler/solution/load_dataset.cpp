#include "schuler/solution/loaded_dataset.h"

#include "schuler/core/units.h"
#include "schuler/dataset/clock_steps.h"
#include "schuler/dataset/imu_log.h"
#include "schuler/dataset/odometer_check.h"
#include "schuler/dataset/paths.h"
#include "schuler/dataset/ranges.h"
#include "schuler/dataset/read_files.h"
#include "schuler/dataset/stated_sigmas.h"
#include "schuler/dataset/time_axis.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/csv/csv_events.h"
#include "schuler/math/rotation.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/facts.h"
#include "schuler/settings/magnetometer_axes.h"
#include "schuler/solution/load_ranges.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace schuler::solution {
namespace {

namespace fs = std::filesystem;

/// Reading options defined by the settings.
dataset::Reading reading_of(const settings::Config& c) {
    dataset::Reading reading;
    reading.imu = c.scheme != settings::Scheme::Gnss;
    reading.ranges = c.scheme == settings::Scheme::Tight;
    // body to sensor: the axes, then the mounting
    reading.C_bs = math::dcm_from_rpy(c.filter.imu.mounting_rpy) * c.filter.imu.C_bs;
    reading.C_imu_mag = settings::C_imu_mag(c);
    reading.gauges = c.instruments.gauges.file;
    reading.log = c.instruments.log.file;
    reading.compass = c.instruments.compass.file;
    return reading;
}

/// Sections whose file was found and not named.
std::set<std::string> found_files(const settings::Dataset& dataset) {
    std::set<std::string> sections;
    for (const Fact& fact : dataset.facts)
        if (fact.key.ends_with(".file") && !dataset.given.contains(fact.key))
            sections.insert(fact.key.substr(0, fact.key.find('.')));
    return sections;
}

/// A companion log that was found and cannot be read is as one that is not there, so that the dumped settings repeat the run.
void leave_out(const std::vector<std::string>& sections, LoadedDataset& out) {
    settings::Config& c = out.config;
    const std::map<std::string, dataset::FileSource*> sources = {
        {"baro", &c.baro}, {"mag", &c.mag}, {"odometer", &c.odometer}, {"heading", &c.heading}, {"reference", &c.reference}};
    for (const std::string& section : sections) {
        *sources.at(section) = {};
        std::erase_if(out.facts, [&](const Fact& fact) { return fact.key.starts_with(section + "."); });
    }
}

/// Applies the statements of the files.
void take_stated(const dataset::ReadFiles& files, settings::Config& c) {
    if (files.imu_kind) c.filter.imu.kind = *files.imu_kind;
    const bool sea_level = files.fix_height == io::HeightKind::Msl || files.fix_height == io::HeightKind::Autopilot;
    if (sea_level && c.filter.gnss.height == fusion::HeightKind::Ellipsoidal) c.filter.gnss.height = fusion::HeightKind::Msl;
}

/// The log from which a receiver's fixes come may contain its raw measurements too; empty: none that could.
std::string log_of_fixes(const fs::path& folder, const std::string& file) {
    if (file.empty()) return {};
    const fs::path log = io::stream_path(folder / file).file;  // "u.ubx#gnss" is a table of u.ubx
    std::error_code none;
    if (!fs::is_regular_file(log, none)) return {};
    const io::RawFormat format = io::raw_format(log);
    if (format != io::RawFormat::Ubx && format != io::RawFormat::Novatel) return {};
    return fs::path(file).parent_path().append(log.filename().string()).string();
}

/// Ranges from raw measurements. Those of the log of the fixes need not be named.
RangingLog read_raw_ranges(const fs::path& folder, LoadedDataset& out, WarningLog& warnings) {
    settings::Config& c = out.config;
    if (!c.raw.observations.empty()) return ranges_from_raw(folder, c, out.given, warnings);
    const std::string file = log_of_fixes(folder, c.gnss.file);
    if (file.empty()) return {};
    const settings::Config named = c;
    const WarningLog heard = warnings;
    c.raw.observations = {file};
    RangingLog log = ranges_from_raw(folder, c, out.given, warnings);
    if (log.empty()) {
        c = named;
        warnings = heard;
        return {};
    }
    Fact fact;
    fact.key = "gnss.observations";
    fact.value = settings::fact_value_of(*settings::config_table().find(fact.key)->get(c));
    fact.note = "the log of the fixes has raw measurements too";
    out.facts.push_back(std::move(fact));
    return log;
}

/// Ranges, and fixes from them if there are no others.
void read_ranges(const fs::path& folder, LoadedDataset& out, WarningLog& warnings) {
    settings::Config& c = out.config;
    const bool csv = !c.ranges.file.empty();
    if (!csv && c.scheme != settings::Scheme::Tight && c.scheme != settings::Scheme::Intermediate) return;
    RangingLog& log = out.recording.ranges;
    log = csv ? dataset::ranges_from_csv(folder, c, warnings) : read_raw_ranges(folder, out, warnings);
    const auto axis = dataset::own_axis(out.recording);
    if (!csv) take_ranges_to_base(out, warnings);
    if (!csv && !log.empty() && axis) {
        const Duration shift =
            Duration::from_seconds(c.gnss.time_offset) + -dataset::axis_zero(c.time, log.epochs.front().time, *axis);
        for (RangeEpoch& e : log.epochs) e.time = e.time + shift;
        log.to_gps = -shift;
    }
    if (out.recording.gnss.empty() && c.gnss.file.empty()) take_fixes_from_ranges(out);
    // On a real log nobody knows that every range is healthy.
    const bool monitored =
        !log.empty() && log.carriers.empty() && uses_ranges(c.filter.coupling) && !out.given.contains("filter.protection.use");
    if (monitored) c.filter.ranging.protection.use = true;
}

/// Converts heights above mean sea level to ellipsoidal ones if the undulation is known.
void settle_heights(LoadedDataset& out, WarningLog& warnings) {
    settings::Config& c = out.config;
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

/// Velocities that are not used show neither rest nor speed nor course, as if the log had none. A solution that is the fixes
/// themselves has them, unless they were found wrong.
void leave_out_velocities(LoadedDataset& out) {
    if (out.config.filter.gnss.use_velocity ||
        (out.config.scheme == settings::Scheme::Gnss && out.given.contains("gnss.use_velocity")))
        return;
    for (GnssFix& fix : out.recording.gnss) fix.velocity_n = fix.std_velocity = not_given3();
}

/// Requested output instants, in order.
void settle_events(LoadedDataset& out, const fs::path& folder) {
    settings::Config& c = out.config;
    if (!c.output.events.empty())
        out.events = io::read_events_csv(io::TextInput(dataset::resolved(folder, c.output.events, "output.events")));
    std::ranges::stable_sort(out.events, {}, &NamedInstant::time);
    c.filter.output_instants.clear();
    for (const NamedInstant& e : out.events) c.filter.output_instants.push_back(e.time);
}

Time absolute(const settings::RunTime& t, Time origin) {
    const Time base = t.absolute ? Time{} : origin;
    return base + Duration::from_seconds(t.seconds);
}

void settle_times(LoadedDataset& out) {
    const Recording& r = out.recording;
    if (r.imu.empty() && (out.config.scheme != settings::Scheme::Gnss || r.gnss.empty()))
        throw input_error("the IMU log has no usable row", {out.config.imu.file, 0, 0, {}},
                          "check its columns with `schuler inspect`");
    out.origin = r.gnss.empty() ? r.imu.front().time : r.gnss.front().time;
    fusion::Settings& f = out.config.filter;
    const settings::RunConfig& run = out.config.run;
    if (run.start) f.start = absolute(*run.start, out.origin);
    if (run.stop) f.stop = absolute(*run.stop, out.origin);
    if (f.start && f.stop && *f.stop <= *f.start) {
        throw input_error("the end of the run is not after its start", {{}, 0, 0, "run.stop_s"},
                          "give a later --stop or an earlier --start");
    }
    f.outages.clear();
    for (const settings::OutageSpan& o : run.outages) {
        const double start = o.absolute ? (Time::from_seconds(o.start) - out.origin).seconds() : o.start;
        f.outages.push_back({start, o.duration});
    }
    if (!std::isnan(out.config.initial_time)) f.initial.time = Time::from_seconds(out.config.initial_time);
}

/// Assumed errors of gauges, DVL and compass, for the instruments with samples.
void assume_instrument_errors(settings::Config& c) {
    const settings::InstrumentsConfig& instruments = c.instruments;
    c.filter.gauges.std = instruments.gauges.white;
    c.filter.gauges.level_std = instruments.gauges.bias;
    std::ranges::copy(instruments.gauges.lever_arms_b, c.filter.gauges.lever_arms_b.begin());
    c.filter.log = {.std = instruments.log.white,
                    .scale_std = instruments.log.scale,
                    .misalignment_std = instruments.log.misalignment,
                    .lever_arm_b = instruments.log.lever_arm_b};
    if (instruments.compass.file.empty()) return;
    c.filter.heading.std = instruments.compass.white;
    c.filter.heading.offset_std = instruments.compass.bias;
}

/// Near the poles the geographic frame is not usable: the Earth-fixed one is selected if none is given.
void choose_mechanization(LoadedDataset& data) {
    // there the geographic frame rotates too fast beneath a vehicle: tan(lat) v / R
    constexpr double polar_latitude = 85.0 * units::deg;
    const auto polar = [](const GnssFix& fix) { return std::abs(fix.position.lat) > polar_latitude; };
    if (data.given.contains("filter.mechanization") || std::ranges::none_of(data.recording.gnss, polar)) return;
    data.config.filter.mechanization = fusion::Mechanization::Ecef;
    Fact& fact = data.facts.emplace_back();
    fact.key = "filter.mechanization";
    fact.value = std::string("ecef");
    fact.note = "fixes within 5 deg of a pole";
}

/// An odometer in another unit or with a late clock would be refused as a whole, or spoil the outages in which it is needed.
void settle_odometer(LoadedDataset& out, WarningLog& warnings) {
    settings::Config& c = out.config;
    std::vector<OdometerSample>& log = out.recording.odometer;
    if (log.empty() || !c.filter.odometer.use) return;
    std::vector<GnssFix> fixes;
    std::ranges::copy_if(out.recording.gnss, std::back_inserter(fixes), [&](const GnssFix& fix) {
        const double t = (fix.time - out.origin).seconds();
        return std::ranges::none_of(c.filter.outages, [t](const fusion::Outage& o) { return o.withholds(t); });
    });
    const fusion::GnssSettings& gnss = c.filter.gnss;
    const auto found = dataset::compare_odometer(log, fixes, gnss.velocity_latency.value_or(gnss.latency));
    if (!found) return;
    const double excess = std::abs(1.0 / found->ratio - 1.0);
    if (const auto unit = dataset::unit_of_ratio(found->ratio)) {
        for (OdometerSample& s : log) s.speed *= unit->factor, s.std *= unit->factor;
        warnings.add("odometer.unit",
                     fmt::format("the odometer's speed_m_s is {:.3g} times the receiver's speed: it is taken for {}",
                                 1.0 / found->ratio, unit->name));
    } else if (excess > 3.0 * c.filter.odometer.scale_std) {
        const bool given = out.given.contains("odometer.scale_factor_ppm");
        if (!given) c.filter.odometer.scale_std = excess;
        warnings.add(
            "odometer.scale",
            fmt::format("the odometer's speed is {:.3f} times the receiver's, more than odometer.scale_factor_ppm allows; {}",
                        1.0 / found->ratio, given ? "the given value is used" : "it is raised to this"));
    }
    constexpr double least = 0.15, clear = 1.5;  // s; improvement
    if (std::abs(found->lag) < least || found->spread_as_stamped < clear * found->spread) return;
    const bool given = out.given.contains("odometer.time_offset_s");
    if (!given) {
        for (OdometerSample& s : log) s.time = s.time + Duration::from_seconds(-found->lag);
        c.odometer.time_offset -= found->lag;
    }
    warnings.add("odometer.clock",
                 fmt::format("the odometer's speeds come {:.2f} s {} than the receiver's; {}", std::abs(found->lag),
                             found->lag > 0.0 ? "later" : "earlier",
                             given ? "the given odometer.time_offset_s is used"
                                   : fmt::format("odometer.time_offset_s = {:.2f} is used", c.odometer.time_offset)));
}

}  // namespace

LoadedDataset settled_dataset(Recording recording, const settings::Config& config, WarningLog& warnings,
                              std::set<std::string> given) {
    LoadedDataset out;
    out.given = std::move(given);
    out.recording = std::move(recording);
    out.config = config;
    assume_instrument_errors(out.config);
    if (out.recording.gnss.empty() && !out.recording.ranges.empty()) take_fixes_from_ranges(out);
    dataset::settle_pressures(out.recording.baro, out.config.sea_level_pressure);
    settle_heights(out, warnings);
    settle_times(out);
    settle_events(out, {});
    return out;
}

/// Outages without any fix of the log's span to leave out.
void tell_idle_outages(const LoadedDataset& data, WarningLog& warnings) {
    if (data.recording.gnss.empty()) return;
    const double first = (data.recording.gnss.front().time - data.origin).seconds(),
                 last = (data.recording.gnss.back().time - data.origin).seconds();
    for (const auto& outage : data.config.filter.outages)
        if (outage.start > last || outage.start + outage.duration < first)
            warnings.add(
                "run.outages.idle",
                fmt::format("the outage of {:.6g} s at {:.6g} s has no effect: the fixes of the log are from {:.6g} to {:.6g} s",
                            outage.duration, outage.start, first, last));
}

LoadedDataset load_dataset(const settings::Dataset& dataset, const settings::Config& config, WarningLog& warnings) {
    const auto begin = std::chrono::steady_clock::now();
    LoadedDataset out;
    out.config = config;
    out.given = dataset.given;
    out.facts = dataset.facts;
    out.config.filter.gnss.latency_found = std::ranges::none_of(
        out.given, [](const std::string& key) { return key.starts_with("gnss.") && key.ends_with("latency_s"); });
    assume_instrument_errors(out.config);
    // The inertial unit shows the slips of single phases, which a solution by satellites alone may miss. With a base the phases are
    // measurements themselves. They are so exact that errors of second order in attitude and lever arm would tell the latter.
    if (out.config.scheme == settings::Scheme::Tight && !out.given.contains("gnss.phase_velocity"))
        out.config.raw.phase_velocity = out.config.base.observations.empty() && !out.config.filter.estimate_lever_arm;
    dataset::Reading reading = reading_of(out.config);
    reading.found = found_files(dataset);
    dataset::ReadFiles files = dataset::read_files(dataset.folder, out.config, reading, warnings);
    leave_out(files.left_out, out);
    take_stated(files, out.config);
    out.recording = std::move(files.recording);
    out.carrier = std::move(files.carrier);
    read_ranges(dataset.folder, out, warnings);
    dataset::settle_rollover(out.recording);
    dataset::put_clock_steps_back(out.recording, dataset.report.clock_steps);
    dataset::settle_drift(out.recording, out.config.clock_drift);
    dataset::settle_pressures(out.recording.baro, out.config.sea_level_pressure);
    settle_heights(out, warnings);
    leave_out_velocities(out);
    settle_times(out);
    settle_odometer(out, warnings);
    dataset::check_stated_sigmas(out.recording, warnings);
    tell_idle_outages(out, warnings);
    settle_events(out, dataset.folder);
    dataset::check_gravity_shows(out.recording.imu, out.config.filter.imu.kind, dataset.folder, out.config);
    choose_mechanization(out);
    for (const std::string& doubt : dataset.doubts) warnings.add(doubt, doubt);
    if (dataset.report.forward_supposed)
        warnings.add(
            "forward.supposed",
            "which way the unit points forward does not show in this log: the heading is that of its axes as they are taken; give imu.axes");
    for (const inspect::Contradiction& c : dataset.contradictions)
        warnings.add("contradiction." + c.key, fmt::format("the data contradict {}: {}; {}", c.key, c.text,
                                                           !c.refuted ? std::string("the given value is used")
                                                           : c.better ? fmt::format("{} is used", to_text(*c.better))
                                                                      : std::string("it is left out")));
    out.read_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return out;
}

}  // namespace schuler::solution
