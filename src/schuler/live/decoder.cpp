#include "schuler/live/decoder.h"

#include "schuler/core/error.h"
#include "schuler/io/formats.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/receiver/vectornav.h"
#include "schuler/io/text/csv/csv_instruments.h"
#include "schuler/live/detail/framing.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <set>
#include <utility>

namespace schuler::live {
namespace {

using io::TextInput;

TextInput input_of(const std::string& text) { return TextInput::memory(text, "the stream"); }

/// Reads table rows with the file reader.
void read_rows(const std::string& table, Instrument instrument, const io::CsvOptions& options, std::vector<Sample>& out) {
    WarningLog heard;
    const auto add = [&out](const auto& samples) { out.insert(out.end(), samples.begin(), samples.end()); };
    switch (instrument) {
        case Instrument::Imu: return add(io::read_imu_csv(input_of(table), options, heard).samples);
        case Instrument::Gnss: return add(io::read_gnss_csv(input_of(table), options, heard).fixes);
        case Instrument::Baro: return add(io::read_baro_csv(input_of(table), options, heard).samples);
        case Instrument::Mag: return add(io::read_mag_csv(input_of(table), options, heard).samples);
        case Instrument::Odometer: return add(io::read_odometer_csv(input_of(table)));
        case Instrument::Heading: return add(io::read_compass_csv(input_of(table)));
        case Instrument::Gauges: return add(io::read_gauges_csv(input_of(table)));
        case Instrument::Log: return add(io::read_dvl_csv(input_of(table)));
    }
}

/// The first line that is not a number is the header; a restarted connection may send it again.
class CsvDecoder final : public Decoder {
public:
    CsvDecoder(Instrument instrument, io::CsvOptions options) : instrument_(instrument), options_(std::move(options)) {}

    void take(std::string_view bytes, std::vector<Sample>& out) override {
        lines_.take(
            bytes, [&](std::string_view line) { take_line(line, out); }, [&] { bad("no line end"); });
    }
    void reset() override { lines_.reset(); }

private:
    void take_line(std::string_view line, std::vector<Sample>& out) {
        const std::size_t first = line.find_first_not_of(" \t");
        if (first == std::string_view::npos || line[first] == '#') return;
        const bool number =
            (line[first] >= '0' && line[first] <= '9') || line[first] == '-' || line[first] == '+' || line[first] == '.';
        if (!number) {
            if (line.find_first_of(",;\t ") == std::string_view::npos) return bad("a line that is neither a header nor a row");
            header_ = line;
            return;
        }
        if (header_.empty()) return bad("a row before the header line");
        table_.assign(header_).append("\n").append(line).append("\n");
        const std::size_t before = out.size();
        try {
            read_rows(table_, instrument_, options_, out);
        } catch (const Error& e) {
            return bad(e.reason());
        }
        if (out.size() > before) ++counters_.messages;
        else bad("a row without a usable value");
    }

    Instrument instrument_;
    io::CsvOptions options_;
    detail::Lines lines_;
    std::string header_, table_;
};

/// True if the checksum after the asterisk is right; begins with the dollar sign.
bool checked(std::string_view line) {
    const std::size_t star = line.rfind('*');
    if (star == std::string_view::npos || star + 3 > line.size()) return false;
    unsigned sum = 0;
    for (const char c : line.substr(1, star - 1)) sum ^= static_cast<unsigned char>(c);
    return fmt::format("{:02X}", sum & 0xffU) == line.substr(star + 1, 2) ||
           fmt::format("{:02x}", sum & 0xffU) == line.substr(star + 1, 2);
}

/// Sentences of one time of day form an epoch, which is complete when the next one begins or no more data arrive.
class NmeaDecoder final : public Decoder {
public:
    void take(std::string_view bytes, std::vector<Sample>& out) override {
        lines_.take(
            bytes, [&](std::string_view line) { take_line(line, out); }, [&] { bad("no line end"); });
    }
    void quiet(std::vector<Sample>& out) override { finish(out); }
    [[nodiscard]] bool waiting() const override { return !epoch_.empty(); }
    void reset() override {
        lines_.reset();
        epoch_.clear();
    }

private:
    void take_line(std::string_view line, std::vector<Sample>& out) {
        const std::size_t begin = line.rfind('$');
        if (begin == std::string_view::npos || line.size() - begin < 11) return bad("a line that is not a sentence");
        line = line.substr(begin);
        if (!checked(line)) return bad("a sentence with a wrong checksum");
        const std::string_view kind = line.substr(3, 3);
        const bool timed = kind == "GGA" || kind == "RMC" || kind == "GNS" || kind == "GST" || kind == "ZDA";
        if (!timed && kind != "VTG" && kind != "GSA" && kind != "GSV") {
            ++counters_.foreign;
            return;
        }
        ++counters_.messages;
        if (kind == "GSV" || kind == "GSA") satellites_.nmea(line);
        if (kind == "GSV") return;  // no part of a fix
        if (timed) {
            const std::size_t end = line.find(',', 7);
            const std::string_view time = line.substr(7, end == std::string_view::npos ? end : end - 7);
            if (time != time_) finish(out);
            time_ = time;
        }
        if (kind == "RMC" || kind == "ZDA") {
            date_ = std::string(line) + "\r\n";
            dated_ = true;
        }
        epoch_.append(line).append("\r\n");
    }

