// `schuler receiver`: generation and tracking of intermediate-frequency recordings.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/receiver/sample_receiver.h"
#include "schuler/report/outcome.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace schuler::app {

/// `receiver generate`.
struct GenerateRequest {
    std::filesystem::path file;
    double seconds = 5.0;
    double sample_rate = 4e6;             ///< complex samples/s
    double intermediate_frequency = 0.0;  ///< Hz
    std::vector<std::string> satellites;  ///< "G07:45:1200:300.5": number, C/N0 in dB-Hz, Doppler in Hz, code delay in chips; the
        ///< trailing values may be omitted; empty: six satellites
    std::uint64_t seed = 1;
    std::function<void(double)> progress;  ///< may be empty
};

/// Writes signals of GPS L1 C/A in white noise as signed bytes, interleaved I and Q. @throws Error(Input) with the option as key
[[nodiscard]] report::Outcome generate_recording(const GenerateRequest& request);

/// `receiver track`.
struct TrackRequest {
    std::filesystem::path file;
    std::string format = "ibyte";
    double sample_rate = not_given;  ///< complex samples/s
    double intermediate_frequency = 0.0;
    double start = 0.0;                   ///< s of the recording, whole milliseconds
    std::optional<double> seconds;        ///< from `start` on; empty: to the end
    std::vector<std::string> satellites;  ///< "G07"; empty: all
    double doppler = 5000.0;              ///< Hz, half width of the search
    int search_ms = 10;                   ///< code periods summed in a search
    std::filesystem::path output;         ///< folder; empty: out/NAME
    std::string version;
    std::function<void(double)> progress;
};

/// Searches and tracks; tracking.csv, summary.json and report.html. The file is read in blocks.
/// @throws Error: Input with file and option, Computation if no satellite is found
[[nodiscard]] report::Outcome track_recording(const TrackRequest& request);

/// "G07", "g7" or "7" as 7. @throws Error(Input) for another name, with --satellites as key
[[nodiscard]] int gps_number(std::string_view name);

/// Results of a run of `receiver track`, in addition to its files.
struct TrackedRecording {
    std::string title;  ///< one line: file, span, rates
    double seconds = 0.0;
    int search_periods = 0;
    std::vector<receiver::SatelliteRecord> satellites;
    std::vector<receiver::ChannelSample> decimated;  ///< of all channels, each in time order; times of the recording
};

[[nodiscard]] std::string tracking_table(const TrackedRecording& run);
void write_tracking_report(report::Outcome& out, const TrackedRecording& run, const std::string& version);

/// "locked", "locking", "pull-in", "code" or "lost".
[[nodiscard]] std::string name_of(receiver::TrackState state, bool locked);

}  // namespace schuler::app
