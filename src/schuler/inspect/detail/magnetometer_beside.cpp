#include "schuler/inspect/detail/magnetometer_beside.h"

#include "schuler/core/error.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/columns.h"

#include <algorithm>

namespace schuler::inspect::detail {

std::optional<LoadedFile> magnetometer_beside(const LoadedFile& imu) {
    if (imu.table != io::TableKind::Imu || imu.plan.unused.size() < 3 || !io::stream_path(imu.path).stream.empty())
        return std::nullopt;
    try {
        const io::ColumnPlan plan = io::match_columns(io::inspect_table(io::TextInput(imu.path)), io::TableKind::Mag);
        for (const char* name : {"mag_x_ut", "mag_y_ut", "mag_z_ut"}) {
            const io::ColumnMatch* match = plan.find(name);
            if (match == nullptr || std::ranges::find(imu.plan.unused, match->file_name) == imu.plan.unused.end())
                return std::nullopt;
        }
    } catch (const Error&) {
        return std::nullopt;  // as the IMU's own table it was read
    }
    LoadedFile mag = load_file(imu.path, imu.report.path, {io::TableKind::Mag, {}, {}, 0.0});
    if (!mag.table) return std::nullopt;
    mag.beside_imu = true;
    mag.as.kind.reset();  // found, not named
    return mag;
}

}  // namespace schuler::inspect::detail
