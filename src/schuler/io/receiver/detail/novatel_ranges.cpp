#include "schuler/io/receiver/detail/novatel_ranges.h"

#include "schuler/io/receiver/detail/signal_codes.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace schuler::io::detail {
namespace {

using gnss::SatelliteId;
using gnss::System;

/// Signal types of the channel status [NovAtelOEM7:RANGE].
// clang-format off
constexpr std::array<SignalCode, 33> signal_codes = {{
    {System::Gps, 0, {'1', 'C'}},     {System::Gps, 5, {'2', 'P'}},     {System::Gps, 9, {'2', 'W'}},      {System::Gps, 14, {'5', 'Q'}},
    {System::Gps, 16, {'1', 'L'}},    {System::Gps, 17, {'2', 'S'}},    {System::Glonass, 0, {'1', 'C'}},  {System::Glonass, 1, {'2', 'C'}},
    {System::Glonass, 5, {'2', 'P'}}, {System::Glonass, 6, {'3', 'Q'}}, {System::Sbas, 0, {'1', 'C'}},     {System::Sbas, 6, {'5', 'I'}},
    {System::Galileo, 2, {'1', 'C'}}, {System::Galileo, 6, {'6', 'B'}}, {System::Galileo, 7, {'6', 'C'}},  {System::Galileo, 12, {'5', 'Q'}},
    {System::Galileo, 17, {'7', 'Q'}}, {System::Galileo, 20, {'8', 'Q'}}, {System::BeiDou, 0, {'2', 'I'}}, {System::BeiDou, 1, {'7', 'I'}},
    {System::BeiDou, 2, {'6', 'I'}},  {System::BeiDou, 4, {'2', 'I'}},  {System::BeiDou, 5, {'7', 'I'}},   {System::BeiDou, 6, {'6', 'I'}},
    {System::BeiDou, 7, {'1', 'P'}},  {System::BeiDou, 9, {'5', 'P'}},  {System::BeiDou, 11, {'7', 'D'}},  {System::Qzss, 0, {'1', 'C'}},
    {System::Qzss, 14, {'5', 'Q'}},   {System::Qzss, 16, {'1', 'L'}},   {System::Qzss, 17, {'2', 'S'}},    {System::Qzss, 27, {'6', 'L'}},
    {System::Navic, 0, {'5', 'A'}},
}};
// clang-format on

void identify(NovatelRange& r, int prn) {
    const auto satellite = satellite_of(r.status >> 16 & 7U, prn);
    if (!satellite) return;
    r.satellite = *satellite;
    r.signal = signal_of(signal_codes, satellite->system, r.status >> 21 & 0x1FU);
}

}  // namespace

std::optional<SatelliteId> satellite_of(unsigned system, int prn) {
    static constexpr std::array<System, 7> systems = {System::Gps,    System::Glonass, System::Sbas, System::Galileo,
                                                      System::BeiDou, System::Qzss,    System::Navic};
    if (system >= systems.size()) return std::nullopt;
    int number = prn;
    if (systems[system] == System::Glonass) number -= 37;
    if (systems[system] == System::Sbas) number -= 100;
    if (systems[system] == System::Qzss) number -= 192;
    const int most = system == 0 ? 32 : 99;
    if (number < 1 || number > most) return std::nullopt;
    return SatelliteId{systems[system], static_cast<std::uint8_t>(number)};
}

NovatelRange range_of(NovatelFields& f) {
    NovatelRange r;
    const int prn = f.next<std::uint16_t>();
    if (const int frequency = f.next<std::uint16_t>(); frequency <= 20) r.channel = frequency - 7;
    r.psr = f.next<double>();
    f.skip(4, 1);  // its sigma
    r.adr = f.next<double>();
    f.skip(4, 1);
    r.doppler = static_cast<double>(f.next<float>()), r.cn0 = static_cast<double>(f.next<float>());
    r.locked = f.next<float>();
    r.status = f.hex();
    identify(r, prn);
    return r;
}

NovatelRange compressed_range_of(NovatelFields& f) {
    constexpr std::size_t size = 24;
    std::string b = f.bytes(size);
    if (b.empty()) return {};
    b.append(sizeof(std::uint64_t), '\0');
    const auto bits = [&](unsigned first, unsigned count) {  // never more than 64 bits from the byte of the first on
        return load<std::uint64_t>(b, first / 8) >> first % 8 & ((std::uint64_t{1} << count) - 1);
    };
    const auto two_complement = [&](unsigned first, unsigned count) {
        const auto value = static_cast<std::int64_t>(bits(first, count));
        return static_cast<double>(value >= std::int64_t{1} << (count - 1) ? value - (std::int64_t{1} << count) : value);
    };
    NovatelRange r;
    r.status = static_cast<std::uint32_t>(bits(0, 32));
    r.doppler = two_complement(32, 28) / 256.0;
    r.psr = static_cast<double>(bits(60, 36)) / 128.0;
    const double adr = two_complement(96, 32) / 256.0;
    constexpr std::uint64_t longest = (1U << 21) - 1;
    const std::uint64_t locked = bits(144, 21);
    // the counter stops there: time added to the largest number leaves it as it is, so that it does not look like a loss
    r.locked = locked == longest ? std::numeric_limits<float>::max() : static_cast<float>(locked) / 32.0F;
    r.cn0 = 20.0 + static_cast<double>(bits(165, 5));
    identify(r, static_cast<int>(bits(136, 8)));
    if (!r.signal) return r;
    if (const auto frequency = static_cast<int>(bits(170, 6)); frequency > 0 && frequency <= 20) r.channel = frequency - 7;
    if (r.psr > 1e6) {
        // a channel that is not known changes the expected phase by less than a tenth of that
        constexpr double roll = 8'388'608.0;  // cycles
        const double expected =
            -r.psr * gnss::frequency_of(r.satellite.system, r.signal->band, r.channel.value_or(0)) / gnss::speed_of_light;
        r.adr = adr + roll * std::round((expected - adr) / roll);
    }
    return r;
}

}  // namespace schuler::io::detail
