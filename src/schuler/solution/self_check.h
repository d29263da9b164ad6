// The self-check of `process`: fixes withheld in windows of its own, the sigmas judged by them, and the noise of the inertial unit
// widened where they are too small.
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
    Inside inside;     ///< three sigma of the innovation, refused ones too
    double nis = 0.0;  ///< mean normalised innovation squared of a component, of those used
};

struct SelfCheck {
    std::string why_not;                   ///< empty: it was done
    double length = 0.0;                   ///< s, of the windows
    Coverage coverage;                     ///< of the solution as it is, in windows that had no part in widening
    std::optional<Coverage> before;        ///< of the same windows without the wider noise, where it was tried
    std::optional<Coverage> all;           ///< of all windows with the wider noise, where it is in force
    std::optional<NoiseScale> tried;       ///< the noise that the other windows require
    bool widened = false;                  ///< it is in force
    std::array<FixRegime, regimes> fixes;  ///< positions
    std::vector<SolutionRow> motion;       ///< of a run with windows, some a second
    double seconds = 0.0;                  ///< wall time of it all

    [[nodiscard]] bool done() const { return why_not.empty(); }
    /// The wider noise is not in force after all.
    void keep_as_it_was();
    /// The worse of what judges the solution.
    [[nodiscard]] const Coverage& worst() const { return all && all->epochs.share() < coverage.epochs.share() ? *all : coverage; }
};

/// Judges `result`, the run of `data`. The log is walked twice side by side with the even and with the odd windows withheld; where less
/// than wanted_coverage of the epochs are inside, once more with the noise that one half of the windows asks for (on short logs, where
/// walks are cheap, up to three times until that half is covered), and the other half judges. Where that is truer `wider` has the
/// settings with which to repeat the run. A noise scale that is given stays.
[[nodiscard]] SelfCheck self_check(const LoadedDataset& data, const fusion::Result& result,
                                   std::optional<fusion::Settings>& wider);

/// Fixes of the undisturbed solution by how it moved: filled in for the run that is kept.
void judge_fixes(SelfCheck& check, const fusion::Result& result);

/// For people: what was withheld, coverage, growth of errors and sigmas, regimes.
[[nodiscard]] std::string self_check_table(const SelfCheck& check);

}  // namespace schuler::solution
