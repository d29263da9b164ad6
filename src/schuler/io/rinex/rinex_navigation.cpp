#include "schuler/core/error.h"
#include "schuler/gnss/system_time.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/ephemeris_checks.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/rinex/detail/rinex_text.h"
#include "schuler/io/rinex/rinex.h"

#include <fmt/format.h>

#include <array>

namespace schuler::io {
namespace {

using detail::has_label;
using detail::integer_in;
using detail::real_in;
using gnss::System;

/// A record: its satellite line and the following lines.
struct Record {
    static constexpr std::size_t most_lines = 12;
    std::array<std::string_view, most_lines> lines;
    std::size_t count = 0;
    long first_line = 0;
    std::string_view message;  ///< of RINEX 4, empty before
    char letter = ' ';         ///< system, of RINEX 4
};

class NavigationReader {
public:
    explicit NavigationReader(std::string_view text) : lines_(text) {}

    void header(const std::string& name) {
        while (lines_.next()) {
            const std::string_view line = lines_.line();
            if (has_label(line, "RINEX VERSION / TYPE")) {
                version_ = real_in(line.substr(0, 9));
                type_ = line[20];
                if (type_ == 'N' && line.size() > 40 && line[40] == 'J') type_ = 'J';
            } else if (has_label(line, "END OF HEADER")) {
                break;
            }
            coefficients(line);
        }
        if (!(version_ >= 2.0 && version_ < 5.0) || (type_ != 'N' && type_ != 'G' && type_ != 'H' && type_ != 'J'))
            throw input_error("is not a RINEX navigation file of version 2, 3 or 4", place_in(name, 1),
                              "choose the navigation file, or decompress it first");
    }

    void records() {
        Record record;
        while (lines_.next()) {
            const std::string_view line = lines_.line();
            if (has_label(line, "COMMENT")) continue;
            if (starts_record(line)) {
                finish(record);
                record = {};
                record.first_line = lines_.number();
                if (version_ >= 4.0) {
                    frame_ = trimmed(columns_of(line, 2, 3));
                    record.message = trimmed(columns_of(line, 10, 4));
                    record.letter = line.size() > 6 ? line[6] : ' ';
                    continue;
                }
            }
            if (record.first_line > 0 && record.count < Record::most_lines) record.lines[record.count++] = line;
        }
        finish(record);
    }

    RinexNavigation result;

private:
    [[nodiscard]] bool starts_record(std::string_view line) const {
        if (line.empty()) return false;
        if (version_ >= 4.0) return line[0] == '>';
        if (version_ >= 3.0) return line[0] != ' ';
        return line.size() > 22 && !trimmed(line.substr(0, 2)).empty();
    }

    /// Versions 3 and 4, and files of version 2.12 with satellite letters, have different columns.
    [[nodiscard]] bool is_wide(std::string_view satellite_line) const {
        return version_ >= 3.0 || gnss::system_from_letter(columns_of(satellite_line, 0, 1).empty() ? ' ' : satellite_line[0]);
    }

    void coefficients(std::string_view line) {
        gnss::Navigation& n = result.navigation;
        if (has_label(line, "LEAP SECONDS")) n.leap_seconds = integer_in(line.substr(0, 6));
        const bool alpha = has_label(line, "ION ALPHA"), beta = has_label(line, "ION BETA");
        if (alpha || beta) klobuchar(System::Gps, line, 2, alpha);
        if (!has_label(line, "IONOSPHERIC CORR")) return;
        const std::string_view kind = line.substr(0, 4);
        if (kind == "GAL ") {
            galileo({real_in(line.substr(5, 12)), real_in(line.substr(17, 12)), real_in(line.substr(29, 12))});
            return;
        }
        static constexpr std::array<std::pair<std::string_view, System>, 4> names = {
            {{"GPS", System::Gps}, {"QZS", System::Qzss}, {"BDS", System::BeiDou}, {"IRN", System::Navic}}};
        for (const auto& [name, system] : names) {
            if (kind.substr(0, 3) == name && (kind[3] == 'A' || kind[3] == 'B')) klobuchar(system, line, 5, kind[3] == 'A');
        }
    }

