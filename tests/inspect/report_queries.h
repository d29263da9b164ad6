// Questions tests ask of a report.
#pragma once

#include "schuler/inspect/inspect.h"

#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>
#include <string>

namespace schuler::inspect::test {

// The pointers below point into the report, which must therefore have a name.
inline const Finding* finding(const InspectReport&&, const std::string&) = delete;
inline const Fact* fact(const InspectReport&&, const std::string&) = delete;
inline const FileReport* file_named(const InspectReport&&, const std::string&) = delete;

inline const Finding* finding(const InspectReport& report, const std::string& key) {
    for (const Finding& f : report.findings) {
        if (f.key == key) return &f;
    }
    return nullptr;
}
inline const Fact* fact(const InspectReport& report, const std::string& key) {
    for (const Fact& f : report.facts) {
        if (f.key == key) return &f;
    }
    return nullptr;
}
inline std::string value_of(const InspectReport& report, const std::string& key) {
    const Finding* f = finding(report, key);
    return f == nullptr ? "(not found)" : f->value;
}
/// The number a value starts with; NaN where it is absent.
inline double number_of(const InspectReport& report, const std::string& key) {
    const Finding* f = finding(report, key);
    return f == nullptr ? std::nan("") : std::strtod(f->value.c_str(), nullptr);
}
inline const FileReport* file_named(const InspectReport& report, const std::string& path) {
    for (const FileReport& f : report.files) {
        if (f.path == path) return &f;
    }
    return nullptr;
}
/// Does any problem of the set or of a file at this level contain the text?
inline bool has_problem(const InspectReport& report, Level level, const std::string& text) {
    const auto in = [&](const std::vector<Problem>& problems) {
        for (const Problem& p : problems) {
            if (p.level == level && p.text.find(text) != std::string::npos) return true;
        }
        return false;
    };
    for (const FileReport& f : report.files) {
        if (in(f.problems)) return true;
    }
    return in(report.problems);
}
/// "section.key = value" of every active line of the draft, comments removed.
inline std::set<std::string> settings_of(const std::string& toml) {
    std::set<std::string> all;
    std::istringstream in(toml);
    std::string section;
    for (std::string line; std::getline(in, line);) {
        bool quoted = false;
        std::string bare;
        for (const char c : line) {
            if (c == '"') quoted = !quoted;
            if (c == '#' && !quoted) break;
            bare += c;
        }
        while (!bare.empty() && bare.back() == ' ') bare.pop_back();
        if (bare.empty()) continue;
        if (bare.front() == '[') section = bare.substr(1, bare.size() - 2) + ".";
        else all.insert(section + bare);
    }
    return all;
}
inline bool sets(const InspectReport& report, const std::string& setting) {
    return settings_of(report.dataset_toml).contains(setting);
}

}  // namespace schuler::inspect::test
