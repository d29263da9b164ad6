#include "schuler/io/receiver/detail/novatel_frames.h"

#include "schuler/io/text/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace schuler::io::detail {
namespace {

constexpr std::string_view long_sync("\xaa\x44\x12", 3), short_sync("\xaa\x44\x13", 3);
constexpr std::size_t short_header = 12, long_header = 28, crc_size = 4;

int digit_of(char c) {
    return c >= '0' && c <= '9' ? c - '0' : c >= 'a' && c <= 'f' ? c - 'a' + 10 : c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// Numbers of the logs of raw measurements, used for ASCII and binary alike.
// clang-format off
int id_of(std::string_view name) {
    static const std::map<std::string_view, int> ids = {{"GPSEPHEM", 7},        {"IONUTC", 8},          {"RAWEPHEM", 41},       {"RANGE", 43},
                                                        {"RANGECMP", 140},      {"GLOEPHEMERIS", 723},  {"GALEPHEMERIS", 1122}, {"BDSEPHEMERIS", 1696}, {"INSCONFIG", 1945}};
    // clang-format on
    const auto it = ids.find(name);
    return it == ids.end() ? 0 : it->second;
}

/// The asterisk before the checksum of all bytes between it and the first character; npos: none. A log may contain another log
/// with its own asterisk (RXCONFIG).
std::size_t checked_star(std::string_view line) {
    constexpr std::size_t digits = 8;
    std::uint32_t crc = 0;
    std::size_t summed = 1;  // up to here
    for (std::size_t star = line.find('*'); star != std::string_view::npos; star = line.find('*', star + 1)) {
        if (line.size() < star + 1 + digits) break;
        std::uint32_t stated = 0;
        bool is_number = true;
        for (const char c : line.substr(star + 1, digits)) {
            const int digit = digit_of(c);
            is_number = is_number && digit >= 0;
            stated = stated << 4 | static_cast<unsigned>(digit);
        }
        if (!is_number) continue;
        crc = novatel_crc(line.substr(summed, star - summed), crc);
        summed = star;
        if (crc == stated) return star;
    }
    return std::string_view::npos;
}

class Scanner {
public:
    explicit Scanner(const std::function<bool(const NovatelMessage&)>& take) : take_(take) {}

    /// Size of the log at the beginning; 0: damaged.
    std::size_t binary(std::string_view b) {
        const bool is_short = b.starts_with(short_sync);
        if (b.size() < short_header + crc_size) return 0;
        const std::size_t header = is_short ? short_header : static_cast<unsigned char>(b[3]);
        const std::size_t body = is_short ? static_cast<unsigned char>(b[3]) : load<std::uint16_t>(b, 8);
        if (header < short_header || (!is_short && header < long_header) || b.size() < header + body + crc_size) return 0;
        if (novatel_crc(b.substr(0, header + body)) != load<std::uint32_t>(b, header + body)) return 0;
        const std::size_t used = header + body + crc_size;
        const unsigned form =
            is_short
                ? 0U
                : static_cast<unsigned char>(b[6]);  // bits 0 to 4: source of the measurements; bit 7: a response to a command
        if ((form & 0x80U) != 0) return used;
        message_.name = {};
        message_.cells.clear();
        message_.id = load<std::uint16_t>(b, 4);
        message_.secondary = (form & 0x1FU) != 0;
        const int week = is_short ? load<std::uint16_t>(b, 6) : load<std::uint16_t>(b, 14);
        const std::uint32_t ms = is_short ? load<std::uint32_t>(b, 8) : load<std::uint32_t>(b, 16);
        message_.ns = novatel_time(week, 1e-3 * ms);
        message_.payload = b.substr(header, body);
        go_on = take_(message_);
        return used;
    }

    std::size_t ascii(std::string_view text) {
        constexpr std::size_t longest = 65'536;
        text = text.substr(0, longest);
        const std::size_t star = checked_star(text.substr(0, text.find('\n')));
        if (star == std::string_view::npos) return 0;
        const std::string_view content = text.substr(1, star - 1);
        const std::size_t semicolon = content.find(';'), used = star + 9;
        if (semicolon == std::string_view::npos) return used;
        header_ = split<std::string_view>(content.substr(0, semicolon), ',');
        const std::size_t week_at = text[0] == '%' ? 1 : 5;
        if (header_.size() < week_at + 2) return used;
        message_.name = header_[0];
        const std::size_t underline = message_.name.rfind('_');  // RANGEA_1 is from the second antenna
        message_.secondary =
            underline != std::string_view::npos && underline + 2 == message_.name.size() && message_.name.back() != '0';
        if (underline != std::string_view::npos && underline + 2 == message_.name.size())
            message_.name = message_.name.substr(0, underline);
        if (!message_.name.ends_with('A')) return used;  // an abbreviated log, or a response
        message_.name.remove_suffix(1);
        if (message_.name.empty()) return used;
        message_.id = id_of(message_.name);
        message_.ns = novatel_time(number_from(header_[week_at]), number_from(header_[week_at + 1]));
        message_.payload = {};
        message_.cells = split<std::string_view>(content.substr(semicolon + 1), ',');
        go_on = take_(message_);
        return used;
    }

    bool go_on = true;

private:
    const std::function<bool(const NovatelMessage&)>& take_;
    NovatelMessage message_;
    std::vector<std::string_view> header_;
};

}  // namespace

std::uint32_t novatel_crc(std::string_view bytes, std::uint32_t crc) {
    static const std::array<std::uint32_t, 256> table = [] {
        std::array<std::uint32_t, 256> t{};
        for (std::uint32_t i = 0; i < 256; ++i) {
            std::uint32_t c = i;
            for (int k = 0; k < 8; ++k) c = (c & 1U) != 0 ? c >> 1 ^ 0xEDB88320U : c >> 1;
            t[i] = c;
        }
        return t;
    }();
    for (const char b : bytes) crc = table[(crc ^ static_cast<unsigned char>(b)) & 0xFFU] ^ crc >> 8;
    return crc;
}

std::int64_t novatel_time(double week, double seconds) {
    const bool known = week >= 1.0 && week < 10'000.0 && seconds >= 0.0 && seconds < 604'801.0;
    return known ? Time::from_gps(static_cast<int>(week), seconds).ns : 0;
}

void tell_compressed(const std::string& file, std::size_t count, WarningLog& warnings) {
    warnings.add(
        file + " novatel.compressed",
        fmt::format(
            "{}: raw measurements in RANGECMP2, RANGECMP4 or RANGECMP5 are not read: log RANGE or RANGECMP, or convert them",
            file),
        count);
}

bool is_compressed(const NovatelMessage& m) {
    static constexpr std::array ids{1273, 2050, 2537};  // RANGECMP2, RANGECMP4, RANGECMP5
    return m.name.empty() ? std::ranges::find(ids, m.id) != ids.end() : m.name.starts_with("RANGECMP") && m.name != "RANGECMP";
}

NovatelScan scan_novatel(std::string_view bytes, const std::function<bool(const NovatelMessage&)>& take) {
    NovatelScan scan;
    Scanner scanner(take);
    std::size_t at = 0;
    std::size_t binary_at = bytes.find('\xaa'), text_at = bytes.find_first_of("#%");
    while (scanner.go_on) {
        if (binary_at < at) binary_at = bytes.find('\xaa', at);
        if (text_at < at) text_at = bytes.find_first_of("#%", at);
        at = std::min(binary_at, text_at);
        if (at == std::string_view::npos) break;
        const std::string_view rest = bytes.substr(at);
        std::size_t used = 0;
        if (rest.starts_with(long_sync) || rest.starts_with(short_sync)) {
            used = scanner.binary(rest);
        } else if (rest[0] != '\xaa' && rest.size() > 2 && rest[1] >= 'A' && rest[1] <= 'Z' && rest[2] >= 'A') {
            used = scanner.ascii(rest);
        } else {
            ++at;
            continue;
        }
        if (used == 0) {
            if (scan.damaged++ == 0) scan.first_damaged = at;
            used = 1;
        }
        at += used;
    }
    return scan;
}

std::uint32_t NovatelFields::hex() {
    if (m_.name.empty()) return next<std::uint32_t>();
    if (at_ >= m_.cells.size()) {
        short_ = true;
        return 0;
    }
    std::uint32_t value = 0;
    for (const char c : m_.cells[at_++]) {
        const int digit = digit_of(c);
        if (digit < 0) return 0;
        value = value << 4 | static_cast<unsigned>(digit);
    }
    return value;
}

std::string NovatelFields::bytes(std::size_t size) {
    std::string out;
    if (m_.name.empty()) {
        if (at_ + size <= m_.payload.size()) out = m_.payload.substr(at_, size);
        at_ += size;
    } else if (at_ < m_.cells.size()) {
        const std::string_view digits = m_.cells[at_++];
        for (std::size_t i = 0; digits.size() == 2 * size && i < digits.size(); i += 2) {
            const int high = digit_of(digits[i]), low = digit_of(digits[i + 1]);
            if (high < 0 || low < 0) break;
            out += static_cast<char>(high << 4 | low);
        }
    }
    if (out.size() == size) return out;
    short_ = true;
    return {};
}

bool NovatelFields::flag() {
    if (m_.name.empty()) return next<std::uint32_t>() != 0;
    if (at_ >= m_.cells.size()) {
        short_ = true;
        return false;
    }
    const std::string_view cell = m_.cells[at_++];
    return cell == "TRUE" || cell == "1";
}

}  // namespace schuler::io::detail
