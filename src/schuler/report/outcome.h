// What a command hands to its door.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace schuler::report {

/// What a command has done, for its door to show.
struct Outcome {
    std::string tables;  ///< for people
    std::string json;    ///< one document
    std::vector<std::string> warnings;
    std::string notice;            ///< for standard error: the inferred dataset.toml
    std::string verdict;           ///< the last line: whether the solution may be trusted; empty where there is none
    bool usable = true;            ///< false: everything is written, and the exit status is that of a failed computation
    std::filesystem::path folder;  ///< what was written where
    std::vector<std::filesystem::path> files;
};

}  // namespace schuler::report
