// Reading and writing speed of the io room: KF-GINS text, CSV, solution.csv; logs of autopilots, receivers and robots. Data are made here,
// in a temporary folder.
#include "schuler/io/formats.h"
#include "schuler/io/solution/kfgins.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/csv/csv_recording.h"

#include "io/log_bytes.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdint>
#include <cstring>
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

namespace logs = io::test;

/// Six numbers as a gyroscope and an accelerometer give them.
struct Noise {
    std::mt19937_64 rng{1};
    std::normal_distribution<float> rate{0.0F, 0.1F}, accel{0.0F, 5.0F};
    float w() { return rate(rng); }
    float f() { return accel(rng); }
};

std::string ulog_bytes() {
    logs::Ulog log;
    Noise n;
    log.define(
        "sensor_combined:uint64_t timestamp;float[3] gyro_rad;uint32_t gyro_integral_dt;int32_t accelerometer_timestamp_relative;"
        "float[3] accelerometer_m_s2;uint32_t accelerometer_integral_dt;");
    log.define("vehicle_attitude_setpoint:uint64_t timestamp;float[4] q_d;float[3] thrust_body;");
    log.subscribe(0, 0, "sensor_combined");
    log.subscribe(0, 1, "vehicle_attitude_setpoint");
    for (std::uint64_t i = 0; i < rows; ++i) {
        log.data(0, 5000 * i, n.w(), n.w(), n.w(), 5000U, 0, n.f(), n.f(), n.f(), 5000U);
        if (i % 2 == 0) log.data(1, 5000 * i, 1.0F, 0.0F, 0.0F, 0.0F, 0.0F, 0.0F, -0.5F);
    }
    return log.bytes();
}

std::string dataflash_bytes() {
    logs::Dataflash log;
    Noise n;
    log.define(1, "IMU", "QBffffff", "TimeUS,I,GyrX,GyrY,GyrZ,AccX,AccY,AccZ");
    log.define(2, "RCOU", "QHHHH", "TimeUS,C1,C2,C3,C4");
    for (std::uint64_t i = 0; i < rows; ++i) {
        log.data(1, 5000 * i, std::uint8_t{0}, n.w(), n.w(), n.w(), n.f(), n.f(), n.f());
        if (i % 2 == 0) log.data(2, 5000 * i, std::uint16_t{1500}, std::uint16_t{1500}, std::uint16_t{1500}, std::uint16_t{1500});
    }
    return log.bytes();
}

/// A receiver with sensors: ten samples a message (ESF-RAW), a fix (NAV-PVT) after ten of them, satellites in view (NAV-SAT) in between.
std::string ubx_bytes() {
    std::string out;
    Noise n;
    std::uint32_t ticks = 0;
    for (std::uint32_t epoch = 0; epoch < rows / 100; ++epoch) {
        std::string fix(92, '\0');
        const auto set = [&](std::size_t where, auto value) { std::memcpy(fix.data() + where, &value, sizeof value); };
        set(0, 1000U * epoch);
        set(4, std::uint16_t{2024});
        fix[6] = 5;
        fix[7] = 1;
        fix[8] = static_cast<char>(epoch / 3600U % 24U);
        fix[9] = static_cast<char>(epoch / 60U % 60U);
        fix[10] = static_cast<char>(epoch % 60U);
        fix[11] = 7;
        fix[20] = 3;
        fix[21] = 1;
        set(24, std::int32_t{85'000'000});
        set(28, std::int32_t{473'000'000});
        out += logs::ubx(0x01, 0x07, fix) + logs::ubx(0x01, 0x35, std::string(8 + 12 * 30, '\0'));
        for (int message = 0; message < 10; ++message) {
            std::string p(4, '\0');
            for (int sample = 0; sample < 10; ++sample, ticks += 256)
                for (const unsigned type : {14U, 13U, 5U, 16U, 17U, 18U}) {
                    const auto value = static_cast<std::int32_t>(type < 15 ? n.w() * 2e5F : n.f() * 1e3F);
                    logs::put(p, type << 24U | (static_cast<std::uint32_t>(value) & 0xFFFFFFU));
                    logs::put(p, ticks);
                }
            out += logs::ubx(0x10, 0x03, p);
        }
    }
    return out;
}

/// sensor_msgs/Imu of ROS 2, in records that are not compressed.
std::string mcap_bytes() {
    const auto text = [](std::string_view value) {
        std::string out;
        logs::put(out, static_cast<std::uint32_t>(value.size()));
        return out.append(value);
    };
    const auto record = [](std::string& out, char op, std::string_view body) {
        out += op;
        logs::put(out, static_cast<std::uint64_t>(body.size()));
        out += body;
    };
    std::string out("\x89MCAP0\r\n", 8), schema, channel;
    record(out, 1, text("ros2") + text("bench"));
    logs::put(schema, std::uint16_t{1});
    record(out, 3, schema + text("sensor_msgs/msg/Imu") + text("ros2msg") + text(""));
    logs::put(channel, std::uint16_t{1});
    logs::put(channel, std::uint16_t{1});
    channel += text("/imu/data") + text("cdr");
    logs::put(channel, std::uint32_t{0});
    record(out, 4, channel);
    Noise n;
    for (std::uint32_t i = 0; i < rows; ++i) {
        std::string m;
        logs::put(m, std::uint16_t{1});
        logs::put(m, i);
        logs::put(m, std::uint64_t{5'000'000} * i);
        logs::put(m, std::uint64_t{5'000'000} * i);
        const std::size_t start = m.size() + 4;
        m += std::string("\0\1\0\0", 4);
        logs::put(m, 1'700'000'000U + i / 200U);
        logs::put(m, 5'000'000U * (i % 200U));
        m += text(std::string_view("imu_link\0", 9));
        while ((m.size() - start) % 8 != 0) m += '\0';
        const auto numbers = [&](int count, auto value) {
            for (int k = 0; k < count; ++k) logs::put(m, static_cast<double>(value()));
        };
        numbers(13, [] { return 0.25; });
        numbers(3, [&] { return n.w(); });
        numbers(9, [] { return 0.0; });
        numbers(3, [&] { return n.f(); });
        numbers(9, [] { return 0.0; });
        record(out, 5, m);
    }
    return out;
}

void read_log(benchmark::State& state, const char* format, const char* name, std::string (*bytes)()) {
    const std::filesystem::path path = folder() / name;
    io::write_file(path, bytes());
    std::size_t samples = 0;
    for (auto _ : state) {
        schuler::WarningLog log;
        const io::StreamLog read = io::format_named(format)->read(io::TextInput(path), log);
        samples = read.find("imu") != nullptr ? read.find("imu")->rows() : 0;
    }
    if (samples < static_cast<std::size_t>(rows) * 9 / 10) state.SkipWithError("the log was not read as it was made");
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) *
                            static_cast<std::int64_t>(std::filesystem::file_size(path)));
    state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * rows);
}
BENCHMARK_CAPTURE(read_log, ulog, "ulog", "log.ulg", ulog_bytes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_log, dataflash, "dataflash", "log.bin", dataflash_bytes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_log, ubx, "ubx", "log.ubx", ubx_bytes)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(read_log, mcap, "mcap", "log.mcap", mcap_bytes)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
