// Tracks for maps: GPX 1.1, read and written; GeoJSON, written.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/dated.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/detail/calendar_text.h"
#include "schuler/io/text/number.h"
#include "schuler/io/text/xml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace schuler::io {
namespace {

constexpr std::int64_t one_second = 1'000'000'000;

/// The value of an attribute or the text of an element inside a piece of XML; empty if there is none.
std::string_view attribute(std::string_view tag, std::string_view name) {
    for (std::size_t at = tag.find(name); at != std::string_view::npos; at = tag.find(name, at + 1)) {
        const std::size_t equals = at + name.size();
        if (at == 0 || (tag[at - 1] != ' ' && tag[at - 1] != '\n' && tag[at - 1] != '\t') || equals + 1 >= tag.size() ||
            tag[equals] != '=')
            continue;
        const char quote = tag[equals + 1];
        const std::size_t end = tag.find(quote, equals + 2);
        if (end == std::string_view::npos) return {};
        return tag.substr(equals + 2, end - equals - 2);
    }
    return {};
}
std::string_view element(std::string_view xml, const std::string& name) {
    const std::size_t open = xml.find("<" + name + ">");
    if (open == std::string_view::npos) return {};
    const std::size_t begin = open + name.size() + 2, end = xml.find("</", begin);
    return end == std::string_view::npos ? std::string_view{} : xml.substr(begin, end - begin);
}

/// "2024-05-01T12:00:00.250Z", or with an offset in hours.
std::optional<Time> time_of(std::string_view text) {
    const std::string s(text);
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, whole = 0, used = 0;
    if (std::sscanf(s.c_str(), "%4d-%2d-%2dT%2d:%2d:%2d%n", &year, &month, &day, &hour, &minute, &whole, &used) != 6)
        return std::nullopt;
    if (!detail::is_date(year, month, day) || hour < 0 || hour > 23 || minute < 0 || minute > 59 || whole < 0 || whole > 60)
        return std::nullopt;
    std::string_view rest = std::string_view(s).substr(static_cast<std::size_t>(used));
    std::int64_t fraction = 0;
    if (rest.starts_with('.')) {
        rest.remove_prefix(1);
        std::int64_t unit = one_second / 10;
        for (; !rest.empty() && rest.front() >= '0' && rest.front() <= '9'; rest.remove_prefix(1), unit /= 10)
            fraction += unit * (rest.front() - '0');
    }
    Time t = gps_from_utc({year, month, day, hour, minute, static_cast<double>(whole)}) + Duration{fraction};
    if (rest.size() >= 6 && (rest[0] == '+' || rest[0] == '-')) {
        int h = 0, m = 0;
        if (std::sscanf(std::string(rest.substr(1)).c_str(), "%2d:%2d", &h, &m) != 2) return std::nullopt;
        const Duration zone{(h * 3600 + m * 60) * one_second};
        t = rest[0] == '+' ? t - zone : t + zone;
    }
    return t;
}

/// Seconds of UTC with as many decimals as required.
std::string utc_text(Time t) {
    const std::int64_t fraction = ((t.ns % one_second) + one_second) % one_second;
    const Calendar c = utc_from_gps(Time{t.ns - fraction});
    std::string text = fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}", c.year, c.month, c.day, c.hour, c.minute,
                                   static_cast<int>(c.second + 0.5));
    if (fraction > 0) {
        std::string digits = fmt::format(".{:09}", fraction);
        digits.erase(digits.find_last_not_of('0') + 1);
        text += digits;
    }
    return text + "Z";
}

