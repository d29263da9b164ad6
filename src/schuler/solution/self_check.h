// The self-check of `process`: fixes withheld in separate windows, evaluation of the sigmas with them, and an increase of the
// inertial noise if they are too small.
#pragma once

#include "schuler/fusion/result.h"
#include "schuler/solution/coverage.h"
#include "schuler/solution/loaded_dataset.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace schuler::solution {

/// The undisturbed solution at its fixes in one regime.
struct FixRegime {
    std::size_t fixes = 0, refused = 0;
    Inside inside;     ///< within three sigma of the innovation, including rejected ones
    double nis = 0.0;  ///< mean normalised innovation squared per component, of those used
};

struct SelfCheck {
    std::string why_not;                   ///< empty: it was made
    double length = 0.0;                   ///< s, of the windows
    Coverage coverage;                     ///< of the solution as it is, in windows not used for the increase
    std::optional<Coverage> before;        ///< of the same windows without the increased noise, if that was tried
    std::optional<Coverage> all;           ///< of all windows with the increased noise, if in force
    std::optional<NoiseScale> tried;       ///< the noise required by the other windows
    bool widened = false;                  ///< the increased noise is in force
    std::array<FixRegime, regimes> fixes;  ///< positions
    std::vector<SolutionRow> motion;       ///< of a run with windows, a few per second
    double seconds = 0.0;                  ///< total wall time

    [[nodiscard]] bool done() const { return why_not.empty(); }
    /// Reverts the increased noise.
    void keep_as_it_was();
    /// The worse of the coverages that judge the solution.
    [[nodiscard]] const Coverage& worst() const { return all && all->epochs.share() < coverage.epochs.share() ? *all : coverage; }
};

/// Evaluates `result`, the run of `data`. The log is processed twice in parallel, with the even and with the odd windows
/// withheld; if less than wanted_coverage of the epochs are inside, once more with the noise required by one half of the windows
/// (on short logs, which are processed quickly, up to three times until that half is covered), evaluated by the other half. If
/// this improves the coverage, `wider` has the settings for repeating the run. A given noise scale is kept.
[[nodiscard]] SelfCheck self_check(const LoadedDataset& data, const fusion::Result& result,
                                   std::optional<fusion::Settings>& wider);

/// Fixes of the undisturbed solution by type of motion: filled in for the final run.
void judge_fixes(SelfCheck& check, const fusion::Result& result);

/// Readable table: withheld fixes, coverage, growth of errors and sigmas, regimes.
[[nodiscard]] std::string self_check_table(const SelfCheck& check);

}  // namespace schuler::solution
