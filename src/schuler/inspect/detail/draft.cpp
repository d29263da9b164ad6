#include "schuler/inspect/detail/draft.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace schuler::inspect::detail {

Draft::Section& Draft::section(const std::string& name) {
    const auto it = std::find_if(sections_.begin(), sections_.end(), [&](const Section& s) { return s.name == name; });
    if (it != sections_.end()) return *it;
    sections_.push_back({name, {}});
    return sections_.back();
}

void Draft::set(const std::string& section_name, const std::string& key, FactValue value, const std::string& comment, bool active,
                Known how, double sigma) {
    section(section_name).lines.push_back({key, std::move(value), comment, active, how, sigma});
}

void Draft::note(const std::string& section_name, const std::string& text) {
    section(section_name).lines.push_back({"", "", text});
}

void Draft::leave_out(const std::string& section_name) { section(section_name).left_out = true; }

bool Draft::has(const std::string& name) const {
    return std::any_of(sections_.begin(), sections_.end(), [&](const Section& s) { return s.name == name; });
}

std::string Draft::text() const {
    std::string out =
        "# Drafted by schuler inspect from the data alone. Each line states its confidence; correct what you know better.\n";
    for (const Section& s : sections_) {
        if (s.lines.empty()) continue;
        if (!s.name.empty()) out += fmt::format("\n{}[{}]\n", s.left_out ? "# " : "", s.name);
        std::size_t width = 0;
        for (const Line& line : s.lines) {
            const std::size_t w = line.key.size() + to_text(line.value).size() + (line.active && !s.left_out ? 3 : 5);
            if (!line.key.empty() && w <= 44) width = std::max(width, w);
        }
        for (const Line& line : s.lines) {
            if (line.key.empty()) {
                out += fmt::format("# {}\n", line.comment);
                continue;
            }
            const std::string entry =
                fmt::format("{}{} = {}", line.active && !s.left_out ? "" : "# ", line.key, to_text(line.value));
            out += line.comment.empty() ? entry + "\n" : fmt::format("{:<{}}  # {}\n", entry, width, line.comment);
        }
    }
    return out;
}

std::vector<Fact> Draft::facts() const {
    std::vector<Fact> facts;
    for (const Section& s : sections_) {
        for (const Line& line : s.lines) {
            if (line.key.empty() || !line.active || s.left_out) continue;
            Fact fact;
            fact.key = s.name.empty() ? line.key : s.name + "." + line.key;
            fact.value = line.value;
            fact.how = line.how;
            fact.sigma = line.sigma;
            fact.note = line.comment;
            facts.push_back(std::move(fact));
        }
    }
    return facts;
}

const char* how_sure(double confidence) {
    if (confidence >= 0.95) return "sure";
    if (confidence >= 0.8) return "likely";
    if (confidence >= 0.6) return "probably";
    return "a guess";
}

}  // namespace schuler::inspect::detail
