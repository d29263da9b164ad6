// What is in a file or folder of logs, what is wrong with it, and the dataset.toml to start from, with how sure it is.
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

/// Something a user should know about a file or the whole set. `hint` may be empty where there is nothing to do.
struct Problem {
    Level level = Level::Info;
    std::string text;
    std::string hint;
};

/// One file. Times are the numbers of the file in s (GPS time since 1980 for RTKLIB and NMEA logs); NaN where there are none.
struct FileReport {
    std::string path;  ///< relative to the folder
    std::string kind;  ///< imu, gnss, baro, mag, reference, rtklib_pos, nmea, kfgins_yaml, kfgins_imu, kfgins_gnss,
        ///< kfgins_reference, dataset_toml, rinex_obs, rinex_nav, rinex, ubx, rtcm3, sp3, unknown
    std::vector<std::string> columns;   ///< as the file names them
    std::vector<std::string> contents;  ///< what raw measurements and ephemerides hold, a line each
    std::size_t rows = 0;
    double rate_hz = 0.0;        ///< 1 / median step
    std::size_t gaps = 0;        ///< steps longer than 3 times the median
    std::size_t duplicates = 0;  ///< rows with the time of the row before
    double start_s = 0.0, stop_s = 0.0;
    struct Hole {
        double start, length;  ///< the last sample before it, on the times of the file; s
    };
    std::vector<Hole> holes;              ///< the gaps, in order
    std::vector<std::string> understood;  ///< interpretation of each column, a line each
    bool chosen = false;                  ///< the generated dataset.toml uses it
    std::string resembles;                ///< of an unknown one: the kind of which it lacks few columns
    std::vector<Problem> problems;
};

/// One fact read from the data.
struct Finding {
    std::string key;          ///< "imu.axes", "gnss.velocity_latency_s", ...: keys of dataset.toml where there is one
    std::string value;        ///< text, numbers with their unit and one sigma
    double confidence = 0.0;  ///< 0 (a guess) to 1 (certain)
    std::string why;          ///< the evidence in one sentence
};

/// A given setting that the data speak against by more than three sigma.
struct Contradiction {
    std::string key;
    std::string text;                 ///< both values, in one sentence
    bool refuted = false;             ///< beyond doubt: the given value is not used
    std::optional<FactValue> better;  ///< what the data show and is used instead; refuted without it: as if nothing were given
    double sigma = not_given;         ///< of it
};

/// A hole of one log that is a step of its clock: no sample is missing, those after it are stamped too late.
struct ClockStep {
    bool imu = true;       ///< of the IMU log, else of the GNSS log
    double after = 0.0;    ///< s from the first sample of that log to the last one before the hole, earlier steps put back
    double hole = 0.0;     ///< s between the samples around it
    double seconds = 0.0;  ///< by which what comes after it is stamped too late
    std::string evidence;
};

/// Why a data set cannot be used as it is given.
struct Refusal {
    std::string file, key;  ///< relative to the folder; of dataset.toml
    std::string text, hint;
};

/// What is drawn of a data set: when it stood still, and where it went.
struct Motion {
    std::vector<std::pair<double, double>> still;  ///< from, to: on the times of the GNSS log, of the IMU log where there is none
    std::vector<double> t, north, east, up;        ///< of the fixes from the first one, m; on their own times
    double imu_shift = 0.0;                        ///< s that are added to the times of the IMU log to come to that axis
};

struct InspectReport {
    std::string path;
    std::vector<FileReport> files;  ///< in order of their names
    std::vector<Finding> findings;
    std::vector<Problem> problems;  ///< of the set as a whole
    std::vector<Fact> facts;        ///< the settings that the files state or show, those that are given left out
    std::vector<Contradiction> contradictions;
    std::vector<std::string> doubts;     ///< what was taken otherwise than the files say it, with the evidence
    std::vector<ClockStep> clock_steps;  ///< in order of time; who loads the logs puts them back
    std::optional<Refusal> refusal;
    bool forward_supposed = false;  ///< of a vehicle that travels: which way the unit points does not show
    Motion motion;
    std::string dataset_toml;  ///< commented, parsable; empty where nothing usable was found
};

/// Looks at a folder of logs (its own files, not those of subfolders) or at a single file. Never throws on odd content: what
/// cannot be read is reported as a problem of its file.
/// @throws Error(Input) where the path does not exist or the folder cannot be listed
[[nodiscard]] InspectReport inspect(const std::filesystem::path& path);

/// Likewise of a folder about which something is given: the files that are named take their roles and are read as said.
[[nodiscard]] InspectReport inspect(const std::filesystem::path& path, const Given& given);

/// The report for people: files, findings with how sure they are, problems with their mends, the dataset.toml.
[[nodiscard]] std::string describe(const InspectReport& report);

}  // namespace schuler::inspect
