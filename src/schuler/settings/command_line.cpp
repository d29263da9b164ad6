#include "schuler/settings/command_line.h"

#include "schuler/settings/toml_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>

namespace schuler::settings {
namespace {

template <class T>
Value number_or_text(const std::string& word) {
    const std::string_view digits = std::string_view(word).substr(word.starts_with('+') ? 1 : 0);
    T x{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), x);
    return error == std::errc{} && end == digits.data() + digits.size() && !digits.empty() ? Value{x} : Value{word};
}

/// Lists may be written as several words or with commas.
std::vector<std::string> parts_of(const std::vector<std::string>& words) {
    std::vector<std::string> out;
    for (const std::string& word : words) {
        std::size_t begin = 0;
        while (begin <= word.size()) {
            const std::size_t end = std::min(word.find(',', begin), word.size());
            out.push_back(word.substr(begin, end - begin));
            begin = end + 1;
        }
    }
    return out;
}

std::string word_of(const Value& value) {
    if (value.text() != nullptr) return *value.text();
    return value.is_number() && value.integer() == nullptr ? fmt::format("{}", value.number()) : to_toml(value);
}

}  // namespace

Value value_from_words(const OptionSpec& spec, const std::vector<std::string>& words) {
    const std::string& word = words.front();
    ValueList list;
    switch (spec.shape) {
        case Shape::Number: return number_or_text<double>(word);
        case Shape::Integer: return number_or_text<std::int64_t>(word);
        case Shape::Flag: return word == "true" ? Value{true} : word == "false" ? Value{false} : Value{word};
        case Shape::Text: return {word};
        case Shape::Numbers:
            for (const std::string& part : parts_of(words)) list.push_back(number_or_text<double>(part));
            return {std::move(list)};
        case Shape::Texts:
            for (const std::string& part : spec.line.repeated ? words : parts_of(words)) list.push_back({part});
            return {std::move(list)};
        default: return parse_toml_value(word);
    }
}

std::vector<std::string> words_from_value(const OptionSpec& spec, const Value& value) {
    const std::string name = "--" + spec.key;
    if (spec.shape == Shape::Flag)
        return value.flag() != nullptr && *value.flag() ? std::vector<std::string>{name} : std::vector<std::string>{};
    if (spec.line.positional) return {word_of(value)};
    const ValueList* list = value.list();
    if (list == nullptr) return {name, word_of(value)};
    std::vector<std::string> out, items;
    for (const Value& item : *list) items.push_back(word_of(item));
    if (items.empty()) return {};
    if (spec.line.repeated) {
        for (const std::string& item : items) out.insert(out.end(), {name, item});
        return out;
    }
    if (spec.length > 0) {
        out.push_back(name);
        out.insert(out.end(), items.begin(), items.end());
        return out;
    }
    return {name, fmt::format("{}", fmt::join(items, ","))};
}

std::string value_name_of(const OptionSpec& spec) {
    if (spec.shape == Shape::Flag) return {};
    if (!spec.line.value_name.empty()) return spec.line.value_name;
    std::string out;
    for (const char c : spec.unit) out += c == '/' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return out.empty() ? "NUMBER" : out;
}

std::string help_of(const OptionSpec& spec, const SettingList& defaults) {
    std::string out = spec.help;
    if (!spec.applies.empty()) out += fmt::format(" ({})", spec.applies);
    const bool numbers = spec.shape == Shape::Number || spec.shape == Shape::Integer || spec.shape == Shape::Numbers;
    if (numbers && !range_text(spec).empty()) out += "; " + accepted_form(spec);
    const auto usual = std::ranges::find(defaults, spec.key, &Setting::key);
    if (!spec.otherwise.empty()) return out + "; default: " + spec.otherwise;
    if (usual == defaults.end() || spec.shape == Shape::Flag) return out;
    if (spec.shape == Shape::Numbers) return out;
    return out + "; default: " + word_of(usual->value);
}

}  // namespace schuler::settings
