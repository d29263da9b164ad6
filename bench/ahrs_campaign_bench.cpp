// The attitude filters on simulated logs of many kinds (ahrs_logs.h): errors in both conventions, whether the published sigmas cover them,
// and whether the smoothed north is nearer than that of the real-time filter.
//
//     bench_ahrs_campaign [LOGS_OF_A_KIND] [FIRST_SEED]
#include "ahrs_coverage.h"
#include "ahrs_logs.h"

#include "schuler/ahrs/run.h"
#include "schuler/analysis/attitude_errors.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <string>
#include <utility>

namespace {

using namespace schuler;

struct Score {
    double removed = 0.0, raw = 0.0, inclination = 0.0, largest = 0.0, largest_raw = 0.0, heading_out = 0.0, tilt_out = 0.0;
    std::uint64_t worst = 0;
};

/// Returns what the log adds to the score that is compared in pairs.
struct North {
    double raw, offset;  ///< deg, offset without sign
};
North add(Score& s, const ahrs::RunResult& result, const ahrs_logs::Log& log, double share, std::uint64_t seed) {
    std::vector<analysis::AttitudePair> pairs;
    const std::size_t lost = log.truth.size() - result.rows.size();
    bench::BeyondThreeSigma beyond;
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        if (!log.moving[i + lost]) continue;
        pairs.push_back({result.rows[i].q_nb, log.truth[i + lost]});
        beyond.add(result.rows[i], log.truth[i + lost]);
    }
    const analysis::BroadErrors e = analysis::broad_errors(pairs);
    s.removed += share * e.total / units::deg;
    s.raw += share * e.raw_total / units::deg;
    s.inclination += share * e.inclination / units::deg;
    s.heading_out += share * beyond.percent(beyond.heading);
    s.tilt_out += share * beyond.percent(beyond.tilt);
    s.largest_raw = std::max(s.largest_raw, e.raw_total / units::deg);
    if (e.total / units::deg > s.largest) {
        s.largest = e.total / units::deg;
        s.worst = seed;
    }
    return {e.raw_total / units::deg, std::abs(e.heading_offset) / units::deg};
}

/// Mean of differences and its standard error.
struct Paired {
    double sum = 0.0, squares = 0.0, n = 0.0, smaller = 0.0;
    void add(double difference) {
        sum += difference;
        squares += difference * difference;
        n += 1.0;
        smaller += difference < 0.0 ? 1.0 : 0.0;
    }
    [[nodiscard]] double mean() const { return sum / n; }
    [[nodiscard]] double error() const { return std::sqrt(std::max(0.0, squares / n - mean() * mean()) / n); }
};

}  // namespace

int main(int argc, char** argv) {
    const int logs = argc > 1 ? std::atoi(argv[1]) : 20;
    const std::uint64_t first = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 1;
    const double share = 1.0 / logs;
    fmt::print(
        "{} logs of each kind from seed {}: mean total error, deg, offset removed and raw, inclination; largest removed (its seed), raw; "
        "% of epochs beyond 3 sigma, heading, tilt\n{:<22}{:>62}{:>62}\n",
        logs, first, "", "online", "offline");
    std::array<Score, 2> all{};
    std::array<double, 2> offsets{};
    Paired raw, offset;
    for (const auto& [kind, name] : ahrs_logs::kinds) {
        std::array<Score, 2> score{};
        for (int k = 0; k < logs; ++k) {
            const std::uint64_t seed = first + static_cast<std::uint64_t>(k);
            const ahrs_logs::Log log = ahrs_logs::simulated(kind, seed);
            std::array<North, 2> north{};
            for (const bool offline : {false, true}) {
                ahrs::RunSettings settings;
                settings.offline = offline;
                const std::size_t j = offline ? 1 : 0;
                north[j] = add(score[j], ahrs::run(log.imu, log.mag, {}, settings), log, share, seed);
                offsets[j] += share * north[j].offset / ahrs_logs::kinds.size();
            }
            raw.add(north[1].raw - north[0].raw);
            offset.add(north[1].offset - north[0].offset);
        }
        fmt::print("{:<22}", name);
        for (std::size_t j = 0; j < 2; ++j) {
            const Score& s = score[j];
            fmt::print("{:>10.2f}{:>6.2f}{:>6.2f}  {:>6.2f} ({:>3}){:>7.2f}{:>8.1f}{:>6.1f}", s.removed, s.raw, s.inclination,
                       s.largest, s.worst, s.largest_raw, s.heading_out, s.tilt_out);
            all[j].removed += s.removed / ahrs_logs::kinds.size();
            all[j].raw += s.raw / ahrs_logs::kinds.size();
        }
        fmt::print("\n");
    }
    fmt::print("{:<22}{:>10.2f}{:>6.2f}{:>55.2f}{:>6.2f}\n", "mean", all[0].removed, all[0].raw, all[1].removed, all[1].raw);
    fmt::print("constant part of the heading error, deg: {:.2f} online, {:.2f} offline\n", offsets[0], offsets[1]);
    for (const auto& [name, p] : {std::pair{"raw total error", &raw}, std::pair{"constant part", &offset}})
        fmt::print("{}, offline minus online, in pairs: {:+.3f} +- {:.3f} deg, smaller offline in {:.0f} of {:.0f} logs\n", name,
                   p->mean(), p->error(), p->smaller, p->n);
    return 0;
}
