#include "schuler/io/receiver/rtcm3.h"

#include "schuler/core/error.h"
#include "schuler/gnss/system_time.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/bits.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/receiver/detail/rtcm3_messages.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

namespace schuler::io {
namespace {

using detail::Decoded;

constexpr char preamble = '\xd3';

/// Payload of the frame at the start of the bytes; empty if it is truncated or its checksum is wrong.
std::optional<std::string_view> payload_at(std::string_view bytes) {
    constexpr std::size_t head = 3, check = 3;
    if (bytes.size() < head + check) return std::nullopt;
    const detail::Bits bits(bytes);
    const std::size_t length = bits.at(14, 10);
    if (bits.at(8, 6) != 0 || bytes.size() < head + length + check) return std::nullopt;
    if (detail::crc24q(bytes.substr(0, head + length)) != bits.at(8 * (head + length), 24)) return std::nullopt;
    return bytes.substr(head, length);
}

/// Calls `frame(payload, offset)` for each valid frame and `damaged(offset)` for an invalid one. False ends the search.
template <class Frame, class Damaged>
void each_frame(std::string_view bytes, Frame frame, Damaged damaged) {
    for (std::size_t at = bytes.find(preamble); at != std::string_view::npos; at = bytes.find(preamble, at)) {
        const auto payload = payload_at(bytes.substr(at));
        if (!payload) damaged(at);
        if (payload && !frame(*payload, at)) return;
        at += payload ? payload->size() + 6 : 1;
    }
}

int number_of(std::string_view payload) { return static_cast<int>(detail::Bits(payload).at(0, 12)); }

/// The date of a stream from its first ephemeris of the system with the longest week count; not later than `near`.
std::optional<Time> date_of(std::string_view bytes, Time near) {
    constexpr Duration doubt{gnss::week_ns};  // of the clocks that determine file times
    std::optional<detail::MessageDate> best;
    each_frame(
        bytes,
        [&](std::string_view payload, std::size_t) {
            const auto date = detail::rtcm3_date(payload, number_of(payload), near + doubt);
            if (date && (!best || date->wrap > best->wrap)) best = date;
            constexpr int weeks_of_gps = 1024;
            return !best || best->wrap <= weeks_of_gps;
        },
        [](std::size_t) {});
    return best ? std::optional<Time>(best->reference) : std::nullopt;
}

class Rtcm3Reader {
public:
    explicit Rtcm3Reader(Time near) : now_(near) {}

    void read(std::string_view bytes) {
        each_frame(
            bytes,
            [&](std::string_view payload, std::size_t at) {
                ++frames_;
                message(payload, at);
                return true;
            },
            [&](std::size_t at) {
                // text between frames may contain the preamble byte: a frame is counted as damaged only after valid frames
                if (frames_ > 0) bad(at);
            });
        finish_epoch();
    }

    Rtcm3Log result;

private:
    void bad(std::size_t offset) { result.records.count_bad(static_cast<long>(offset)); }

    void message(std::string_view payload, std::size_t offset) {
        if (payload.size() < 2) return;
        const int number = number_of(payload);
        Decoded decoded = Decoded::Foreign;
        if (detail::is_msm(number)) {
            detail::MeasuredEpoch epoch;
            decoded = detail::rtcm3_msm(payload, number, now_, result.observations.channels, epoch);
            if (decoded == Decoded::Used) add(epoch);
        } else if (detail::LegacyObservations::holds(number)) {
            detail::MeasuredEpoch epoch;
            decoded = legacy_.read(payload, number, now_, result.observations.channels, epoch);
            if (decoded == Decoded::Used) add(epoch);
        } else if (const Decoded station = detail::rtcm3_station(payload, number, result.observations);
                   station != Decoded::Foreign) {
            decoded = station;
        } else {
            decoded = detail::rtcm3_ephemeris(payload, number, now_, result.navigation);
            if (decoded == Decoded::Used && number == 1020) channel_of_last();
        }
        result.records.read += decoded == Decoded::Used ? 1 : 0;
        result.records.foreign += decoded == Decoded::Foreign ? 1 : 0;
        if (decoded == Decoded::Damaged) bad(offset);
    }

