#include "schuler/settings/option_table.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>

namespace schuler::settings {
namespace {

/// Optimal string alignment distance: insertion, deletion, replacement, transposition of neighbours.
std::size_t distance(std::string_view a, std::string_view b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + change});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    }
    return d[a.size()][b.size()];
}

std::string_view last_part(std::string_view key) {
    const auto dot = key.rfind('.');
    return dot == std::string_view::npos ? key : key.substr(dot + 1);
}

/// True for the same words up to abbreviation: latitude_deg and lat_deg.
bool abbreviates(std::string_view a, std::string_view b) {
    while (!a.empty() && !b.empty()) {
        const std::string_view x = a.substr(0, a.find('_')), y = b.substr(0, b.find('_'));
        const std::size_t common = std::min(x.size(), y.size());
        if (x.substr(0, common) != y.substr(0, common) || (x.size() != y.size() && common < 3)) return false;
        a.remove_prefix(std::min(a.size(), x.size() + 1));
        b.remove_prefix(std::min(b.size(), y.size() + 1));
    }
    return a.empty() && b.empty();
}

/// Letters and digits in lower case.
std::string bare(std::string_view name) {
    std::string out;
    for (const char c : name)
        if (c != '-' && c != '_' && c != ' ') out += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out;
}

void check_number(const OptionSpec& spec, const Value& value, const SourcePlace& place) {
    if (!value.is_number() || (spec.shape == Shape::Integer && value.integer() == nullptr)) {
        if (value.text() != nullptr && place.file.starts_with("-"))  // a word of the command line
            throw input_error(fmt::format("\"{}\" is not {}", *value.text(), accepted_form(spec)), place,
                              fmt::format("give {}", accepted_form(spec)));
        throw input_error(fmt::format("is {}, expected {}", kind_of(value), accepted_form(spec)), place,
                          value.text() != nullptr ? "write it without quotes" : fmt::format("give {}", accepted_form(spec)));
    }
    const double x = value.number();
    if (!std::isfinite(x) && !(x >= spec.low && x <= spec.high))
        throw input_error(fmt::format("{} is out of range: not a finite number", to_toml(value)), place,
                          fmt::format("give {}", accepted_form(spec)));
    if (!(x >= spec.low && x <= spec.high)) {
        throw input_error(fmt::format("{} is out of range", to_toml(value)), place, fmt::format("give {}", accepted_form(spec)));
    }
}

[[noreturn]] void wrong_kind(const OptionSpec& spec, const Value& value, const SourcePlace& place) {
    throw input_error(fmt::format("is {}, expected {}", kind_of(value), accepted_form(spec)), place,
                      fmt::format("give {}", accepted_form(spec)));
}

void check_text(const OptionSpec& spec, const Value& value, const SourcePlace& place) {
    if (value.text() == nullptr) wrong_kind(spec, value, place);
    const std::string& text = *value.text();
    const bool known = std::ranges::any_of(
        spec.choices, [&](const std::string& c) { return c == text || (spec.any_spelling && bare(c) == bare(text)); });
    if (spec.choices.empty() || known) return;
    throw input_error(fmt::format("unknown value \"{}\"", text), place, fmt::format("use {}", accepted_form(spec)));
}

const OptionSpec* find_spec(const std::vector<OptionSpec>& known, std::string_view key) {
    const auto it = std::ranges::find(known, key, &OptionSpec::key);
    return it == known.end() ? nullptr : &*it;
}

bool is_section(const std::vector<OptionSpec>& known, const std::string& key) {
    return std::ranges::any_of(known, [&](const OptionSpec& s) { return s.key.starts_with(key + "."); });
}

[[noreturn]] void unknown_key(const std::string& key, const SourcePlace& place, const std::vector<OptionSpec>& known) {
    std::vector<std::string> names;
    for (const OptionSpec& s : known) {
        names.push_back(s.key);
        const auto dot = s.key.find('.');
        if (dot != std::string::npos && std::ranges::find(names, s.key.substr(0, dot)) == names.end())
            names.push_back(s.key.substr(0, dot));
    }
    const std::string near = nearest_key(key, names);
    throw input_error("unknown key", place,
                      near.empty() ? "`schuler help settings` and `schuler help scenario` list the known keys"
                                   : fmt::format("did you mean {}?", near));
}

