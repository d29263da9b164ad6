#include "serve/names.h"

#include "serve/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;

/// Well-formed UTF-8 without surrogates and overlong forms.
bool is_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = [&](std::size_t k) { return k < text.size() ? static_cast<unsigned char>(text[k]) : 0u; };
        const unsigned first = byte(i);
        const std::size_t length = first < 0x80                    ? 1
                                   : first >= 0xc2 && first < 0xe0 ? 2
                                   : first >= 0xe0 && first < 0xf0 ? 3
                                   : first >= 0xf0 && first < 0xf5 ? 4
                                                                   : 0;
        if (length == 0) return false;
        for (std::size_t k = 1; k < length; ++k)
            if ((byte(i + k) & 0xc0u) != 0x80u) return false;
        const unsigned second = byte(i + 1);
        if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) || (first == 0xf0 && second < 0x90) ||
            (first == 0xf4 && second > 0x8f))
            return false;
        i += length;
    }
    return true;
}

bool leads_out(std::string_view text) {
    if (text.empty()) return false;
    if (text.front() == '/' || text.front() == '~' || text.find('$') != std::string_view::npos) return true;
    if (text.find('\\') != std::string_view::npos) return true;
    for (const fs::path& part : fs::path(text))
        if (part == "..") return true;
    return false;
}

void check_value_of_file(const settings::Value& value, const settings::Setting& setting) {
    if (value.list() != nullptr) {
        for (const settings::Value& item : *value.list()) check_value_of_file(item, setting);
    } else if (value.text() != nullptr && leads_out(*value.text())) {
        throw Refusal{422, fmt::format("{} = \"{}\" leads out of the data set's folder", setting.key, *value.text()),
                      "upload the file with the others and give its name alone", setting.key, setting.place.line};
    }
}

}  // namespace

bool is_file_name(std::string_view name) {
    if (name.empty() || name.size() > 120 || name.front() == '.') return false;
    const bool clean = std::ranges::none_of(name, [](unsigned char c) { return c < 0x20 || c == 0x7f || c == '/' || c == '\\'; });
    return clean && is_utf8(name);
}

std::string folder_name(std::string_view title) {
    std::string out;
    for (const unsigned char c : title) {
        if (std::isalnum(c) != 0 && c < 0x80) out += static_cast<char>(std::tolower(c));
        else if (!out.empty() && out.back() != '-') out += '-';
        if (out.size() >= 40) break;
    }
    while (!out.empty() && out.back() == '-') out.pop_back();
    return out.empty() ? "run" : out;
}

fs::path inside(const fs::path& folder, const std::string& name) {
    if (!is_file_name(name)) {
        throw Refusal{400, "not a usable name", "a name has 1 to 120 bytes of UTF-8, no / or \\ and no leading dot"};
    }
    const fs::path path = folder / name;
    std::error_code ec;
    const fs::path real = fs::weakly_canonical(path, ec), home = fs::weakly_canonical(folder, ec);
    if (ec || real.parent_path() != home) throw Refusal{404, fmt::format("{}: there is no such file here", name)};
    return path;
}

void check_file_settings(const settings::SettingList& settings) {
    for (const settings::Setting& s : settings) check_value_of_file(s.value, s);
}

void check_project_text(std::string_view text, const std::string& file) {
    long line = 1;
    for (std::size_t begin = 0; begin <= text.size(); ++line) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        std::string_view value = text.substr(begin, end - begin);
        value = value.substr(0, value.find('#'));
        const std::size_t colon = value.find(':');
        value = colon == std::string_view::npos ? std::string_view() : value.substr(colon + 1);
        while (!value.empty() && (value.front() == ' ' || value.front() == '"' || value.front() == '\'' || value.front() == '\t'))
            value.remove_prefix(1);
        if (leads_out(value)) {
            throw Refusal{422,
                          fmt::format("{}, line {}: leads out of the data set's folder", file, line),
                          "upload the files with it and give their names alone",
                          {},
                          line};
        }
        begin = end + 1;
    }
}

}  // namespace schuler::serve
