// Output of `schuler --version`.
#pragma once

#include <string>
#include <string_view>

namespace schuler::cli {

/// Commit of the sources, "0123456789ab" or "0123456789ab, modified"; empty if unknown.
[[nodiscard]] std::string_view commit();

/// "schuler 0.1.0 (0123456789ab)"
[[nodiscard]] inline std::string version_line() {
    std::string line = "schuler " SCHULER_VERSION;
    if (!commit().empty()) line.append(" (").append(commit()).append(")");
    return line;
}

}  // namespace schuler::cli
