#include "schuler/app/raw_input.h"

#include "schuler/core/error.h"
#include "schuler/io/rinex.h"
#include "schuler/io/rtcm3.h"
#include "schuler/io/ubx.h"

#include <chrono>

namespace schuler::app {
namespace {

/// When a file was last written, as GPS time.
Time last_written(const std::filesystem::path& file) {
    std::error_code ec;
    const auto written = std::filesystem::last_write_time(file, ec);
    const auto system = std::chrono::file_clock::to_sys(written).time_since_epoch();
    const std::int64_t seconds = std::chrono::duration_cast<std::chrono::seconds>(system).count() - unix_time_of_gps_epoch;
    return {(seconds + gps_minus_utc(seconds)) * 1'000'000'000};
}

}  // namespace

RawInput read_raw_input(const std::filesystem::path& file, std::optional<Time> near, WarningLog& warnings) {
    const io::TextInput input(file);
    switch (io::rinex_kind(input)) {
        case io::RinexKind::Observation:
        case io::RinexKind::CompactObservation: return {io::read_rinex_observations(input, warnings).log, {}};
        case io::RinexKind::Navigation: return {{}, io::read_rinex_navigation(input, warnings).navigation};
        default: break;
    }
    if (io::is_ubx(input)) {
        io::UbxLog log = io::read_ubx(input, warnings);
        return {std::move(log.observations), std::move(log.navigation)};
    }
    if (io::is_rtcm3(input)) {
        io::Rtcm3Log log = io::read_rtcm3(input, near.value_or(last_written(file)), warnings);
        return {std::move(log.observations), std::move(log.navigation)};
    }
    throw input_error("is no RINEX, UBX or RTCM 3 file", {file.string(), 0, 0, {}},
                      "choose a file of raw measurements or ephemerides");
}

}  // namespace schuler::app
