// Settings of a live run: those of the filter as in dataset.toml, where samples come from, where messages go.
#pragma once

#include "schuler/filter/navigator_settings.h"
#include "schuler/live/decoder.h"
#include "schuler/live/endpoint.h"
#include "schuler/live/output.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/option_table.h"

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace schuler::live {

struct SourceSettings {
    std::string from;      ///< an endpoint as written; empty: there is none
    std::string format;    ///< empty: csv; of gpsd:// its own
    bool arrival = false;  ///< times are those of arrival by this computer's clock, not the stamps
    double rate = 0.0;     ///< Hz, most of it; 0: the usual one
};

enum class MessageFormat { Json, Csv, Nmea };

struct OutputSettings {
    Endpoint to;
    MessageFormat format = MessageFormat::Json;
    double rate = 10.0;   ///< Hz; 0: at every sample of the IMU (of lagged rows: every one of the filter)
    bool lagged = false;  ///< the filter itself, the lag ago, rather than predicted to the newest sample
    bool events = true;   ///< of Json: events and health too
    OutputLimits limits;
};

struct LiveSettings {
    settings::Config config;
    std::array<SourceSettings, instrument_count> sources;  ///< by Instrument
    std::vector<OutputSettings> outputs;
    double imu_rate = 100.0;                                   ///< Hz, nominal
    double lag = 0.5, still_delay = 0.0, longest_hole = 10.0;  ///< s, NavigatorSettings
    std::string state;                 ///< file in which the filter's state is kept from run to run; empty: none
    double save_every = 60.0;          ///< s
    std::string log = "stderr";        ///< or a file, or "none": what happens, a line each
    double health_every = 1.0;         ///< s
    std::string file;                  ///< for messages
    std::vector<std::string> ignored;  ///< keys that were given and have no effect on a live run, each with the reason
};

/// The options beside those of dataset.toml.
[[nodiscard]] const settings::OptionTable<LiveSettings>& live_table();

/// @throws Error(Input) with file, line and key
[[nodiscard]] LiveSettings read_live(const std::filesystem::path& file, const settings::SettingList& above);

[[nodiscard]] filter::NavigatorSettings navigator_settings(const LiveSettings& live);

}  // namespace schuler::live
