#include "schuler/io/raw_input.h"

#include "schuler/core/error.h"
#include "schuler/io/receiver/novatel_raw.h"
#include "schuler/io/receiver/rtcm3.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/rinex/rinex.h"

#include <chrono>
#include <system_error>

namespace schuler::io {
namespace {

/// Modification time of a file, as GPS time.
Time last_written(const std::filesystem::path& file) {
    std::error_code ec;
    const auto written = std::filesystem::last_write_time(file, ec);
    const auto system = std::chrono::file_clock::to_sys(written).time_since_epoch();
    const std::int64_t seconds = std::chrono::duration_cast<std::chrono::seconds>(system).count() - unix_time_of_gps_epoch;
    return {(seconds + gps_minus_utc(seconds)) * 1'000'000'000};
}

}  // namespace

RawFormat raw_format(const std::filesystem::path& file) {
    const TextInput input(file);
    switch (rinex_kind(input)) {
        case RinexKind::Observation:
        case RinexKind::CompactObservation: return RawFormat::RinexObservations;
        case RinexKind::Navigation: return RawFormat::RinexNavigation;
        default: break;
    }
    return is_ubx(input)           ? RawFormat::Ubx
           : is_novatel_raw(input) ? RawFormat::Novatel
           : is_rtcm3(input)       ? RawFormat::Rtcm3
                                   : RawFormat::None;
}

RawInput read_raw_input(const std::filesystem::path& file, std::optional<Time> near, WarningLog& warnings) {
    if (std::error_code none; !std::filesystem::exists(file, none))
        throw input_error("does not exist", {file.string(), 0, 0, {}}, "check its name and folder");
    const TextInput input(file);
    switch (raw_format(file)) {
        case RawFormat::RinexObservations: return {read_rinex_observations(input, warnings).log, {}, {}};
        case RawFormat::RinexNavigation: return {{}, read_rinex_navigation(input, warnings).navigation, {}};
        case RawFormat::Ubx: {
            UbxLog log = read_ubx(input, warnings);
            return {std::move(log.observations), std::move(log.navigation), std::move(log.fixes)};
        }
        case RawFormat::Rtcm3: {
            Rtcm3Log log = read_rtcm3(input, near.value_or(last_written(file)), warnings);
            return {std::move(log.observations), std::move(log.navigation), {}};
        }
        case RawFormat::Novatel: {
            NovatelRaw raw = read_novatel_raw(input, warnings);
            return {std::move(raw.observations), std::move(raw.navigation), {}};
        }
        default: break;
    }
    throw input_error("is not a RINEX, UBX, RTCM 3 or NovAtel file", {file.string(), 0, 0, {}},
                      "choose a file of raw measurements or ephemerides");
}

}  // namespace schuler::io
