// `schuler analyze requirements|budget|integrity|triad`: design studies.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/settings/scenario/scenario.h"
#include "schuler/settings/value.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

struct RequirementsRequest {
    double budget = 5.0;               ///< m
    std::vector<double> outages;       ///< s; empty: default values
    std::vector<std::string> devices;  ///< names; empty: all
};
/// Accelerometer and gyro errors permitted by a position budget over outages, and permissible outages of devices.
[[nodiscard]] report::Outcome analyze_requirements(const RequirementsRequest& request);

/// A study on a scenario.
struct StudyRequest {
    std::filesystem::path scenario;
    settings::SettingList above;  ///< of the command line
    std::optional<std::uint64_t> seed;
    std::size_t runs = 10;
    int jobs = 0;
    std::vector<std::string> kinds;  ///< integrity: kinds of faults
    std::vector<double> sizes;       ///< integrity: m or m/s
    double start = 0.0;              ///< integrity: s; 0: the middle of the scenario
    double duration = 100.0;         ///< integrity: s
    std::function<void(double)> progress;
};
/// Error budget: one source at a time is simulated, while the filter assumes all of them.
[[nodiscard]] report::Outcome analyze_budget(const StudyRequest& request);

/// The scenario without simulated errors.
[[nodiscard]] settings::ScenarioConfig without_errors(const settings::ScenarioConfig& full);

/// Detection, false alarms and time to alert for the receiver's faults.
[[nodiscard]] report::Outcome analyze_integrity(const StudyRequest& request);

/// The experiments of paper D over geometries and seeds. Run j uses geometry j mod 48 and the seed `seed` + j / 48.
struct TriadRequest {
    std::string cases;              ///< letters of arrangements; empty: all
    std::string grade, oscillator;  ///< navigation | tactical, ocxo | tcxo; empty with no baro: the cases of math.md 5.5
    std::optional<double> baro;     ///< m, sigma of the barometer's bias; 0: no barometer
    std::size_t runs = 48;
    std::uint64_t seed = 1;
    int jobs = 0;
    std::string mechanization = "geographic";
    std::filesystem::path output;  ///< folder of CSV files and a report; empty: none
    std::string version;
    std::function<void(double)> progress;
};
/// Pooled errors compared with those of math.md 5.5 with their standard errors, NEES, and the ratios stated in the paper. @throws Error,
/// Input with the option as key.
[[nodiscard]] report::Outcome analyze_triad(const TriadRequest& request);

}  // namespace schuler::study
