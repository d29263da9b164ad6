// The self-check of `process`: fixes withheld in windows of its own, the sigmas judged by them, and the noise of the inertial unit
// widened where they are too small.
#pragma once

#include "schuler/app/coverage.h"
#include "schuler/app/dataset.h"
#include "schuler/fusion/run_filter.h"

#include <array>
#include <optional>
#include <string>

namespace schuler::app {

/// The undisturbed solution at its fixes in one regime.
struct FixRegime {
    std::size_t fixes = 0, refused = 0;
    Inside inside;      ///< three sigma of the innovation, refused ones too
    double nis = 0.0;   ///< mean normalised innovation squared of a component, of those used
};

struct SelfCheck {
    std::string why_not;                    ///< empty: it was done
    double length = 0.0;                    ///< s, of the windows
    Coverage coverage;                      ///< of the solution as it is, in windows that had no part in widening
    std::optional<Coverage> before;         ///< of the same windows without the wider noise, where it was tried
    std::optional<NoiseScale> tried;        ///< what the other windows asked for
    bool widened = false;                   ///< it is in force
    bool one_sided = false;                 ///< the half of the windows that was asked first had nothing to ask for
    std::array<FixRegime, regimes> fixes;   ///< positions
    double seconds = 0.0;                   ///< wall time of it all

    [[nodiscard]] bool done() const { return why_not.empty(); }
};

/// Judges `result`, the run of `data`. Each of the two further passes walks the log once, or twice side by side: first with the even and
/// with the odd windows withheld; then, where less than wanted_coverage of the epochs are inside, with the noise that one half of the
/// windows asks for, the other half withheld; beside it the run that `result` is, which replaces it in `widened` where the noise made the
/// sigmas truer. `output_rate`, `rows`: of that run (see fusion::run_filter). A noise scale that is given stays.
[[nodiscard]] SelfCheck self_check(const LoadedDataset& data, const fusion::Result& result, double output_rate,
                                   const fusion::RowSink& rows, std::optional<fusion::Result>& widened);

/// For people: what was withheld, coverage, growth of errors and sigmas, regimes.
[[nodiscard]] std::string self_check_table(const SelfCheck& check);

}  // namespace schuler::app
