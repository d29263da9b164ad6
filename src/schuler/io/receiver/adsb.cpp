#include "schuler/io/receiver/adsb.h"

#include "schuler/core/error.h"
#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <string_view>

namespace schuler::io {
namespace {

constexpr double deg = units::deg, foot = 0.3048, fraction = 131072.0;  // 2^17
constexpr int zones = 15;                                               // between equator and pole
constexpr Duration pair_age{10'000'000'000};

using ModeSMessage = std::array<std::uint8_t, 14>;

double modulo(double a, double b) { return a - b * std::floor(a / b); }

std::uint32_t bits(const ModeSMessage& m, int first, int count) {
    std::uint32_t out = 0;
    for (int i = first; i < first + count; ++i)
        out = out << 1 | (static_cast<std::uint32_t>(m[static_cast<std::size_t>(i / 8)]) >> (7 - i % 8) & 1U);
    return out;
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/// 12-bit altitude with 25 ft steps, m; NaN if not reported or in the old 100 ft code.
double altitude(std::uint32_t code) {
    if (code == 0 || (code & 0x10) == 0) return not_given;
    const std::uint32_t n = (code & 0xfe0) >> 1 | (code & 0xf);
    return (25.0 * n - 1000.0) * foot;
}

Time ticks(std::uint64_t count) {
    // 12 MHz: 250/3 ns per tick
    return {static_cast<std::int64_t>(count * 250 / 3)};
}

/// State of one address.
struct Track {
    std::array<std::optional<CompactPosition>, 2> last;  ///< even, odd
    std::array<Time, 2> time{};
    std::optional<Geodetic> place;
    Time placed{};
};

class Decoder {
public:
    explicit Decoder(std::optional<Geodetic> near) : near_(near) {}

    void take(const ModeSMessage& m, Time time) {
        const std::uint32_t format = bits(m, 0, 5);
        if (format != 17 && format != 18) {
            ++out.messages.foreign;
            return;
        }
        if (squitter_parity(m) != 0) {
            ++out.messages.bad;
            return;
        }
        ++out.messages.read;
        const std::uint32_t type = bits(m, 32, 5);
        const bool surface = type >= 5 && type <= 8, airborne = (type >= 9 && type <= 18) || (type >= 20 && type <= 22);
        if (!surface && !airborne) return;
        SquitterPosition p;
        p.address = bits(m, 8, 24) | (format == 18 && bits(m, 5, 3) != 0 ? 1U << 24 : 0U);
        p.time = time;
        p.surface = surface;
        p.geometric_height = type >= 20;
        const CompactPosition report{bits(m, 53, 1) == 1, bits(m, 54, 17), bits(m, 71, 17)};
        const auto found = surface ? on_surface(report) : in_air(tracks_[p.address], report, time);
        if (!found) return;
        p.position = *found;
        p.position.h = not_given;
        if (airborne) p.position.h = p.geometric_height ? static_cast<double>(bits(m, 40, 12)) : altitude(bits(m, 40, 12));
        out.positions.push_back(p);
    }

    AdsbLog out;

private:
    [[nodiscard]] std::optional<Geodetic> on_surface(const CompactPosition& report) const {
        if (!near_) return std::nullopt;
        return local_position(report, *near_, true);
    }
    static std::optional<Geodetic> in_air(Track& track, const CompactPosition& report, Time time) {
        const std::size_t own = report.odd ? 1 : 0, other = 1 - own;
        track.last[own] = report;
        track.time[own] = time;
        std::optional<Geodetic> found;
        if (track.last[other] && time - track.time[other] <= pair_age)
            found = global_position(*track.last[0], *track.last[1], report.odd);
        else if (track.place && time - track.placed <= pair_age) found = local_position(report, *track.place, false);
        if (found) {
            track.place = found;
            track.placed = time;
        }
        return found;
    }

    std::optional<Geodetic> near_;
    std::map<std::uint32_t, Track> tracks_;
};

/// Frames of 0x1a: type, six bytes of time, level, message; 0x1a inside is doubled.
void read_beast(std::string_view text, Decoder& decoder) {
    std::size_t i = 0;
    while (i + 1 < text.size()) {
        if (static_cast<unsigned char>(text[i]) != 0x1a) {
            ++i;
            continue;
        }
        const char type = text[i + 1];
        const std::size_t length = type == '1' ? 2 : type == '2' ? 7 : type == '3' ? 14 : 0;
        i += 2;
        if (length == 0) continue;
        std::array<std::uint8_t, 21> frame{};
        std::size_t n = 0;
        for (; n < 7 + length && i < text.size(); ++n, ++i) {
            const auto byte = static_cast<std::uint8_t>(text[i]);
            if (byte == 0x1a) {
                if (i + 1 >= text.size() || static_cast<unsigned char>(text[i + 1]) != 0x1a) break;  // a new frame starts
                ++i;
            }
            frame[n] = byte;
        }
        if (n < 7 + length) {
            ++decoder.out.messages.bad;
            continue;
        }
        if (length != 14) {
            ++decoder.out.messages.foreign;
            continue;
        }
        std::uint64_t count = 0;
        for (std::size_t k = 0; k < 6; ++k) count = count << 8 | frame[k];
        ModeSMessage m;
        std::copy_n(frame.begin() + 7, 14, m.begin());
        decoder.take(m, ticks(count));
    }
}

/// Lines "*MESSAGE;" or "@TIMEMESSAGE;" in hexadecimal.
void read_avr(std::string_view text, Decoder& decoder) {
    for (Lines lines(text); lines.next();) {
        std::string_view line = lines.line();
        while (!line.empty() && line.back() == ' ') line.remove_suffix(1);
        if (line.empty() || (line.front() != '*' && line.front() != '@')) continue;
        const bool timed = line.front() == '@';
        const std::size_t head = timed ? 12 : 0;
        if (line.back() != ';' || (line.size() != 2 + head + 28 && line.size() != 2 + head + 14)) {
            ++decoder.out.messages.bad;
            continue;
        }
        if (line.size() != 2 + head + 28) {
            ++decoder.out.messages.foreign;
            continue;
        }
        std::uint64_t count = 0;
        ModeSMessage m{};
        bool good = true;
        const auto digit = [&](std::size_t at) {
            const int d = hex_digit(line[at]);
            good = good && d >= 0;
            return static_cast<unsigned>(std::max(d, 0));
        };
        for (std::size_t k = 1; k <= head; ++k) count = count << 4 | digit(k);
        for (std::size_t k = 0; k < m.size(); ++k) {
            const unsigned high = digit(1 + head + 2 * k);
            m[k] = static_cast<std::uint8_t>(high << 4 | digit(2 + head + 2 * k));
        }
        if (good) decoder.take(m, ticks(count));
        else ++decoder.out.messages.bad;
    }
}

bool is_beast(std::string_view text) { return text.size() > 2 && text[0] == 0x1a && text[1] >= '1' && text[1] <= '4'; }

}  // namespace

std::uint32_t squitter_parity(std::span<const std::uint8_t, 14> m) {
    constexpr std::uint32_t generator = 0xfff409;
    std::uint32_t rest = 0;
    for (std::size_t i = 0; i < 11; ++i) {
        rest ^= static_cast<std::uint32_t>(m[i]) << 16;
        for (int k = 0; k < 8; ++k) rest = rest << 1 ^ ((rest & 0x800000) != 0 ? generator | 0x1000000 : 0);
        rest &= 0xffffff;
    }
    return rest ^ (static_cast<std::uint32_t>(m[11]) << 16 | static_cast<std::uint32_t>(m[12]) << 8 | m[13]);
}

int longitude_zones(double lat) {
    const double a = std::abs(lat);
    if (a < 1e-9) return 59;
    if (a > 87.0 * deg) return 1;
    const double c = std::cos(a);
    const double x = 1.0 - (1.0 - std::cos(std::numbers::pi / (2.0 * zones))) / (c * c);
    return static_cast<int>(std::floor(2.0 * std::numbers::pi / std::acos(std::max(x, -1.0))));
}

std::optional<Geodetic> global_position(const CompactPosition& even, const CompactPosition& odd, bool odd_is_later) {
    const double e = even.lat / fraction, o = odd.lat / fraction;
    const double j = std::floor((4 * zones - 1) * e - 4 * zones * o + 0.5);
    const auto latitude = [j](double part, int n) {
        const double lat = 360.0 / n * (modulo(j, n) + part);
        return (lat >= 270.0 ? lat - 360.0 : lat) * deg;
    };
    const double lat_even = latitude(e, 4 * zones), lat_odd = latitude(o, 4 * zones - 1);
    if (std::abs(lat_even) > 90.0 * deg || std::abs(lat_odd) > 90.0 * deg) return std::nullopt;
    const int n = longitude_zones(lat_even);
    if (n != longitude_zones(lat_odd)) return std::nullopt;
    const double m = std::floor(even.lon / fraction * (n - 1) - odd.lon / fraction * n + 0.5);
    const int ni = std::max(odd_is_later ? n - 1 : n, 1);
    const double lon = 360.0 / ni * (modulo(m, ni) + (odd_is_later ? odd.lon : even.lon) / fraction);
    return Geodetic{odd_is_later ? lat_odd : lat_even, (lon >= 180.0 ? lon - 360.0 : lon) * deg, 0.0};
}

Geodetic local_position(const CompactPosition& r, const Geodetic& near, bool surface) {
    const double whole = surface ? 90.0 : 360.0;
    const auto nearest = [](double around, double zone, double part) {
        const double j = std::floor(around / zone) + std::floor(0.5 + modulo(around, zone) / zone - part);
        return zone * (j + part);
    };
    const double lat = nearest(near.lat / deg, whole / (r.odd ? 4 * zones - 1 : 4 * zones), r.lat / fraction) * deg;
    const double zone = whole / std::max(longitude_zones(lat) - (r.odd ? 1 : 0), 1);
    const double lon = nearest(near.lon / deg, zone, r.lon / fraction) * deg;
    return {lat, std::remainder(lon, 2.0 * std::numbers::pi), 0.0};
}

bool is_adsb(const TextInput& input) {
    std::string text;
    try {
        text = read_head(input, 64);
    } catch (const Error&) {
        return false;
    }
    if (is_beast(text)) return true;
    if (text.empty() || (text[0] != '*' && text[0] != '@')) return false;
    std::size_t n = 1;
    while (n < text.size() && hex_digit(text[n]) >= 0) ++n;
    return n >= 15 && n < text.size() && text[n] == ';';
}

AdsbLog read_adsb(const TextInput& input, std::optional<Geodetic> near, WarningLog& log) {
    const std::string text = read_bytes(input);
    Decoder decoder(near);
    if (is_beast(text)) read_beast(text, decoder);
    else read_avr(text, decoder);
    if (decoder.out.messages.read == 0)
        throw input_error("has no extended squitter that is whole", place_in(input.name()), "give a log in AVR or Beast format");
    if (decoder.out.messages.bad > 0)
        log.add("adsb.bad", fmt::format("{}: messages with wrong parity or length: skipped", input.name()),
                decoder.out.messages.bad);
    return std::move(decoder.out);
}

std::vector<StationRow> stations_of(const AdsbLog& log) {
    struct Sum {
        Geodetic sum{0, 0, 0};
        double heights = 0, n = 0;
        Geodetic low{10, 10, 0}, high{-10, -10, 0};
    };
    std::map<std::uint32_t, Sum> by_address;
    for (const SquitterPosition& p : log.positions) {
        Sum& s = by_address[p.address];
        s.sum.lat += p.position.lat;
        s.sum.lon += p.position.lon;
        s.n += 1.0;
        if (std::isfinite(p.position.h)) {
            s.sum.h += p.position.h;
            s.heights += 1.0;
        }
        s.low = {std::min(s.low.lat, p.position.lat), std::min(s.low.lon, p.position.lon), 0.0};
        s.high = {std::max(s.high.lat, p.position.lat), std::max(s.high.lon, p.position.lon), 0.0};
    }
    std::vector<StationRow> out;
    constexpr double radius = 6.371e6, largest = 60.0;  // m
    for (const auto& [address, s] : by_address) {
        const double lat = s.sum.lat / s.n;
        const double north = radius * (s.high.lat - s.low.lat), east = radius * std::cos(lat) * (s.high.lon - s.low.lon);
        if (s.n < 5.0 || std::hypot(north, east) > largest) continue;
        out.push_back({fmt::format("ADSB-{:06X}", address & 0xffffff),
                       {lat, s.sum.lon / s.n, s.heights > 0.0 ? s.sum.h / s.heights : not_given}});
    }
    return out;
}

extern const Format adsb_format;
const Format adsb_format = {.name = "adsb",
                            .title = "ADS-B squitters",
                            .extensions = ".bin .avr",
                            .holds = "extended squitters of 1090 MHz (Beast, AVR) as stations of [stations]",
                            .time = "the receiver's clock",
                            .recognise = [](const FileHead& head) { return is_adsb(TextInput(head.path)); }};

}  // namespace schuler::io
