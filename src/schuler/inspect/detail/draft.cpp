#include "schuler/inspect/detail/draft.h"

#include <fmt/format.h>

#include <algorithm>

namespace schuler::inspect::detail {

Draft::Section& Draft::section(const std::string& name) {
    const auto it = std::find_if(sections_.begin(), sections_.end(), [&](const Section& s) { return s.name == name; });
    if (it != sections_.end()) return *it;
    sections_.push_back({name, {}});
    return sections_.back();
}

void Draft::set(const std::string& section_name, const std::string& key, const std::string& value, const std::string& comment,
                bool active) {
    section(section_name).lines.push_back({key, value, comment, active});
}

void Draft::note(const std::string& section_name, const std::string& text) {
    section(section_name).lines.push_back({"", "", text, true});
}

void Draft::leave_out(const std::string& section_name) { section(section_name).left_out = true; }

bool Draft::has(const std::string& name) const {
    return std::any_of(sections_.begin(), sections_.end(), [&](const Section& s) { return s.name == name; });
}

std::string Draft::text() const {
    std::string out =
        "# Drafted by schuler inspect from the data alone. Each line says how sure it is; change what you know better.\n";
    for (const Section& s : sections_) {
        if (s.lines.empty()) continue;
        if (!s.name.empty()) out += fmt::format("\n{}[{}]\n", s.left_out ? "# " : "", s.name);
        std::size_t width = 0;
        for (const Line& line : s.lines) {
            const std::size_t w = line.key.size() + line.value.size() + (line.active && !s.left_out ? 3 : 5);
            if (!line.key.empty() && w <= 44) width = std::max(width, w);
        }
        for (const Line& line : s.lines) {
            if (line.key.empty()) {
                out += fmt::format("# {}\n", line.comment);
                continue;
            }
            const std::string entry = fmt::format("{}{} = {}", line.active && !s.left_out ? "" : "# ", line.key, line.value);
            out += line.comment.empty() ? entry + "\n" : fmt::format("{:<{}}  # {}\n", entry, width, line.comment);
        }
    }
    return out;
}

const char* how_sure(double confidence) {
    if (confidence >= 0.95) return "sure";
    if (confidence >= 0.8) return "likely";
    if (confidence >= 0.6) return "probably";
    return "a guess";
}

std::string toml_string(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto u = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            (out += '\\') += c;
        else if (u < 0x20 || u == 0x7f)
            out += fmt::format("\\u{:04X}", u);
        else
            out += c;
    }
    return out + "\"";
}

}  // namespace schuler::inspect::detail
