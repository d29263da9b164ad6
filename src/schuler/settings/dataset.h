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

/// What a path turned out to be: the settings that describe it, and where its files are.
struct Dataset {
    std::string name;
    std::filesystem::path folder;  ///< relative paths start here
    SettingList settings;          ///< all layers: found, above them the data set's own, above those of the caller
    std::set<std::string> given;   ///< keys of the upper layers
    std::vector<Fact> facts;       ///< the lowest layer: what the files state or show
    std::vector<inspect::Contradiction> contradictions;  ///< of what is given by what the files show
    inspect::InspectReport report;                       ///< what the files were recognised as; empty of a KF-GINS project
    std::string inferred_toml;        ///< the dataset.toml that describes what was inferred; empty where there is one
    std::vector<std::string> doubts;  ///< what is wrong with the files that were recognised, and how it was taken
};

/// Opens a folder with dataset.toml, the path of a dataset.toml, a KF-GINS YAML file, or a folder or file whose content is
/// recognised, as far as `needs` asks. What neither the data set nor `above` (--config, --set) gives is found from the files, the same
/// for all of them but KF-GINS projects, which are complete.
/// @throws Error(Input) saying what is wrong and how to mend it.
[[nodiscard]] Dataset open_dataset(const std::filesystem::path& path, dataset::Needs needs = dataset::Needs::ImuAndGnss,
                                   const SettingList& above = {});

}  // namespace schuler::settings
