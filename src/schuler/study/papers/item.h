// A reproducible table or figure of a paper: common parts of the files in this folder.
#pragma once

#include "schuler/report/report.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/scenario/scenario.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace schuler::study {

/// Input of an item.
struct PaperWork {
    std::size_t runs = 1;
    std::uint64_t seed = 1;
    int jobs = 0;
    std::function<void(double)> progress{};
};

/// Result of an item: numbers by the keys of data/papers.toml, tables and plots.
struct PaperResult {
    std::vector<std::pair<std::string, double>> numbers{};
    /// Of numbers of a Monte Carlo item, by the same keys: their scatter for this number of runs.
    std::vector<std::pair<std::string, double>> standard_errors{};
    std::vector<report::ResultTable> tables{};
    std::vector<report::Panel> panels{};
    std::string notes{};  ///< for display, below the tables
};

struct PaperItem {
    const char* paper;  ///< "A"
    const char* name;   ///< as in data/papers.toml
    const char* what;   ///< one line
    std::size_t runs;   ///< of a Monte Carlo item, unless specified otherwise; 0: not a Monte Carlo item
    double seconds;     ///< approximate duration on two cores; for a Monte Carlo item: of one run
    PaperResult (*make)(const PaperWork&);
};

/// In the order of the papers.
[[nodiscard]] std::vector<PaperItem> paper_a_algorithms();  ///< chapters 1 and 2
[[nodiscard]] std::vector<PaperItem> paper_a_systems();     ///< tables 1.1.1 and 1.4.2
[[nodiscard]] std::vector<PaperItem> paper_a_receiver();    ///< table 1.2.1
[[nodiscard]] std::vector<PaperItem> paper_a_errors();      ///< section 4.1
[[nodiscard]] std::vector<PaperItem> paper_a_flight();      ///< sections 4.2 and 4.3
[[nodiscard]] std::vector<PaperItem> paper_b_items();
[[nodiscard]] std::vector<PaperItem> paper_c_items();
[[nodiscard]] std::vector<PaperItem> paper_d_items();
[[nodiscard]] std::vector<PaperItem> paper_e_items();
[[nodiscard]] std::vector<PaperItem> paper_e_laboratory();

/// The settings of an embedded scenario, with additional ones. @throws Error
[[nodiscard]] settings::SettingList paper_settings(std::string_view file, std::uint64_t seed,
                                                   const settings::SettingList& over = {});
/// The scenario of these. @throws Error
[[nodiscard]] settings::ScenarioConfig paper_scenario(std::string_view file, std::uint64_t seed,
                                                      const settings::SettingList& over = {});

/// A curve of a plot.
[[nodiscard]] inline report::Series paper_curve(std::string name, std::vector<double> x, std::vector<double> y,
                                                report::Ink ink = report::Ink::Blue, report::Mark mark = report::Mark::Line) {
    return {std::move(name), std::move(x), std::move(y), ink, mark};
}
[[nodiscard]] double paper_rms(const std::vector<double>& x);

/// Numbers of an item from these of its runs (indices, possibly repeated).
using NumbersOfRuns = std::function<std::vector<std::pair<std::string, double>>(const std::vector<std::size_t>&)>;
/// Numbers of all runs, and their standard errors by bootstrap: drawn runs, with repetition, as many as there are. One run has none.
void set_numbers(PaperResult& result, std::size_t runs, const NumbersOfRuns& numbers);

}  // namespace schuler::study
