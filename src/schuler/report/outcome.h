// Result of a command for its interface.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::report {

/// Result of a command, to be displayed by its interface.
struct Outcome {
    std::string tables;  ///< readable text
    std::string json;    ///< one document
    std::vector<std::string> warnings;
    std::string notice;            ///< for standard error: the inferred dataset.toml
    std::string verdict;           ///< the last line: whether the solution may be trusted; empty if there is none
    bool usable = true;            ///< false: everything is written, but the exit status is that of a failed computation
    std::filesystem::path folder;  ///< location of the written files
    std::vector<std::filesystem::path> files;
};

}  // namespace schuler::report
