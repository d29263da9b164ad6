// The trials of the BROAD benchmark, loaded as the program loads a folder that nobody described.
#pragma once

#include "schuler/dataset/recognise.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/dataset.h"
#include "schuler/solution/loaded_dataset.h"

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace schuler::bench {

struct BroadTrial {
    std::string name;  ///< what follows broad_, such as 01_undisturbed_slow_rotation_A
    solution::LoadedDataset data;
};

/// Every broad_* of the folder, by name; none where the folder is missing.
inline std::vector<BroadTrial> broad_trials(const std::filesystem::path& folder) {
    std::set<std::filesystem::path> found;
    std::error_code ec;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ec))
        if (entry.is_directory() && entry.path().filename().string().starts_with("broad_")) found.insert(entry.path());
    std::vector<BroadTrial> out;
    for (const std::filesystem::path& path : found) {
        WarningLog unheard;
        const settings::Dataset dataset = settings::open_dataset(path, dataset::Needs::Attitude);
        out.push_back({path.filename().string().substr(6),
                       solution::load_dataset(dataset, settings::config_from(dataset.settings), unheard)});
    }
    return out;
}

}  // namespace schuler::bench
