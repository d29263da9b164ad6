#include "schuler/gnss/satellite.h"

namespace schuler::gnss {
namespace {

constexpr std::string_view letters = "GRECJSI";
constexpr double mhz = 1e6;
constexpr double f_l1 = l1_frequency, f_l2 = 1227.60 * mhz, f_l5 = 1176.45 * mhz;

double glonass_frequency(char band, int channel) {
    switch (band) {
        case '1': return (1602.0 + 0.5625 * channel) * mhz;
        case '2': return (1246.0 + 0.4375 * channel) * mhz;
        case '3': return 1202.025 * mhz;
        case '4': return 1600.995 * mhz;
        case '6': return 1248.06 * mhz;
        default: return 0.0;
    }
}

double galileo_or_beidou_frequency(System system, char band) {
    const bool galileo = system == System::Galileo;
    switch (band) {
        case '1': return f_l1;
        case '2': return galileo ? 0.0 : 1561.098 * mhz;
        case '5': return f_l5;
        case '6': return (galileo ? 1278.75 : 1268.52) * mhz;
        case '7': return 1207.14 * mhz;
        case '8': return 1191.795 * mhz;
        default: return 0.0;
    }
}

}  // namespace

char letter_of(System system) { return letters[static_cast<std::size_t>(system)]; }

std::optional<System> system_from_letter(char letter) {
    const std::size_t i = letters.find(letter == 'Q' ? 'J' : letter);
    if (i == std::string_view::npos) return std::nullopt;
    return static_cast<System>(i);
}

std::string name_of(SatelliteId s) {
    return {letter_of(s.system), static_cast<char>('0' + s.number / 10), static_cast<char>('0' + s.number % 10)};
}

std::optional<SatelliteId> satellite_from(std::string_view text) {
    if (text.size() != 3) return std::nullopt;
    const auto system = system_from_letter(text[0] == ' ' ? 'G' : text[0]);
    const auto digit = [](char c) { return c == ' ' ? 0 : c >= '0' && c <= '9' ? c - '0' : -1; };
    const int tens = digit(text[1]), ones = text[2] == ' ' ? -1 : digit(text[2]);
    if (!system || tens < 0 || ones < 0 || tens + ones == 0) return std::nullopt;
    return SatelliteId{*system, static_cast<std::uint8_t>(10 * tens + ones)};
}

double frequency_of(System system, char band, int channel) {
    switch (system) {
        case System::Glonass: return glonass_frequency(band, channel);
        case System::Galileo:
        case System::BeiDou: return galileo_or_beidou_frequency(system, band);
        case System::Navic: return band == '9' ? 2492.028 * mhz : band == '5' ? f_l5 : band == '1' ? f_l1 : 0.0;
        default: break;
    }
    switch (band) {
        case '1': return f_l1;
        case '2': return system == System::Sbas ? 0.0 : f_l2;
        case '5': return f_l5;
        case '6': return system == System::Qzss ? 1278.75 * mhz : 0.0;
        default: return 0.0;
    }
}

}  // namespace schuler::gnss