void flatten_into(const ValueTable& table, const std::string& prefix, const std::string& file,
                  const std::vector<OptionSpec>& known, SettingList& out) {
    for (const auto& [name, value] : table) {
        const std::string key = prefix.empty() ? name : prefix + "." + name;
        const SourcePlace place{file, value.line, 0, key};
        if (find_spec(known, key) != nullptr) {
            out.push_back({key, value, place});
        } else if (is_section(known, key)) {
            if (value.table() == nullptr)
                throw input_error(fmt::format("is {}, expected a section", kind_of(value)), place,
                                  fmt::format("write [{}] on a line of its own", key));
            flatten_into(*value.table(), key, file, known, out);
        } else {
            unknown_key(key, place, known);
        }
    }
}

}  // namespace

std::string range_text(const OptionSpec& spec) {
    constexpr double huge = 1e9;  // a bound that merely excludes nonsense is not shown
    const bool low = spec.low > -huge, high = spec.high < huge;
    if (low && high) return fmt::format(" from {} to {}", spec.low, spec.high);
    if (low) return fmt::format(" of at least {}", spec.low);
    if (high) return fmt::format(" of at most {}", spec.high);
    return {};
}

std::string accepted_form(const OptionSpec& spec) {
    if (!spec.form.empty()) return spec.form;
    switch (spec.shape) {
        case Shape::Number: return "a number" + range_text(spec);
        case Shape::Integer: return "an integer" + range_text(spec);
        case Shape::Flag: return "true or false";
        case Shape::Numbers:
            return spec.length > 0 ? fmt::format("a list of {} numbers{}", spec.length, range_text(spec))
                                   : "a list of numbers" + range_text(spec);
        case Shape::Texts:
            return spec.choices.empty() ? "a list of texts" : fmt::format("a list out of {}", fmt::join(spec.choices, ", "));
        case Shape::Table: return "a table { name = value, ... }";
        case Shape::Tables: return "tables [[...]]";
        case Shape::Any: return "a value";
        case Shape::Text: break;
    }
    if (spec.choices.empty()) return "text";
    std::string out;
    for (std::size_t i = 0; i < spec.choices.size(); ++i) {
        out += fmt::format("{}\"{}\"", i == 0 ? "" : (i + 1 == spec.choices.size() ? " or " : ", "), spec.choices[i]);
    }
    return out;
}

void check_value(const OptionSpec& spec, const Value& value, const SourcePlace& place) {
    switch (spec.shape) {
        case Shape::Number:
        case Shape::Integer: check_number(spec, value, place); return;
        case Shape::Flag:
            if (value.flag() == nullptr) wrong_kind(spec, value, place);
            return;
        case Shape::Text: check_text(spec, value, place); return;
        case Shape::Numbers:
        case Shape::Texts: {
            if (value.list() == nullptr) wrong_kind(spec, value, place);
            OptionSpec item = spec;
            item.shape = spec.shape == Shape::Numbers ? Shape::Number : Shape::Text;
            for (const Value& v : *value.list()) check_value(item, v, place);
            if (spec.length > 0 && value.list()->size() != spec.length) {
                throw input_error(fmt::format("has {} numbers", value.list()->size()), place,
                                  fmt::format("give {}", accepted_form(spec)));
            }
            return;
        }
        case Shape::Table:
            if (value.table() == nullptr) wrong_kind(spec, value, place);
            return;
        case Shape::Tables:
            if (value.list() == nullptr) wrong_kind(spec, value, place);
            for (const Value& v : *value.list()) {
                if (v.table() == nullptr) wrong_kind(spec, v, place);
            }
            return;
        case Shape::Any: return;
    }
}