    void finish(std::vector<Sample>& out) {
        if (epoch_.empty()) return;
        satellites_.nmea_epoch();
        // an epoch without a date has that of the previous one
        const std::string text = dated_ ? std::exchange(epoch_, {}) : date_ + std::exchange(epoch_, {});
        dated_ = false;
        WarningLog heard;
        try {
            for (const GnssFix& fix : io::read_nmea(input_of(text), heard).fixes) {
                if (last_ && fix.time <= *last_ && *last_ - fix.time < Duration::from_seconds(5.0)) continue;
                last_ = fix.time;
                out.emplace_back(fix);
            }
        } catch (const Error&) {  // no fix in it
        }
    }

    detail::Lines lines_;
    std::string epoch_, time_, date_;
    bool dated_ = false;
    std::optional<Time> last_;
};

/// Binary frames: other bytes are skipped and counted once per run.
class FrameDecoder : public Decoder {
public:
    void take(std::string_view bytes, std::vector<Sample>& out) override {
        waiting_ += bytes;
        std::size_t at = 0;
        while (at < waiting_.size()) {
            const std::string_view rest(waiting_.data() + at, waiting_.size() - at);
            const std::size_t size = frame(rest);
            if (size == more) break;
            if (size == none) {
                if (!lost_) bad("bytes between the messages");
                lost_ = true;
                ++at;
                continue;
            }
            lost_ = false;
            message(std::string(rest.substr(0, size)), out);
            at += size;
        }
        waiting_.erase(0, at);
        if (waiting_.size() > longest) waiting_.clear();
    }
    void reset() override { waiting_.clear(); }

protected:
    static constexpr std::size_t more = SIZE_MAX, none = 0, longest = 1 << 17;
    /// Size of the message at the beginning; `more` if it is incomplete, `none` if there is none.
    [[nodiscard]] virtual std::size_t frame(std::string_view bytes) const = 0;
    virtual void message(const std::string& bytes, std::vector<Sample>& out) = 0;
    static unsigned byte(std::string_view bytes, std::size_t i) { return static_cast<unsigned char>(bytes[i]); }

private:
    std::string waiting_;
    bool lost_ = false;
};

/// NMEA sentences between the messages count as foreign, not as garbage.
class UbxDecoder final : public FrameDecoder {
protected:
    [[nodiscard]] std::size_t frame(std::string_view b) const override {
        if (b[0] == '$') {
            const std::size_t end = b.find('\n');
            return end != std::string_view::npos ? end + 1 : b.size() < 120 ? more : none;
        }
        if (byte(b, 0) != 0xb5) return none;
        if (b.size() < 2) return more;
        if (byte(b, 1) != 0x62) return none;
        if (b.size() < 6) return more;
        const std::size_t size = 8 + byte(b, 4) + 256 * byte(b, 5);
        if (size > 8192) return none;
        if (b.size() < size) return more;
        unsigned a = 0, c = 0;
        for (std::size_t i = 2; i < size - 2; ++i) {
            a = (a + byte(b, i)) & 0xffU;
            c = (c + a) & 0xffU;
        }
        return a == byte(b, size - 2) && c == byte(b, size - 1) ? size : none;
    }
    void message(const std::string& bytes, std::vector<Sample>& out) override {
        if (bytes[0] == '$') return sentence(bytes);
        const bool navigation = byte(bytes, 2) == 0x01;
        if (navigation && byte(bytes, 3) == 0x35) {  // NAV-SAT
            ++counters_.messages;
            return satellites_.ubx(bytes);
        }
        if (!navigation || byte(bytes, 3) != 0x07) {  // NAV-PVT
            ++counters_.foreign;
            return;
        }
        ++counters_.messages;
        WarningLog heard;
        try {
            for (const GnssFix& fix : io::read_ubx(input_of(bytes), heard).fixes) out.emplace_back(fix);
        } catch (const Error&) {  // without a fix
        }
    }

private:
    /// Of the sentences only the satellites are taken.
    void sentence(std::string_view line) {
        ++counters_.foreign;
        const std::size_t end = line.find_last_not_of("\r\n");
        line = line.substr(0, end == std::string_view::npos ? 0 : end + 1);
        if (!checked(line)) return;
        const std::string_view kind = line.size() > 6 ? line.substr(3, 3) : std::string_view();
        if (kind == "GGA" || kind == "RMC") satellites_.nmea_epoch();
        satellites_.nmea(line);
    }
};

/// Position and velocity are separate messages: they are read together when the receiver pauses. Of several kinds of positions one is used,
/// as for a file: the best one received. Data between pauses are read separately, each preceded by the configuration that identifies the IMU.
class NovatelDecoder final : public FrameDecoder {
public:
    void quiet(std::vector<Sample>& out) override {
        if (chunk_.empty()) return;
        const std::string text = configuration_ + std::exchange(chunk_, {});
        WarningLog heard;
        try {
            const io::StreamLog log = io::format_named("novatel")->read(input_of(text), heard);
            for (const io::Stream& s : log.streams) {
                if (s.kind == io::TableKind::Imu) read_rows(io::table_text(s, log.clock), Instrument::Imu, {}, out);
                else if (s.kind == io::TableKind::Gnss && is_chosen(s))
                    read_rows(io::table_text(s, log.clock), Instrument::Gnss, {}, out);
            }
        } catch (const Error&) {  // no usable content
        }
        tell(heard);
    }
    [[nodiscard]] bool waiting() const override { return !chunk_.empty(); }
    void reset() override {
        FrameDecoder::reset();
        chunk_.clear();
    }

private:
    static constexpr std::array<std::string_view, 3> kinds{"BESTGNSSPOS", "BESTPOS", "PSRPOS"};  // best first, as in files

