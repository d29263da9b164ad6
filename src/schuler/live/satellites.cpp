#include "schuler/live/satellites.h"

#include "schuler/core/units.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/text/split.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace schuler::live {
namespace {

using gnss::SatelliteId;
using gnss::System;
using Fields = std::vector<std::string_view>;

constexpr std::size_t most = 200;  ///< satellites of one group

std::optional<int> whole_number(std::string_view text) {
    int x = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), x);
    if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
    return x;
}

/// A number from `low` to `high`, otherwise not given.
double within(std::string_view text, int low, int high) {
    const auto x = whole_number(text);
    return x && *x >= low && *x <= high ? static_cast<double>(*x) : not_given;
}

SatelliteId id_of(System system, int number) { return {system, static_cast<std::uint8_t>(number)}; }

std::optional<System> system_of_talker(std::string_view talker) {
    constexpr std::array<std::pair<std::string_view, System>, 8> table{{{"GP", System::Gps},
                                                                        {"GL", System::Glonass},
                                                                        {"GA", System::Galileo},
                                                                        {"GB", System::BeiDou},
                                                                        {"BD", System::BeiDou},
                                                                        {"GQ", System::Qzss},
                                                                        {"QZ", System::Qzss},
                                                                        {"GI", System::Navic}}};
    const auto it = std::ranges::find(table, talker, &std::pair<std::string_view, System>::first);
    return it == table.end() ? std::nullopt : std::optional(it->second);
}

/// The system number of NMEA 4.10 and later, in hexadecimal.
std::optional<System> system_of_number(std::string_view text) {
    constexpr std::array systems{System::Gps, System::Glonass, System::Galileo, System::BeiDou, System::Qzss, System::Navic};
    const auto n = whole_number(text);
    if (!n || *n < 1 || *n > static_cast<int>(systems.size())) return std::nullopt;
    return systems[static_cast<std::size_t>(*n - 1)];
}

struct Range {
    int first, last;
    System system;
    int less;  ///< number of the satellite: that of the sentence less this
};

std::optional<SatelliteId> find_in(const Range* begin, const Range* end, int number, std::optional<System> system) {
    const Range* it = std::find_if(
        begin, end, [&](const Range& r) { return number >= r.first && number <= r.last && (!system || r.system == *system); });
    return it == end ? std::nullopt : std::optional(id_of(it->system, number - it->less));
}

/// Numbers within a system start with one; those beyond say the system themselves, in one of several habits of manufacturers.
std::optional<SatelliteId> satellite_of(std::optional<System> system, int number) {
    constexpr std::array within_system{Range{1, 32, System::Gps, 0},        Range{1, 32, System::Glonass, 0},
                                       Range{1, 36, System::Galileo, 0},    Range{1, 63, System::BeiDou, 0},
                                       Range{1, 10, System::Qzss, 0},       Range{1, 14, System::Navic, 0},
                                       Range{201, 263, System::BeiDou, 200}};
    constexpr std::array anywhere{Range{1, 32, System::Gps, 0},          Range{33, 64, System::Sbas, 13},
                                  Range{65, 96, System::Glonass, 64},    Range{120, 158, System::Sbas, 100},
                                  Range{193, 202, System::Qzss, 192},    Range{203, 237, System::BeiDou, 200},
                                  Range{301, 336, System::Galileo, 300}, Range{401, 463, System::BeiDou, 400}};
    if (system)
        if (const auto found = find_in(within_system.begin(), within_system.end(), number, system)) return found;
    if (system && number < 33) return std::nullopt;
    return find_in(anywhere.begin(), anywhere.end(), number, std::nullopt);
}

unsigned byte(std::string_view bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }

}  // namespace

void SatelliteReport::nmea(std::string_view sentence) {
    if (binary_ || sentence.size() < 7) return;
    const Fields fields = io::split<std::string_view>(sentence.substr(0, sentence.find('*')), ',');
    const std::string_view kind = sentence.substr(3, 3);
    if (kind == "GSV") gsv(fields);
    else if (kind == "GSA") gsa(fields);
}