std::string nearest_key(std::string_view key, const std::vector<std::string>& known) {
    std::string best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (const std::string& candidate : known) {
        double cost = static_cast<double>(distance(key, candidate));
        // the same name in another section, or without its unit: cheaper than the differing letters
        if (last_part(key) == last_part(candidate)) cost = std::min(cost, 2.5);
        if (abbreviates(key, candidate)) cost = std::min(cost, 2.25);
        if (candidate.size() > key.size() && candidate.starts_with(key) && candidate[key.size()] == '_')
            cost = std::min(cost, 1.5);
        if (candidate.size() > key.size()) {
            cost = std::min(cost, static_cast<double>(distance(key, std::string_view(candidate).substr(0, key.size()))) + 1.75);
        }
        if (cost < best_cost) {
            best_cost = cost;
            best = candidate;
        }
    }
    const double far = std::max(3.0, 0.4 * static_cast<double>(last_part(key).size()));
    return best_cost <= far ? best : std::string();
}

double in_unit(double si, double factor) {
    const double quotient = si / factor;
    if (!std::isfinite(quotient) || quotient == 0.0) return quotient;
    for (int digits = 1; digits <= 17; ++digits) {
        const double x = std::strtod(fmt::format("{:.{}e}", quotient, digits - 1).c_str(), nullptr);
        if (x * factor == si) return x;
    }
    double below = quotient, above = quotient;
    for (int i = 0; i < 4; ++i) {
        below = std::nextafter(below, -std::numeric_limits<double>::infinity());
        above = std::nextafter(above, std::numeric_limits<double>::infinity());
        if (below * factor == si) return below;
        if (above * factor == si) return above;
    }
    return quotient;
}

SettingList flatten(const ValueTable& root, const std::string& file, const std::vector<OptionSpec>& known) {
    SettingList out;
    flatten_into(root, {}, file, known, out);
    return out;
}

std::string to_toml(const SettingList& settings, const std::vector<OptionSpec>& known, bool comments) {
    // TOML requires keys without a section first and every section once
    std::vector<std::string> sections{""};
    const auto section_of = [](const std::string& key) {
        return key.find('.') == std::string::npos ? std::string() : key.substr(0, key.find('.'));
    };
    for (const Setting& s : settings) {
        if (std::ranges::find(sections, section_of(s.key)) == sections.end()) sections.push_back(section_of(s.key));
    }
    std::string out, tables;
    for (const std::string& section : sections) {
        if (!section.empty()) out += fmt::format("\n[{}]\n", section);
        for (const Setting& s : settings) {
            if (section_of(s.key) != section) continue;
            const OptionSpec* spec = find_spec(known, s.key);
            if (spec != nullptr && spec->shape == Shape::Tables && section.empty()) {
                for (const Value& item : *s.value.list()) {
                    tables += fmt::format("\n[[{}]]\n", s.key);
                    for (const auto& [name, v] : *item.table()) tables += fmt::format("{} = {}\n", name, to_toml(v));
                }
                continue;
            }
            const std::string name = section.empty() ? s.key : s.key.substr(section.size() + 1);
            const std::string line = fmt::format("{} = {}", name, to_toml(s.value));
            out += comments && spec != nullptr ? fmt::format("{:<40} # {}\n", line, spec->help) : line + "\n";
        }
    }
    return out + tables;
}

std::string listing(const std::vector<OptionSpec>& known, const SettingList& defaults, std::string_view prefix) {
    std::string out;
    for (const OptionSpec& spec : known) {
        if (!spec.key.starts_with(prefix)) continue;
        const auto it = std::ranges::find(defaults, spec.key, &Setting::key);
        const std::string text = it == defaults.end() ? "none" : shown(it->value);
        const std::string applies = spec.applies.empty() ? "" : "; applies to: " + spec.applies;
        out += fmt::format("  {}\n      {}\n      {}{}; default {}{}\n", spec.key, spec.help, accepted_form(spec),
                           spec.unit.empty() ? "" : ", in " + spec.unit, text, applies);
    }
    return out;
}

}  // namespace schuler::settings
