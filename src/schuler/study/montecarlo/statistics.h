// Statistics of a campaign from one run at a time, without storing runs: their size does not depend on the number of runs.
#pragma once

#include "schuler/analysis/ensemble.h"
#include "schuler/analysis/errors.h"
#include "schuler/analysis/outages.h"
#include "schuler/core/packed.h"
#include "schuler/math/exact_sum.h"
#include "schuler/math/quantile_sketch.h"
#include "schuler/settings/value.h"
#include "schuler/solution/evaluate.h"
#include "schuler/solution/state_errors.h"
#include "schuler/study/montecarlo/run_warnings.h"

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <vector>

namespace schuler::study {

/// A scalar error of summary.json: its position, its source, its unit.
struct ErrorField {
    const char* group;
    const char* name;
    const char* title;
    analysis::Spread analysis::ErrorSummary::*of_run;
    double (*of_row)(const analysis::ErrorRow&);
    double si;
};
inline constexpr std::size_t error_field_count = 11;
[[nodiscard]] const std::array<ErrorField, error_field_count>& error_fields();

/// Data of one run used by a campaign.
struct MonteCarloRun {
    std::uint64_t run = 0, seed = 0;
    settings::SettingList drawn;  ///< values of the keys that vary
    std::vector<double> numbers;  ///< for each varying key: its value, or if that is not a number its index in the list
    std::uint64_t point = 0;      ///< of the grid of sweeps
    std::string failure;          ///< empty: successful
    std::string scheme, mechanization, loop;  ///< as used in the run
    bool smoothed = false;
    double settled_s = 0.0;                     ///< s after the first fix, from which errors are evaluated
    Time origin;                                ///< first fix
    analysis::ErrorSummary summary;             ///< at every reference epoch
    std::vector<analysis::ErrorRow> errors;     ///< at most a thousand of them, settled
    std::vector<solution::StateErrors> states;  ///< from the start on
    std::vector<solution::MeasurementConsistency> measurements;
    std::vector<analysis::OutageStatistics> outages;
    WarningLog warnings;

    [[nodiscard]] bool failed() const { return !failure.empty(); }
};

/// Sum of squares and quantiles of some values.
struct ValueStatistics {
    math::ExactSum square;
    math::QuantileSketch sketch;

    ValueStatistics() : ValueStatistics(100'000, 7) {}
    ValueStatistics(std::size_t bound, unsigned bits) : sketch(bound, bits) {}
    void add(double x);
    [[nodiscard]] analysis::Quantiles quantiles() const;
};

struct FieldStatistics {
    math::ExactSum square;  ///< of every reference epoch of every run
    std::uint64_t epochs = 0;
    double largest = 0.0;
    ValueStatistics runs;                   ///< the runs' own root mean squares
    math::QuantileSketch size{130'000, 7};  ///< absolute values of the rows kept from each run
};

/// Mean of a positive number over runs, and the scatter of the runs.
struct NeesOfRuns {
    math::ExactSum sum, square;
    std::uint64_t runs = 0, epochs = 0;
};

/// One block of states at one epoch over the runs.
struct BlockAtEpoch {
    std::array<ValueStatistics, 3> error{ValueStatistics{256, 4}, ValueStatistics{256, 4},
                                         ValueStatistics{256, 4}};  ///< in the unit used in files
    math::ExactSum nees, settled_nees;
    std::uint64_t count = 0, settled = 0;  ///< runs
};
struct Epoch {
    double time_s = std::numeric_limits<double>::infinity();              ///< after the first fix
    std::array<std::vector<BlockAtEpoch>, solution::state_blocks> block;  ///< one each, or none
};

struct MeasurementStatistics {
    math::ExactSum nis, dof, lag1;
    std::uint64_t accepted = 0, rejected = 0;
};

struct OutageOfRuns {
    double start_s = 0.0, duration_s = 0.0;
    std::array<ValueStatistics, 5> size;  ///< end horizontal, max horizontal, end vertical, max 3-d, growth
    std::uint64_t runs = 0, inside = 0;
};

/// One point of the grid of sweeps.
struct PointStatistics {
    std::uint64_t runs = 0, failed = 0, epochs = 0, nees_runs = 0;
    std::array<math::ExactSum, error_field_count> square;
    math::ExactSum nees, end_square;
    std::uint64_t ends = 0;  ///< runs with a first outage, for the horizontal error at its end
};

struct Failure {
    std::uint64_t seed = 0;
    std::string reason;
};
inline constexpr std::size_t kept_failures = 1000;  ///< those with the lowest run numbers

/// Sums are exact and histograms fixed, so that runs in any order, added one by one or merged in parts, give bitwise equal statistics.
struct CampaignStatistics {
    double epoch_step = 1.0;  ///< s, of epochs.csv
    std::uint64_t runs = 0, failed = 0;
    std::uint64_t first_run = std::numeric_limits<std::uint64_t>::max();  ///< of the successful ones: `head` is from it
    struct Head {
        std::string scheme, mechanization, loop;
        bool smoothed = false;
        double settled_s = 0.0;
    } head;
    std::array<FieldStatistics, error_field_count> fields;
    std::array<std::array<ValueStatistics, 3>, solution::state_blocks> components;  ///< settled, in the unit used in files
    std::array<NeesOfRuns, solution::state_blocks> nees;
    std::map<std::int64_t, Epoch> epochs;
    std::map<std::string, MeasurementStatistics> measurements;
    std::vector<OutageOfRuns> outages;
    std::map<std::uint64_t, PointStatistics> points;  ///< only with sweeps
    bool swept = false;
    std::map<std::uint64_t, Failure> failures;  ///< by run number
    RunWarnings warnings;                       ///< of the successful runs

    void add(const MonteCarloRun& run);
    void merge(const CampaignStatistics& other);
    void pack(Packer& to) const;
    /// @throws Error(Input) if the bytes are damaged
    void unpack(Unpacker& from);

    [[nodiscard]] bool present(std::size_t block) const { return nees[block].runs > 0; }
    [[nodiscard]] analysis::Quantiles component(std::size_t block, std::size_t axis) const {
        return components[block][axis].quantiles();
    }
    /// Over all runs and settled epochs, as analysis::ensemble_consistency.
    [[nodiscard]] analysis::EnsembleConsistency consistency(std::size_t block) const;
};

/// Mean NEES of the blocks of one run after settling; NaN if there is none.
[[nodiscard]] std::array<double, solution::state_blocks> mean_nees(const MonteCarloRun& run);

}  // namespace schuler::study
