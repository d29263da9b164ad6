// The trials of the BROAD benchmark spoilt on purpose: magnets, fields that change, axes in all orders and signs, calibration of
// magnetometers that are wrong, gaps in the log, biases of the gyro, clocks that differ. Directions at random from a seed.
//
//     bench_ahrs_spoilt [FOLDER] [SEED]
#include "ahrs_coverage.h"
#include "broad_trials.h"
#include "schuler/ahrs/run.h"
#include "schuler/app/attitude/ahrs.h"
#include "schuler/core/units.h"
#include "schuler/math/random.h"
#include "schuler/solution/loaded_dataset.h"

#include <fmt/format.h>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace schuler;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using schuler::bench::broad_trials;
using schuler::bench::BroadTrial;

struct Errors {
    double removed, raw;  // deg
    bool applied = false;
};

Errors errors_of(const solution::LoadedDataset& data, bool offline, bool calibrate) {
    WarningLog unheard;
    app::AhrsRequest request;
    request.offline = offline;
    request.calibrate = calibrate;
    const app::AhrsInput input = app::ahrs_input(data, request, unheard);
    const ahrs::RunResult result = ahrs::run(input.imu, input.mag, input.speed, input.settings);
    const auto e = analysis::broad_errors(app::attitude_pairs(result.rows, data.recording.reference));
    return {e.total / units::deg, e.raw_total / units::deg, std::ranges::any_of(input.calibration, [](const std::string& c) {
                return c.find(": applied:") != std::string::npos;
            })};
}

using Spoil = std::function<void(std::vector<MagSample>&, math::Random&)>;

solution::LoadedDataset spoilt(const BroadTrial& t, const Spoil& spoil, std::uint64_t seed) {
    solution::LoadedDataset data = t.data;
    math::Random random(seed, t.name.substr(0, 2));
    spoil(data.recording.mag, random);
    return data;
}

/// A field in the axes of the sensor for a share of the log.
Spoil magnet(double size, double from, double to) {
    return [=](std::vector<MagSample>& mag, math::Random& r) {
        const Vector3d field = size * r.normal3().normalized();
        for (std::size_t i = 0; i < mag.size(); ++i) {
            const double along = static_cast<double>(i) / static_cast<double>(mag.size());
            if (along >= from && along < to) mag[i].field_b += field;
        }
    };
}

Spoil distorted(double matrix, double iron) {
    return [=](std::vector<MagSample>& mag, math::Random& r) {
        Matrix3d M;
        for (int c = 0; c < 3; ++c) M.col(c) = matrix * r.normal3();
        const Matrix3d soft = Matrix3d::Identity() + 0.5 * (M + M.transpose());
        const Vector3d hard = iron * r.normal3().normalized();
        for (MagSample& s : mag) s.field_b = (soft * s.field_b + hard).eval();
    };
}

struct Case {
    const char* name;
    Spoil spoil;
};

