#include "schuler/settings/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace schuler::settings {
namespace {

std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
        switch (c) {
            case '"': out += "\\\""; break;
            case '\\': out += "\\\\"; break;
            case '\n': out += "\\n"; break;
            case '\t': out += "\\t"; break;
            case '\r': out += "\\r"; break;
            default:
                if (static_cast<unsigned char>(c) < 0x20) {
                    out += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
                } else {
                    out += c;
                }
        }
    }
    return out + '"';
}

std::string number_text(double x) {
    if (std::isnan(x)) return "nan";
    if (std::isinf(x)) return x > 0 ? "inf" : "-inf";
    std::string text = fmt::format("{}", x);
    if (text.find_first_of(".e") == std::string::npos) text += ".0";
    return text;
}

/// A number with more digits than a user would give was converted from another unit.
std::string rounded_text(double x) {
    constexpr std::ptrdiff_t most = 12;
    const std::string text = number_text(x);
    const auto digits = std::ranges::count_if(text.substr(0, text.find('e')), [](char c) { return c >= '0' && c <= '9'; });
    return digits <= most ? text : number_text(std::strtod(fmt::format("{:.6g}", x).c_str(), nullptr));
}

bool bare_key(const std::string& key) {
    return !key.empty() &&
           key.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-") == std::string::npos;
}

struct Writer {
    bool rounded = false;  ///< numbers with six digits

    std::string operator()(bool b) const { return b ? "true" : "false"; }
    std::string operator()(std::int64_t i) const { return fmt::format("{}", i); }
    std::string operator()(double x) const { return rounded && std::isfinite(x) ? rounded_text(x) : number_text(x); }
    std::string operator()(const std::string& s) const { return quoted(s); }
    std::string operator()(const ValueList& list) const {
        std::string out = "[";
        for (const Value& v : list) out += (out.size() > 1 ? ", " : "") + std::visit(*this, v.data);
        return out + "]";
    }
    std::string operator()(const ValueTable& table) const {
        std::string out = "{";
        for (const auto& [key, v] : table) {
            out += fmt::format("{}{} = {}", out.size() > 1 ? ", " : " ", bare_key(key) ? key : quoted(key),
                               std::visit(*this, v.data));
        }
        return out + (table.empty() ? "}" : " }");
    }
};

}  // namespace

double Value::number() const {
    if (const auto* i = integer()) return static_cast<double>(*i);
    return std::get<double>(data);
}

std::string_view kind_of(const Value& value) {
    switch (value.data.index()) {
        case 0: return "true or false";
        case 1: return "an integer";
        case 2: return "a number";
        case 3: return "text";
        case 4: return "a list";
        default: return "a table";
    }
}

std::string to_toml(const Value& value) { return std::visit(Writer{}, value.data); }

std::string shown(const Value& value) { return std::visit(Writer{.rounded = true}, value.data); }

}  // namespace schuler::settings
