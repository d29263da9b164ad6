// The attitude filters on simulated logs of many kinds (ahrs_logs.h): errors in both conventions, and whether the published sigmas cover them.
//
//     bench_ahrs_campaign [LOGS_OF_A_KIND] [FIRST_SEED]
#include "ahrs_logs.h"

#include "schuler/ahrs/run.h"
#include "schuler/analysis/attitude_errors.h"

#include <fmt/format.h>

#include <cstdlib>
#include <string>

namespace {

using namespace schuler;

struct Score {
    double removed = 0.0, raw = 0.0, inclination = 0.0, largest = 0.0, largest_raw = 0.0, heading_out = 0.0, tilt_out = 0.0;
    std::uint64_t worst = 0;
};

void add(Score& s, const ahrs::RunResult& result, const ahrs_logs::Log& log, double share, std::uint64_t seed) {
    std::vector<analysis::AttitudePair> pairs;
    const std::size_t lost = log.truth.size() - result.rows.size();
    double heading_out = 0.0, tilt_out = 0.0;
    for (std::size_t i = 0; i < result.rows.size(); ++i) {
        if (!log.moving[i + lost]) continue;
        const ahrs::AttitudeRow& row = result.rows[i];
        pairs.push_back({row.q_nb, log.truth[i + lost]});
        const Eigen::Vector3d e = math::rotation_vector_from_quaternion(row.q_nb * log.truth[i + lost].conjugate());
        heading_out += std::abs(e.z()) > 3.0 * row.std_phi.z() ? 1.0 : 0.0;
        tilt_out += std::abs(e.x()) > 3.0 * row.std_phi.x() || std::abs(e.y()) > 3.0 * row.std_phi.y() ? 1.0 : 0.0;
    }
    const analysis::BroadErrors e = analysis::broad_errors(pairs);
    const double n = static_cast<double>(pairs.size());
    s.removed += share * e.total / units::deg;
    s.raw += share * e.raw_total / units::deg;
    s.inclination += share * e.inclination / units::deg;
    s.heading_out += share * 100.0 * heading_out / n;
    s.tilt_out += share * 100.0 * tilt_out / n;
    s.largest_raw = std::max(s.largest_raw, e.raw_total / units::deg);
    if (e.total / units::deg > s.largest) {
        s.largest = e.total / units::deg;
        s.worst = seed;
    }
}

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
    for (const auto& [kind, name] : ahrs_logs::kinds) {
        std::array<Score, 2> score{};
        for (int k = 0; k < logs; ++k) {
            const std::uint64_t seed = first + static_cast<std::uint64_t>(k);
            const ahrs_logs::Log log = ahrs_logs::simulated(kind, seed);
            for (const bool offline : {false, true}) {
                ahrs::RunSettings settings;
                settings.offline = offline;
                add(score[offline ? 1 : 0], ahrs::run(log.imu, log.mag, {}, settings), log, share, seed);
            }
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
    return 0;
}
