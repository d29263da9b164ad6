// `schuler paper`: the tables and figures of the five papers, our results compared with the printed ones.
#pragma once

#include "schuler/report/outcome.h"
#include "schuler/study/papers/item.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace schuler::study {

struct PaperRequest {
    std::string paper;             ///< A to E
    std::string item;              ///< empty: list them; "all": all except Monte Carlo campaigns
    std::filesystem::path output;  ///< folder; empty: no files are written
    int runs = 0;                  ///< 0: the default of the item
    std::uint64_t seed = 1;
    int jobs = 0;
    std::string version;
    std::function<void(double)> progress;
};

/// In the order of the papers.
[[nodiscard]] const std::vector<PaperItem>& paper_items();

/// The list of a paper's items, or the processed item: comparison, tables; with a folder report.html, comparison.csv, curves.csv
/// and summary.json. Not usable if a printed number is neither reproduced nor explained. @throws Error
[[nodiscard]] report::Outcome make_paper(const PaperRequest& request);

}  // namespace schuler::study
