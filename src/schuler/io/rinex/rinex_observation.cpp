#include "schuler/core/error.h"
#include "schuler/gnss/system_time.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/rinex/compact_rinex.h"
#include "schuler/io/rinex/detail/rinex_observation_header.h"
#include "schuler/io/rinex/detail/rinex_text.h"
#include "schuler/io/rinex/rinex.h"

#include <fmt/format.h>

#include <array>

namespace schuler::io {
namespace {

using detail::integer_in;

/// A field of 14 columns with a decimal point, as F14.3. False if damaged; NaN if blank or zero, which both mean "none".
bool fixed_point(const char* p, std::size_t count, double& value) {
    static constexpr std::array<double, 14> powers = {1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13};
    const char* end = p + count;
    value = not_given;
    while (p < end && *p == ' ') ++p;
    while (p < end && end[-1] == ' ') --end;
    if (p == end) return true;
    const bool minus = *p == '-';
    if (minus || *p == '+') ++p;
    std::int64_t digits = 0;
    const char* point = nullptr;
    const char* first = p;
    for (; p < end; ++p) {
        const unsigned d = static_cast<unsigned>(*p) - unsigned{'0'};
        if (d < 10) {
            digits = digits * 10 + d;
        } else if (*p == '.' && point == nullptr) {
            point = p;
        } else {
            return false;
        }
    }
    if (point == nullptr || end - first < 2) return false;
    if (digits == 0) return true;
    const double magnitude = static_cast<double>(digits) / powers[static_cast<std::size_t>(end - point - 1)];
    value = minus ? -magnitude : magnitude;
    return true;
}

class ObservationReader {
public:
    ObservationReader(std::string_view text, const std::string& name) : lines_(text) {
        header_ = detail::read_observation_header(lines_, name, result.log);
        result.log.observations.reserve(text.size() / 60);
    }

    void records() {
        const bool version2 = header_.version < 3.0;
        while (lines_.next()) {
            if (lines_.line().empty()) continue;
            begin_epoch();
            if (!(version2 ? epoch_line_2() : epoch_line_3())) {
                bad_record();
                drop_epoch();
                continue;
            }
            if (flag_ > 1) {
                skip_event();
                continue;
            }
            if (!(version2 ? satellites_2() : satellites_3())) bad_record();
            finish_epoch();
        }
    }

    RinexObservations result;

private:
    void begin_epoch() {
        epoch_ = {};
        epoch_.first = result.log.observations.size();
    }
    void drop_epoch() { result.log.observations.resize(epoch_.first); }

    void bad_record() {
        ++result.records.bad;
        note_line();
    }
    void bad_line() {
        ++result.bad_lines;
        note_line();
    }
    void note_line() {
        if (result.records.first_bad_line == 0) result.records.first_bad_line = lines_.number();
    }

    void finish_epoch() {
        epoch_.count = result.log.observations.size() - epoch_.first;
        auto& epochs = result.log.epochs;
        if (!epochs.empty() && epoch_.time <= epochs.back().time) {
            ++result.records.repeated;
            drop_epoch();
            return;
        }
        ++result.records.read;
        epochs.push_back(epoch_);
    }

    /// Events: skips the stated number of header lines or cycle slip records.
    void skip_event() {
        for (int i = 0; i < satellites_ && lines_.peek() != '>' && lines_.next(); ++i) {}
        ++result.records.foreign;
    }

    bool set_time(std::optional<Time> t) {
        if (!t) return false;
        epoch_.time = *t;
        if (header_.time_system == 'C') epoch_.time = epoch_.time + gnss::lag_of(gnss::System::BeiDou);
        return true;
    }
    [[nodiscard]] TimeScale scale() const { return header_.time_system == 'R' ? TimeScale::Utc : TimeScale::Gps; }

    bool flag_and_count(std::string_view flag, std::string_view count) {
        const auto f = integer_in(flag), n = integer_in(count);
        if ((!f && !trimmed(flag).empty()) || !n || *n < 0) return false;
        flag_ = f.value_or(0);
        satellites_ = *n;
        epoch_.power_failure = flag_ == 1;
        return flag_ >= 0 && flag_ <= 6;
    }