void calibration_and_magnets(const std::vector<BroadTrial>& trials, std::uint64_t seed) {
    const std::vector<Case> cases{{"nothing", [](std::vector<MagSample>&, math::Random&) {}},
                                  {"magnet of 5 uT", magnet(5e-6, 0.0, 1.0)},
                                  {"magnet of 10 uT", magnet(10e-6, 0.0, 1.0)},
                                  {"magnet of 20 uT", magnet(20e-6, 0.0, 1.0)},
                                  {"magnet of 40 uT", magnet(40e-6, 0.0, 1.0)},
                                  {"magnet of 80 uT", magnet(80e-6, 0.0, 1.0)},
                                  {"magnet of 160 uT", magnet(160e-6, 0.0, 1.0)},
                                  {"10 uT, middle third", magnet(10e-6, 0.33, 0.67)},
                                  {"20 uT, middle third", magnet(20e-6, 0.33, 0.67)},
                                  {"70 uT, middle third", magnet(70e-6, 0.33, 0.67)},
                                  {"600 uT, middle third", magnet(600e-6, 0.33, 0.67)},
                                  {"gains off by 4 %", distorted(0.04, 0.0)},
                                  {"gains and 15 uT", distorted(0.05, 15e-6)}};
    fmt::print(
        "total error, deg RMS, mean over {} trials (largest); then with --calibrate: mean, trials in which it was applied, by how much it is "
        "worse in the worst\n{:<22}{:>54}{:>58}\n{:<22}{:>16}{:>16}  {:>18}{:>16}{:>16}  {:>18}\n",
        trials.size(), "", "online", "offline", "", "removed", "raw", "calibrated", "removed", "raw", "calibrated");
    for (const Case& c : cases) {
        fmt::print("{:<22}", c.name);
        for (const bool offline : {false, true}) {
            double removed = 0.0, raw = 0.0, largest = 0.0, largest_raw = 0.0, mended = 0.0, worse = 0.0;
            int applied = 0;
            for (const BroadTrial& t : trials) {
                const solution::LoadedDataset data = spoilt(t, c.spoil, seed);
                const Errors plain = errors_of(data, offline, false), calibrated = errors_of(data, offline, true);
                const double n = static_cast<double>(trials.size());
                removed += plain.removed / n;
                raw += plain.raw / n;
                mended += calibrated.removed / n;
                largest = std::max(largest, plain.removed);
                largest_raw = std::max(largest_raw, plain.raw);
                worse = std::max(worse, calibrated.removed - plain.removed);
                applied += calibrated.applied ? 1 : 0;
            }
            fmt::print("{:>16}{:>16}  {:>18}", fmt::format("{:.2f} ({:.2f})", removed, largest),
                       fmt::format("{:.2f} ({:.2f})", raw, largest_raw),
                       fmt::format("{:.2f}, {}, {:+.2f}", mended, applied, worse));
        }
        fmt::print("\n");
    }
}

using SpoilLog = std::function<void(Recording&, math::Random&)>;

/// Five gaps of a length (s), at random from 15 s on.
SpoilLog gaps(double length) {
    return [=](Recording& log, math::Random& r) {
        std::vector<ImuSample>& imu = log.imu;
        const double from = imu.front().time.seconds() + 15.0, span = imu.back().time.seconds() - 10.0 - from;
        std::array<double, 5> at{};
        for (double& a : at) a = from + span * r.uniform();
        std::erase_if(imu, [&](const ImuSample& s) {
            const double t = s.time.seconds();
            return std::ranges::any_of(at, [&](double a) { return t > a && t < a + length; });
        });
    };
}

/// A constant rate (rad/s) of random direction.
SpoilLog biased(double rate) {
    return [=](Recording& log, math::Random& r) {
        const Vector3d bias = rate * r.normal3().normalized();
        for (ImuSample& s : log.imu) s.gyro += bias;
    };
}

/// Times of the magnetometer that are too late (s).
SpoilLog late(double delay) {
    return [=](Recording& log, math::Random&) {
        for (MagSample& s : log.mag) s.time = s.time + Duration::from_seconds(delay);
    };
}