    /// Streams of a log are in the order of `kinds`. The next best is used if a better one has been missing for long.
    bool is_chosen(const io::Stream& s) {
        constexpr std::int64_t long_gone = 10'000'000'000;  // ns
        const auto it = std::ranges::find_if(kinds, [&](std::string_view kind) { return s.source.starts_with(kind); });
        const auto rank = static_cast<std::size_t>(it - kinds.begin());
        if (rank > rank_ && s.time_ns.back() - last_ns_ < long_gone) return false;
        rank_ = rank;
        last_ns_ = s.time_ns.back();
        return true;
    }

    /// True if this message identifies the IMU of RAWIMU; a damaged one does not.
    static bool names_imu(const std::string& bytes) {
        constexpr unsigned ins_config = 1945;
        const bool text = bytes[0] == '#' || bytes[0] == '%';
        const bool named = text ? bytes.find("CONNECTIMU") != std::string::npos ||
                                      bytes.find("SETIMUTYPE") != std::string::npos || bytes.starts_with("#INSCONFIGA")
                                : byte(bytes, 2) == 0x12 && byte(bytes, 4) + 256 * byte(bytes, 5) == ins_config;
        if (!named) return false;
        WarningLog heard;
        try {
            (void)io::format_named("novatel")->read(input_of(bytes), heard);
        } catch (const Error&) {  // no measurements in it
        }
        return heard.empty();
    }

