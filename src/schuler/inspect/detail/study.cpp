#include "schuler/inspect/detail/study.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::inspect::detail {

void Study::found(std::string key, std::string value, double confidence, std::string why) {
    findings.push_back({std::move(key), std::move(value), confidence, std::move(why)});
}

void Study::problem(Level level, std::string text, std::string hint) {
    problems.push_back({level, std::move(text), std::move(hint)});
}

void Study::states(std::string key, FactValue value, std::string note, Known how) {
    Fact& fact = stated.emplace_back();
    fact.key = std::move(key);
    fact.value = std::move(value);
    fact.how = how;
    fact.note = std::move(note);
}

void Study::contradicts(std::string key, std::string text) {
    contradictions.push_back({std::move(key), std::move(text), false, {}, not_given});
}

void Study::refutes(std::string key, std::string text, std::optional<FactValue> better, double sigma) {
    contradictions.push_back({std::move(key), std::move(text), true, std::move(better), sigma});
}

double Study::confidence_in(const std::string& key) const {
    const auto it = std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.key == key; });
    return it == findings.end() ? 0.0 : it->confidence;
}

void draft_columns(Study& study, const std::string& section, const LoadedFile& file, const std::vector<UnitChange>& units) {
    std::string guesses;
    if (!file.column_map.empty()) study.draft.set(section, "columns", file.column_map, "by the sizes of the numbers");
    for (const io::ColumnMatch& match : file.plan.matches) {
        if (match.certainty != io::Certainty::Guess || file.column_map.contains(match.canonical)) continue;
        guesses += fmt::format("{}{} as {}", guesses.empty() ? "" : ", ", match.file_name, match.canonical);
    }
    if (!guesses.empty()) study.draft.note(section, "taken by name: " + guesses);
    std::map<std::string, double> scale;
    std::string why;
    const auto add = [&](const std::string& key, double factor, const std::string& reason) {
        if (file.as.overrides.scale.contains(key)) {
            study.contradicts(fmt::format("{}.scale", section), fmt::format("{} = {} is given; the data show {:.6g} ({})", key,
                                                                            file.as.overrides.scale.at(key), factor, reason));
            return;
        }
        scale[key] = std::stod(fmt::format("{:.10g}", factor));  // as written
        if (why.find(reason) == std::string::npos) why += (why.empty() ? "" : "; ") + reason;
    };
    // in a described data set, a name with a wrong unit must be corrected by the user: the run rejects it
    for (const UnitChange& unit : units)
        if (!unit.against_name || study.given.find_logs || file.as.overrides.scale.contains(unit.key))
            add(unit.key, unit.factor, fmt::format("{} {}: {}", unit.unit, how_sure(unit.confidence), unit.why));
    if (file.time_unit_judged) {
        const double factor = *file.time_unit_judged == io::TimeUnit::Milliseconds   ? 1e-3
                              : *file.time_unit_judged == io::TimeUnit::Microseconds ? 1e-6
                                                                                     : 1e-9;
        add("time_s", factor, "time unit by the steps");
    }
    if (!scale.empty()) study.draft.set(section, "scale", scale, why);
    for (const UnitChange& unit : units)
        study.found(section + ".scale." + unit.key, fmt::format("{:.10g} ({})", unit.factor, unit.unit), unit.confidence,
                    unit.why);
}

}  // namespace schuler::inspect::detail
