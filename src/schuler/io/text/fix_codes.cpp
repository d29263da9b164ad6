#include "schuler/io/text/fix_codes.h"

#include "schuler/io/place.h"
#include "schuler/io/text/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace schuler::io {
namespace {

struct Word {
    std::string_view text;
    FixType fix;
};

constexpr std::array words = {
    Word{"none", FixType::None},
    Word{"no", FixType::None},
    Word{"nofix", FixType::None},
    Word{"no_fix", FixType::None},
    Word{"invalid", FixType::None},
    Word{"no_solution", FixType::None},
    Word{"autonomous", FixType::Autonomous},
    Word{"single", FixType::Autonomous},
    Word{"spp", FixType::Autonomous},
    Word{"3d", FixType::Autonomous},
    Word{"is3d", FixType::Autonomous},
    Word{"2d", FixType::Autonomous},
    Word{"is2d", FixType::Autonomous},
    Word{"gps", FixType::Autonomous},
    Word{"standalone", FixType::Autonomous},
    Word{"pps", FixType::Autonomous},
    Word{"differential", FixType::Differential},
    Word{"dgps", FixType::Differential},
    Word{"dgnss", FixType::Differential},
    Word{"diff", FixType::Differential},
    Word{"sbas", FixType::Differential},
    Word{"ppp", FixType::Differential},
    Word{"rtk_fixed", FixType::RtkFixed},
    Word{"fixed", FixType::RtkFixed},
    Word{"fix", FixType::RtkFixed},
    Word{"rtk", FixType::RtkFixed},
    Word{"rtk_fix", FixType::RtkFixed},
    Word{"narrow_int", FixType::RtkFixed},
    Word{"rtk_float", FixType::RtkFloat},
    Word{"float", FixType::RtkFloat},
    Word{"narrow_float", FixType::RtkFloat},
    Word{"unknown", FixType::Unknown},
};

/// Codes written in a name: every word that has one digit in front of letters ("rtk1fix", "2float", "3is3d").
std::map<int, FixType> codes_in_name(const std::vector<std::string>& name_words) {
    std::map<int, FixType> codes;
    for (const std::string& word : name_words) {
        const std::size_t digit = word.find_first_of("0123456789");
        if (digit == std::string::npos || digit + 1 >= word.size()) continue;
        if (std::isdigit(static_cast<unsigned char>(word[digit + 1])) != 0) continue;
        if (const auto fix = fix_from_word(std::string_view(word).substr(digit + 1))) codes[word[digit] - '0'] = *fix;
    }
    // "3 is 3d" is the scale of u-blox and PX4, in which lower codes are no fix and a two-dimensional one.
    if (codes.size() == 1 && codes.contains(3))
        codes.insert({{0, FixType::None},
                      {1, FixType::None},
                      {2, FixType::Autonomous},
                      {4, FixType::Differential},
                      {5, FixType::RtkFloat},
                      {6, FixType::RtkFixed}});
    if (!codes.empty()) codes.insert({0, FixType::None});
    return codes;
}

std::map<int, FixType> rtklib_codes() {
    std::map<int, FixType> codes;
    for (int q = 0; q <= 6; ++q) codes[q] = fix_from_rtklib(q);
    return codes;
}

std::map<int, FixType> nmea_codes() {
    std::map<int, FixType> codes;
    for (int q = 0; q <= 8; ++q) codes[q] = fix_from_nmea(q);
    return codes;
}

// clang-format off
const std::map<int, FixType> vectornav_codes = {{0, FixType::None},       {1, FixType::None},         {2, FixType::Autonomous},
                                                {3, FixType::Autonomous}, {4, FixType::Differential}, {7, FixType::RtkFloat},
                                                {8, FixType::RtkFixed}};
// clang-format on
// clang-format off
const std::map<int, FixType> mavlink_codes = {{0, FixType::None},       {1, FixType::None},         {2, FixType::Autonomous},
                                              {3, FixType::Autonomous}, {4, FixType::Differential}, {5, FixType::RtkFloat},
                                              {6, FixType::RtkFixed},   {8, FixType::Differential}};
// clang-format on
// dead reckoning only (1) and time only (5) are not fixes; the carrier solution is in a separate column
// clang-format off
const std::map<int, FixType> ublox_codes = {{0, FixType::None},       {1, FixType::None},       {2, FixType::Autonomous},
                                            {3, FixType::Autonomous}, {4, FixType::Autonomous}, {5, FixType::None}};
// clang-format on
const std::map<int, FixType> ros_codes = {
    {-1, FixType::None}, {0, FixType::Autonomous}, {1, FixType::Differential}, {2, FixType::Differential}};

}  // namespace

std::optional<FixType> fix_from_word(std::string_view word) {
    std::string lower;
    for (const char c : trimmed(word)) {
        const auto u = static_cast<unsigned char>(c);
        lower += (c == '-' || c == ' ') ? '_' : static_cast<char>(std::tolower(u));
    }
    const auto it = std::find_if(words.begin(), words.end(), [&](const Word& w) { return w.text == lower; });
    if (it == words.end()) return std::nullopt;
    return it->fix;
}

std::string_view name_of(FixType fix) {
    switch (fix) {
        case FixType::None: return "none";
        case FixType::Autonomous: return "autonomous";
        case FixType::Differential: return "differential";
        case FixType::RtkFixed: return "rtk_fixed";
        case FixType::RtkFloat: return "rtk_float";
        case FixType::Unknown: return "unknown";
    }
    return "unknown";
}

