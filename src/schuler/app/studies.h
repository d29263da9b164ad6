// `schuler analyze requirements|budget|integrity`: what a designer asks.
#pragma once

#include "schuler/app/commands.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace schuler::app {

struct RequirementsRequest {
    double budget = 5.0;                          ///< m
    std::vector<double> outages;                  ///< s; empty: the usual ones
    std::vector<std::string> devices;             ///< names; empty: all
};
/// Accelerometer and gyro errors that a position budget allows over outages, and outages that devices allow.
[[nodiscard]] Outcome analyze_requirements(const RequirementsRequest& request);

/// A study on a scenario.
struct StudyRequest {
    std::filesystem::path scenario;
    SettingList above;                            ///< of the command line
    std::optional<std::uint64_t> seed;
    std::size_t runs = 10;
    int jobs = 0;
    std::vector<std::string> kinds;               ///< integrity: of faults
    std::vector<double> sizes;                    ///< integrity: m or m/s
    double start = 0.0;                           ///< integrity: s; 0: half of the scenario
    double duration = 100.0;                      ///< integrity: s
    std::function<void(double)> progress;
};
/// Errors by source: one source at a time is simulated, the filter goes on believing in all of them.
[[nodiscard]] Outcome analyze_budget(const StudyRequest& request);

/// Detection, false alarms and time to alert of the receiver's faults.
[[nodiscard]] Outcome analyze_integrity(const StudyRequest& request);

}  // namespace schuler::app
