#include "schuler/io/solution/kml.h"

#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/text/xml_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::io {
namespace {

std::string coordinates(const Geodetic& p) {
    return fmt::format("{:.8f},{:.8f},{:.2f}", p.lon / units::deg, p.lat / units::deg, p.h);
}

bool finite(const Geodetic& p) { return std::isfinite(p.lat) && std::isfinite(p.lon) && std::isfinite(p.h); }

std::string mark(const std::string& name, const SolutionRow& row) {
    return fmt::format(
        "<Placemark><name>{}</name><description>{:.3f} s</description><Point><coordinates>{}</coordinates></Point></Placemark>\n",
        name, row.time.seconds(), coordinates(row.position));
}

}  // namespace

std::string track_kml(std::span<const SolutionRow> rows, const std::string& name, std::size_t largest) {
    std::string text = fmt::format(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml "
        "xmlns=\"http://www.opengis.net/kml/2.2\">\n<Document>\n<name>{}</name>\n"
        "<Style id=\"track\"><LineStyle><color>ff0000ff</color><width>3</width></LineStyle></Style>\n",
        xml_text(name));
    if (!rows.empty() && finite(rows.front().position) && finite(rows.back().position)) {
        text += mark("start", rows.front());
        text += mark("stop", rows.back());
    }
    text += "<Placemark><name>track</name><styleUrl>#track</styleUrl><LineString><tessellate>1</tessellate><coordinates>\n";
    const std::size_t wanted = std::max<std::size_t>(largest, 2);
    const std::size_t step = rows.size() <= wanted ? 1 : (rows.size() - 1 + wanted - 2) / (wanted - 1);
    for (std::size_t i = 0; i < rows.size(); i += step) {
        if (finite(rows[i].position)) text += coordinates(rows[i].position) + "\n";
        if (i + step >= rows.size() && i + 1 < rows.size() && finite(rows.back().position))
            text += coordinates(rows.back().position) + "\n";
    }
    return text + "</coordinates></LineString></Placemark>\n</Document>\n</kml>\n";
}

void write_track_kml(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string& name,
                     std::size_t largest) {
    write_file(path, track_kml(rows, name, largest));
}

}  // namespace schuler::io
