// Warnings of many runs, each reported once.
#pragma once

#include "schuler/core/log.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace schuler::study {

/// One topic: the text of the first run that gave it, and the number of runs that did.
struct WarningOfRuns {
    std::uint64_t first_run = 0, seed = 0, runs = 0;
    std::string text;
};

/// By topic. The same for runs in any order, added one by one or merged in parts.
struct RunWarnings {
    std::map<std::string, WarningOfRuns> topics;

    void add(std::uint64_t run, std::uint64_t seed, const WarningLog& warnings);
    void merge(const RunWarnings& other);
    /// One line per topic, with the share of `runs` and the seed that the text is from.
    [[nodiscard]] std::vector<std::string> lines(std::uint64_t runs) const;
};

}  // namespace schuler::study
