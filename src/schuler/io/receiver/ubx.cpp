#include "schuler/io/receiver/ubx.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/place.h"
#include "schuler/io/receiver/detail/navigation_frames.h"
#include "schuler/io/receiver/detail/signal_codes.h"
#include "schuler/io/receiver/detail/ubx_message.h"
#include "schuler/io/text/detail/calendar_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace schuler::io {

std::optional<gnss::SatelliteId> ubx_satellite(int gnss_id, int number) {
    using gnss::System;
    struct Numbers {
        System system;
        int first, last, less;  ///< numbers of the receiver, and what they exceed those of the satellite by
    };
    constexpr std::array<Numbers, 8> numbers{{{System::Gps, 1, 32, 0},
                                              {System::Sbas, 120, 158, 100},
                                              {System::Galileo, 1, 36, 0},
                                              {System::BeiDou, 1, 63, 0},
                                              {System::Gps, 0, -1, 0},  // not assigned
                                              {System::Qzss, 1, 10, 0},
                                              {System::Glonass, 1, 32, 0},
                                              {System::Navic, 1, 14, 0}}};
    if (gnss_id < 0 || gnss_id >= static_cast<int>(numbers.size())) return std::nullopt;
    const Numbers& n = numbers[static_cast<std::size_t>(gnss_id)];
    if (number < n.first || number > n.last) return std::nullopt;
    return gnss::SatelliteId{n.system, static_cast<std::uint8_t>(number - n.less)};
}

namespace {

using gnss::SatelliteId;
using gnss::Signal;
using gnss::System;

using detail::message_at;
using detail::number_at;
using detail::Scan;
using detail::SignalCode;
using Message = detail::UbxMessage;

/// Signal identifiers of [UBloxF9:1.5.4]; modes in which data and pilot are combined, or distinguished only by the receiver's
/// settings, are written as X, as in converters.
// clang-format off
constexpr std::array<SignalCode, 33> ubx_codes = {{
    {System::Gps, 0, {'1', 'C'}},     {System::Gps, 3, {'2', 'X'}},     {System::Gps, 4, {'2', 'X'}},
    {System::Gps, 6, {'5', 'X'}},     {System::Gps, 7, {'5', 'X'}},     {System::Sbas, 0, {'1', 'C'}},
    {System::Galileo, 0, {'1', 'X'}}, {System::Galileo, 1, {'1', 'X'}}, {System::Galileo, 3, {'5', 'X'}},
    {System::Galileo, 4, {'5', 'X'}}, {System::Galileo, 5, {'7', 'X'}}, {System::Galileo, 6, {'7', 'X'}},
    {System::BeiDou, 0, {'2', 'I'}},  {System::BeiDou, 1, {'2', 'I'}},  {System::BeiDou, 2, {'7', 'I'}},
    {System::BeiDou, 3, {'7', 'I'}},  {System::BeiDou, 4, {'6', 'I'}},  {System::BeiDou, 10, {'6', 'I'}},
    {System::Galileo, 8, {'6', 'X'}}, {System::Galileo, 9, {'6', 'X'}}, {System::Galileo, 10, {'6', 'X'}}, {System::BeiDou, 5, {'1', 'X'}},  {System::BeiDou, 6, {'1', 'X'}},
    {System::BeiDou, 7, {'5', 'X'}},  {System::BeiDou, 8, {'5', 'X'}},  {System::Qzss, 0, {'1', 'C'}},
    {System::Qzss, 4, {'2', 'X'}},    {System::Qzss, 5, {'2', 'X'}},    {System::Qzss, 8, {'5', 'X'}},
    {System::Qzss, 9, {'5', 'X'}},    {System::Glonass, 0, {'1', 'C'}}, {System::Glonass, 2, {'2', 'C'}},
    {System::Navic, 0, {'5', 'A'}},
}};
// clang-format on

class UbxReader {
public:
    explicit UbxReader(UbxContent content) : satellites_(content == UbxContent::All), frames_(result.navigation) {}

    void read(std::string_view bytes) {
        constexpr std::string_view sync = "\xb5\x62";
        for (std::size_t at = bytes.find(sync); at != std::string_view::npos; at = bytes.find(sync, at)) {
            Message m;
            const Scan found = message_at(bytes.substr(at), m);
            if (found == Scan::Message) {
                damage.message();
                if (!message(m)) damage.bad(at);
                at += m.size;
            } else {
                if (found == Scan::Cut) damage.cut(at);
                else damage.bad(at);
                at += sync.size();
            }
        }
        result.records.bad = damage.count();
        result.records.first_bad_line = static_cast<long>(damage.first());
    }

