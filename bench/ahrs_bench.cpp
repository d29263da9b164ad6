// All attitude filters over all trials of the BROAD benchmark that are there, and how fast the real-time filter is.
//
// Both of BROAD's conventions: with the constant heading offset removed, and raw.
//
//     bench_ahrs [FOLDER]     FOLDER holds broad_* data sets; default $SCHULER_DATA, then ../shared/data
//
// VQF's figures are those of its authors' program with its default settings on the full-rate files [LaidigSeel2023].
#include "ahrs_coverage.h"
#include "broad_trials.h"
#include "schuler/ahrs/mekf.h"
#include "schuler/app/attitude/ahrs.h"
#include "schuler/core/units.h"
#include "schuler/math/rotation.h"
#include "schuler/solution/loaded_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <map>
#include <utility>
#include <vector>

namespace {

using namespace schuler;
using schuler::bench::broad_trials;
using schuler::bench::BroadTrial;

struct Variant {
    const char* title;
    const char* filter;
    bool six_axis, offline;
};
constexpr std::array variants{Variant{"mekf", "mekf", false, false},
                              Variant{"mekf offline", "mekf", false, true},
                              Variant{"six-axis", "mekf", true, false},
                              Variant{"dcm", "dcm", false, false},
                              Variant{"quaternion", "quaternion", false, false},
                              Variant{"printed", "quaternion-printed", false, false},
                              Variant{"coupled", "quaternion-coupled", false, false}};

/// VQF, nine axes: total, deg, online and offline with the heading offset removed, then raw.
// clang-format off
const std::map<std::string, std::array<double, 4>> vqf{
    {"01", {1.17, 0.85, 1.99, 3.37}}, {"02", {0.83, 0.44, 1.38, 1.01}}, {"04", {1.05, 0.72, 1.07, 1.85}}, {"07", {1.75, 1.61, 1.75, 1.71}},
    {"08", {2.67, 1.63, 3.34, 2.27}}, {"10", {0.70, 0.44, 1.80, 2.09}}, {"11", {0.67, 0.47, 0.90, 0.61}}, {"18", {0.80, 0.65, 0.81, 0.68}},
    {"24", {1.23, 0.88, 1.55, 1.16}}, {"25", {0.79, 0.49, 1.62, 1.24}}, {"29", {2.23, 1.38, 2.38, 1.81}}, {"31", {2.26, 1.72, 3.21, 3.98}},
    {"35", {1.08, 1.41, 1.09, 1.41}}, {"36", {2.03, 1.32, 2.39, 3.26}}};
// clang-format on

using Row = std::vector<double>;

void print(const char* name, const std::vector<std::array<double, 3>>& errors, const Row& beside) {
    fmt::print("{:<32.32}", name);
    for (const auto& e : errors) fmt::print("{:>19}", fmt::format("{:.2f} ({:.2f}/{:.2f})", e[0], e[1], e[2]));
    fmt::print("{:>8}", "");
    for (const double v : beside) fmt::print("{:6.2f}", v);
    fmt::print("\n");
}

/// What the raw errors are mostly made of: the direction of the field where the sensor moves, against the north of the reference.
void offsets(const std::vector<BroadTrial>& trials, const std::vector<std::vector<analysis::BroadErrors>>& all) {
    fmt::print(
        "constant heading offset, deg, online and offline; and the direction of the field turned by the reference's attitude: "
        "where the sensor rests, where it moves\n");
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const auto& recording = trials[i].data.recording;
        WarningLog unheard;
        const app::AhrsInput input = app::ahrs_input(trials[i].data, {}, unheard);
        Eigen::Vector3d rest = Eigen::Vector3d::Zero(), moving = Eigen::Vector3d::Zero();
        std::size_t k = 0;
        for (const MagSample& m : input.mag) {
            while (k + 1 < recording.reference.size() && recording.reference[k + 1].time <= m.time) ++k;
            const ReferenceSample& r = recording.reference[k];
            if (!r.rpy.allFinite() || std::abs((r.time - m.time).seconds()) > 0.02) continue;
            (r.movement ? moving : rest) += math::quaternion_from_rpy(r.rpy) * m.field_b;
        }
        const auto direction = [](const Eigen::Vector3d& f) { return -std::atan2(f.y(), f.x()) / units::deg; };
        fmt::print("{:<32.32}{:>8.2f}{:>8.2f}{:>14.2f}{:>8.2f}\n", trials[i].name, all[i][0].heading_offset / units::deg,
                   all[i][1].heading_offset / units::deg, direction(rest), direction(moving));
    }
    fmt::print("\n");
}

void coverage(const std::vector<BroadTrial>& trials, const std::vector<std::array<bench::BeyondThreeSigma, 2>>& beyond) {
    fmt::print("beyond three sigma in movement, %, online and offline: tilt; heading (raw: the field is taken for north)\n");
    for (std::size_t i = 0; i < trials.size(); ++i) {
        const auto& [online, offline] = beyond[i];
        fmt::print("{:<32.32}{:>8.1f}{:>8.1f}{:>14.1f}{:>8.1f}\n", trials[i].name, online.percent(online.tilt),
                   offline.percent(offline.tilt), online.percent(online.heading), offline.percent(offline.heading));
    }
    fmt::print("\n");
}

