// Satellites and their signals: systems, names and carrier frequencies by RINEX conventions.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace schuler::gnss {

enum class System : std::uint8_t { Gps, Glonass, Galileo, BeiDou, Qzss, Sbas, Navic };
inline constexpr std::size_t system_count = 7;

/// RINEX letter: G R E C J S I. Q, used by some writers for QZSS, is also accepted.
[[nodiscard]] char letter_of(System system);
[[nodiscard]] std::optional<System> system_from_letter(char letter);

/// A satellite by its RINEX number: PRN; orbital slot (GLONASS); PRN - 100 (SBAS); PRN - 192 (QZSS). 1 to 99.
struct SatelliteId {
    System system = System::Gps;
    std::uint8_t number = 0;
    auto operator<=>(const SatelliteId&) const = default;
};
/// Satellite numbers are below this, and indices below system_count * this.
inline constexpr std::size_t numbers_per_system = 100;
[[nodiscard]] inline std::size_t index_of(SatelliteId s) {
    return static_cast<std::size_t>(s.system) * numbers_per_system + s.number;
}
inline constexpr std::size_t satellite_count = system_count * numbers_per_system;

/// "G05" and back; a blank counts as zero ("G 5").
[[nodiscard]] std::string name_of(SatelliteId satellite);
[[nodiscard]] std::optional<SatelliteId> satellite_from(std::string_view text);

/// A signal by its RINEX 3 code: band digit and tracking letter ("1C", "5Q") [RINEX304:table 4-10].
struct Signal {
    char band = '1';
    char attribute = 'C';
    auto operator<=>(const Signal&) const = default;
};

/// Carrier frequency of a band in Hz [RINEX304:tables 4-10]; `channel` is the GLONASS frequency number (-7 to 6). Zero if the
/// system does not have the band. BeiDou's B1I is band 2 (1561.098 MHz).
[[nodiscard]] double frequency_of(System system, char band, int channel = 0);

/// BeiDou numbers 1 to 5 and 59 on, which differ in orbits and messages (D2) [BeiDouICD:5.2.4.12].
[[nodiscard]] constexpr bool is_geostationary_beidou(SatelliteId s) {
    return s.system == System::BeiDou && (s.number <= 5 || s.number >= 59);
}

inline constexpr double speed_of_light = 299'792'458.0;  ///< m/s
inline constexpr double l1_frequency = 1575.42e6;        ///< Hz, of GPS L1, Galileo E1 and BeiDou B1C

}  // namespace schuler::gnss
