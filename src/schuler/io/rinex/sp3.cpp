#include "schuler/io/rinex/sp3.h"

#include "schuler/core/error.h"
#include "schuler/gnss/system_time.h"
#include "schuler/io/bytes.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/rinex/detail/rinex_text.h"

#include <fmt/format.h>

namespace schuler::io {
namespace {

using detail::integer_in;
using detail::real_in;

struct Sp3Time {
    TimeScale scale = TimeScale::Gps;
    Duration lag;
};

/// Time system of the first %c line; blanks in SP3-a mean GPS.
Sp3Time time_system(std::string_view name) {
    if (name == "UTC" || name == "GLO") return {TimeScale::Utc, {}};
    if (name == "BDT") return {TimeScale::Gps, gnss::lag_of(gnss::System::BeiDou)};
    if (name == "TAI") return {TimeScale::Gps, {-19 * detail::ns_per_second}};
    return {};
}

std::optional<Time> epoch_of(std::string_view line, const Sp3Time& system) {
    const auto at = [&](std::size_t from, std::size_t count) { return columns_of(line, from, count); };
    auto t = detail::calendar_time(integer_in(at(3, 4)), integer_in(at(8, 2)), integer_in(at(11, 2)), at(14, 2), at(17, 2),
                                   at(20, 11), system.scale);
    if (t) *t = *t + system.lag;
    return t;
}

bool position(std::string_view line, Time t, Sp3File& file) {
    const auto satellite = gnss::satellite_from(columns_of(line, 1, 3));
    const Eigen::Vector3d km(real_in(columns_of(line, 4, 14)), real_in(columns_of(line, 18, 14)),
                             real_in(columns_of(line, 32, 14)));
    const double clock = real_in(columns_of(line, 46, 14));
    if (!satellite || !km.allFinite() || km.norm() > 1e5) return false;
    if (km.norm() < 1e3) return true;  // zeros: unknown
    auto& nodes = file.nodes[gnss::index_of(*satellite)];
    if (!nodes.empty() && nodes.back().time >= t) {
        ++file.records.repeated;
        return true;
    }
    constexpr double absent = 999999.0;
    nodes.push_back({t, 1000.0 * km, std::isfinite(clock) && std::abs(clock) < absent ? clock * 1e-6 : not_given});
    ++file.records.read;
    return true;
}

}  // namespace

Sp3File read_sp3(const TextInput& input, WarningLog& log) {
    const std::string text = read_bytes(input);
    Lines lines(text);
    if (!lines.next() || lines.line().size() < 32 || lines.line()[0] != '#' || lines.line()[1] < 'a' || lines.line()[1] > 'd')
        throw input_error("is not an SP3 file of version a to d", place_in(input.name(), 1), "choose the file of precise orbits");
    Sp3File file;
    file.nodes.resize(gnss::satellite_count);
    std::optional<Sp3Time> system;
    std::optional<Time> t;
    while (lines.next()) {
        const std::string_view line = lines.line();
        if (line.starts_with("EOF")) break;
        if (line.starts_with("%c") && !system) system = time_system(trimmed(columns_of(line, 9, 3)));
        bool good = true;
        if (line.starts_with('*')) {
            t = epoch_of(line, system.value_or(Sp3Time{}));
            good = t.has_value();
            file.epochs += good ? 1 : 0;
        } else if (line.starts_with('P')) {
            good = t && position(line, *t, file);
        }
        if (!good) file.records.count_bad(lines.number());
    }
    if (file.records.read == 0)
        throw input_error("there is no usable position", place_in(input.name(), file.records.first_bad_line),
                          "choose another file");
    if (file.records.bad > 0)
        log.add(input.name() + " sp3.bad",
                fmt::format("{}: damaged lines: skipped, the first is line {}", input.name(), file.records.first_bad_line),
                file.records.bad);
    return file;
}

extern const Format sp3_format;
const Format sp3_format = {.name = "sp3",
                           .title = "SP3 precise orbits",
                           .extensions = ".sp3",
                           .holds = "orbits and clocks, versions a to d",
                           .time = "GPS time",
                           .recognise = [](const FileHead& head) {
                               return head.bytes.size() > 2 && head.bytes[0] == '#' && head.bytes[1] >= 'a' &&
                                      head.bytes[1] <= 'd' && (head.bytes[2] == 'P' || head.bytes[2] == 'V');
                           }};

}  // namespace schuler::io
