// Raw measurements between formats.
#pragma once

#include "schuler/report/outcome.h"

#include <filesystem>
#include <optional>
#include <string>

namespace schuler::app {

/// Converts a UBX or RTCM 3 log or a RINEX file to RINEX observations ("rinex-obs") or navigation ("rinex-nav"); nothing where
/// `format` is neither and the name of `out` does not end as such files do (.obs, .rnx, .YYo; .nav, .YYn and the like).
/// @throws Error(Input): the input cannot be read or has nothing of the kind.
[[nodiscard]] std::optional<report::Outcome> convert_raw(const std::filesystem::path& in, const std::filesystem::path& out,
                                                         const std::string& format);

}  // namespace schuler::app
