#include "schuler/settings/toml_file.h"

#include "schuler/io/regular_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <sstream>

namespace schuler::settings {
namespace {

constexpr std::uintmax_t largest_file = 16u << 20;  // a larger file is not a settings file

Value convert(const toml::node& node);

ValueTable convert_table(const toml::table& table) {
    ValueTable out;
    for (const auto& [key, node] : table) out.emplace_back(std::string(key.str()), convert(node));
    // toml++ sorts by name; readers of the messages expect the order of the file
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.second.line < b.second.line; });
    return out;
}

template <class T>
std::string as_text(const T& x) {
    std::ostringstream stream;
    stream << x;
    return stream.str();
}

Value convert(const toml::node& node) {
    const long line = static_cast<long>(node.source().begin.line);
    switch (node.type()) {
        case toml::node_type::boolean: return {node.as_boolean()->get(), line};
        case toml::node_type::integer: return {std::int64_t{node.as_integer()->get()}, line};
        case toml::node_type::floating_point: return {node.as_floating_point()->get(), line};
        case toml::node_type::string: return {node.as_string()->get(), line};
        case toml::node_type::date: return {as_text(node.as_date()->get()), line};
        case toml::node_type::time: return {as_text(node.as_time()->get()), line};
        case toml::node_type::date_time: return {as_text(node.as_date_time()->get()), line};
        case toml::node_type::array: {
            ValueList list;
            for (const toml::node& item : *node.as_array()) list.push_back(convert(item));
            return {std::move(list), line};
        }
        default: return {convert_table(*node.as_table()), line};
    }
}

/// Position in `text` after the string that begins at `at`: basic or literal, single- or multi-line. An unclosed one ends with the text.
std::size_t after_string(std::string_view text, std::size_t at) {
    const char quote = text[at];
    const std::string_view fence = text.substr(at, 3);
    const bool many_lines = fence.size() == 3 && fence[1] == quote && fence[2] == quote;
    const std::string closing(many_lines ? 3 : 1, quote);
    for (std::size_t i = at + closing.size(); i < text.size(); ++i) {
        if (quote == '"' && text[i] == '\\') ++i;
        else if (text.substr(i, closing.size()) == closing) return i + closing.size();
        else if (!many_lines && text[i] == '\n') return i;
    }
    return text.size();
}

/// The parser recurses for each part of a dotted key, without limit: a stack overflow for a hostile file.
/// @throws Error(Input) if a key has more than `most_parts` parts
void check_dotted_keys(std::string_view text, const std::string& origin) {
    constexpr int most_parts = 32;  // settings have four
    int dots = 0;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (c == '"' || c == '\'') {
            i = after_string(text, i);
            continue;
        }
        if (c == '#') {
            i = std::min(text.find('\n', i), text.size());
            continue;
        }
        const bool part_of_key =
            std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == ' ' || c == '\t' || c == '.';
        dots = part_of_key ? dots + (c == '.' ? 1 : 0) : 0;
        if (dots >= most_parts) {
            const long line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(i), '\n');
            throw input_error(fmt::format("a key of more than {} parts", most_parts), {origin, line, 0, {}},
                              "settings have at most four: section.part.key");
        }
        ++i;
    }
}

}  // namespace

ValueTable parse_toml(std::string_view text, const std::string& origin) {
    check_dotted_keys(text, origin);
    try {
        return convert_table(toml::parse(text, origin));
    } catch (const toml::parse_error& e) {
        std::string what(e.description());
        for (char& c : what) {
            if (c == '\n' || c == '\r') c = ' ';
        }
        throw input_error(fmt::format("not valid TOML: {}", what), {origin, static_cast<long>(e.source().begin.line), 0, {}},
                          "see https://toml.io for the syntax; text needs \"quotes\"");
    }
}

ValueTable read_toml(const std::filesystem::path& file) {
    const std::string name = file.string();
    io::check_regular_file(file);
    std::error_code ec;
    const auto size = std::filesystem::file_size(file, ec);
    if (ec || size > largest_file)
        throw input_error("too large for a settings file", {name, 0, 0, {}}, "give a TOML file below 16 MB");
    std::ifstream stream(file, std::ios::binary);
    std::stringstream text;
    text << stream.rdbuf();
    if (!stream) throw input_error("cannot be read", {name, 0, 0, {}}, "check its permissions");
    return parse_toml(text.str(), name);
}

Value parse_toml_value(std::string_view text) {
    check_dotted_keys(text, "--set");
    try {
        const toml::table table = toml::parse(fmt::format("x = {}", text));
        if (table.size() == 1) {
            Value value = convert(*table.get("x"));
            value.line = 0;
            return value;
        }
    } catch (const toml::parse_error&) {  // not a TOML value: plain text, so that --set filter.scheme=loose needs no quotes
    }
    return {std::string(text), 0};
}

}  // namespace schuler::settings