    void klobuchar(System system, std::string_view line, std::size_t column, bool alpha) {
        std::array<double, 4> values{};
        for (std::size_t i = 0; i < 4; ++i) {
            values[i] = real_in(line.substr(column + 12 * i, 12));
            if (!std::isfinite(values[i])) return;
        }
        // BeiDou transmits a set each hour: the first is kept, because it is complete with its partner
        auto& half = (alpha ? alpha_ : beta_)[static_cast<std::size_t>(system)];
        if (!half) half = values;
        const auto &a = alpha_[static_cast<std::size_t>(system)], &b = beta_[static_cast<std::size_t>(system)];
        if (a && b) result.navigation.klobuchar[static_cast<std::size_t>(system)] = gnss::KlobucharCoefficients{*a, *b};
    }

    void galileo(const std::array<double, 3>& a) {
        if (std::isfinite(a[0]) && std::isfinite(a[1]) && std::isfinite(a[2]) && !result.navigation.galileo_ionosphere)
            result.navigation.galileo_ionosphere = gnss::GalileoIonosphere{a};
    }

    void finish(const Record& record) {
        if (record.first_line == 0) return;
        RecordCounts& counts = result.records;
        if (version_ >= 4.0 && frame_ != "EPH") {
            if (frame_ == "ION") ionosphere(record);
            return;
        }
        if (version_ >= 4.0 && !is_used(record.message)) {
            ++counts.foreign;
            return;
        }
        if (!ephemeris(record)) {
            if (counts.bad++ == 0) counts.first_bad_line = record.first_line;
        }
    }

    static bool is_used(std::string_view message) {
        return message == "LNAV" || message == "INAV" || message == "FNAV" || message == "D1" || message == "D2" ||
               message == "D1D2" || message == "FDMA" || message == "SBAS";
    }

    void ionosphere(const Record& r) {
        if (r.count < 2) return;
        std::array<double, 8> v{};
        for (std::size_t i = 0; i < v.size(); ++i) {
            const std::size_t line = (i + 1) / 4, place = (i + 1) % 4;
            v[i] = line < r.count ? real_in(columns_of(r.lines[line], 4 + 19 * place, 19)) : NAN;
        }
        if (r.message == "IFNV") galileo({v[0], v[1], v[2]});
        const auto system = gnss::system_from_letter(r.letter);
        if (!system || (r.message != "LNAV" && r.message != "D1D2")) return;
        for (const double x : v) {
            if (!std::isfinite(x)) return;
        }
        auto& slot = result.navigation.klobuchar[static_cast<std::size_t>(*system)];
        if (!slot) slot = gnss::KlobucharCoefficients{{v[0], v[1], v[2], v[3]}, {v[4], v[5], v[6], v[7]}};
    }

    /// Value `place` (from 0) of line `line` of a record, as broadcast; NaN if blank or damaged.
    [[nodiscard]] double value(const Record& r, std::size_t line, std::size_t place) const {
        if (line >= r.count) return NAN;
        return real_in(columns_of(r.lines[line], (is_wide(r.lines[0]) ? 4 : 3) + 19 * place, 19));
    }
    [[nodiscard]] double value_or_zero(const Record& r, std::size_t line, std::size_t place) const {
        const double x = value(r, line, place);
        return std::isfinite(x) ? x : 0.0;
    }

    [[nodiscard]] std::optional<gnss::SatelliteId> satellite(std::string_view line) const {
        if (is_wide(line)) return gnss::satellite_from(columns_of(line, 0, 3));
        const auto number = integer_in(columns_of(line, 0, 2));
        if (!number || *number < 1 || *number > 99) return std::nullopt;
        const System system = type_ == 'G'   ? System::Glonass
                              : type_ == 'H' ? System::Sbas
                              : type_ == 'J' ? System::Qzss
                                             : System::Gps;
        return gnss::SatelliteId{system, static_cast<std::uint8_t>(*number)};
    }

