// Files of a running campaign that allow it to be resumed after any interruption.
#pragma once

#include "schuler/study/montecarlo/run_set.h"
#include "schuler/study/montecarlo/statistics.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

namespace schuler::study {

/// A row of runs.csv as numbers; the first two are the run and whether it failed.
using RunNumbers = std::vector<double>;

/// The part of a campaign processed by one process. Its file checkpoint-RANK.bin is replaced as a whole; the rows of its runs are
/// appended to rows-RANK.bin, which is valid up to the length stored in the checkpoint.
class CampaignPart {
public:
    /// `identity`: of scenario, settings and program; `row`: numbers per row.
    CampaignPart(std::filesystem::path folder, int rank, std::string identity, std::size_t row, const CampaignStatistics& empty);

    /// Adopts the parts of an interrupted campaign. @throws Error(Input) if they belong to another campaign or are damaged
    void take_over();
    /// Creates the file of rows and the first checkpoint, so that write errors are detected before the work. @throws Error
    void begin();
    void add(const MonteCarloRun& run, const RunNumbers& row);
    /// Writes the checkpoint. @throws Error(Input) if the disk is full
    void save();
    /// The rows of all parts in the order of runs, `first` to `end`. @throws Error
    void each_row(std::uint64_t first, std::uint64_t end, const std::function<void(const RunNumbers&)>& show);

    [[nodiscard]] std::string packed() const;
    /// Statistics and runs of another part, from packed(); its rows stay in their own file.
    void merge(std::string_view bytes);

    [[nodiscard]] const RunSet& done() const { return done_; }
    [[nodiscard]] const CampaignStatistics& statistics() const { return statistics_; }

    /// Files of interrupted campaigns in a folder.
    [[nodiscard]] static std::vector<std::filesystem::path> left_in(const std::filesystem::path& folder);
    static void remove_from(const std::filesystem::path& folder);

private:
    [[nodiscard]] std::filesystem::path file(const char* kind, int rank) const;
    void append_rows(const std::filesystem::path& from, std::uint64_t bytes);
    void flush_rows();

    std::filesystem::path folder_;
    int rank_;
    std::string identity_;
    std::size_t row_;
    CampaignStatistics empty_, statistics_;
    RunSet done_;
    std::uint64_t row_bytes_ = 0;
    std::ofstream rows_;
};

}  // namespace schuler::study
