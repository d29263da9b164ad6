// Many seeds of one flight processed by several schemes.
#pragma once

#include "schuler/analysis/ensemble.h"
#include "schuler/analysis/errors.h"
#include "schuler/report/outcome.h"
#include "schuler/report/report.h"
#include "schuler/report/result_table.h"
#include "schuler/settings/config/config.h"
#include "schuler/settings/request.h"
#include "schuler/settings/scenario/comparison.h"
#include "schuler/solution/ignored.h"
#include "schuler/study/comparison/compare_windows.h"
#include "schuler/study/montecarlo/run_warnings.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace schuler::study {

/// Squared errors of one run, or of many, in equal intervals of the scenario, with the variances stated by the solution.
struct SquaredCourse {
    static constexpr std::size_t spans = 300, quantities = 4;  ///< horizontal and height, m; velocity, m/s; heading, rad
    std::array<std::array<double, spans>, quantities> square{}, variance{};
    std::array<std::array<double, spans>, quantities> count{};

    /// Error rows of one run, with times relative to `origin`, in a scenario of `duration` s. Rows without a sigma are not used.
    void add(const std::vector<analysis::ErrorRow>& rows, Time origin, double duration);
    void add(const SquaredCourse& other);
};

/// Results of one scheme for all seeds.
struct SchemeCampaign {
    const settings::KnownScheme* scheme = nullptr;
    std::optional<std::size_t> satellites;               ///< compare.satellites
    std::vector<std::vector<double>> numbers;            ///< of each run, as compared_numbers(); empty: it failed
    std::vector<std::vector<WindowStatistics>> windows;  ///< of each run
    std::vector<std::array<double, 3>>
        run_nees;  ///< of each run, means of position, velocity, attitude, one expected; NaN: it failed
    std::array<analysis::EnsembleConsistency, 3> nees;  ///< position, velocity, attitude; NaN if the scheme has no covariance
    SquaredCourse course;                               ///< of all runs together
    std::vector<std::string> failures;                  ///< of the runs that failed, with their seed
    RunWarnings warnings;                               ///< of the others
    bool unsmoothed = false;                            ///< smoothing was requested, and the scheme has no smoother
};

struct CompareCampaign {
    std::string name, version;
    std::vector<std::uint64_t> seeds;
    std::vector<settings::CompareWindow> windows;
    settings::WindowRules rules;
    std::vector<SchemeCampaign> schemes;        ///< those with equal number of satellites are contiguous
    std::vector<settings::OutageSpan> outages;  ///< of GNSS
    double duration = 0.0;                      ///< s, of the scenario
    std::string settings;                       ///< TOML
    std::vector<solution::Ignored> ignored;     ///< given settings without effect on any scheme
    bool report_wanted = true;                  ///< output.files contains "report"
    double wall_s = 0.0;

    [[nodiscard]] bool with_satellites() const { return schemes.front().satellites.has_value(); }
    /// Which schemes are not smoothed, and those of the runs: one line per scheme and topic.
    [[nodiscard]] std::vector<std::string> warnings() const;
};

/// Runs every scheme compared in the scenario with the seed of the scenario, that seed plus one, and so on: all schemes use the
/// same flights. Variations (montecarlo.vary) are drawn for each seed. The result does not depend on `jobs`. @throws Error: the
/// first run of the first scheme fails.
[[nodiscard]] CompareCampaign compare_campaign(const settings::ProcessRequest& request, std::size_t runs, int jobs);
/// The same for the settings of a scenario, with settings of the processing over them.
[[nodiscard]] CompareCampaign compare_campaign(const settings::SettingList& scenario, const settings::SettingList& over,
                                               std::size_t runs, int jobs, const std::function<void(double)>& progress);

/// Root mean squares over the seeds and NEES with the bounds for that number of independent runs; one more table per window.
[[nodiscard]] std::string campaign_tables(const CompareCampaign& campaign);
/// The table of NEES among these.
[[nodiscard]] report::ResultTable nees_table(const CompareCampaign& campaign);
[[nodiscard]] std::string campaign_json(const CompareCampaign& campaign);
/// report.html: the tables, and for each scheme the root mean square of the errors over the seeds with its stated sigma, over time.
[[nodiscard]] report::ReportInput campaign_report(const CompareCampaign& campaign);
/// One row per scheme and run.
[[nodiscard]] std::string campaign_runs_csv(const CompareCampaign& campaign);

/// The Monte Carlo run for every scheme compared in the scenario, as performed by run_montecarlo if there are such.
[[nodiscard]] report::Outcome montecarlo_of_schemes(const settings::ProcessRequest& request, std::size_t runs, int jobs);

}  // namespace schuler::study