    [[nodiscard]] std::optional<Time> epoch(std::string_view line, System system) const {
        const TimeScale scale = system == System::Glonass ? TimeScale::Utc : TimeScale::Gps;
        const auto at = [&](std::size_t from, std::size_t count) { return columns_of(line, from, count); };
        std::optional<Time> t;
        if (version_ >= 3.0) {
            t = detail::calendar_time(integer_in(at(4, 4)), integer_in(at(9, 2)), integer_in(at(12, 2)), at(15, 2), at(18, 2),
                                      at(21, 2), scale);
        } else {
            const std::size_t c = is_wide(line) ? 4 : 3;
            t = detail::calendar_time(detail::full_year(integer_in(at(c, 2))), integer_in(at(c + 3, 2)), integer_in(at(c + 6, 2)),
                                      at(c + 9, 2), at(c + 12, 2), at(c + 14, 5), scale);
        }
        if (t) t = *t + gnss::lag_of(system);
        return t;
    }

    bool ephemeris(const Record& r) {
        if (r.count == 0) return false;
        const auto satellite_id = satellite(r.lines[0]);
        if (!satellite_id) return false;
        const auto toc = epoch(r.lines[0], satellite_id->system);
        if (!toc) return false;
        if (satellite_id->system == System::Glonass) return state_vector<gnss::GlonassEphemeris>(r, *satellite_id, *toc);
        if (satellite_id->system == System::Sbas) return state_vector<gnss::SbasEphemeris>(r, *satellite_id, *toc);
        return kepler(r, *satellite_id, *toc);
    }

    /// Value of the satellite line, after the date.
    [[nodiscard]] double clock(const Record& r, std::size_t place) const {
        return real_in(columns_of(r.lines[0], (is_wide(r.lines[0]) ? 23 : 22) + 19 * place, 19));
    }

    bool kepler(const Record& r, gnss::SatelliteId id, Time toc) {
        gnss::KeplerEphemeris k;
        k.satellite = id;
        k.toc = toc;
        k.af0 = clock(r, 0), k.af1 = clock(r, 1), k.af2 = clock(r, 2);
        k.crs = value(r, 1, 1), k.delta_n = value(r, 1, 2), k.m0 = value(r, 1, 3);
        k.cuc = value(r, 2, 0), k.e = value(r, 2, 1), k.cus = value(r, 2, 2), k.sqrt_a = value(r, 2, 3);
        const double toe = value(r, 3, 0);
        k.cic = value(r, 3, 1), k.omega0 = value(r, 3, 2), k.cis = value(r, 3, 3);
        k.i0 = value(r, 4, 0), k.crc = value(r, 4, 1), k.omega = value(r, 4, 2), k.omega_dot = value(r, 4, 3);
        k.idot = value(r, 5, 0);
        k.iode = detail::whole(value_or_zero(r, 1, 0));
        k.accuracy = value_or_zero(r, 6, 0);
        k.health = detail::whole(value_or_zero(r, 6, 1));
        k.group_delay = {value_or_zero(r, 6, 2),
                         id.system == System::Galileo || id.system == System::BeiDou ? value_or_zero(r, 6, 3) : 0.0};
        if (id.system == System::Gps || id.system == System::Qzss) {
            k.iodc = detail::whole(value_or_zero(r, 6, 3));
            // hours in version 3, a flag in some files: four hours if not stated
            const double hours = value_or_zero(r, 7, 1);
            if (hours >= 2.0 && hours <= 200.0) k.fit_interval = hours * 3600.0;
        }
        if (id.system == System::BeiDou) k.iodc = detail::whole(value_or_zero(r, 7, 1));
        k.message = message_of(r, id);
        const double sent = value(r, 7, 0);
        detail::set_times(k, toe, sent);
        return r.count >= 8 && detail::is_sound(k) && add(result.navigation.kepler, k);
    }

