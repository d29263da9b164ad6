#include "schuler/inspect/detail/beside_imu.h"

#include "schuler/core/error.h"
#include "schuler/inspect/detail/recognise.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

namespace schuler::inspect::detail {
namespace {

/// The IMU's table read once more, as that of another instrument which has these columns.
std::optional<LoadedFile> read_as(const LoadedFile& imu, io::TableKind kind, std::span<const char* const> needed) {
    if (imu.table != io::TableKind::Imu || !io::stream_path(imu.path).stream.empty()) return std::nullopt;
    try {
        const io::ColumnPlan plan = io::match_columns(io::inspect_table(io::TextInput(imu.path)), kind);
        for (const char* name : needed) {
            const io::ColumnMatch* match = plan.find(name);
            if (match == nullptr || io::is_estimate(match->file_name) ||
                std::ranges::find(imu.plan.unused, match->file_name) == imu.plan.unused.end())
                return std::nullopt;
        }
    } catch (const Error&) {
        return std::nullopt;  // as the IMU's own table it was read
    }
    LoadedFile other = load_file(imu.path, imu.report.path, {kind, {}, {}, 0.0});
    if (!other.table) return std::nullopt;
    other.beside_imu = true;
    other.as.kind.reset();  // found, not named
    return other;
}

}  // namespace

std::optional<LoadedFile> fixes_beside(LoadedFile& imu) {
    std::optional<LoadedFile> fixes = read_as(imu, io::TableKind::Gnss, std::array{"lat_deg", "lon_deg"});
    constexpr double fastest = 25.0;  // Hz, of receivers
    if (!fixes || fixes->report.rate_hz <= fastest) return fixes;
    imu.problem(Level::Warning,
                fmt::format("has positions at {:.3g} Hz, as a navigation system computes them: they are not taken for fixes",
                            fixes->report.rate_hz),
                fmt::format("add the log of the receiver; if they are its own, [gnss] file = {}", toml_text(imu.report.path)));
    return std::nullopt;
}

std::optional<LoadedFile> magnetometer_beside(const LoadedFile& imu) {
    constexpr std::array axes{"mag_x_ut", "mag_y_ut", "mag_z_ut"};
    std::optional<LoadedFile> mag = read_as(imu, io::TableKind::Mag, axes);
    const auto changes = [&](const char* name) {
        const std::vector<double>& values = (*mag)[name];
        return std::ranges::any_of(values, [&](double v) { return v != values.front(); });
    };
    return mag && std::ranges::any_of(axes, changes) ? mag : std::nullopt;
}

}  // namespace schuler::inspect::detail
