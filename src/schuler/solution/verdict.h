// Whether a solution may be trusted: concerns with their severity, and the verdict that follows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace schuler::solution {

/// In order: what it takes to be trusted falls.
enum class Gravity { None, Care, DoNotUse };

/// Something that is known of a run: a warning's topic or a finding of its own (evidence.h).
struct Concern {
    std::string id;
    std::string text;
};

struct SolutionVerdict {
    Gravity word = Gravity::Care;
    std::vector<std::string> reasons;  ///< the most severe first; of a trustworthy solution: the evidence for it
};

/// Its severity, by the one table of all topics; a topic that is not in it has none.
[[nodiscard]] Gravity gravity_of(std::string_view id);

/// The most severe of the concerns decides. Without evidence of its quality no solution is trustworthy: at least one concern must begin
/// with "evidence.".
[[nodiscard]] SolutionVerdict verdict_of(const std::vector<Concern>& concerns);

/// "trustworthy", "care", "do not use": of summary.json.
[[nodiscard]] std::string_view word_of(Gravity gravity);
/// "trustworthy", "usable with care", "do not use": for people.
[[nodiscard]] std::string_view words_of(Gravity gravity);
/// One line for the terminal.
[[nodiscard]] std::string line_of(const SolutionVerdict& verdict);

}  // namespace schuler::solution
