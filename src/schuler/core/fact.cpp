#include "schuler/core/fact.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace schuler {
namespace {

/// A key of an inline table: bare if permitted by TOML.
std::string key_text(const std::string& key) {
    const bool bare =
        !key.empty() && std::ranges::all_of(key, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; });
    return bare ? key : toml_text(key);
}

struct Writer {
    std::string operator()(bool x) const { return x ? "true" : "false"; }
    std::string operator()(double x) const { return fmt::format("{}", x == 0.0 ? 0.0 : x); }
    std::string operator()(const std::string& x) const { return toml_text(x); }
    template <class T>
    std::string operator()(const std::vector<T>& list) const {
        std::string out;
        for (const T& x : list) out += (out.empty() ? "" : ", ") + (*this)(x);
        return "[" + out + "]";
    }
    template <class T>
    std::string operator()(const std::map<std::string, T>& table) const {
        std::string out;
        for (const auto& [key, x] : table) out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", key_text(key), (*this)(x));
        return "{ " + out + " }";
    }
};

}  // namespace

std::string_view name_of(Known how) {
    switch (how) {
        case Known::Given: return "given";
        case Known::File: return "file";
        case Known::Found: return "found";
        case Known::Default: return "default";
    }
    return "";
}

std::string to_text(const FactValue& value) { return std::visit(Writer{}, value); }

std::string toml_text(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        const auto u = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') (out += '\\') += c;
        else if (u < 0x20 || u == 0x7f) out += fmt::format("\\u{:04X}", u);
        else out += c;
    }
    return out + "\"";
}

}  // namespace schuler