    [[nodiscard]] gnss::NavMessage message_of(const Record& r, gnss::SatelliteId id) const {
        const System system = id.system;
        if (system == System::Galileo) {
            constexpr int clock_of_e5a = 256;
            if (version_ >= 4.0) return r.message == "FNAV" ? gnss::NavMessage::Fnav : gnss::NavMessage::Inav;
            return (detail::whole(value_or_zero(r, 5, 1)) & clock_of_e5a) != 0 ? gnss::NavMessage::Fnav : gnss::NavMessage::Inav;
        }
        if (system == System::BeiDou) {
            // before version 4 only the satellite determines it
            const bool d2 = version_ >= 4.0 ? r.message == "D2" : gnss::is_geostationary_beidou(id);
            return d2 ? gnss::NavMessage::D2 : gnss::NavMessage::D1;
        }
        return gnss::NavMessage::Lnav;
    }

    template <class Ephemeris>
    bool state_vector(const Record& r, gnss::SatelliteId id, Time toe) {
        constexpr double km = 1000.0;
        Ephemeris g;
        g.satellite = id;
        g.toe = toe;
        g.clock = clock(r, 0), g.clock_rate = clock(r, 1);
        for (Eigen::Index i = 0; i < 3; ++i) {
            const auto line = static_cast<std::size_t>(i + 1);
            g.position[i] = value(r, line, 0) * km;
            g.velocity[i] = value(r, line, 1) * km;
            g.acceleration[i] = value(r, line, 2) * km;
        }
        g.health = detail::whole(value_or_zero(r, 1, 3));
        g.transmission = toe;
        if constexpr (std::is_same_v<Ephemeris, gnss::GlonassEphemeris>) {
            g.channel = detail::whole(value_or_zero(r, 2, 3));
            if (g.channel > 128) g.channel -= 256;  // written as an unsigned byte by some programs
            g.age_days = detail::whole(value_or_zero(r, 3, 3));
            const double delay = value(r, 4, 1);
            if (std::isfinite(delay) && std::abs(delay) < 1e-6) g.l2_delay = delay;
            return r.count >= 4 && detail::is_sound(g) && add(result.navigation.glonass, g);
        } else {
            g.accuracy = value_or_zero(r, 2, 3);
            return r.count >= 4 && detail::is_sound(g) && add(result.navigation.sbas, g);
        }
    }

    template <class Ephemeris>
    bool add(std::vector<Ephemeris>& to, const Ephemeris& ephemeris) {
        ++result.records.read;
        to.push_back(ephemeris);
        return true;
    }

    Lines lines_;
    double version_ = 0.0;
    char type_ = ' ';
    std::string_view frame_;
    std::array<std::optional<std::array<double, 4>>, gnss::system_count> alpha_, beta_;
};

}  // namespace

RinexNavigation read_rinex_navigation(const TextInput& input, WarningLog& log) {
    const std::string text = read_bytes(input);
    NavigationReader reader(text);
    reader.header(input.name());
    reader.records();
    const RecordCounts& c = reader.result.records;
    if (c.read == 0)
        throw input_error(
            fmt::format("there is no usable ephemeris ({} damaged records, {} of a kind that is not used)", c.bad, c.foreign),
            place_in(input.name(), c.first_bad_line), "choose another navigation file");
    if (c.bad > 0)
        log.add(input.name() + " rinex.bad",
                fmt::format("{}: damaged navigation records: skipped, the first at line {}", input.name(), c.first_bad_line),
                c.bad);
    return std::move(reader.result);
}

extern const Format rinex_navigation_format;
const Format rinex_navigation_format = {
    .name = "rinex_nav",
    .title = "RINEX navigation",
    .extensions = ".nav .YYn .YYp",
    .holds = "broadcast ephemerides of GPS, GLONASS, Galileo, BeiDou, QZSS and SBAS, versions 2 to 4",
    .time = "GPS time",
    .recognise = [](const FileHead& head) { return rinex_kind(TextInput(head.path)) == RinexKind::Navigation; }};

}  // namespace schuler::io
