// Conversion of raw measurements between formats.
#pragma once

#include "schuler/report/outcome.h"

#include <filesystem>
#include <optional>
#include <string>

namespace schuler::app {

/// Converts a UBX or RTCM 3 log or a RINEX file to RINEX observations ("rinex-obs") or navigation ("rinex-nav"); no result if
/// `format` is neither and the name of `out` does not have such an ending (.obs, .rnx, .YYo; .nav, .YYn and the like). @throws
/// Error(Input): the input cannot be read or contains no such data.
[[nodiscard]] std::optional<report::Outcome> convert_raw(const std::filesystem::path& in, const std::filesystem::path& out,
                                                         const std::string& format);

}  // namespace schuler::app