    UbxLog result;
    detail::UbxDamage damage;
    std::map<unsigned, std::size_t> others;  ///< messages of kinds that are not read here

private:
    bool message(const Message& m) {
        bool good = true;
        switch (m.kind) {
            case 0x0215: good = !satellites_ || raw_measurements(m.payload); break;
            case 0x0213: good = !satellites_ || subframe(m.payload); break;
            case 0x0107: good = fix(m.payload); break;
            default:
                ++result.records.foreign;
                ++others[m.kind];
                return true;
        }
        result.records.read += good ? 1 : 0;
        return good;
    }

    /// RXM-RAWX.
    bool raw_measurements(std::string_view p) {
        constexpr std::size_t head = 16, block = 32;
        if (p.size() < head) return false;
        const std::size_t count = number_at<std::uint8_t>(p, 11);
        if (p.size() < head + block * count) return false;
        if (count == 0) {
            ++result.empty_epochs;
            return true;
        }
        const auto tow = number_at<double>(p, 0);
        const int week = number_at<std::uint16_t>(p, 8);
        if (!(tow >= 0.0 && tow < 604'800.0 + 1.0) || week < 1 || week > 6000) return false;
        gnss::ObservationEpoch epoch;
        epoch.time = Time::from_gps(week, tow);
        now_ = epoch.time;
        auto& log = result.observations;
        if (!log.epochs.empty() && epoch.time <= log.epochs.back().time) {
            ++result.records.repeated;
            return true;
        }
        epoch.first = log.observations.size();
        for (std::size_t i = 0; i < count; ++i) measurement(p.substr(head + block * i, block));
        epoch.count = log.observations.size() - epoch.first;
        group(epoch);
        log.epochs.push_back(epoch);
        return true;
    }

    /// Groups an epoch by satellite, satellites in the order of their first signal.
    void group(const gnss::ObservationEpoch& epoch) {
        auto& all = result.observations.observations;
        const auto begin = all.begin() + static_cast<std::ptrdiff_t>(epoch.first);
        order_.clear();
        bool grouped = true;
        for (auto o = begin; o != all.end(); ++o) {
            if (!order_.empty() && order_.back() == o->satellite) continue;
            if (std::ranges::find(order_, o->satellite) == order_.end()) order_.push_back(o->satellite);
            else grouped = false;
        }
        if (grouped) return;
        std::stable_sort(begin, all.end(), [&](const auto& a, const auto& b) {
            return std::ranges::find(order_, a.satellite) < std::ranges::find(order_, b.satellite);
        });
    }

    void measurement(std::string_view p) {
        const auto satellite = ubx_satellite(number_at<std::uint8_t>(p, 20), number_at<std::uint8_t>(p, 21));
        const auto signal =
            satellite ? detail::signal_of(ubx_codes, satellite->system, number_at<std::uint8_t>(p, 22)) : std::nullopt;
        if (!signal) {
            ++result.unknown_signals;
            return;
        }
        gnss::SignalObservation o;
        o.satellite = *satellite;
        o.signal = *signal;
        const unsigned status = number_at<std::uint8_t>(p, 30);
        const bool range_valid = (status & 1U) != 0, phase_valid = (status & 2U) != 0, half_cycle_known = (status & 4U) != 0;
        const auto range = number_at<double>(p, 0), phase = number_at<double>(p, 8);
        const double doppler = static_cast<double>(number_at<float>(p, 16));
        if (range_valid && std::isfinite(range) && std::abs(range) < 1e9) o.pseudorange = range;
        if (phase_valid && std::isfinite(phase) && std::abs(phase) < 1e10 && phase != 0.0) o.phase = phase;
        if (std::isfinite(doppler) && std::abs(doppler) < 1e6) o.doppler = doppler;
        o.cn0 = number_at<std::uint8_t>(p, 26);
        const int lock = number_at<std::uint16_t>(p, 24);
        const bool half_subtracted = (status & 8U) != 0;
        Held& before = held_[{o.satellite, o.signal}];
        if (std::isfinite(o.phase)) {
            // the receiver counts the duration of phase lock; subtracting half a cycle causes a jump
            const bool lost = lock == 0 || lock < before.lock || before.lock < 0 || half_subtracted != before.half_subtracted;
            o.loss_of_lock = static_cast<std::uint8_t>((lost ? 1 : 0) | (half_cycle_known ? 0 : 2));
        }
        before = {std::isfinite(o.phase) ? lock : -1, half_subtracted};
        if (satellite->system == System::Glonass) {
            const int channel = number_at<std::uint8_t>(p, 23) - 7;
            if (channel >= -7 && channel <= 13)
                result.observations.channels.of_slot[satellite->number] = static_cast<std::int8_t>(channel);
        }
        result.observations.observations.push_back(o);
    }

    /// RXM-SFRBX.
    bool subframe(std::string_view p) {
        constexpr std::size_t head = 8;
        if (p.size() < head) return false;
        const std::size_t count = number_at<std::uint8_t>(p, 4);
        if (p.size() < head + 4 * count) return false;
        const auto satellite = ubx_satellite(number_at<std::uint8_t>(p, 0), number_at<std::uint8_t>(p, 1));
        if (!satellite || !now_) return true;
        const int signal = number_at<std::uint8_t>(p, 2);
        const auto word = [&](std::size_t i) { return number_at<std::uint32_t>(p, head + 4 * i); };
        if ((satellite->system == System::Gps || satellite->system == System::Qzss) && count == 10) {
            std::array<std::uint32_t, 10> words{};
            constexpr int l2_l = 3, l2_m = 4, l5_i = 6, l5_q = 7;
            if (satellite->system == System::Gps && (signal == l2_l || signal == l2_m || signal == l5_i || signal == l5_q)) {
                for (std::size_t i = 0; i < 10; ++i) words[i] = word(i);
                return frames_.gps_message(*satellite, words, *now_);
            }
            for (std::size_t i = 0; i < 10; ++i) words[i] = word(i) >> 6 & 0xFFFFFFU;
            if (!frames_.gps_subframe(*satellite, words, *now_)) ++result.records.foreign;
            return true;
        }
        if (satellite->system == System::BeiDou && count == 10) {
            std::array<std::uint32_t, 10> words{};
            for (std::size_t i = 0; i < 10; ++i) words[i] = word(i);
            if (!frames_.beidou_subframe(*satellite, words, *now_)) ++result.records.foreign;
            return true;
        }
        if (satellite->system == System::Glonass && count == 4) {
            const int channel = number_at<std::uint8_t>(p, 3) - 7;
            return frames_.glonass_string(*satellite, {word(0), word(1), word(2), word(3)}, channel, *now_);
        }
        constexpr int e1b = 1, e5b_i = 5;
        if (satellite->system == System::Galileo && count >= 8 && (signal == e1b || signal == e5b_i || signal == 0)) {
            std::array<std::uint32_t, 8> words{};
            for (std::size_t i = 0; i < 8; ++i) words[i] = word(i);
            return frames_.galileo_page(*satellite, words, *now_);
        }
        constexpr int e5a_i = 3, e5a_q = 4;
        if (satellite->system == System::Galileo && count >= 8 && (signal == e5a_i || signal == e5a_q)) {
            std::array<std::uint32_t, 8> words{};
            for (std::size_t i = 0; i < 8; ++i) words[i] = word(i);
            return frames_.galileo_freely_accessible_page(*satellite, words, *now_);
        }
        ++result.records.foreign;
        return true;
    }

    /// NAV-PVT.
    bool fix(std::string_view p) {
        if (p.size() < 84) return false;
        const unsigned valid = number_at<std::uint8_t>(p, 11), flags = number_at<std::uint8_t>(p, 21);
        const int kind = number_at<std::uint8_t>(p, 20);
        const int year = number_at<std::uint16_t>(p, 4), month = number_at<std::uint8_t>(p, 6),
                  day = number_at<std::uint8_t>(p, 7);
        const int hour = number_at<std::uint8_t>(p, 8), minute = number_at<std::uint8_t>(p, 9),
                  second = number_at<std::uint8_t>(p, 10);
        if ((valid & 3U) != 3U || kind < 2 || kind > 4) return true;  // time or position not yet available
        if (!detail::is_date(year, month, day) || hour > 23 || minute > 59 || second > 60) return false;
        GnssFix f;
        f.time = gps_from_utc({year, month, day, hour, minute, static_cast<double>(second)}) +
                 Duration{number_at<std::int32_t>(p, 16)};
        now_ = f.time;
        const auto signed_at = [&](std::size_t at) { return static_cast<double>(number_at<std::int32_t>(p, at)); };
        const auto unsigned_at = [&](std::size_t at) { return static_cast<double>(number_at<std::uint32_t>(p, at)); };
        f.position = {signed_at(28) * 1e-7 * units::deg, signed_at(24) * 1e-7 * units::deg, signed_at(32) * 1e-3};
        const double horizontal = unsigned_at(40) * 1e-3 / std::sqrt(2.0), speed = unsigned_at(68) * 1e-3 / std::sqrt(3.0);
        f.std_position = {horizontal, horizontal, unsigned_at(44) * 1e-3};
        f.velocity_n = Eigen::Vector3d(signed_at(48), signed_at(52), signed_at(56)) * 1e-3;
        f.std_velocity = Eigen::Vector3d::Constant(speed);
        f.satellites = number_at<std::uint8_t>(p, 23);
        const unsigned carrier = flags >> 6;
        f.fix = (flags & 1U) == 0   ? FixType::None
                : carrier == 2      ? FixType::RtkFixed
                : carrier == 1      ? FixType::RtkFloat
                : (flags & 2U) != 0 ? FixType::Differential
                                    : FixType::Autonomous;
        if (f.fix != FixType::None) result.fixes.push_back(f);
        return true;
    }

    /// State of a phase at the previous epoch.
    struct Held {
        int lock = -1;  ///< ms; -1: none
        bool half_subtracted = false;
    };
    bool satellites_;
    std::vector<SatelliteId> order_;  ///< of an epoch
    std::map<std::pair<SatelliteId, Signal>, Held> held_;
    std::optional<Time> now_;
    detail::FrameCollector frames_;
};

/// "ESF-MEAS (8), HNR-PVT (13)": the most frequent kinds.
std::string listed(const std::map<unsigned, std::size_t>& kinds) {
    constexpr std::array names = {
        std::pair{0x0101U, "NAV-POSECEF"}, std::pair{0x0102U, "NAV-POSLLH"}, std::pair{0x0103U, "NAV-STATUS"},
        std::pair{0x0105U, "NAV-ATT"},     std::pair{0x0106U, "NAV-SOL"},    std::pair{0x0112U, "NAV-VELNED"},
        std::pair{0x0121U, "NAV-TIMEUTC"}, std::pair{0x0135U, "NAV-SAT"},    std::pair{0x0210U, "RXM-RAW"},
        std::pair{0x0211U, "RXM-SFRB"},    std::pair{0x1002U, "ESF-MEAS"},   std::pair{0x1003U, "ESF-RAW"},
        std::pair{0x1010U, "ESF-STATUS"},  std::pair{0x1014U, "ESF-ALG"},    std::pair{0x1015U, "ESF-INS"},
        std::pair{0x2800U, "HNR-PVT"},     std::pair{0x2801U, "HNR-ATT"},    std::pair{0x2802U, "HNR-INS"}};
    std::vector<std::pair<unsigned, std::size_t>> sorted(kinds.begin(), kinds.end());
    std::ranges::stable_sort(sorted, std::greater{}, &std::pair<unsigned, std::size_t>::second);
    constexpr std::size_t most = 6;
    std::string text;
    for (std::size_t i = 0; i < std::min(most, sorted.size()); ++i) {
        const auto& [kind, count] = sorted[i];
        const auto* known = std::ranges::find(names, kind, &std::pair<unsigned, const char*>::first);
        text += fmt::format(
            "{}{} ({})", i > 0 ? ", " : "",
            known != names.end() ? std::string(known->second) : fmt::format("{:02X}-{:02X}", kind >> 8U, kind & 0xFFU), count);
    }
    return text + (sorted.size() > most ? fmt::format(" and {} more kinds", sorted.size() - most) : "");
}

Error nothing_read(const TextInput& input, const UbxReader& reader) {
    const SourcePlace place = place_in(input.name());
    if (reader.others.empty())
        return input_error(fmt::format("there is no usable UBX message ({} damaged)", reader.damage.count()), place,
                           "log RXM-RAWX and RXM-SFRBX, or NAV-PVT, and copy the log completely");
    const bool inertial = reader.others.contains(0x1002) || reader.others.contains(0x1003);
    return input_error(
        fmt::format("has neither raw measurements (RXM-RAWX) nor fixes (NAV-PVT); it holds {}", listed(reader.others)), place,
        inertial ? "log NAV-PVT too: the sensors alone give no position" : "log NAV-PVT too, or RXM-RAWX with RXM-SFRBX");
}

}  // namespace

UbxLog read_ubx(const TextInput& input, WarningLog& log, UbxContent content) {
    const std::string bytes = read_bytes(input);
    UbxReader reader(content);
    reader.read(bytes);
    UbxLog& r = reader.result;
    if (r.records.read == 0) throw nothing_read(input, reader);
    reader.damage.tell(input.name(), log);
    if (r.unknown_signals > 0)
        log.add(input.name() + " ubx.signals", fmt::format("{}: measurements of unknown signals: skipped", input.name()),
                r.unknown_signals);
    if (r.records.repeated > 0)
        log.add(input.name() + " ubx.repeated", fmt::format("{}: epochs not later than the one before: skipped", input.name()),
                r.records.repeated);
    return std::move(r);
}

bool is_ubx(const TextInput& input) {
    try {
        constexpr std::size_t enough = 100'000;
        const std::string bytes = read_head(input, enough);
        const std::string_view head = bytes;
        Message m;
        for (std::size_t at = head.find("\xb5\x62"); at != std::string_view::npos; at = head.find("\xb5\x62", at + 2)) {
            if (message_at(head.substr(at), m) == Scan::Message) return true;
        }
    } catch (const Error&) {
        return false;
    }
    return false;
}

}  // namespace schuler::io
