// The request of a command that processes data or a scenario.
#pragma once

#include "schuler/settings/value.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace schuler::settings {

/// Common part of the requests of all commands that process data. `above` are the command line settings, which override all others.
struct ProcessRequest {
    std::filesystem::path input;   ///< data set or scenario
    std::filesystem::path output;  ///< folder; empty: out/NAME
    std::filesystem::path config;  ///< --config; empty: none
    SettingList above;
    std::optional<std::uint64_t> seed;  ///< of a scenario
    std::string version;
    std::function<void(double)> progress;  ///< may be empty
    std::function<void(std::string_view)>
        stage;  ///< called at the start of reading, simulating, filtering, checking, writing; may be empty

    void begin(std::string_view what) const {
        if (stage) stage(what);
    }

    /// All settings of the run: those of the data set, overridden by --config, then by `above`.
    [[nodiscard]] SettingList over(const SettingList& base) const;
    [[nodiscard]] std::filesystem::path folder_for(const std::string& name) const;

    /// True if one coupling is requested (`--scheme`, `filter.scheme` in --config): it then replaces a scenario's `[compare]`.
    [[nodiscard]] bool names_a_scheme() const;
};

}  // namespace schuler::settings
