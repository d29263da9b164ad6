// Trustworthiness of a solution: concerns with their severity, and the resulting verdict.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace schuler::solution {

/// In order of decreasing trust.
enum class Gravity { None, Care, DoNotUse };

/// Information about a run: the topic of a warning or a separate finding (evidence.h).
struct Concern {
    std::string id;
    std::string text;
};

struct SolutionVerdict {
    Gravity word = Gravity::Care;
    std::vector<std::string> reasons;  ///< the most severe first; for a trustworthy solution: the evidence for it
};

/// Its severity from the single table of all topics; none for a topic not in it.
[[nodiscard]] Gravity gravity_of(std::string_view id);

/// The most severe concern determines the verdict. Without evidence of its quality no solution is trustworthy: at least one
/// concern must begin with "evidence.".
[[nodiscard]] SolutionVerdict verdict_of(const std::vector<Concern>& concerns);

/// "trustworthy", "care", "do not use": in summary.json.
[[nodiscard]] std::string_view word_of(Gravity gravity);
/// "trustworthy", "usable with care", "do not use": for display.
[[nodiscard]] std::string_view words_of(Gravity gravity);
/// One line for the terminal.
[[nodiscard]] std::string line_of(const SolutionVerdict& verdict);

}  // namespace schuler::solution
