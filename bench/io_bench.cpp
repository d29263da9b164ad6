// Reading and writing speed of the io room: KF-GINS text, CSV, solution.csv. Data are made here, in a temporary folder.
#include "schuler/io/solution/kfgins.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/csv/csv_recording.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <filesystem>
#include <random>
#include <string>

namespace {

namespace io = schuler::io;

/// Half an hour at 200 Hz, as large as the reference drive.
constexpr int rows = 354'000;

std::filesystem::path folder() {
    const std::filesystem::path path = std::filesystem::temp_directory_path() / "schuler_io_bench";
    std::filesystem::create_directories(path);
    return path;
}

std::string increments_text() {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> angle(0.0, 1e-5), velocity(0.0, 0.05);
    std::string text;
    for (int i = 0; i < rows; ++i) {
        text += fmt::format("{:.4f}", 100000.0 + 0.005 * i);
        for (int k = 0; k < 3; ++k) text += fmt::format(" {:.15e}", angle(rng));
        for (int k = 0; k < 3; ++k) text += fmt::format(" {:.15e}", velocity(rng));
        text += '\n';
    }
    return text;
}

std::string rates_text() {
    std::mt19937_64 rng(1);
    std::normal_distribution<double> rate(0.0, 0.1), accel(0.0, 5.0);
    std::string text = "time_s,gyro_x_rad_s,gyro_y_rad_s,gyro_z_rad_s,accel_x_m_s2,accel_y_m_s2,accel_z_m_s2\n";
    for (int i = 0; i < rows; ++i) {
        text += fmt::format("{:.4f},{:.6f},{:.6f},{:.6f},{:.5f},{:.5f},{:.5f}\n", 0.005 * i, rate(rng), rate(rng), rate(rng),
                            accel(rng), accel(rng), accel(rng));
    }
    return text;
}

std::vector<schuler::SolutionRow> solution() {
    std::mt19937_64 rng(1);
    std::uniform_real_distribution<double> u(-1.0, 1.0);
    std::vector<schuler::SolutionRow> result(rows);
    const auto three = [&](double size) { return Eigen::Vector3d(size * u(rng), size * u(rng), size * u(rng)); };
    for (int i = 0; i < rows; ++i) {
        schuler::SolutionRow& r = result[static_cast<std::size_t>(i)];
        r.time.ns = 100'000'000'000'000 + i * std::int64_t{5'000'000};
        r.position = {0.5313 + 1e-3 * u(rng), 1.99 + 1e-3 * u(rng), 30.0 + 10.0 * u(rng)};
        r.v_eb_n = three(15.0);
        r.rpy = three(1.0) + Eigen::Vector3d(0.0, 0.0, 3.0);
        r.std_position = three(0.1).cwiseAbs();
        r.std_velocity = three(0.1).cwiseAbs();
        r.std_rpy = three(0.01).cwiseAbs();
    }
    return result;
}

void read_kfgins_imu(benchmark::State& state) {
    const std::filesystem::path path = folder() / "imu.txt";
    io::write_file(path, increments_text());
    schuler::WarningLog log;
    for (auto _ : state) benchmark::DoNotOptimize(io::read_kfgins_imu(path, log).samples.data());
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(std::filesystem::file_size(path)));
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * rows);
}
BENCHMARK(read_kfgins_imu)->Unit(benchmark::kMillisecond);

void read_imu_csv(benchmark::State& state) {
    const std::filesystem::path path = folder() / "imu.csv";
    io::write_file(path, rates_text());
    schuler::WarningLog log;
    for (auto _ : state) benchmark::DoNotOptimize(io::read_imu_csv(path, {}, log).samples.data());
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(std::filesystem::file_size(path)));
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * rows);
}
BENCHMARK(read_imu_csv)->Unit(benchmark::kMillisecond);

void write_solution(benchmark::State& state) {
    const std::filesystem::path path = folder() / "solution.csv";
    const std::vector<schuler::SolutionRow> data = solution();
    for (auto _ : state) io::write_solution_csv(path, data);
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(std::filesystem::file_size(path)));
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * rows);
}
BENCHMARK(write_solution)->Unit(benchmark::kMillisecond);

void write_solution_to_null(benchmark::State& state) {
    const std::vector<schuler::SolutionRow> data = solution();
    for (auto _ : state) io::write_solution_csv("/dev/null", data);
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * rows);
}
BENCHMARK(write_solution_to_null)->Unit(benchmark::kMillisecond);

void read_solution(benchmark::State& state) {
    const std::filesystem::path path = folder() / "solution.csv";
    io::write_solution_csv(path, solution());
    schuler::WarningLog log;
    for (auto _ : state) benchmark::DoNotOptimize(io::read_solution_csv(path, log).data());
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(std::filesystem::file_size(path)));
}
BENCHMARK(read_solution)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