void SatelliteReport::gsv(const Fields& f) {
    if (f.size() < 4) return;
    const auto count = whole_number(f[1]), number = whole_number(f[2]);
    if (!count || !number || *number < 1 || *number > *count) return;
    const std::string_view talker = f[0].substr(1, 2), signal = f.size() % 4 == 1 ? f.back() : std::string_view();
    const std::string key = std::string(talker) + std::string(signal.substr(0, 2));
    constexpr std::size_t most_groups = 64;
    if (!groups_.contains(key) && groups_.size() >= most_groups) return;
    Group& g = groups_[key];
    if (*number == 1) g.partial.clear();
    else if (*number != g.next) {  // one before it is missing: the next sequence counts
        g.next = 0;
        return;
    }
    g.next = *number + 1;
    const std::optional<System> system = system_of_talker(talker);
    for (std::size_t i = 4; i + 3 < f.size() && g.partial.size() < most; i += 4) {
        const auto n = whole_number(f[i]);
        const auto id = n ? satellite_of(system, *n) : std::nullopt;
        if (id)
            g.partial.push_back({*id, within(f[i + 1], -90, 90) * units::deg, within(f[i + 2], 0, 360) * units::deg,
                                 within(f[i + 3], 1, 99), false});
    }
    if (*number != *count) return;
    g.seen = std::exchange(g.partial, {});
    g.age = 0;
    news_ = true;
}

void SatelliteReport::gsa(const Fields& f) {
    constexpr std::size_t first = 3, channels = 12, system_field = 18;
    if (f.size() < first + channels) return;
    std::optional<System> system = system_of_talker(f[0].substr(1, 2));
    if (!system && f.size() > system_field) system = system_of_number(f[system_field]);
    const auto name = [this](System s) -> std::set<SatelliteId>& {
        auto& named = naming_[static_cast<std::size_t>(s)];
        return named ? *named : named.emplace();
    };
    if (system) (void)name(*system);  // also where none is used
    for (std::size_t i = first; i < first + channels; ++i)
        if (const auto n = whole_number(f[i]))
            if (const auto id = satellite_of(system, *n)) name(id->system).insert(*id);
}

void SatelliteReport::nmea_epoch() {
    for (std::size_t s = 0; s < gnss::system_count; ++s) {
        if (!naming_[s]) continue;
        used_[s] = {std::move(*naming_[s]), 0};
        naming_[s].reset();
        news_ = true;
    }
}

void SatelliteReport::ubx(std::string_view frame) {
    constexpr std::size_t head = 6, checksum = 2, fixed = 8, each = 12;
    if (frame.size() < head + fixed + checksum) return;
    const std::size_t count = byte(frame, head + 5);
    if (frame.size() != head + fixed + each * count + checksum) return;
    std::vector<SatelliteSeen> all;
    for (std::size_t k = 0; k < count; ++k) {
        const std::string_view s = frame.substr(head + fixed + each * k, each);
        const auto id = io::ubx_satellite(static_cast<int>(byte(s, 0)), static_cast<int>(byte(s, 1)));
        if (!id) continue;
        const int elevation = static_cast<std::int8_t>(byte(s, 3));
        const int azimuth = static_cast<std::int16_t>(byte(s, 4) | byte(s, 5) << 8U);
        const unsigned cn0 = byte(s, 2), flags = byte(s, 8);
        SatelliteSeen seen{.id = *id, .used = (flags & 8U) != 0};
        // where the orbit is not known the elevation is +-91 deg
        if (std::abs(elevation) <= 90 && azimuth >= 0 && azimuth <= 360) {
            seen.elevation = elevation * units::deg;
            seen.azimuth = azimuth * units::deg;
        }
        if (cn0 > 0) seen.cn0 = cn0;
        all.push_back(seen);
    }
    binary_ = true;
    groups_.clear();
    used_ = {};
    replace(std::move(all));
}

void SatelliteReport::replace(std::vector<SatelliteSeen> all) {
    whole_ = std::move(all);
    news_ = true;
}

std::optional<std::vector<SatelliteSeen>> SatelliteReport::renewed() {
    constexpr int oldest = 5;
    for (auto& [key, group] : groups_) ++group.age;
    std::erase_if(groups_, [](const auto& g) { return g.second.age > oldest; });
    for (Used& u : used_)
        if (++u.age > oldest) u.all.clear();
    if (!std::exchange(news_, false)) return std::nullopt;
    std::map<SatelliteId, SatelliteSeen> all;
    const auto add = [&all](const SatelliteSeen& s) {
        const auto [it, is_new] = all.try_emplace(s.id, s);
        if (is_new) return;
        SatelliteSeen& known = it->second;
        known.cn0 = std::fmax(known.cn0, s.cn0);
        known.used = known.used || s.used;
        if (std::isfinite(known.elevation)) return;
        known.elevation = s.elevation;
        known.azimuth = s.azimuth;
    };
    for (const SatelliteSeen& s : whole_) add(s);
    for (const auto& [key, group] : groups_)
        for (const SatelliteSeen& s : group.seen) add(s);
    for (const Used& u : used_)
        for (const SatelliteId id : u.all) add({.id = id, .used = true});
    std::vector<SatelliteSeen> out;
    for (const auto& [id, s] : all) out.push_back(s);
    return out;
}

}  // namespace schuler::live