void gaps_biases_and_clocks(const std::vector<BroadTrial>& trials, std::uint64_t seed) {
    fmt::print(
        "\ngaps in the IMU log, biases of the gyro, times of the magnetometer: total error, deg RMS, mean (largest); headings beyond three sigma in movement, %, mean "
        "(largest)\n{:<22}{:>48}{:>48}\n{:<22}{:>16}{:>16}{:>16}{:>16}{:>16}{:>16}\n",
        "", "online", "offline", "", "removed", "raw", "beyond", "removed", "raw", "beyond");
    std::vector<std::pair<std::string, SpoilLog>> cases;
    for (const double length : {0.05, 0.1, 0.2, 0.3, 0.49, 0.6, 1.0})
        cases.emplace_back(fmt::format("5 gaps of {} s", length), gaps(length));
    for (const double rate : {2.5, 3.5, 5.0, 10.0, 20.0})
        cases.emplace_back(fmt::format("bias of {} deg/s", rate), biased(rate * units::deg_per_s));
    for (const double delay : {-0.4, -0.1, 0.02, 0.05, 0.1, 0.2, 0.4})
        cases.emplace_back(fmt::format("magnetometer {} s late", delay), late(delay));
    for (const auto& [name, spoil] : cases) {
        fmt::print("{:<22}", name);
        for (const bool offline : {false, true}) {
            std::array<double, 3> mean{}, largest{};
            for (const BroadTrial& t : trials) {
                solution::LoadedDataset data = t.data;
                math::Random random(seed, t.name.substr(0, 2));
                spoil(data.recording, random);
                WarningLog unheard;
                app::AhrsRequest request;
                request.offline = offline;
                const app::AhrsInput input = app::ahrs_input(data, request, unheard);
                const ahrs::RunResult result = ahrs::run(input.imu, input.mag, input.speed, input.settings);
                const auto e = analysis::broad_errors(app::attitude_pairs(result.rows, data.recording.reference));
                const bench::BeyondThreeSigma beyond = bench::beyond_three_sigma(result.rows, data.recording.reference);
                const std::array<double, 3> here{e.total / units::deg, e.raw_total / units::deg, beyond.percent(beyond.heading)};
                for (std::size_t i = 0; i < here.size(); ++i) {
                    mean[i] += here[i] / static_cast<double>(trials.size());
                    largest[i] = std::max(largest[i], here[i]);
                }
            }
            for (std::size_t i = 0; i < mean.size(); ++i)
                fmt::print("{:>16}", fmt::format("{:.2f} ({:.2f})", mean[i], largest[i]));
        }
        fmt::print("\n");
    }
}

void axes(const std::vector<BroadTrial>& trials) {
    fmt::print(
        "\naxes of the magnetometer in all orders and signs: recognised and undone, of 24 rotations and 24 mirrored ones\n");
    for (const BroadTrial& t : trials) {
        std::array<int, 2> undone{};
        WarningLog unheard;
        const app::AhrsInput straight = app::ahrs_input(t.data, {}, unheard);
        std::array<int, 3> order{0, 1, 2};
        do {
            for (int signs = 0; signs < 8; ++signs) {
                Matrix3d C = Matrix3d::Zero();
                for (int i = 0; i < 3; ++i) C(i, order[static_cast<std::size_t>(i)]) = (signs >> i & 1) != 0 ? -1.0 : 1.0;
                solution::LoadedDataset data = t.data;
                for (MagSample& s : data.recording.mag) s.field_b = (C * s.field_b).eval();
                WarningLog warnings;
                const app::AhrsInput input = app::ahrs_input(data, {}, warnings);
                double worst = 0.0;
                for (std::size_t i = 0; i < input.mag.size(); ++i)
                    worst = std::max(worst, (input.mag[i].field_b - straight.mag[i].field_b).norm());
                undone[C.determinant() > 0.0 ? 0 : 1] += worst < 1e-12 ? 1 : 0;
            }
        } while (std::next_permutation(order.begin(), order.end()));
        fmt::print("trial {}: {} and {}\n", t.name.substr(0, 2), undone[0], undone[1]);
    }
}

}  // namespace

int main(int argc, char** argv) {
    const char* named = std::getenv("SCHULER_DATA");
    const std::vector<BroadTrial> trials = broad_trials(argc > 1 ? argv[1] : named ? named : "../shared/data");
    if (trials.empty()) {
        fmt::print("no broad_* folders: name the folder that holds them\n");
        return 0;
    }
    const std::uint64_t seed = argc > 2 ? static_cast<std::uint64_t>(std::atoll(argv[2])) : 1;
    calibration_and_magnets(trials, seed);
    gaps_biases_and_clocks(trials, seed);
    axes(trials);
    return 0;
}
