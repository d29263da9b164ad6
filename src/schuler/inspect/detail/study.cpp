#include "schuler/inspect/detail/study.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::inspect::detail {

void Study::found(std::string key, std::string value, double confidence, std::string why) {
    findings.push_back({std::move(key), std::move(value), confidence, std::move(why)});
}

void Study::problem(Level level, std::string text, std::string mend) {
    problems.push_back({level, std::move(text), std::move(mend)});
}

double Study::confidence_in(const std::string& key) const {
    const auto it = std::find_if(findings.begin(), findings.end(), [&](const Finding& f) { return f.key == key; });
    return it == findings.end() ? 0.0 : it->confidence;
}

void draft_columns(Study& study, const std::string& section, const LoadedFile& file, const std::vector<UnitChange>& units) {
    std::string columns, guesses;
    for (const auto& [canonical, name] : file.column_map)
        columns += fmt::format("{}{} = {}", columns.empty() ? "" : ", ", canonical, toml_string(name));
    if (!columns.empty()) study.draft.set(section, "columns", "{ " + columns + " }", "by the sizes of the numbers");
    for (const io::ColumnMatch& match : file.plan.matches) {
        if (match.certainty != io::Certainty::Guess || file.column_map.contains(match.canonical)) continue;
        guesses += fmt::format("{}{} as {}", guesses.empty() ? "" : ", ", match.file_name, match.canonical);
    }
    if (!guesses.empty()) study.draft.note(section, "taken by name: " + guesses);
    std::string scale, why;
    const auto add = [&](const std::string& key, double factor, const std::string& reason) {
        scale += fmt::format("{}{} = {:.10g}", scale.empty() ? "" : ", ", key, factor);
        if (why.find(reason) == std::string::npos) why += (why.empty() ? "" : "; ") + reason;
    };
    for (const UnitChange& unit : units)
        add(unit.key, unit.factor, fmt::format("{} {}: {}", unit.unit, how_sure(unit.confidence), unit.why));
    if (file.time_unit_judged) {
        const double factor = *file.time_unit_judged == io::TimeUnit::Milliseconds   ? 1e-3
                              : *file.time_unit_judged == io::TimeUnit::Microseconds ? 1e-6
                                                                                     : 1e-9;
        add("time_s", factor, "time unit by the steps");
    }
    if (!scale.empty()) study.draft.set(section, "scale", "{ " + scale + " }", why);
    for (const UnitChange& unit : units)
        study.found(section + ".scale." + unit.key, fmt::format("{:.10g} ({})", unit.factor, unit.unit), unit.confidence,
                    unit.why);
}

}  // namespace schuler::inspect::detail
