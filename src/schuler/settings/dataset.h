// Data sets: found by their path, described by settings.
#pragma once

#include "schuler/core/fact.h"
#include "schuler/dataset/recognise.h"
#include "schuler/settings/config/config.h"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace schuler::settings {

/// Result of opening a path: the settings that describe it, and the location of its files.
struct Dataset {
    std::string name;
    std::filesystem::path folder;                        ///< base of relative paths
    SettingList settings;                                ///< all layers: found, then the data set's own, then those of the caller
    std::set<std::string> given;                         ///< keys of the upper layers
    std::vector<Fact> facts;                             ///< the lowest layer: stated or shown by the files
    std::vector<inspect::Contradiction> contradictions;  ///< of given settings with the data
    inspect::InspectReport report;                       ///< recognised content of the files; empty for a KF-GINS project
    std::string inferred_toml;        ///< the dataset.toml that describes the inferred settings; empty if there is one
    std::vector<std::string> doubts;  ///< problems of the recognised files, and how they were interpreted
};

/// Opens a folder with dataset.toml, the path of a dataset.toml, a KF-GINS YAML file, or a folder or file whose content is
/// recognised, to the extent required by `needs`. Settings given neither by the data set nor by `above` (--config, --set) are
/// found from the files, in the same way for all except KF-GINS projects, which are complete.
/// @throws Error(Input) with the error and its remedy.
[[nodiscard]] Dataset open_dataset(const std::filesystem::path& path, dataset::Needs needs = dataset::Needs::ImuAndGnss,
                                   const SettingList& above = {});

}  // namespace schuler::settings
