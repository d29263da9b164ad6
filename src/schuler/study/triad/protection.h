// Faults injected into the ranges of the triad's flights, compared with alarms and protection levels of the tight filter.
#pragma once

#include "schuler/filter/ranging_settings.h"
#include "schuler/fusion/settings.h"
#include "schuler/report/outcome.h"

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

/// Kind of fault: in one satellite or in two, constant from an instant on or growing linearly from it.
struct FaultKind {
    bool twice = false, ramp = false;
};

/// One flight with a fault in one or two satellites' pseudoranges from a random instant on.
struct ProtectionTrial {
    std::array<double, 2> size{0.0, 0.0};   ///< m, for a ramp m/s; 0: no fault there
    std::array<int, 2> satellite{-1, -1};   ///< indices in the list of sources
    double start = 0.0;                     ///< s of the flight, of the fault
    bool alarm_before = false;              ///< without a fault: a false alarm
    bool alarm = false, right = false;      ///< from the fault on; at least one alarm identifies a faulty satellite
    double time_to_alarm = 0.0;             ///< s
    bool excluded = false;                  ///< the single-epoch test excluded ranges within 3 s of the fault
    std::array<int, 2> misleading{0, 0};    ///< epochs with an error above its level before any alarm: horizontal, vertical
    std::array<int, 2> late{0, 0};          ///< likewise after an alarm
    int epochs = 0, epochs_before = 0;      ///< evaluated with and without a fault
    std::array<double, 2> level{0.0, 0.0};  ///< m, root mean square of the levels after the fault, horizontal, vertical
    std::array<double, 2> worst{0.0, 0.0};  ///< largest ratio of error to level before any alarm
};

/// Trial j: geometry j mod 48 of paper D's scenario with all satellites in view (math.md 5.4), own noise, a fault of random sign and
/// of size uniform over 2 to 60 m (or two of them) after 90 to 110 s, followed for 40 s; for a ramp 0.1 to 5 m/s, log-uniform, 100 s.
[[nodiscard]] ProtectionTrial run_protection_trial(std::size_t j, std::uint64_t seed, FaultKind kind,
                                                   const fusion::ProtectionSettings& settings);

/// `analyze protection`.
struct ProtectionRequest {
    std::size_t runs = 1000;
    std::uint64_t seed = 1;
    FaultKind kind;
    int jobs = 0;
    fusion::ProtectionSettings settings;
    std::filesystem::path output;  ///< folder of trials.csv; empty: none
    std::function<void(double)> progress;
};
/// Missed detections and false alarms with 95 % bounds compared with the stated risk.
[[nodiscard]] report::Outcome analyze_protection(const ProtectionRequest& request);

}  // namespace schuler::study
