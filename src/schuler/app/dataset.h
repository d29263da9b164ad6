// Data sets: found by their path, described by settings, loaded into a recording.
#pragma once

#include "schuler/app/carrier_phase.h"
#include "schuler/app/config.h"
#include "schuler/core/aid_samples.h"
#include "schuler/core/fact.h"
#include "schuler/core/log.h"
#include "schuler/core/samples.h"
#include "schuler/dataset/recognise.h"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace schuler::app {

/// What a path turned out to be: the settings that describe it, and where its files are.
struct Dataset {
    std::string name;
    std::filesystem::path folder;        ///< relative paths start here
    SettingList settings;                ///< all layers: found, above them the data set's own, above those of the caller
    std::set<std::string> given;         ///< keys of the upper layers
    std::vector<Fact> facts;             ///< the lowest layer: what the files state or show
    std::vector<inspect::Contradiction> contradictions;  ///< of what is given by what the files show
    inspect::InspectReport report;       ///< what the files were recognised as; empty of a KF-GINS project
    std::string inferred_toml;           ///< the dataset.toml that would say what was inferred; empty where there is one
    std::vector<std::string> doubts;     ///< what is wrong with the files that were recognised, and how it was taken
};

using dataset::Needs;

/// Opens a folder with dataset.toml, the path of a dataset.toml, a KF-GINS YAML file, or a folder or file whose content is
/// recognised, as far as `needs` asks. What neither the data set nor `above` (--config, --set) says is found from the files, the same
/// for all of them but KF-GINS projects, which say everything.
/// @throws Error(Input) saying what is wrong and how to mend it.
[[nodiscard]] Dataset open_dataset(const std::filesystem::path& path, Needs needs = Needs::ImuAndGnss, const SettingList& above = {});

/// A recording with what loading it has told about the settings.
struct LoadedDataset {
    Recording recording;                 ///< times on the data set's own axis
    CarrierPhase carrier;                ///< whose fixes are those of the recording, where there is a base
    std::vector<NamedInstant> events;    ///< in order of time: those of filter.output_instants
    Config config;
    Time origin;                         ///< zero of the command line's times: first GNSS epoch, else first IMU epoch
    std::set<std::string> given;         ///< keys of the settings that a user or a scenario gave
    std::vector<Fact> facts;             ///< what the files state or show
    fusion::HeightKind logged_height = fusion::HeightKind::Ellipsoidal;  ///< before an undulation was added
    bool true_reference = false;         ///< the reference is simulated truth
    double read_seconds = 0.0;
};

/// Reads the files that the settings name and settles what depends on them (heights, start, stop, outages).
/// @throws Error(Input) with file, line, column or key.
[[nodiscard]] LoadedDataset load_dataset(const Dataset& dataset, const Config& config, WarningLog& warnings);

/// Settles times and axes of a recording that is in memory; `given`: keys of the settings that somebody gave.
[[nodiscard]] LoadedDataset settled_dataset(Recording recording, const Config& config, WarningLog& warnings,
                                            std::set<std::string> given = {});

/// $NAME and ${NAME} replaced by environment variables. @throws Error(Input) for one that is not set.
[[nodiscard]] std::string with_environment(const std::string& path, const std::string& key);

/// A file that the settings name under `key`, from the data set's folder on. @throws Error(Input) as with_environment().
[[nodiscard]] std::filesystem::path resolved(const std::filesystem::path& folder, const std::string& file, const std::string& key);

/// Throws Error(Input) with what inspection finds wrong with the IMU log, where it does find something and the settings do not
/// scale its columns already.
void blame_the_imu_log(const std::filesystem::path& folder, const Config& config);

/// Truth or another program's solution: CSV with names, solution.csv, or a table of ten columns without them (time, latitude,
/// longitude, height, velocity NED, roll, pitch, heading in degrees). @throws Error(Input).
[[nodiscard]] std::vector<ReferenceSample> read_reference(const std::filesystem::path& file, const FileSource& source,
                                                          const Config& config, WarningLog& warnings);

}  // namespace schuler::app
