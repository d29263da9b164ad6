// Reading speed of RINEX observations: an hour at 1 Hz, made here in memory.
#include "schuler/io/rinex/rinex.h"

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <string>

namespace {

namespace io = schuler::io;

std::string observations_text() {
    const auto label = [](const char* text, const char* name) { return fmt::format("{:<60}{:<20}\n", text, name); };
    std::string text = label("     3.04           OBSERVATION DATA    M: MIXED", "RINEX VERSION / TYPE") +
                       label("G   12 C1C L1C D1C S1C C2X L2X D2X S2X C5I L5I D5I S5I", "SYS / # / OBS TYPES") +
                       label("", "END OF HEADER");
    for (int i = 0; i < 3600; ++i) {
        text += fmt::format("> 2023 01 08 10 {:02} {:2}.0000000  0 20\n", i / 60, i % 60);
        for (int s = 1; s <= 20; ++s) {
            text += fmt::format("G{:02}", s);
            for (int k = 0; k < 3; ++k)
                text += fmt::format("{:14.3f} 9{:14.3f} 9{:14.3f} 9{:14.3f} 9", 2.1e7 + 317.123 * i + s, 1.1e8 + 1666.456 * i + s,
                                    -1452.267 + 0.1 * i, 54.233);
            text += '\n';
        }
    }
    return text;
}

void read_rinex_observations(benchmark::State& state) {
    const std::string text = observations_text();
    schuler::WarningLog log;
    for (auto _ : state) {
        const io::TextInput input = io::TextInput::memory(text, "bench.obs");
        benchmark::DoNotOptimize(io::read_rinex_observations(input, log).log.observations.data());
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations()) * static_cast<std::int64_t>(text.size()));
}
BENCHMARK(read_rinex_observations)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
