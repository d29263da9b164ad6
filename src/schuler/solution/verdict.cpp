#include "schuler/solution/verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace schuler::solution {
namespace {

struct Row {
    std::string_view begins;
    Gravity gravity;
};

/// Prefixes of topics of warnings and findings; the first match is used. Topics that only describe the data or their treatment
/// have no severity and are omitted.
constexpr std::array table{
    // about the solution (evidence.h)
    Row{"solution.sigma", Gravity::DoNotUse},    // zero or not a number
    Row{"solution.useless", Gravity::DoNotUse},  // too uncertain for most of the log, in spite of fixes
    Row{"solution.adrift", Gravity::Care},       // too uncertain for a while
    Row{"solution.heading", Gravity::Care},      // in motion, with unknown heading at the end
    Row{"truth.lost", Gravity::DoNotUse},        // simulated: far outside the sigmas most of the time
    Row{"truth.outside", Gravity::Care},
    // about the fixes
    Row{"gnss.rejected", Gravity::DoNotUse},      // more refused than used
    Row{"gnss.contradicted", Gravity::DoNotUse},  // the solution differs from the receiver's
    Row{"gnss.none", Gravity::Care},
    Row{"gnss.refused", Gravity::Care},
    Row{"gnss.outside", Gravity::Care},          // used, but outside their sigmas too often
    Row{"gnss.lost", Gravity::Care},             // refused over many consecutive seconds
    Row{"gnss.found_again", Gravity::Care},      // after a silence, where nothing foretold it
    Row{"gnss.latency", Gravity::Care},          // not known well enough for the speed
    Row{"gnss.explained", Gravity::Care},        // by larger receiver errors than assumed
    Row{"gnss.alert", Gravity::Care},            // the receiver was considered faulty
    Row{"gnss.unjudged", Gravity::Care},         // the solution became too tilted to judge it
    Row{"base.position.off", Gravity::Care},     // the base contradicts its position
    Row{"base.prediction", Gravity::Care},       // carrier phases: the inertial unit was knocked
    Row{"base.slips.many", Gravity::Care},       // carrier phases: more slips than receivers have
    Row{"gnss.jump", Gravity::Care},             // its positions moved to another level
    Row{"ranges.fault", Gravity::Care},          // a satellite or station was found faulty and left out
    Row{"navigation.lost", Gravity::Care},       // attitude and biases were re-estimated
    Row{"navigation.realigned", Gravity::Care},  // all of the initial state as well
    // about the other instruments
    Row{"instrument.refused", Gravity::Care},  // more than used
    // about the self-check
    Row{"self_check.failed", Gravity::DoNotUse},  // nine tenths or fewer inside three sigma
    Row{"self_check.low", Gravity::Care},
    Row{"self_check.growth", Gravity::Care},
    Row{"self_check.none", Gravity::Care},
    // about start-up and the logs (warnings)
    Row{"start.heading", Gravity::Care},
    Row{"forward.supposed", Gravity::Care},
    Row{"mounting", Gravity::Care},  // not found: forward is assumed
    Row{"loop.open", Gravity::Care},
    Row{"time.overlap", Gravity::Care},
    Row{"imu.saturated", Gravity::DoNotUse},  // so often that the log does not represent the motion
    Row{"imu.hole", Gravity::Care},
    Row{"legs.left_out", Gravity::Care},
    Row{"imu.stuck", Gravity::Care},
    Row{"gnss.frozen", Gravity::Care},
    Row{"gnss.strayed", Gravity::Care},
    Row{"gnss.height_off", Gravity::Care},
    Row{"contradiction.", Gravity::Care},
    Row{"gnss.fix.unknown", Gravity::Care},
    Row{"gnss.klobuchar", Gravity::Care},
    Row{"stations.unknown", Gravity::Care},
};

constexpr std::string_view evidence = "evidence.";

}  // namespace

Gravity gravity_of(std::string_view id) {
    const auto row = std::ranges::find_if(table, [&](const Row& r) { return id.starts_with(r.begins); });
    return row == table.end() ? Gravity::None : row->gravity;
}

SolutionVerdict verdict_of(const std::vector<Concern>& concerns) {
    SolutionVerdict verdict{Gravity::None, {}};
    const auto reasons = [&](Gravity gravity) {
        for (const Concern& c : concerns)
            if (gravity_of(c.id) == gravity) verdict.reasons.push_back(c.text);
    };
    for (const Concern& c : concerns) verdict.word = std::max(verdict.word, gravity_of(c.id));
    if (verdict.word != Gravity::None) {
        reasons(Gravity::DoNotUse);
        reasons(Gravity::Care);
        return verdict;
    }
    for (const Concern& c : concerns)
        if (c.id.starts_with(evidence)) verdict.reasons.push_back(c.text);
    if (!verdict.reasons.empty()) return verdict;
    return {Gravity::Care, {"no quality evidence available"}};
}

std::string_view word_of(Gravity gravity) {
    return gravity == Gravity::None ? "trustworthy" : gravity == Gravity::Care ? "care" : "do not use";
}

std::string_view words_of(Gravity gravity) { return gravity == Gravity::Care ? "usable with care" : word_of(gravity); }

std::string line_of(const SolutionVerdict& verdict) {
    std::string line(words_of(verdict.word));
    for (std::size_t i = 0; i < verdict.reasons.size() && i < 3; ++i) line += (i == 0 ? ": " : "; ") + verdict.reasons[i];
    if (verdict.reasons.size() > 3) line += fmt::format("; and {} more", verdict.reasons.size() - 3);
    return line;
}

}  // namespace schuler::solution