void accuracy(const std::vector<BroadTrial>& trials) {
    std::vector<std::vector<analysis::BroadErrors>> all;
    std::vector<std::array<bench::BeyondThreeSigma, 2>> beyond;
    for (const BroadTrial& t : trials) {
        all.emplace_back();
        beyond.emplace_back();
        for (std::size_t k = 0; k < variants.size(); ++k) {
            const Variant& v = variants[k];
            WarningLog unheard;
            app::AhrsRequest request;
            request.filter = v.filter;
            request.six_axis = v.six_axis;
            request.offline = v.offline;
            const app::AhrsInput input = app::ahrs_input(t.data, request, unheard);
            const ahrs::RunResult result = ahrs::run(input.imu, input.mag, input.speed, input.settings);
            all.back().push_back(analysis::broad_errors(app::attitude_pairs(result.rows, t.data.recording.reference)));
            if (k < 2) beyond.back()[k] = bench::beyond_three_sigma(result.rows, t.data.recording.reference);
        }
    }
    for (const bool raw : {false, true}) {
        fmt::print("total (heading/inclination) error, deg RMS in movement, {}\n\n{:<32}",
                   raw ? "raw: nothing removed" : "constant heading offset removed", "trial");
        for (const Variant& v : variants) fmt::print("{:>19}", v.title);
        fmt::print("   VQF online, offline\n");
        std::vector<std::array<double, 3>> mean(variants.size(), std::array<double, 3>{});
        Row vqf_mean(2, 0.0);
        std::size_t with_vqf = 0;
        for (std::size_t i = 0; i < trials.size(); ++i) {
            std::vector<std::array<double, 3>> errors;
            for (std::size_t k = 0; k < variants.size(); ++k) {
                const analysis::BroadErrors& e = all[i][k];
                errors.push_back({(raw ? e.raw_total : e.total) / units::deg, (raw ? e.raw_heading : e.heading) / units::deg,
                                  e.inclination / units::deg});
                for (std::size_t j = 0; j < 3; ++j) mean[k][j] += errors.back()[j] / static_cast<double>(trials.size());
            }
            Row beside;
            if (const auto known = vqf.find(trials[i].name.substr(0, 2)); known != vqf.end()) {
                ++with_vqf;
                for (std::size_t j = 0; j < 2; ++j) {
                    beside.push_back(known->second[j + (raw ? 2 : 0)]);
                    vqf_mean[j] += beside.back();
                }
            }
            print(trials[i].name.c_str(), errors, beside);
        }
        for (double& v : vqf_mean) v /= static_cast<double>(std::max<std::size_t>(1, with_vqf));
        print("mean", mean, vqf_mean);
        fmt::print("\n");
    }
    offsets(trials, all);
    coverage(trials, beyond);
}

/// Samples a second of the full filter, magnetometer included, the attitude read at every sample: median and best of several
/// runs, by the processor's time, so that what else the machine does counts little.
void speed(const BroadTrial& trial) {
    WarningLog unheard;
    const app::AhrsInput input = app::ahrs_input(trial.data, {}, unheard);
    double sink = 0.0;
    constexpr std::size_t runs = 31;
    const auto rates_of = [&](const auto& filtered) {
        std::vector<double> rates;
        for (std::size_t run = 0; run < runs; ++run) {
            const std::clock_t begin = std::clock();
            filtered();
            const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
            rates.push_back(static_cast<double>(input.imu.size()) / seconds * 1e-6);
        }
        std::ranges::sort(rates);
        return rates;
    };
    const auto online = rates_of([&] {
        ahrs::Mekf filter(input.settings.mekf);
        std::size_t m = 0;
        for (std::size_t i = 1; i < input.imu.size(); ++i) {
            filter.step((input.imu[i].time - input.imu[i - 1].time).seconds(), input.imu[i].gyro, input.imu[i].accel);
            for (; m < input.mag.size() && input.mag[m].time <= input.imu[i].time; ++m) filter.magnetometer(input.mag[m].field_b);
            sink += filter.q_nb().w();
        }
    });
    ahrs::RunSettings both_ways = input.settings;
    both_ways.offline = true;
    const auto offline = rates_of([&] { sink += ahrs::run(input.imu, input.mag, input.speed, both_ways).rows.back().q_nb.w(); });
    for (const auto& [name, rates] : {std::pair{"mekf", &online}, std::pair{"mekf offline", &offline}})
        fmt::print("{}: {:.2f} million samples/s on one core (median of {}, best {:.2f})\n", name, (*rates)[runs / 2], runs,
                   rates->back());
    fmt::print("checksum {:.6g}\n", sink / runs);
}

}  // namespace

int main(int argc, char** argv) {
    const char* named = std::getenv("SCHULER_DATA");
    const std::vector<BroadTrial> trials = broad_trials(argc > 1 ? argv[1] : named ? named : "../shared/data");
    if (trials.empty()) {
        fmt::print("no broad_* folders: name the folder that holds them\n");
        return 0;
    }
    accuracy(trials);
    speed(trials.front());
    return 0;
}
