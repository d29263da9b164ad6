#include "schuler/settings/toml_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <fstream>
#include <sstream>

namespace schuler::settings {
namespace {

constexpr std::uintmax_t largest_file = 16u << 20;  // a settings file beyond this is something else

Value convert(const toml::node& node);

ValueTable convert_table(const toml::table& table) {
    ValueTable out;
    for (const auto& [key, node] : table) out.emplace_back(std::string(key.str()), convert(node));
    // toml++ sorts by name; the order of the file is what a reader of the messages expects
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

}  // namespace

ValueTable parse_toml(std::string_view text, const std::string& origin) {
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
    std::error_code ec;
    if (std::filesystem::is_directory(file, ec))
        throw input_error("is a directory, not a file", {name, 0, 0, {}}, "name the .toml file in it");
    if (!std::filesystem::exists(file, ec)) throw input_error("no such file", {name, 0, 0, {}}, "check the path");
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
