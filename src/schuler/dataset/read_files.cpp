#include "schuler/dataset/read_files.h"

#include "schuler/core/error.h"
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
#include "schuler/io/text/csv/csv_aids.h"

#include <cmath>
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

void read_imu(const fs::path& folder, const Description& d, const Reading& reading, io::LogFiles& logs, ReadFiles& out,
              WarningLog& warnings) {
    if (d.imu.file.empty() && !reading.imu) return;
    if (d.imu.file.empty()) {
        throw input_error("no IMU file", {{}, 0, 0, "imu.file"},
                          "name it in dataset.toml: [imu] file = \"imu.csv\", or choose --scheme gnss");
    }
    const io::TextInput input = logs.open(resolved(folder, d.imu.file, "imu.file"), warnings);
    if (is_bare_table(input, csv_options(d.imu, d, reading), 7)) {
        out.recording.imu = io::read_kfgins_imu(input, warnings, Duration::from_seconds(d.imu.time_offset)).samples;
        out.imu_kind = ImuKind::Increments;
        return;
    }
    io::ImuTable table = io::read_imu_csv(input, csv_options(d.imu, d, reading), warnings);
    out.recording.imu = std::move(table.samples);
    out.imu_kind = table.kind;
}

void read_gnss(const fs::path& folder, const Description& d, const Reading& reading, io::LogFiles& logs, ReadFiles& out,
               WarningLog& warnings) {
    const Duration offset = Duration::from_seconds(d.gnss.time_offset);
    if (!d.base.observations.empty() && d.gnss.file.empty()) {
        if (d.raw.observations.empty())
            throw input_error("a base station needs the rover's raw measurements", {{}, 0, 0, "base.observations"},
                              "name them: [gnss] observations = \"rover.obs\"");
        out.carrier = carrier_phase(folder, d, warnings);
        out.carrier.fixes = on_own_axis(std::move(out.carrier.fixes), d.time, out.recording, offset);
        out.recording.gnss = out.carrier.fixes;
        return;
    }
    if (d.gnss.file.empty() && !d.raw.observations.empty()) {
        out.recording.gnss = on_own_axis(fixes_from_raw(folder, d.raw, warnings), d.time, out.recording, offset);
        return;
    }
    if (d.gnss.file.empty()) return;
    const io::TextInput input = logs.open(resolved(folder, d.gnss.file, "gnss.file"), warnings);
    if (io::is_ubx(input)) {
        io::UbxLog log = io::read_ubx(input, warnings);
        if (log.fixes.empty())
            throw input_error("has no fix of the receiver itself (NAV-PVT)", {d.gnss.file, 0, 0, "gnss.file"},
                              "its raw measurements are used as [gnss] observations");
        out.recording.gnss = on_own_axis(std::move(log.fixes), d.time, out.recording, offset);
        return;
    }
    if (is_bare_table(input, csv_options(d.gnss, d, reading), 7) || is_bare_table(input, csv_options(d.gnss, d, reading), 13)) {
        out.recording.gnss = io::read_kfgins_gnss(input, warnings, offset).fixes;
        return;
    }
    if (io::is_rtklib_pos(input)) {
        io::RtklibPos pos = io::read_rtklib_pos(input, warnings);
        out.recording.gnss = on_own_axis(std::move(pos.fixes), d.time, out.recording, offset);
        out.fix_height = pos.height;
        return;
    }
    if (io::is_nmea(input)) {
        io::NmeaLog log = io::read_nmea(input, warnings);
        out.recording.gnss = log.has_date ? on_own_axis(std::move(log.fixes), d.time, out.recording, offset)
                                          : shifted(std::move(log.fixes), offset);
        out.fix_height = log.height;
        return;
    }
    io::GnssTable table = io::read_gnss_csv(input, csv_options(d.gnss, d, reading), warnings);
    // a stream from a dated log, beside logs that may be undated
    const bool dated = input.in_memory() && table.plan.find("time_s")->file_name == io::time_name(io::Clock::Gps);
    out.recording.gnss = dated ? on_own_axis(std::move(table.fixes), d.time, out.recording, {}) : std::move(table.fixes);
    out.fix_height = table.height;
}

void read_others(const fs::path& folder, const Description& d, const Reading& reading, io::LogFiles& logs, ReadFiles& out,
                 WarningLog& warnings) {
    if (!d.baro.file.empty()) {
        out.recording.baro = io::read_baro_csv(logs.open(resolved(folder, d.baro.file, "baro.file"), warnings),
                                               csv_options(d.baro, d, reading), warnings)
                                 .samples;
    }
    if (!d.mag.file.empty()) {
        out.recording.mag = io::read_mag_csv(logs.open(resolved(folder, d.mag.file, "mag.file"), warnings),
                                             csv_options(d.mag, d, reading), warnings)
                                .samples;
        if (reading.C_imu_mag)
            for (MagSample& m : out.recording.mag) m.field_b = *reading.C_imu_mag * m.field_b;
    }
    const auto moved = [](auto samples, const FileSource& source) {
        for (auto& sample : samples) sample.time = sample.time + Duration::from_seconds(source.time_offset);
        return samples;
    };
    if (!d.odometer.file.empty())
        out.recording.odometer =
            moved(io::read_odometer_csv(io::TextInput(resolved(folder, d.odometer.file, "odometer.file"))), d.odometer);
    if (!d.heading.file.empty())
        out.recording.heading =
            moved(io::read_compass_csv(io::TextInput(resolved(folder, d.heading.file, "heading.file"))), d.heading);
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
    if (!d.reference.file.empty()) {
        out.recording.reference = read_reference(logs.open(resolved(folder, d.reference.file, "reference.file"), warnings),
                                                 csv_options(d.reference, d, reading), warnings);
    }
}

}  // namespace

ReadFiles read_files(const fs::path& folder, const Description& d, const Reading& reading, WarningLog& warnings) {
    ReadFiles out;
    io::LogFiles logs;
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
