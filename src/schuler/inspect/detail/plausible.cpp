#include "schuler/inspect/detail/plausible.h"

#include "schuler/core/units.h"
#include "schuler/inspect/detail/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

/// The median of the numbers of a column, NaN if it has none.
double typical(const LoadedFile& file, const char* name) {
    if (!file.has(name)) return std::nan("");
    std::vector<double> numbers = file[name];
    std::erase_if(numbers, [](double x) { return !std::isfinite(x); });
    return numbers.empty() ? std::nan("") : median(std::move(numbers));
}

/// Air from the ground to 30 km, in Pa, hPa or kPa.
bool is_air_pressure(double p) { return (p > 1e3 && p < 1.2e5) || (p >= 300.0 && p < 1200.0) || (p >= 10.0 && p < 120.0); }

std::pair<std::string, std::string> no_air(const LoadedFile& file) {
    const double pressure = typical(file, "pressure_pa"), height = typical(file, "height_m");
    const auto column = [&](const char* name) { return file.plan.find(name)->file_name; };
    const std::string named = fmt::format("if it is a barometer's: [baro] file = {}", toml_text(file.report.path));
    constexpr double highest = 1e5;  // m, of the air
    if (std::isfinite(pressure) && !is_air_pressure(pressure))
        return {fmt::format(
                    "column {} has a median of {:.5g}, out of range of an air pressure in Pa, hPa or kPa: the table is not used",
                    column("pressure_pa"), pressure),
                named + ", scale = { pressure_pa = ... }"};
    if (std::abs(height) > highest)
        return {fmt::format("column {} has a median of {:.5g} m, which is beyond the atmosphere: the table is not used",
                            column("height_m"), height),
                named + ", scale = { height_m = ... }"};
    return {};
}

/// Positions of events or of several objects in turn: from row to row they are as far apart as any two rows. Those of one antenna change
/// less from row to row than over the log, or scatter by what a receiver errs.
std::pair<std::string, std::string> no_track(const LoadedFile& file) {
    if (!file.has("lat_deg") || !file.has("lon_deg")) return {};
    constexpr double ticks = 1e-7, circle = 360.0, farthest = 0.01, share = 0.7;  // of a receiver's error, deg: 1 km
    const double unit = std::abs(typical(file, "lat_deg")) > circle ? ticks : 1.0;
    std::vector<double> lat, lon;
    for (std::size_t i = 0; i < file.time_ns.size(); ++i) {
        const double north = unit * file["lat_deg"][i], east = unit * file["lon_deg"][i];
        if (!std::isfinite(north) || !std::isfinite(east) || (north == 0.0 && east == 0.0)) continue;
        lat.push_back(north);
        lon.push_back(east);
    }
    constexpr std::size_t fewest = 10;
    if (lat.size() < fewest) return {};
    const double middle_lat = median(lat), middle_lon = median(lon);
    const auto apart = [&](std::size_t i, double other_lat, double other_lon) {
        const double shrink = std::cos(middle_lat * units::deg);
        return std::hypot(lat[i] - other_lat, std::remainder(lon[i] - other_lon, circle) * shrink);
    };
    std::vector<double> steps, distances;
    for (std::size_t i = 1; i < lat.size(); ++i) {
        steps.push_back(apart(i, lat[i - 1], lon[i - 1]));
        distances.push_back(apart(i, middle_lat, middle_lon));
    }
    const double step = median(std::move(steps));
    if (step < farthest || step < share * median(std::move(distances))) return {};
    return {fmt::format(
                "the positions jump by {:.3g} deg from row to row, as those of events or of several objects: they are not the "
                "track of one antenna, and not used",
                step),
            fmt::format("if they are a receiver's fixes: [gnss] file = {}", toml_text(file.report.path))};
}

}  // namespace

std::pair<std::string, std::string> implausible(const LoadedFile& file) {
    if (file.table == io::TableKind::Baro) return no_air(file);
    if (file.table == io::TableKind::Gnss) return no_track(file);
    return {};
}

}  // namespace schuler::inspect::detail
