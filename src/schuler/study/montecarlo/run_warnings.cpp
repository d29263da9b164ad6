#include "schuler/study/montecarlo/run_warnings.h"

#include <fmt/format.h>

namespace schuler::study {
namespace {

void merge_topic(WarningOfRuns& into, const WarningOfRuns& other) {
    const std::uint64_t runs = into.runs + other.runs;
    if (into.runs == 0 || other.first_run < into.first_run) into = other;
    into.runs = runs;
}

}  // namespace

void RunWarnings::add(std::uint64_t run, std::uint64_t seed, const WarningLog& warnings) {
    const std::vector<std::string> texts = warnings.summary();
    for (std::size_t i = 0; i < texts.size(); ++i) merge_topic(topics[warnings.topics()[i]], {run, seed, 1, texts[i]});
}

void RunWarnings::merge(const RunWarnings& other) {
    for (const auto& [topic, warning] : other.topics) merge_topic(topics[topic], warning);
}

std::vector<std::string> RunWarnings::lines(std::uint64_t runs) const {
    std::vector<std::string> out;
    for (const auto& [topic, w] : topics)
        out.push_back(runs > 1 ? fmt::format("{} (seed {}; {} of {} runs)", w.text, w.seed, w.runs, runs) : w.text);
    return out;
}

}  // namespace schuler::study
