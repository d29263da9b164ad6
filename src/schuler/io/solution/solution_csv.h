// solution.csv: the trajectory with one sigma of each component, fast writing and reading.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/nav_state.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/text/text_input.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io {

/// True for a table with the names of a solution's time, position and sigmas, as read_solution_csv() takes it.
[[nodiscard]] bool is_solution_csv(const TextInput& input);

/// The header line of solution.csv (without line end).
[[nodiscard]] std::string_view solution_csv_header();

/// One row in the same format.
[[nodiscard]] std::string solution_csv_row(const SolutionRow& row);

/// Writes rows in batches. Angles in degrees (latitude and longitude to 1e-10, attitude to 1e-6), heights to 0.1 mm, velocities
/// to 0.01 mm/s, sigmas to 1e-5 m, 1e-5 m/s, 1e-6 deg; times exactly; NaN is an empty field. The file appears at commit().
class SolutionCsvWriter {
public:
    /// Throws Error(Input) if the file cannot be created.
    explicit SolutionCsvWriter(const std::filesystem::path& path);

    void append(const SolutionRow& row);
    void append(std::span<const SolutionRow> rows);
    /// Throws Error(Input) if the disk is full.
    void commit();

private:
    void flush();

    AtomicFile file_;
    std::vector<char> buffer_;
    std::size_t used_ = 0;
};

/// Writes a whole solution. `legs`: start of each; with more than one there is a last column `leg`, counted from 1.
void write_solution_csv(const std::filesystem::path& path, std::span<const SolutionRow> rows, std::span<const Time> legs = {});

/// The leg of a given time, from 1.
[[nodiscard]] int leg_at(std::span<const Time> legs, Time time);

/// Reads a solution; columns are found as in any CSV file, missing sigmas are NaN. Throws Error(Input) as read_reference_csv.
[[nodiscard]] std::vector<SolutionRow> read_solution_csv(const TextInput& input, WarningLog& log);

}  // namespace schuler::io
