// Settings of a live run: those of the filter as in dataset.toml, sources of samples, destinations of messages.
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
    std::string from;      ///< an endpoint as given; empty: none
    std::string format;    ///< empty: csv, or for gpsd:// its own
    bool arrival = false;  ///< use the arrival times by this computer's clock, not the stamps
    double rate = 0.0;     ///< Hz, upper limit; 0: the usual one
};

enum class MessageFormat { Json, Csv, Nmea, Mcap, Shared };

struct OutputSettings {
    Endpoint to;
    MessageFormat format = MessageFormat::Json;
    double rate = 10.0;   ///< Hz; 0: at every IMU sample (for lagged rows: every filter row)
    bool lagged = false;  ///< output the filter state itself, delayed by the lag, instead of the prediction to the newest sample
    bool events = true;   ///< for Json: also events and health
    OutputLimits limits;
};

struct LiveSettings {
    settings::Config config;
    std::array<SourceSettings, instrument_count> sources;  ///< by Instrument
    std::vector<OutputSettings> outputs;
    double imu_rate = 100.0;                                   ///< Hz, nominal
    int gauges = 1;                                            ///< number of heights in a sample of the gauges, at most 3
    double lag = 0.5, still_delay = 0.0, longest_hole = 10.0;  ///< s, NavigatorSettings
    std::string state;                 ///< file that preserves the filter's state between runs; empty: none
    double save_every = 60.0;          ///< s
    std::string log = "stderr";        ///< or a file, or "none": events, one line each
    double health_every = 1.0;         ///< s
    std::string file;                  ///< for messages
    std::vector<std::string> ignored;  ///< keys that were given but have no effect on a live run, each with the reason
};

/// The options in addition to those of dataset.toml.
[[nodiscard]] const settings::OptionTable<LiveSettings>& live_table();

/// @throws Error(Input) with file, line and key
[[nodiscard]] LiveSettings read_live(const std::filesystem::path& file, const settings::SettingList& above);

[[nodiscard]] filter::NavigatorSettings navigator_settings(const LiveSettings& live);

}  // namespace schuler::live
