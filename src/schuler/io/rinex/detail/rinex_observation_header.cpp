#include "schuler/io/rinex/detail/rinex_observation_header.h"

#include "schuler/core/error.h"
#include "schuler/io/place.h"
#include "schuler/io/rinex/detail/rinex_text.h"

#include <algorithm>

namespace schuler::io::detail {
namespace {

using gnss::Signal;
using gnss::System;

void add_type(SystemTypes& types, char kind, Signal signal) {
    const bool used = kind == 'C' || kind == 'L' || kind == 'D' || kind == 'S';
    const auto at = std::ranges::find(types.signals, signal);
    const auto place = static_cast<std::size_t>(at - types.signals.begin());
    if (used && at == types.signals.end()) types.signals.push_back(signal);
    types.types.push_back({used ? kind : ' ', used ? place : 0, 1.0});
}

/// B1I is band 2, called band 1 in early version 3 files.
Signal signal_from(System system, std::string_view code) {
    Signal s{code[1], code.size() > 2 ? code[2] : ' '};
    if (system == System::BeiDou && s.band == '1' && (s.attribute == 'I' || s.attribute == 'Q')) s.band = '2';
    return s;
}

/// Codes of version 2 are less specific than those of version 3: the code belonging to a phase follows from the list.
Signal signal_of_version2(System system, std::string_view code, const std::vector<std::string>& all) {
    const char band = code[1];
    const auto has = [&](std::string_view name) { return std::ranges::find(all, name) != all.end(); };
    if (system == System::Galileo) return {band, 'X'};
    if (band != '1' && band != '2') return {band, 'X'};
    const bool precise_code = has(std::string("P") + band), open_code = has(std::string("C") + band);
    if (code[0] == 'P') return {band, system == System::Gps ? 'W' : 'P'};
    if (code[0] == 'C') return {band, 'C'};
    const bool open = band == '1' ? open_code || !precise_code : open_code && !precise_code;
    return {band, open ? 'C' : system == System::Gps ? 'W' : 'P'};
}

class HeaderReader {
public:
    HeaderReader(Lines& lines, gnss::ObservationLog& log) : lines_(lines), log_(log) {}

    ObservationHeader read(const std::string& name) {
        char type = ' ';
        bool ended = false;
        while (!ended && lines_.next()) {
            const std::string_view line = lines_.line();
            if (has_label(line, "RINEX VERSION / TYPE")) {
                header_.version = real_in(line.substr(0, 9));
                type = line[20];
                header_.file_system = gnss::system_from_letter(line[40]) ? line[40] : 'G';
            }
            ended = has_label(line, "END OF HEADER");
            if (line.size() > label_column) entry(line);
        }
        const SourcePlace place = place_in(name, lines_.number());
        if (!(header_.version >= 2.0 && header_.version < 5.0) || type != 'O')
            throw input_error("is not a RINEX observation file of version 2, 3 or 4", place_in(name, 1),
                              "choose the observation file");
        if (header_.version < 3.0) spread_version2();
        const bool any = std::ranges::any_of(header_.systems, [](const SystemTypes& s) { return !s.types.empty(); });
        if (!ended || !any)
            throw input_error("the header has no observation types or does not end", place, "copy the file completely");
        log_.version = header_.version;
        return header_;
    }

private:
    void entry(std::string_view line) {
        if (has_label(line, "SYS / # / OBS TYPES")) types(line);
        if (has_label(line, "# / TYPES OF OBSERV")) types_of_version2(line);
        if (has_label(line, "SYS / SCALE FACTOR")) scale(line);
        if (has_label(line, "MARKER NAME")) log_.marker = std::string(trimmed(line.substr(0, 60)));
        if (has_label(line, "APPROX POSITION XYZ")) log_.approximate.r = three(line);
        if (has_label(line, "ANT # / TYPE")) log_.antenna = std::string(trimmed(line.substr(20, 20)));
        if (has_label(line, "ANTENNA: DELTA H/E/N")) log_.antenna_delta = three(line);
        if (has_label(line, "TIME OF FIRST OBS")) time_system(trimmed(line.substr(48, 3)));
        if (has_label(line, "GLONASS SLOT / FRQ #")) channels(line);
    }

    static Eigen::Vector3d three(std::string_view line) {
        const Eigen::Vector3d v(real_in(line.substr(0, 14)), real_in(line.substr(14, 14)), real_in(line.substr(28, 14)));
        return v.allFinite() ? v : not_given3();
    }

    void time_system(std::string_view name) {
        if (name == "GLO") header_.time_system = 'R';
        if (name == "BDT") header_.time_system = 'C';
        if (name.empty() && (header_.file_system == 'R' || header_.file_system == 'C')) header_.time_system = header_.file_system;
    }

    void types(std::string_view line) {
        if (line[0] != ' ') system_ = gnss::system_from_letter(line[0]);
        if (!system_) return;
        for (std::size_t column = 7; column + 3 <= label_column; column += 4) {
            const std::string_view code = line.substr(column, 3);
            if (code[0] == ' ') break;
            add_type(header_.systems[static_cast<std::size_t>(*system_)], code[0], signal_from(*system_, code));
        }
    }

    void types_of_version2(std::string_view line) {
        for (std::size_t column = 10; column + 2 <= label_column; column += 6) {
            const std::string_view code = line.substr(column, 2);
            if (code[0] != ' ') version2_.emplace_back(code);
        }
    }

    void spread_version2() {
        for (std::size_t i = 0; i < gnss::system_count; ++i) {
            for (const std::string& code : version2_) {
                const char kind = code[0] == 'P' ? 'C' : code[0];
                add_type(header_.systems[i], kind, signal_of_version2(static_cast<System>(i), code, version2_));
            }
        }
    }

    void scale(std::string_view line) {
        const auto system = gnss::system_from_letter(line[0]);
        const auto factor = integer_in(line.substr(2, 4));
        if (!system || !factor || *factor <= 0) return;
        SystemTypes& types = header_.systems[static_cast<std::size_t>(*system)];
        const bool every = trimmed(line.substr(8, 2)).empty();
        for (ObservationType& t : types.types) {
            if (t.kind == ' ') continue;
            const Signal s = types.signals[t.signal];
            const std::string code{t.kind, s.band, s.attribute};
            if (every || line.substr(10, 50).find(code) != std::string_view::npos) t.scale = *factor;
        }
    }

    void channels(std::string_view line) {
        for (std::size_t column = 4; column + 7 <= label_column; column += 7) {
            const auto satellite = gnss::satellite_from(line.substr(column, 3));
            const auto channel = integer_in(line.substr(column + 3, 3));
            if (satellite && satellite->system == System::Glonass && channel && std::abs(*channel) <= 13)
                log_.channels.of_slot[satellite->number] = static_cast<std::int8_t>(*channel);
        }
    }

    Lines& lines_;
    gnss::ObservationLog& log_;
    ObservationHeader header_;
    std::optional<System> system_;
    std::vector<std::string> version2_;
};

}  // namespace

ObservationHeader read_observation_header(Lines& lines, const std::string& name, gnss::ObservationLog& log) {
    return HeaderReader(lines, log).read(name);
}

}  // namespace schuler::io::detail