    /// Damaged logs are reported each time, unusable data once.
    void tell(const WarningLog& heard) {
        const std::vector<std::string> lines = heard.summary();
        for (std::size_t i = 0; i < lines.size(); ++i) {
            const std::string& topic = heard.topics()[i];
            if (topic.ends_with("novatel.damaged")) {
                counters_.garbage += heard.count(topic);
                counters_.example = lines[i];
            } else if (told_.insert(topic).second) {
                counters_.warnings.push_back(lines[i]);
            }
        }
    }

protected:
    [[nodiscard]] std::size_t frame(std::string_view b) const override {
        if (b[0] == '#' || b[0] == '%') {
            const std::size_t end = b.find('\n');
            return end != std::string_view::npos ? end + 1 : b.size() < 4096 ? more : none;
        }
        if (byte(b, 0) != 0xaa) return none;
        if (b.size() < 10) return more;
        if (byte(b, 1) != 0x44 || (byte(b, 2) != 0x12 && byte(b, 2) != 0x13)) return none;
        const bool is_long = byte(b, 2) == 0x12;
        const std::size_t size = is_long ? byte(b, 3) + byte(b, 8) + 256 * byte(b, 9) + 4 : 12 + byte(b, 3) + 4;
        return size > detail::longest_message ? none : b.size() < size ? more : size;
    }
    void message(const std::string& bytes, std::vector<Sample>& out) override {
        ++counters_.messages;
        if (names_imu(bytes)) configuration_ = bytes;
        chunk_ += bytes;
        if (chunk_.size() > detail::longest_message) quiet(out);
    }

private:
    std::string chunk_, configuration_;
    std::size_t rank_ = kinds.size();
    std::int64_t last_ns_ = 0;
    std::set<std::string> told_;
};

/// Inertial data of the best source that the unit sends. The first dated ones determine the axis: GPS time, or time since power-on if the
/// unit has no GPS time field; fixes have the receiver's own time on the former, that of their message on the latter.
class VectorNavDecoder final : public FrameDecoder {
protected:
    [[nodiscard]] std::size_t frame(std::string_view b) const override {
        if (b[0] == '$') {  // ASCII messages of the same unit
            const std::size_t end = b.find('\n');
            return end != std::string_view::npos ? end + 1 : b.size() < 400 ? more : none;
        }
        const std::size_t size = io::vectornav_size(b);
        return size == io::vectornav_incomplete ? more : size;
    }
    void message(const std::string& bytes, std::vector<Sample>& out) override {
        if (bytes[0] == '$') {
            ++counters_.foreign;
            return;
        }
        const io::VectorNavMessage m = io::parse_vectornav(bytes);
        const std::size_t before = out.size();
        if (const std::optional<Time> time = time_of(m)) {
            source_ = std::min(source_, m.inertial);
            if (m.inertial == source_ && m.inertial != io::VectorNavMessage::Inertial::None)
                out.emplace_back(ImuSample{*time, m.rate, m.force});
            if (m.field.allFinite()) out.emplace_back(MagSample{*time, m.field});
            if (std::isfinite(m.pressure)) out.emplace_back(BaroSample{*time, not_given, m.pressure});
            if (m.fix && axis_ == Axis::PowerOn) add(*m.fix, *time, out);
        }
        if (m.fix && axis_ == Axis::Gps && m.fix->time.ns != 0) add(*m.fix, m.fix->time, out);
        ++(out.size() > before ? counters_.messages : counters_.foreign);
    }

private:
    enum class Axis { Open, Gps, PowerOn };

    std::optional<Time> time_of(const io::VectorNavMessage& m) {
        if (axis_ == Axis::Open && m.inertial != io::VectorNavMessage::Inertial::None) {
            if (m.gps_ns) axis_ = Axis::Gps;
            else if (m.startup_ns && !m.awaits_gps) axis_ = Axis::PowerOn;
            else if (!told_) counters_.warnings.emplace_back("the unit has no GPS time yet: its samples are not used until then");
            told_ = true;
        }
        const std::optional<std::int64_t>& ns = axis_ == Axis::PowerOn ? m.startup_ns : m.gps_ns;
        return axis_ == Axis::Open || !ns ? std::nullopt : std::optional(Time{*ns});
    }
    void add(GnssFix fix, Time time, std::vector<Sample>& out) {
        if (fix.fix == FixType::None) return;
        const bool same = last_ && io::repeats(fix, *last_);
        last_ = fix;
        if (same) return;
        fix.time = time;
        out.emplace_back(fix);
    }

    io::VectorNavMessage::Inertial source_ = io::VectorNavMessage::Inertial::None;
    Axis axis_ = Axis::Open;
    bool told_ = false;
    std::optional<GnssFix> last_;
};

}  // namespace

std::string_view name_of(Instrument instrument) {
    constexpr std::array<std::string_view, instrument_count> names{"imu",      "gnss",    "baro",   "mag",
                                                                   "odometer", "heading", "gauges", "log"};
    return names[static_cast<std::size_t>(instrument)];
}

std::unique_ptr<Decoder> make_decoder(StreamFormat format, Instrument instrument, const io::CsvOptions& options) {
    switch (format) {
        case StreamFormat::Nmea: return std::make_unique<NmeaDecoder>();
        case StreamFormat::Ubx: return std::make_unique<UbxDecoder>();
        case StreamFormat::Novatel: return std::make_unique<NovatelDecoder>();
        case StreamFormat::Vectornav: return std::make_unique<VectorNavDecoder>();
        case StreamFormat::Json: return detail::json_decoder();
        case StreamFormat::Gpsd: return detail::gpsd_decoder();
        default: return std::make_unique<CsvDecoder>(instrument, options);
    }
}

}  // namespace schuler::live
