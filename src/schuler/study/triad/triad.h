// The experiments of paper D (math.md 5.4): one run, and many over geometries and seeds.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/fusion/settings.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

/// Results in math.md 5.5 for a case: pooled errors from 300 s after the loss, metres, observed and predicted.
struct TriadReference {
    double pooled = 0, predicted = 0;  ///< horizontal
    double vertical = 0, predicted_vertical = 0;
    double end = 0;  ///< horizontal at 600 s, observed
    double nees3 = 0, nees9 = 0;
};

/// Transmitters in view after the warm-up, and the quality of the instruments.
struct TriadCase {
    std::string name;
    char key = 'a';              ///< of the arrangement, as in math.md 5.5; s: e from 300 s on, g: f and four stations
    std::size_t satellites = 4;  ///< 99: all in view
    std::size_t stations = 0;    ///< number of stations, the first of four
    double stations_on = 0.0;    ///< s after the loss
    bool tactical = false;       ///< otherwise navigation grade
    bool tcxo = false;           ///< otherwise OCXO
    bool baro = true;
    double baro_sigma = 30.0;                               ///< m
    double station_white = 10.0, station_correlated = 5.0;  ///< m, of each station
    double network = 10.0;                                  ///< m, common to all stations
    std::optional<TriadReference> reference;
    fusion::Mechanization mechanization = fusion::Mechanization::Geographic;
};

/// The cases of math.md 5.5, in the same order.
[[nodiscard]] std::vector<TriadCase> triad_cases();

/// All its arrangements with these instruments; `baro_sigma` 0: no barometer. With a reference if there is one in math.md.
[[nodiscard]] std::vector<TriadCase> triad_cases_with(bool tactical, bool tcxo, double baro_sigma);

inline constexpr std::size_t triad_geometries = 48;

inline constexpr std::size_t triad_epochs = 601;  ///< seconds after the loss, 0 to 600

/// One run: errors relative to truth and the filter's sigmas, for each second after the loss.
struct TriadRun {
    std::array<double, triad_epochs> horizontal, vertical;                      ///< m, of errors
    std::array<double, triad_epochs> predicted_horizontal, predicted_vertical;  ///< m, one sigma
    std::array<double, triad_epochs> nees3, nees9;                              ///< position; position, velocity, attitude
};

/// The flight of run `k` as ranges, inertial and barometer data, and the filter's assumptions. `seed` 0: noise seeded by k alone.
struct TriadFlight {
    Recording recording;
    fusion::Settings settings;
    Time origin;  ///< of the recording's times
};
[[nodiscard]] TriadFlight triad_flight(const TriadCase& which, std::size_t k, std::uint64_t seed, double duration = 780.0);

/// Run `k` of math.md 5.4: with its geometry, heading and noise. `seed` 0: noise seeded by k alone.
[[nodiscard]] TriadRun run_triad(const TriadCase& which, std::size_t k, std::uint64_t seed = 0);

/// Statistics over runs, by default every ten seconds from 300 s after the loss (math.md 5.5).
struct TriadStatistics {
    double median = 0, low = 0, high = 0;         ///< m, of the runs' root mean squares (2.5 and 97.5 %)
    double pooled = 0, predicted = 0;             ///< m, root mean square over runs and epochs, horizontal
    double vertical = 0, predicted_vertical = 0;  ///< m
    double two_sigma = 0;                         ///< m, median over runs of twice the root mean square of the 3-D error
    double end = 0, predicted_end = 0;            ///< m, horizontal at 600 s
    double at_300 = 0, at_330 = 0;                ///< m, horizontal at those seconds
    double nees3 = 0, nees9 = 0;                  ///< per degree of freedom
};
[[nodiscard]] TriadStatistics statistics_of(const std::vector<TriadRun>& runs);
[[nodiscard]] TriadStatistics statistics_of(const std::vector<const TriadRun*>& runs);

/// Standard error of the pooled horizontal error of one set of 48 runs, m, by bootstrap. Run j has geometry j mod 48: with several
/// runs of each geometry they are drawn from the same geometry, so that only noise contributes; otherwise geometries are drawn.
[[nodiscard]] double standard_error_of_a_set(const std::vector<TriadRun>& runs);

}  // namespace schuler::study