StreamLog read_gpx(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    Stream s("gnss", TableKind::Gnss, "trkpt", {"lat_deg", "lon_deg", "height_m"});
    std::size_t without_time = 0;
    for (std::size_t at = bytes.find("<trkpt"); at != std::string::npos;) {
        const std::size_t next = bytes.find("<trkpt", at + 6);
        const std::string_view point =
            std::string_view(bytes).substr(at, next == std::string::npos ? std::string::npos : next - at);
        const std::string_view tag = point.substr(0, std::min(point.find('>'), point.size()));
        const auto t = time_of(element(point, "time"));
        const double lat = number_from(attribute(tag, "lat")), lon = number_from(attribute(tag, "lon"));
        if (t && std::isfinite(lat) && std::isfinite(lon)) s.add(t->ns, {lat, lon, number_from(element(point, "ele"))});
        else ++without_time;
        at = next;
    }
    if (s.rows() == 0)
        throw input_error(without_time > 0 ? fmt::format("none of its {} track points has a time and a place", without_time)
                                           : "holds no track point",
                          place_in(input.name()), "record the track with times; routes and way points are not tracks");
    if (without_time > 0)
        warnings.add(input.name() + " gpx.time", fmt::format("{}: track points without time or place: skipped", input.name()),
                     without_time);
    StreamLog log;
    log.clock = Clock::Gps;
    log.add(std::move(s));
    return log;
}

void write_gpx(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& title) {
    std::string out = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"schuler\" "
        "xmlns=\"http://www.topografix.com/GPX/1/1\">\n<trk><name>{}</name><trkseg>\n",
        xml_text(title));
    for (const SolutionRow& r : rows) {
        if (!std::isfinite(r.position.lat) || !std::isfinite(r.position.lon)) continue;
        fmt::format_to(std::back_inserter(out), "<trkpt lat=\"{:.10f}\" lon=\"{:.10f}\">", r.position.lat / units::deg,
                       r.position.lon / units::deg);
        if (std::isfinite(r.position.h)) fmt::format_to(std::back_inserter(out), "<ele>{:.4f}</ele>", r.position.h);
        if (detail::is_dated(r.time)) out += "<time>" + utc_text(r.time) + "</time>";
        out += "</trkpt>\n";
    }
    write_file(path, out + "</trkseg></trk>\n</gpx>\n");
}

void write_geojson(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& title) {
    std::string name;
    for (const char c : title) {
        if (c == '"' || c == '\\') name += '\\';
        if (static_cast<unsigned char>(c) >= 0x20) name += c;
    }
    std::string line, times;
    for (const SolutionRow& r : rows) {
        if (!std::isfinite(r.position.lat) || !std::isfinite(r.position.lon)) continue;
        const char* comma = line.empty() ? "" : ",\n";
        if (std::isfinite(r.position.h))
            line += fmt::format("{}[{:.10f},{:.10f},{:.4f}]", comma, r.position.lon / units::deg, r.position.lat / units::deg,
                                r.position.h);
        else line += fmt::format("{}[{:.10f},{:.10f}]", comma, r.position.lon / units::deg, r.position.lat / units::deg);
        times += times.empty() ? "" : ",";
        times += detail::is_dated(r.time) ? "\"" + utc_text(r.time) + "\"" : fmt::format("{:.9f}", r.time.seconds());
    }
    write_file(
        path,
        fmt::format(
            "{{\"type\":\"FeatureCollection\",\"features\":[{{\"type\":\"Feature\",\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[\n{}\n]}},"
            "\"properties\":{{\"name\":\"{}\",\"times\":[{}]}}}}]}}\n",
            line, name, times));
}

}  // namespace

extern const Format gpx_format, geojson_format;
const Format gpx_format = {
    .name = "gpx",
    .title = "GPX track",
    .extensions = ".gpx",
    .holds = "track points with their times as fixes",
    .time = "UTC, as GPS time; points of runs without a date are written without time",
    .recognise = [](const FileHead& head) { return head.bytes.substr(0, 1000).find("<gpx") != std::string::npos; },
    .read = read_gpx,
    .write = write_gpx,
    .one_stream = true};
const Format geojson_format = {
    .name = "geojson", .title = "GeoJSON", .extensions = ".geojson .json", .holds = "-", .time = "", .write = write_geojson};

}  // namespace schuler::io