FixType fix_from_rtklib(int q) {
    static constexpr std::array table = {FixType::None,         FixType::RtkFixed,   FixType::RtkFloat,    FixType::Differential,
                                         FixType::Differential, FixType::Autonomous, FixType::Differential};
    return q >= 0 && q < static_cast<int>(table.size()) ? table[static_cast<std::size_t>(q)] : FixType::Unknown;
}

FixType fix_from_nmea(int quality) {
    static constexpr std::array table = {FixType::None,       FixType::Autonomous, FixType::Differential,
                                         FixType::Autonomous, FixType::RtkFixed,   FixType::RtkFloat,
                                         FixType::None,       FixType::None,       FixType::None};
    return quality >= 0 && quality < static_cast<int>(table.size()) ? table[static_cast<std::size_t>(quality)] : FixType::Unknown;
}

CodeCounts count_fix_codes(const TextInput& input, const TableLayout& layout, const ColumnPlan& plan) {
    CodeCounts counts;
    const ColumnMatch* fix = plan.find("fix");
    if (fix == nullptr) return counts;
    FieldRequest request;
    request.column = fix->column;
    request.kind = FieldKind::Text;
    request.name = fix->file_name;
    TableReader reader(input, layout, {request});
    while (reader.next()) {
        const double code = number_from(reader.text(0));
        if (std::abs(code) < 1000.0) ++counts[static_cast<int>(code)];
    }
    return counts;
}

namespace {

constexpr std::size_t at_least = 2;  // rows, required for a code to be evidence

bool occurs(const CodeCounts& counts, int low, int high) {
    std::size_t n = 0;
    for (const auto& [code, count] : counts) n += code >= low && code <= high ? count : 0;
    return n >= at_least;
}

/// GPS.Status of ArduPilot counts dimensions starting at 1 = no fix; NavSatStatus of ROS has -1 = no fix, 0 = fix.
/// Returns whether it is that of ROS. @throws Error(Input) if the codes present have different meanings in the two
bool is_ros_status(std::string_view column, const CodeCounts& counts, const std::string& file) {
    if (occurs(counts, 3, 8)) return false;
    if (occurs(counts, -1, -1)) return true;
    std::string codes;
    for (const auto& [code, n] : counts) codes += fmt::format("{}{}", codes.empty() ? "" : ", ", code);
    throw input_error(
        fmt::format(
            "the codes {} of column '{}' mean one thing to ArduPilot (0, 1 no fix, 2 two-dimensional) and another to ROS (0 fix, "
            "1, 2 augmented)",
            codes, column),
        place_in(file, 0, 0, "gnss.fix_codes"),
        "specify them: [gnss] fix_codes = { 0 = \"none\", 1 = \"none\", 2 = \"autonomous\" }");
}

}  // namespace

FixCodes FixCodes::for_column(std::string_view column_name, const std::map<std::string, std::string>& user,
                              const std::string& file, const CodeCounts& counts, bool carrier) {
    FixCodes result;
    for (const auto& [code, name] : user) {
        const auto fix = fix_from_word(name);
        if (!fix) {
            throw input_error(fmt::format("'{}' is not a known kind of fix", name),
                              place_in(file, 0, 0, "gnss fix_codes." + code),
                              "use none, autonomous, differential, rtk_fixed or rtk_float");
        }
        result.user_[code] = *fix;
    }
    const bool all_said = std::ranges::all_of(counts, [&](const auto& c) { return user.contains(std::to_string(c.first)); });
    const std::vector<std::string> name_words = words_of_name(column_name);
    const auto has = [&](std::string_view w) { return std::find(name_words.begin(), name_words.end(), w) != name_words.end(); };
    if (auto in_name = codes_in_name(name_words); !in_name.empty()) {
        result.codes_ = std::move(in_name);
        result.table_ = "codes in the column's name";
    } else if (name_words.size() == 1 && has("q")) {
        result.codes_ = rtklib_codes();
        result.table_ = "RTKLIB Q";
    } else if (has("vn")) {
        result.codes_ = vectornav_codes;
        result.table_ = "VectorNav";
    } else if (carrier) {
        result.codes_ = ublox_codes;
        result.table_ = "u-blox fixType";
    } else if (has("type") || has("fixtype")) {
        result.codes_ = mavlink_codes;
        result.table_ = "MAVLink fix type";
    } else if (has("status") && !counts.empty() && !all_said) {
        result.by_evidence_ = true;
        const bool ros = is_ros_status(column_name, counts, file);
        result.codes_ = ros ? ros_codes : mavlink_codes;
        result.table_ = ros ? "NavSatStatus of ROS" : "GPS.Status of ArduPilot";
    } else if (name_words.size() == 1 && has("mode")) {
        result.codes_ = mavlink_codes;
        result.table_ = "gpsd mode";
    } else if (occurs(counts, 3, 3)) {
        result.by_evidence_ = true;
        result.codes_ = mavlink_codes;
        result.table_ = "3 = three-dimensional (ArduPilot, PX4, u-blox), by the codes that occur";
    } else {
        result.codes_ = nmea_codes();
        result.table_ = "NMEA quality";
    }
    if (!user.empty()) result.table_ = "given, else " + result.table_;
    return result;
}

FixType FixCodes::of(std::string_view field) const {
    if (const auto it = user_.find(field); it != user_.end()) return it->second;
    const double number = number_from(field);
    // 1.0000000 is 1
    if (const auto it = user_.find(fmt::format("{:.0f}", number)); it != user_.end() && number == std::round(number))
        return it->second;
    if (std::isnan(number)) return fix_from_word(field).value_or(FixType::Unknown);
    const auto it = codes_.find(static_cast<int>(std::clamp(number, -2.0, 1000.0)));
    return it == codes_.end() ? FixType::Unknown : it->second;
}

}  // namespace schuler::io
