// What one core does at most: multiplications and additions in registers, and loads from its caches and from memory. Beside the counted
// arithmetic of the filter (bench/run prints the ratio; docs/speed.md).
#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

namespace {

using Vec4 = double __attribute__((vector_size(32)));  // as the filter's kernels (estim/detail/vec4.h)

constexpr int chains = 12;  // more than latency times throughput of the fused multiply-add

/// Independent chains of fused multiply-adds: two operations for each number.
template <class Number>
void multiply_add(benchmark::State& state) {
    constexpr int steps = 1000;
    std::array<Number, chains> sum{};
    Number factor = Number{} + 0.999, addend = Number{} + 1e-3;
    for (auto _ : state) {
        benchmark::DoNotOptimize(factor);
        benchmark::DoNotOptimize(addend);
        for (int k = 0; k < steps; ++k)
            for (Number& s : sum) s = s * factor + addend;
        for (Number& s : sum) benchmark::DoNotOptimize(s);
    }
    const double operations = 2.0 * chains * steps * static_cast<double>(sizeof(Number) / sizeof(double));
    state.counters["flops_per_s"] =
        benchmark::Counter(operations * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

/// One chain: each step waits for the one before, as in the sums of a short dot product.
void multiply_add_in_turn(benchmark::State& state) {
    constexpr int steps = 1000;
    double sum = 0.0, factor = 0.999, addend = 1e-3;
    for (auto _ : state) {
        benchmark::DoNotOptimize(factor);
        benchmark::DoNotOptimize(addend);
        for (int k = 0; k < steps; ++k) sum = sum * factor + addend;
        benchmark::DoNotOptimize(sum);
    }
    state.counters["flops_per_s"] =
        benchmark::Counter(2.0 * steps * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

/// Loads of so many kilobytes, over and over.
void load(benchmark::State& state) {
    const auto bytes = static_cast<std::size_t>(state.range(0)) * 1024;
    const std::vector<double> data(bytes / sizeof(double), 1.0);
    const std::size_t n = data.size() / 32 * 32;
    for (auto _ : state) {
        std::array<Vec4, 8> sum{};
        for (std::size_t i = 0; i < n; i += 32) {
            for (std::size_t k = 0; k < 8; ++k) {
                Vec4 v;
                std::memcpy(&v, data.data() + i + 4 * k, sizeof v);
                sum[k] += v;
            }
        }
        for (Vec4& s : sum) benchmark::DoNotOptimize(s);
    }
    state.counters["bytes_per_s"] = benchmark::Counter(
        static_cast<double>(n * sizeof(double)) * static_cast<double>(state.iterations()), benchmark::Counter::kIsRate);
}

/// Copies of 64 MB: what the reader and the writer of text cannot exceed.
void copy(benchmark::State& state) {
    const std::vector<char> from(std::size_t{64} << 20U, 'x');
    std::vector<char> to(from.size());
    for (auto _ : state) {
        std::memcpy(to.data(), from.data(), from.size());
        benchmark::ClobberMemory();
    }
    state.counters["bytes_per_s"] = benchmark::Counter(static_cast<double>(from.size()) * static_cast<double>(state.iterations()),
                                                       benchmark::Counter::kIsRate);
}

BENCHMARK_TEMPLATE(multiply_add, Vec4)->Name("multiply_add/vector");
BENCHMARK_TEMPLATE(multiply_add, double)->Name("multiply_add/scalar");
BENCHMARK(multiply_add_in_turn)->Name("multiply_add/in_turn");
BENCHMARK(load)->Name("load")->Arg(16)->Arg(512)->Arg(131072);
BENCHMARK(copy)->Name("copy");

}  // namespace

BENCHMARK_MAIN();