    bool epoch_line_3() {
        const std::string_view line = lines_.line();
        if (line[0] != '>' || line.size() < 35) return false;
        if (!flag_and_count(line.substr(29, 3), line.substr(32, 3))) return false;
        if (flag_ > 1) return true;
        return set_time(detail::calendar_time(integer_in(line.substr(2, 4)), integer_in(line.substr(7, 2)),
                                              integer_in(line.substr(10, 2)), line.substr(13, 2), line.substr(16, 2),
                                              line.substr(18, 11), scale()));
    }

    bool epoch_line_2() {
        const std::string_view line = lines_.line();
        if (line.size() < 32 || !flag_and_count(line.substr(26, 3), line.substr(29, 3))) return false;
        if (flag_ > 1) return true;
        if (satellites_ > 99) return false;
        return set_time(detail::calendar_time(detail::full_year(integer_in(line.substr(0, 3))), integer_in(line.substr(3, 3)),
                                              integer_in(line.substr(6, 3)), line.substr(9, 3), line.substr(12, 3),
                                              line.substr(15, 11), scale()));
    }

    /// False if fewer lines than announced followed: the epoch is kept with the available data.
    bool satellites_3() {
        for (int i = 0; i < satellites_; ++i) {
            if (lines_.peek() == '>' || !lines_.next()) return false;
            const std::string_view line = lines_.line();
            const auto satellite = gnss::satellite_from(columns_of(line, 0, 3));
            if (!satellite) {
                bad_line();
                continue;
            }
            const detail::SystemTypes& types = header_.systems[static_cast<std::size_t>(satellite->system)];
            begin_satellite(types, *satellite);
            if (!fields(types, columns_of(line, 3, line.size()), 0, types.types.size())) {
                bad_line();
                continue;
            }
            finish_satellite();
        }
        return true;
    }

    bool satellites_2() {
        std::array<std::optional<gnss::SatelliteId>, 100> list;
        std::string_view line = lines_.line();
        for (int i = 0; i < satellites_; ++i) {
            if (i > 0 && i % 12 == 0) {
                if (!lines_.next()) return false;
                line = lines_.line();
            }
            std::array<char, 3> name{'G', ' ', ' '};
            const std::string_view text = columns_of(line, 32 + 3 * static_cast<std::size_t>(i % 12), 3);
            std::copy(text.begin(), text.end(), name.begin());
            if (name[0] == ' ') name[0] = header_.file_system == 'M' ? 'G' : header_.file_system;
            list[static_cast<std::size_t>(i)] = gnss::satellite_from({name.data(), 3});
        }
        for (int i = 0; i < satellites_; ++i) {
            if (!satellite_2(list[static_cast<std::size_t>(i)])) return false;
        }
        return true;
    }

    bool satellite_2(std::optional<gnss::SatelliteId> satellite) {
        const auto system = static_cast<std::size_t>(satellite ? satellite->system : gnss::System::Gps);
        const detail::SystemTypes& types = header_.systems[system];
        if (satellite) begin_satellite(types, *satellite);
        bool good = satellite.has_value();
        for (std::size_t first = 0; first < types.types.size(); first += 5) {
            if (!lines_.next()) return false;
            if (good) good = fields(types, lines_.line(), first, std::min(first + 5, types.types.size()));
        }
        if (good) {
            finish_satellite();
        } else {
            bad_line();
        }
        return true;
    }

    void begin_satellite(const detail::SystemTypes& types, gnss::SatelliteId satellite) {
        signals_.resize(types.signals.size());
        for (std::size_t i = 0; i < signals_.size(); ++i) {
            signals_[i] = {};
            signals_[i].satellite = satellite;
            signals_[i].signal = types.signals[i];
        }
    }