    void channel_of_last() {
        const gnss::GlonassEphemeris& g = result.navigation.glonass.back();
        result.observations.channels.of_slot[g.satellite.number] = static_cast<std::int8_t>(g.channel);
    }

    void add(detail::MeasuredEpoch& epoch) {
        auto& log = result.observations;
        // Some sources use the GPS time of the others for BeiDou messages; the flag of the previous message shows that they
        // belong together.
        if (more_ && epoch.time - current_.time == gnss::lag_of(gnss::System::BeiDou)) epoch.time = current_.time;
        more_ = epoch.more;
        if (epoch.time != current_.time || log.observations.size() == current_.first) {
            finish_epoch();
            current_ = {};
            current_.time = epoch.time;
            current_.first = log.observations.size();
        }
        for (std::size_t i = 0; i < epoch.observations.size(); ++i) {
            gnss::SignalObservation& o = epoch.observations[i];
            int& before = locks_.try_emplace({o.satellite, o.signal}, unknown_lock).first->second;
            if (std::isfinite(o.phase) && (epoch.locks[i] == 0 || epoch.locks[i] < before)) o.loss_of_lock |= 1;
            before = std::isfinite(o.phase) ? epoch.locks[i] : unknown_lock;
        }
        log.observations.insert(log.observations.end(), epoch.observations.begin(), epoch.observations.end());
        now_ = epoch.time;
    }

    void finish_epoch() {
        auto& log = result.observations;
        current_.count = log.observations.size() - current_.first;
        if (current_.count == 0) return;
        if (!log.epochs.empty() && current_.time <= log.epochs.back().time) {
            ++result.records.repeated;
            log.observations.resize(current_.first);
        } else {
            log.epochs.push_back(current_);
        }
        current_ = {};
        current_.first = log.observations.size();
    }

    Time now_;
    bool more_ = false;
    static constexpr int unknown_lock = 1 << 20;  ///< longer than any: the following phase counts as new
    std::map<std::pair<gnss::SatelliteId, gnss::Signal>, int> locks_;
    detail::LegacyObservations legacy_;
    gnss::ObservationEpoch current_;
    std::size_t frames_ = 0;
};

}  // namespace

Rtcm3Log read_rtcm3(const TextInput& input, Time near, WarningLog& log) {
    const std::string bytes = read_bytes(input);
    const std::optional<Time> date = date_of(bytes, near);
    Rtcm3Reader reader(date.value_or(near));
    reader.read(bytes);
    if (!date && !reader.result.observations.epochs.empty()) {
        const Calendar c = utc_from_gps(reader.result.observations.epochs.front().time);
        log.add(input.name() + " rtcm.date", fmt::format("{}: no ephemeris dates the stream: taken as of {:04}-{:02}-{:02}",
                                                         input.name(), c.year, c.month, c.day));
    }
    const RecordCounts& r = reader.result.records;
    if (r.read == 0)
        throw input_error(fmt::format("there is no usable RTCM 3 message ({} damaged, {} of other kinds)", r.bad, r.foreign),
                          place_in(input.name()), "log MSM4 to MSM7 (or 1004 and 1012) and ephemerides");
    if (r.bad > 0)
        log.add(input.name() + " rtcm.bad",
                fmt::format("{}: damaged RTCM frames: skipped, the first at byte {}", input.name(), r.first_bad_line), r.bad);
    return std::move(reader.result);
}

bool is_rtcm3(const TextInput& input) {
    try {
        constexpr std::size_t enough = 100'000;
        const std::string bytes = read_head(input, enough);
        const std::string_view head = bytes;
        for (std::size_t at = head.find(preamble); at != std::string_view::npos; at = head.find(preamble, at + 1)) {
            if (const auto payload = payload_at(head.substr(at)); payload && payload->size() >= 2) return true;
        }
    } catch (const Error&) {
        return false;
    }
    return false;
}

extern const Format rtcm3_format;
const Format rtcm3_format = {
    .name = "rtcm3",
    .title = "RTCM 3 stream",
    .extensions = ".rtcm3 .rtcm",
    .holds = "raw measurements (MSM4 to MSM7; 1002, 1004, 1010, 1012), ephemerides, place and antenna of a station",
    .time = "GPS time",
    .recognise = [](const FileHead& head) { return is_rtcm3(TextInput(head.path)); }};

}  // namespace schuler::io
