#include "schuler/io/rinex/antex.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/bytes.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/rinex/detail/rinex_text.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace schuler::io {
namespace {

using detail::has_label;
using detail::integer_in;
using detail::real_in;

constexpr std::string_view first_label = "ANTEX VERSION / SYST";
constexpr double mm = 1e-3;

/// One antenna while its lines are read.
class AntennaReader {
public:
    void read(std::string_view line) {
        if (has_label(line, "TYPE / SERIAL NO")) type(line);
        else if (has_label(line, "DAZI")) azimuth_step_ = real_in(line.substr(2, 6));
        else if (has_label(line, "ZEN1 / ZEN2 / DZEN")) grid(line);
        else if (has_label(line, "VALID FROM")) valid(line, from_);
        else if (has_label(line, "VALID UNTIL")) valid(line, until_);
        else if (has_label(line, "START OF FREQ RMS")) in_rms_ = true;
        else if (has_label(line, "END OF FREQ RMS")) in_rms_ = false;
        else if (in_rms_ || has_label(line, "COMMENT")) return;
        else if (has_label(line, "START OF FREQUENCY")) begin(columns_of(line, 3, 3));
        else if (has_label(line, "END OF FREQUENCY")) end();
        else if (has_label(line, "NORTH / EAST / UP")) offset(line);
        else if (in_carrier_) row(line);
    }

    /// False if the antenna is damaged.
    [[nodiscard]] bool add_to(gnss::Antennas& antennas) {
        if (!good_ || in_carrier_ || antenna_.type.empty()) return false;
        if (antenna_.carriers.empty()) return true;  // of unknown systems only
        if (satellite_) antennas.satellites.push_back({*satellite_, from_, until_, std::move(antenna_)});
        else antennas.receivers.push_back(std::move(antenna_));
        return true;
    }

private:
    void type(std::string_view line) {
        antenna_.type = std::string(columns_of(line, 0, 20));
        // a satellite is named by its system and number, anything else is the serial number of a single receiver antenna
        satellite_ = gnss::satellite_from(trimmed(columns_of(line, 20, 20)));
        const bool launched = antenna_.type.starts_with("BLOCK") || antenna_.type.starts_with("GLONASS") ||
                              antenna_.type.starts_with("GALILEO") || antenna_.type.starts_with("BEIDOU") ||
                              antenna_.type.starts_with("QZSS") || antenna_.type.starts_with("IRNSS") ||
                              antenna_.type.starts_with("SBAS");
        if (!launched) satellite_ = {};
    }
    void grid(std::string_view line) {
        first_ = real_in(line.substr(2, 6)), last_ = real_in(line.substr(8, 6)), step_ = real_in(line.substr(14, 6));
        constexpr double most = 1000.0;  // nodes
        good_ &= first_ >= 0.0 && last_ > first_ && step_ > 0.0 && (last_ - first_) / step_ < most;
    }
    void valid(std::string_view line, Time& t) {
        const auto at = [&](std::size_t from, std::size_t count) { return columns_of(line, from, count); };
        const auto read = detail::calendar_time(integer_in(at(0, 6)), integer_in(at(6, 6)), integer_in(at(12, 6)), at(18, 6),
                                                at(24, 6), at(30, 13), TimeScale::Gps);
        good_ &= read.has_value();
        if (read) t = *read;
    }
    void begin(std::string_view code) {
        const auto system = code.empty() ? std::nullopt : gnss::system_from_letter(code[0]);
        const auto number = integer_in(code.substr(std::min<std::size_t>(1, code.size())));
        carrier_ = {};
        in_carrier_ = true;
        has_offset_ = false;
        if (system && number && *number > 0 && *number < 10)
            carrier_.frequency = gnss::frequency_of(*system, static_cast<char>('0' + *number));
        carrier_.variation.first = first_ * units::deg;
        carrier_.variation.step = step_ * units::deg;
    }
    void offset(std::string_view line) {
        const Eigen::Vector3d v(real_in(line.substr(0, 10)), real_in(line.substr(10, 10)), real_in(line.substr(20, 10)));
        good_ &= v.allFinite();
        carrier_.offset = mm * v;
        has_offset_ = true;
    }
    void row(std::string_view line) {
        const bool mean = trimmed(columns_of(line, 0, 8)) == "NOAZI";
        // with rows by azimuth their mean is not needed
        const bool by_azimuth = azimuth_step_ > 0.0;
        if (mean == by_azimuth) return;
        const auto nodes = static_cast<std::size_t>(std::lround((last_ - first_) / step_)) + 1;
        std::vector<double> values;
        for (std::size_t i = 0; good_ && i < nodes; ++i) {
            values.push_back(mm * real_in(columns_of(line, 8 + 8 * i, 8)));
            good_ &= std::isfinite(values.back());
        }
        carrier_.variation.rows.push_back(std::move(values));
    }
    void end() {
        const auto rows = azimuth_step_ > 0.0 ? static_cast<std::size_t>(std::lround(360.0 / azimuth_step_)) + 1 : 1;
        good_ &= has_offset_ && (carrier_.variation.rows.size() == rows);
        if (carrier_.frequency > 0.0) antenna_.carriers.push_back(std::move(carrier_));
        in_carrier_ = false;
    }

    gnss::Antenna antenna_;
    gnss::AntennaCarrier carrier_;
    std::optional<gnss::SatelliteId> satellite_;
    Time from_ = gnss::SatelliteAntenna{}.from, until_ = gnss::SatelliteAntenna{}.until;
    double azimuth_step_ = 0, first_ = 0, last_ = 0, step_ = 0;  // deg
    bool in_carrier_ = false, in_rms_ = false, has_offset_ = false, good_ = true;
};

}  // namespace

AntexFile read_antex(const TextInput& input, WarningLog& log) {
    const std::string text = read_bytes(input);
    Lines lines(text);
    if (!lines.next() || !has_label(lines.line(), first_label))
        throw input_error("is not an ANTEX file", place_in(input.name(), 1), "choose the file of antenna calibrations");
    AntexFile file;
    std::optional<AntennaReader> antenna;
    long begun = 0;
    while (lines.next()) {
        const std::string_view line = lines.line();
        if (has_label(line, "START OF ANTENNA")) {
            if (antenna) file.records.count_bad(begun);
            antenna.emplace();
            begun = lines.number();
        } else if (has_label(line, "END OF ANTENNA")) {
            if (antenna && antenna->add_to(file.antennas)) ++file.records.read;
            else file.records.count_bad(begun);
            antenna.reset();
        } else if (antenna) {
            antenna->read(line);
        }
    }
    if (antenna) file.records.count_bad(begun);
    if (file.antennas.receivers.empty() && file.antennas.satellites.empty())
        throw input_error("there is no usable antenna", place_in(input.name(), file.records.first_bad_line),
                          "choose another file");
    if (file.records.bad > 0)
        log.add(
            input.name() + " antex.bad",
            fmt::format("{}: damaged antennas: skipped, the first begins in line {}", input.name(), file.records.first_bad_line),
            file.records.bad);
    return file;
}

extern const Format antex_format;
const Format antex_format = {.name = "antex",
                             .title = "ANTEX antenna calibrations",
                             .extensions = ".atx",
                             .holds = "phase centres of receivers' and satellites' antennas",
                             .time = "GPS time",
                             .recognise = [](const FileHead& head) {
                                 return std::string_view(head.bytes).substr(0, 200).find(first_label) != std::string_view::npos;
                             }};

}  // namespace schuler::io
