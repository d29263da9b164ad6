// All attitude filters over all trials of the BROAD benchmark that are there, and how fast the real-time filter is.
//
//     bench_ahrs [FOLDER]     FOLDER holds broad_* data sets; default $SCHULER_DATA, then ../shared/data
//
// VQF's figures are those of its authors' program with its default settings on the full-rate files [LaidigSeel2023].
#include "schuler/ahrs/mekf.h"
#include "schuler/app/ahrs.h"
#include "schuler/core/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <map>
#include <set>

namespace {

using namespace schuler;
namespace fs = std::filesystem;

struct Variant {
    const char* title;
    const char* filter;
    bool six_axis, offline;
};
constexpr std::array variants{Variant{"mekf", "mekf", false, false},
                              Variant{"mekf offline", "mekf", false, true},
                              Variant{"mekf six-axis", "mekf", true, false},
                              Variant{"dcm", "dcm", false, false},
                              Variant{"quaternion", "quaternion", false, false},
                              Variant{"coupled", "quaternion-coupled", false, false}};

/// VQF: nine-axis online, offline, six-axis online; total, deg.
const std::map<std::string, std::array<double, 3>> vqf{{"02", {1.38, 1.01, 0.70}}, {"07", {1.75, 1.71, 1.59}},
                                                       {"11", {0.90, 0.61, 0.70}}, {"25", {1.62, 1.24, 3.84}},
                                                       {"31", {3.21, 3.98, 6.55}}, {"36", {2.39, 3.26, 5.44}}};

struct Trial {
    std::string name;
    app::LoadedDataset data;
};

std::vector<Trial> trials_in(const fs::path& folder) {
    std::set<fs::path> found;
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(folder, ec)) {
        if (entry.is_directory() && entry.path().filename().string().starts_with("broad_")) found.insert(entry.path());
    }
    std::vector<Trial> out;
    for (const fs::path& path : found) {
        WarningLog unheard;
        const app::Dataset dataset = app::open_dataset(path, app::Needs::Attitude);
        out.push_back(
            {path.filename().string().substr(6), app::load_dataset(dataset, app::config_from(dataset.settings), unheard)});
    }
    return out;
}

void accuracy(const std::vector<Trial>& trials) {
    fmt::print("total (heading/inclination) error, deg RMS in movement, constant heading offset removed\n\n{:<34}", "trial");
    for (const Variant& v : variants) fmt::print("{:>19}", v.title);
    fmt::print("   VQF online, offline, six-axis\n");
    std::array<std::array<double, 3>, variants.size()> sum{};
    for (const Trial& t : trials) {
        fmt::print("{:<34}", t.name);
        for (std::size_t k = 0; k < variants.size(); ++k) {
            WarningLog unheard;
            app::AhrsRequest request;
            request.filter = variants[k].filter;
            request.six_axis = variants[k].six_axis;
            request.offline = variants[k].offline;
            const app::AhrsInput input = app::ahrs_input(t.data, request, unheard);
            const ahrs::RunResult result = ahrs::run(input.imu, input.mag, input.speed, input.settings);
            const auto e = analysis::broad_errors(app::attitude_pairs(result.rows, t.data.recording.reference));
            const std::array error{e.total / units::deg, e.heading / units::deg, e.inclination / units::deg};
            fmt::print("{:>19}", fmt::format("{:.2f} ({:.2f}/{:.2f})", error[0], error[1], error[2]));
            for (std::size_t i = 0; i < 3; ++i) sum[k][i] += error[i] / static_cast<double>(trials.size());
        }
        if (const auto known = vqf.find(t.name.substr(0, 2)); known != vqf.end())
            fmt::print("   {:.2f}, {:.2f}, {:.2f}", known->second[0], known->second[1], known->second[2]);
        fmt::print("\n");
    }
    fmt::print("{:<34}", "mean");
    for (const auto& s : sum) fmt::print("{:>19}", fmt::format("{:.2f} ({:.2f}/{:.2f})", s[0], s[1], s[2]));
    fmt::print("\n\n");
}

/// Samples a second of the full filter, magnetometer included, the attitude read at every sample: median and best of several
/// runs, by the processor's time, so that what else the machine does counts little.
void speed(const Trial& trial) {
    WarningLog unheard;
    const app::AhrsInput input = app::ahrs_input(trial.data, {}, unheard);
    double sink = 0.0;
    constexpr std::size_t runs = 31;
    std::vector<double> rates;
    for (std::size_t run = 0; run < runs; ++run) {
        const std::clock_t begin = std::clock();
        ahrs::Mekf filter(input.settings.mekf);
        std::size_t m = 0;
        for (std::size_t i = 1; i < input.imu.size(); ++i) {
            filter.step((input.imu[i].time - input.imu[i - 1].time).seconds(), input.imu[i].gyro, input.imu[i].accel);
            for (; m < input.mag.size() && input.mag[m].time <= input.imu[i].time; ++m) filter.magnetometer(input.mag[m].field_b);
            sink += filter.q_nb().w();
        }
        const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
        rates.push_back(static_cast<double>(input.imu.size()) / seconds * 1e-6);
    }
    std::ranges::sort(rates);
    fmt::print("mekf: {:.2f} million samples/s on one core (median of {}, best {:.2f}; checksum {:.6g})\n", rates[runs / 2], runs,
               rates.back(), sink / runs);
}

}  // namespace

int main(int argc, char** argv) {
    const char* named = std::getenv("SCHULER_DATA");
    const std::vector<Trial> trials = trials_in(argc > 1 ? argv[1] : named ? named : "../shared/data");
    if (trials.empty()) {
        fmt::print("no broad_* folders: name the folder that holds them\n");
        return 0;
    }
    accuracy(trials);
    speed(trials.front());
    return 0;
}
