// Conversion of a KF-GINS project to the settings of dataset.toml.
#pragma once

#include "schuler/io/solution/kfgins.h"
#include "schuler/settings/value.h"

#include <filesystem>

namespace schuler::settings {

/// The settings equivalent to the project: its files, noise model, initial state, lever arm and time span; the gravity series and
/// rotation rate of its program; the wheel constraint only if the log itself shows wheeled motion.
/// `file` is the YAML file; files under its folder are named relative to it.
[[nodiscard]] SettingList kfgins_settings(const io::KfGinsProject& project, const std::filesystem::path& file);

}  // namespace schuler::settings
