#include "schuler/dataset/read_files.h"

#include "schuler/core/error.h"
#include "schuler/core/fact.h"
#include "schuler/dataset/paths.h"
#include "schuler/dataset/raw_gnss.h"
#include "schuler/dataset/time_axis.h"
#include "schuler/dataset/trajectory_file.h"
#include "schuler/earth/atmosphere.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/solution/kfgins.h"
#include "schuler/io/solution/rtklib_pos.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/csv/csv_instruments.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

namespace schuler::dataset {
namespace {

namespace fs = std::filesystem;

io::CsvOptions csv_options(const FileSource& source, const Description& d, const Reading& reading) {
    io::CsvOptions o;
    o.columns = source.columns;
    o.scale = source.scale;
    o.fix_codes = d.fix_codes;
    o.time_offset = Duration::from_seconds(source.time_offset);
    if (d.quaternion == Quaternion::SensorToEnu) o.quaternion = "sensor_to_enu";
    o.C_sb = reading.C_bs.transpose();
    return o;
}

/// The samples of a log and of its further parts, in order of time. Rows of a part that are not later than those before it repeat them.
template <class Read>
auto joined(const fs::path& folder, const FileSource& source, const std::string& section, io::LogFiles& logs,
            WarningLog& warnings, const Read& read) {
    using Samples = decltype(read(std::declval<const io::TextInput&>()));
    std::vector<std::pair<std::string, Samples>> parts;
    std::vector<std::string> files{source.file};
    files.insert(files.end(), source.parts.begin(), source.parts.end());
    for (std::size_t i = 0; i < files.size(); ++i)
        parts.emplace_back(files[i],
                           read(logs.open(resolved(folder, files[i], section + (i == 0 ? ".file" : ".parts")), warnings)));
    if (parts.size() == 1) return std::move(parts.front().second);
    std::erase_if(parts, [](const auto& part) { return part.second.empty(); });
    std::ranges::stable_sort(parts, {}, [](const auto& part) { return part.second.front().time; });
    Samples all;
    for (auto& [file, samples] : parts) {
        const auto later = [&](const auto& s) { return all.empty() || s.time > all.back().time; };
        const auto first = std::ranges::find_if(samples, later);
        const auto repeated = static_cast<std::size_t>(first - samples.begin());
        if (repeated > 0)
            warnings.add(file + " " + section + ".parts",
                         fmt::format("{}: rows that are in the part before it too: left out", file), repeated);
        all.insert(all.end(), std::make_move_iterator(first), std::make_move_iterator(samples.end()));
    }
    return all;
}

void read_imu(const fs::path& folder, const Description& d, const Reading& reading, io::LogFiles& logs, ReadFiles& out,
              WarningLog& warnings) {
    if (d.imu.file.empty() && !reading.imu) return;
    if (d.imu.file.empty()) {
        throw input_error("no IMU file", {{}, 0, 0, "imu.file"},
                          "name it in dataset.toml: [imu] file = \"imu.csv\", or choose --scheme gnss");
    }
    const io::CsvOptions options = csv_options(d.imu, d, reading);
    out.recording.imu = joined(folder, d.imu, "imu", logs, warnings, [&](const io::TextInput& input) {
        const bool bare = is_bare_table(input, options, 7);
        io::ImuTable table;
        if (!bare) table = io::read_imu_csv(input, options, warnings);
        const ImuKind kind = bare ? ImuKind::Increments : table.kind;
        if (out.imu_kind && *out.imu_kind != kind)
            throw input_error("has rates and the part before increments, or the reverse", {input.name(), 0, 0, "imu.parts"},
                              "give parts with the same columns");
        out.imu_kind = kind;
        return bare ? io::read_kfgins_imu(input, warnings, Duration::from_seconds(d.imu.time_offset)).samples
                    : std::move(table.samples);
    });
}

/// Fixes of one file; `dated`: in GPS time, to be moved to the axis of the other logs, and shifted by `offset`.
struct FixLog {
    std::vector<GnssFix> fixes;
    bool dated = false;
    Duration offset{};
    io::HeightKind height = io::HeightKind::Unstated;
};

FixLog read_fixes(const io::TextInput& input, const Description& d, const Reading& reading, WarningLog& warnings) {
    const Duration offset = Duration::from_seconds(d.gnss.time_offset);
    if (io::is_ubx(input)) {
        io::UbxLog log = io::read_ubx(input, warnings);
        if (log.fixes.empty())
            throw input_error("has no fix of the receiver itself (NAV-PVT)", {input.name(), 0, 0, "gnss.file"},
                              "its raw measurements are used as [gnss] observations");
        return {std::move(log.fixes), true, offset};
    }
    if (is_bare_table(input, csv_options(d.gnss, d, reading), 7) || is_bare_table(input, csv_options(d.gnss, d, reading), 13))
        return {io::read_kfgins_gnss(input, warnings, offset).fixes};
    if (io::is_rtklib_pos(input)) {
        io::RtklibPos pos = io::read_rtklib_pos(input, warnings);
        return {std::move(pos.fixes), true, offset, pos.height};
    }
    if (io::is_nmea(input)) {
        io::NmeaLog log = io::read_nmea(input, warnings);
        if (log.has_date) return {std::move(log.fixes), true, offset, log.height};
        return {shifted(std::move(log.fixes), offset), false, {}, log.height};
    }
    io::GnssTable table = io::read_gnss_csv(input, csv_options(d.gnss, d, reading), warnings);
    // a stream from a dated log, beside logs that may be undated
    const bool dated = input.in_memory() && table.plan.find("time_s")->file_name == io::time_name(io::Clock::Gps);
    return {std::move(table.fixes), dated, {}, table.height};
}

void read_gnss(const fs::path& folder, const Description& d, const Reading& reading, io::LogFiles& logs, ReadFiles& out,
               WarningLog& warnings) {
    const Duration offset = Duration::from_seconds(d.gnss.time_offset);
    if (!d.base.observations.empty() && d.gnss.file.empty()) {
        if (d.raw.observations.empty())
            throw input_error("a base station needs the rover's raw measurements", {{}, 0, 0, "base.observations"},
                              "name them: [gnss] observations = \"rover.obs\"");
        out.carrier = carrier_phase(folder, d, reading.ranges, warnings);
        out.carrier.fixes = on_own_axis(std::move(out.carrier.fixes), d.time, out.recording, offset);
        out.recording.gnss = out.carrier.fixes;
        return;
    }
    if (d.gnss.file.empty() && !d.raw.observations.empty()) {
        out.recording.gnss = on_own_axis(fixes_from_raw(folder, d.raw, warnings), d.time, out.recording, offset);
        return;
    }
    if (d.gnss.file.empty()) return;
    std::optional<FixLog> log;
    std::vector<GnssFix> fixes = joined(folder, d.gnss, "gnss", logs, warnings, [&](const io::TextInput& input) {
        FixLog part = read_fixes(input, d, reading, warnings);
        if (log && (part.dated != log->dated || part.height != log->height))
            throw input_error("has another time scale or another kind of heights than the part before",
                              {input.name(), 0, 0, "gnss.parts"}, "give parts of one log of one receiver");
        std::vector<GnssFix> its = std::move(part.fixes);
        log = std::move(part);
        return its;
    });
    out.recording.gnss = log->dated ? on_own_axis(std::move(fixes), d.time, out.recording, log->offset) : std::move(fixes);
    out.fix_height = log->height;
}

/// Reads a companion log. A file that nobody named must not stop the run: it is left out, and told.
template <class Read>
void read_companion(const char* section, const FileSource& source, const Reading& reading, ReadFiles& out, WarningLog& warnings,
                    const Read& read) {
    if (source.file.empty()) return;
    try {
        read();
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Input || !reading.found.contains(section)) throw;
        out.left_out.emplace_back(section);
        warnings.add(std::string(section) + ".left_out",
                     fmt::format("{} was found and is left out: {}; if it is to be used: [{}] file = {}", source.file, e.what(),
                                 section, toml_text(source.file)));
    }
}

void read_others(const fs::path& folder, const Description& d, const Reading& reading, io::LogFiles& logs, ReadFiles& out,
                 WarningLog& warnings) {
    const auto companion = [&](const char* section, const FileSource& source, const auto& read) {
        read_companion(section, source, reading, out, warnings, read);
    };
    companion("baro", d.baro, [&] {
        out.recording.baro = joined(folder, d.baro, "baro", logs, warnings, [&](const io::TextInput& input) {
            return io::read_baro_csv(input, csv_options(d.baro, d, reading), warnings).samples;
        });
    });
    companion("mag", d.mag, [&] {
        out.recording.mag = joined(folder, d.mag, "mag", logs, warnings, [&](const io::TextInput& input) {
            return io::read_mag_csv(input, csv_options(d.mag, d, reading), warnings).samples;
        });
        if (reading.C_imu_mag)
            for (MagSample& m : out.recording.mag) m.field_b = *reading.C_imu_mag * m.field_b;
    });
    const auto moved = [](auto samples, const FileSource& source) {
        for (auto& sample : samples) sample.time = sample.time + Duration::from_seconds(source.time_offset);
        return samples;
    };
    companion("odometer", d.odometer, [&] {
        out.recording.odometer =
            moved(io::read_odometer_csv(io::TextInput(resolved(folder, d.odometer.file, "odometer.file"))), d.odometer);
    });
    companion("heading", d.heading, [&] {
        out.recording.heading =
            moved(io::read_compass_csv(io::TextInput(resolved(folder, d.heading.file, "heading.file"))), d.heading);
    });
    if (!reading.gauges.empty())
        out.recording.gauges = io::read_gauges_csv(io::TextInput(resolved(folder, reading.gauges, "gauges.file")));
    if (!reading.log.empty())
        out.recording.body_velocity = io::read_dvl_csv(io::TextInput(resolved(folder, reading.log, "log.file")));
    if (!reading.compass.empty()) {
        if (!d.heading.file.empty())
            throw input_error("there are two headings, of [heading] and of [compass]", {{}, 0, 0, "compass.file"},
                              "leave out one of them");
        out.recording.heading = io::read_compass_csv(io::TextInput(resolved(folder, reading.compass, "compass.file")));
    }
    companion("reference", d.reference, [&] {
        out.recording.reference = read_reference(logs.open(resolved(folder, d.reference.file, "reference.file"), warnings),
                                                 csv_options(d.reference, d, reading), warnings);
    });
}

}  // namespace

ReadFiles read_files(const fs::path& folder, const Description& d, const Reading& reading, WarningLog& warnings) {
    ReadFiles out;
    io::LogFiles logs;
    for (const auto& [section, source] :
         {std::pair("imu", &d.imu), std::pair("gnss", &d.gnss), std::pair("baro", &d.baro), std::pair("mag", &d.mag)})
        if (source->file.empty() && !source->parts.empty())
            throw input_error("there are further parts of a log that is not named", {{}, 0, 0, fmt::format("{}.parts", section)},
                              fmt::format("name its first part: [{}] file = \"...\"", section));
    read_imu(folder, d, reading, logs, out, warnings);
    read_others(folder, d, reading, logs, out, warnings);
    read_gnss(folder, d, reading, logs, out, warnings);
    return out;
}

void settle_pressures(std::vector<BaroSample>& samples, double sea_level_pressure) {
    for (BaroSample& b : samples) {
        if (std::isfinite(b.height) || !std::isfinite(b.pressure)) continue;
        b.height = earth::geometric_from_geopotential(earth::geopotential_height_from_pressure(b.pressure, sea_level_pressure));
    }
}

}  // namespace schuler::dataset
