// Content of a file or folder of logs, its problems, and an initial dataset.toml, with confidence levels.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/inspect/given.h"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace schuler::inspect {

enum class Level { Info, Warning, Error };
[[nodiscard]] std::string_view name_of(Level level);  ///< "info", "warning", "error"

/// Information for the user about a file or the whole set. `hint` may be empty if no action is required.
struct Problem {
    Level level = Level::Info;
    std::string text;
    std::string hint;
};

/// One file. Times are the numbers of the file in s (GPS time since 1980 for RTKLIB and NMEA logs); NaN if there are none.
struct FileReport {
    std::string path;  ///< relative to the folder
    std::string kind;  ///< imu, gnss, baro, mag, reference, rtklib_pos, nmea, kfgins_yaml, kfgins_imu, kfgins_gnss,
        ///< kfgins_reference, dataset_toml, rinex_obs, rinex_nav, rinex, ubx, rtcm3, sp3, unknown
    std::vector<std::string> provides;  ///< of imu, fixes, ranges, ephemerides (broadcast), orbits (precise)
    std::vector<std::string> columns;   ///< as named in the file
    std::vector<std::string> contents;  ///< content of raw measurements and ephemerides, one line each
    std::size_t rows = 0;
    double rate_hz = 0.0;        ///< 1 / median step
    std::size_t gaps = 0;        ///< steps longer than 3 times the median
    std::size_t duplicates = 0;  ///< rows with the time of the previous row
    double start_s = 0.0, stop_s = 0.0;
    struct Hole {
        double start, length;  ///< the last sample before it, on the times of the file; s
    };
    std::vector<Hole> holes;              ///< the gaps, in order
    std::vector<std::string> understood;  ///< interpretation of each column, one line each
    bool chosen = false;                  ///< used in the generated dataset.toml
    std::string resembles;                ///< for an unknown file: the kind for which only few columns are missing
    std::vector<Problem> problems;
};

/// One fact found from the data.
struct Finding {
    std::string key;          ///< "imu.axes", "gnss.velocity_latency_s", ...: keys of dataset.toml if there is one
    std::string value;        ///< text, numbers with their unit and one sigma
    double confidence = 0.0;  ///< 0 (a guess) to 1 (certain)
    std::string why;          ///< the evidence in one sentence
};

/// A given setting contradicted by the data by more than three sigma.
struct Contradiction {
    std::string key;
    std::string text;                 ///< both values, in one sentence
    bool refuted = false;             ///< beyond doubt: the given value is not used
    std::optional<FactValue> better;  ///< value found from the data, used instead; if refuted without it: as if not given
    double sigma = not_given;         ///< of that value
};

/// A gap in one log that is a step of its clock: no sample is missing, the following ones are stamped too late.
struct ClockStep {
    bool imu = true;       ///< of the IMU log, else of the GNSS log
    double after = 0.0;    ///< s from the first sample of that log to the last one before the gap, earlier steps corrected
    double hole = 0.0;     ///< s between the samples around it
    double seconds = 0.0;  ///< amount by which the following samples are stamped too late
    std::string evidence;
};

/// Why a data set cannot be used as given.
struct Refusal {
    std::string file, key;  ///< relative to the folder; of dataset.toml
    std::string text, hint;
};

/// Plot data of a data set: standstill periods and track.
struct Motion {
    std::vector<std::pair<double, double>> still;  ///< from, to: on the times of the GNSS log, or of the IMU log if there is none
    std::vector<double> t, north, east, up;        ///< of the fixes from the first one, m; on their own times
    double imu_shift = 0.0;                        ///< s added to the times of the IMU log to convert them to that axis
};

struct InspectReport {
    std::string path;
    std::vector<FileReport> files;  ///< in order of their names
    std::vector<Finding> findings;
    std::vector<Problem> problems;  ///< of the set as a whole
    std::vector<Fact> facts;        ///< settings stated or shown by the files, except those given
    std::vector<Contradiction> contradictions;
    std::vector<std::string> doubts;     ///< data interpreted differently from the files' own description, with the evidence
    std::vector<ClockStep> clock_steps;  ///< in time order; corrected when the logs are loaded
    std::optional<Refusal> refusal;
    bool forward_supposed = false;  ///< the vehicle travels, but the orientation of the unit is not determined
    Motion motion;
    std::string dataset_toml;  ///< with comments, parsable; empty if nothing usable was found
};

/// Examines a folder of logs (its own files, not those of subfolders) or a single file. Never throws on unusual content:
/// unreadable data are reported as a problem of their file.
/// @throws Error(Input) if the path does not exist or the folder cannot be listed
[[nodiscard]] InspectReport inspect(const std::filesystem::path& path);

/// The same for a folder with given information: named files take their roles and are read as specified.
[[nodiscard]] InspectReport inspect(const std::filesystem::path& path, const Given& given);

/// The report as readable text: files, findings with confidence, problems with remedies, the dataset.toml.
[[nodiscard]] std::string describe(const InspectReport& report);

}  // namespace schuler::inspect