    bool fields(const detail::SystemTypes& types, std::string_view text, std::size_t first, std::size_t last) {
        constexpr std::size_t width = 16, digits = 14;
        for (std::size_t i = first; i < last; ++i) {
            const std::size_t at = width * (i - first);
            if (at >= text.size()) return true;
            const detail::ObservationType& type = types.types[i];
            double value = 0.0;
            if (type.kind == ' ') continue;
            if (!fixed_point(text.data() + at, std::min(digits, text.size() - at), value)) return false;
            gnss::SignalObservation& o = signals_[type.signal];
            if (type.scale != 1.0) value /= type.scale;
            switch (type.kind) {
                case 'C': o.pseudorange = value; break;
                case 'L':
                    o.phase = value;
                    o.loss_of_lock = digit(text, at + digits);
                    o.strength = digit(text, at + digits + 1);
                    break;
                case 'D': o.doppler = value; break;
                default: o.cn0 = value; break;
            }
        }
        return true;
    }

    static std::uint8_t digit(std::string_view text, std::size_t at) {
        if (at >= text.size() || text[at] < '0' || text[at] > '9') return 0;
        return static_cast<std::uint8_t>(text[at] - '0');
    }

    void finish_satellite() {
        for (const gnss::SignalObservation& o : signals_) {
            if (std::isfinite(o.pseudorange) || std::isfinite(o.phase) || std::isfinite(o.doppler))
                result.log.observations.push_back(o);
        }
    }

    Lines lines_;
    detail::ObservationHeader header_;
    gnss::ObservationEpoch epoch_;
    std::vector<gnss::SignalObservation> signals_;
    int flag_ = 0, satellites_ = 0;
};

void warn(WarningLog& log, const std::string& name, const RinexObservations& r) {
    const long line = r.records.first_bad_line;
    if (r.records.bad > 0)
        log.add(name + " rinex.bad",
                fmt::format("{}: damaged or cut epochs: what could not be read is skipped, the first at line {}", name, line),
                r.records.bad);
    if (r.bad_lines > 0)
        log.add(name + " rinex.line",
                fmt::format("{}: damaged satellite lines: skipped, the first damage at line {}", name, line), r.bad_lines);
    if (r.records.repeated > 0)
        log.add(name + " rinex.repeated", fmt::format("{}: epochs not later than the one before: skipped", name),
                r.records.repeated);
}

}  // namespace

RinexObservations read_rinex_observations(const TextInput& input, WarningLog& log) {
    std::string text = read_bytes(input);
    if (is_compact_rinex(text)) text = decompact_rinex(text, input.name());
    ObservationReader reader(text, input.name());
    reader.records();
    warn(log, input.name(), reader.result);
    if (reader.result.records.read == 0)
        throw input_error(fmt::format("there is no usable epoch ({} damaged)", reader.result.records.bad),
                          place_in(input.name(), reader.result.records.first_bad_line), "choose another observation file");
    return std::move(reader.result);
}

RinexKind rinex_kind(const TextInput& input) {
    try {
        constexpr std::size_t enough = 4096;
        const std::string text = read_head(input, enough);
        if (is_compact_rinex(text)) return RinexKind::CompactObservation;
        Lines lines(text);
        for (int i = 0; i < 20 && lines.next(); ++i) {
            const std::string_view line = lines.line();
            if (!detail::has_label(line, "RINEX VERSION / TYPE")) continue;
            const char type = line[20];
            return type == 'O'                                                ? RinexKind::Observation
                   : type == 'N' || type == 'G' || type == 'H' || type == 'J' ? RinexKind::Navigation
                                                                              : RinexKind::None;
        }
    } catch (const Error&) {
        return RinexKind::None;
    }
    return RinexKind::None;
}

extern const Format rinex_observation_format;
const Format rinex_observation_format = {
    .name = "rinex_obs",
    .title = "RINEX observations",
    .extensions = ".obs .rnx .YYo .crx .YYd",
    .holds = "raw measurements, versions 2 to 4, Hatanaka-compressed ones where crx2rnx is installed",
    .time = "GPS time",
    .recognise = [](const FileHead& head) {
        return rinex_kind(TextInput(head.path)) == RinexKind::Observation ||
               rinex_kind(TextInput(head.path)) == RinexKind::CompactObservation;
    }};

}  // namespace schuler::io
