#include "schuler/inspect/detail/plausible.h"

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
        return {fmt::format("column {} has a median of {:.5g}, which is no air pressure in Pa, hPa or kPa: the table is not used",
                            column("pressure_pa"), pressure),
                named + ", scale = { pressure_pa = ... }"};
    if (std::abs(height) > highest)
        return {fmt::format("column {} has a median of {:.5g} m, which is beyond the atmosphere: the table is not used",
                            column("height_m"), height),
                named + ", scale = { height_m = ... }"};
    return {};
}

}  // namespace

std::pair<std::string, std::string> implausible(const LoadedFile& file) {
    return file.table == io::TableKind::Baro ? no_air(file) : std::pair<std::string, std::string>{};
}

}  // namespace schuler::inspect::detail
