#include "schuler/io/container/detail/ros_velocities.h"

#include "schuler/core/samples.h"
#include "schuler/core/units.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace schuler::io::detail {
namespace {

constexpr std::int64_t same_ns = 1'000'000;  // tolerance for stamps of one epoch of a receiver

/// The rows of a stream by time, independent of their order in the log.
class RowsByTime {
public:
    explicit RowsByTime(const std::vector<std::int64_t>& time_ns) {
        for (std::size_t i = 0; i < time_ns.size(); ++i) rows_.emplace_back(time_ns[i], i);
        std::ranges::stable_sort(rows_, {}, &Row::first);
    }
    [[nodiscard]] std::optional<std::size_t> at(std::int64_t ns) const {
        const auto it = std::ranges::lower_bound(rows_, ns - same_ns, {}, &Row::first);
        if (it == rows_.end() || it->first > ns + same_ns) return std::nullopt;
        return it->second;
    }

private:
    using Row = std::pair<std::int64_t, std::size_t>;
    std::vector<Row> rows_;
};

/// Receiver drivers publish the velocity of a fix (east, north, up) as a separate twist with the stamp of the fix. A vehicle's
/// twist in its own axes may have such stamps as well: it does not agree with the track of the fixes.
enum class Fit { None, Contradicts, Unclear, Fits };

Fit fit_of(const Stream& gnss, const Stream& twist) {
    constexpr double least_share = 0.9, some = 0.2;  // of the fixes
    constexpr double longest_step = 2.5,
                     span = 5.0;  // s: of the sum, and of the compared displacements: longer than the fixes' noise
    constexpr double least_length = 20.0, at_rest = 0.3;  // m in total; m/s
    constexpr double agrees = 0.3, contradicts = 0.7;     // 1 - cos of the angle between the displacements
    constexpr double radius = 6.378e6;
    const auto &lat = gnss.columns[0].values, &lon = gnss.columns[1].values;
    const auto &east = twist.columns[0].values, &north = twist.columns[1].values;
    const RowsByTime rows(twist.time_ns);
    std::size_t found = 0, first = 0;
    double fastest = 0.0, length = 0.0, squares = 0.0, off = 0.0, sum_n = 0.0, sum_e = 0.0;
    std::optional<std::size_t> last;
    const auto seconds = [&](std::size_t from, std::size_t to) {
        return 1e-9 * static_cast<double>(gnss.time_ns[to] - gnss.time_ns[from]);
    };
    for (std::size_t i = 0; i < gnss.rows(); ++i) {
        const std::optional<std::size_t> row = rows.at(gnss.time_ns[i]);
        const double dt = i == 0 ? 0.0 : seconds(i - 1, i);
        if (!row || !last || !(dt > 0.0) || dt > longest_step) {
            first = i;
            sum_n = sum_e = 0.0;
        } else {
            const double n = 0.5 * dt * (north[*row] + north[*last]), e = 0.5 * dt * (east[*row] + east[*last]);
            sum_n += n;
            sum_e += e;
            length += std::isfinite(n + e) ? std::hypot(n, e) : 0.0;
            if (seconds(first, i) >= span) {
                const double way_n = (lat[i] - lat[first]) * units::deg * radius;
                const double way_e = (lon[i] - lon[first]) * units::deg * radius * std::cos(lat[i] * units::deg);
                if (const double square = std::pow(way_n - sum_n, 2) + std::pow(way_e - sum_e, 2); std::isfinite(square)) {
                    squares += way_n * way_n + way_e * way_e + sum_n * sum_n + sum_e * sum_e;
                    off += square;
                }
                first = i;
                sum_n = sum_e = 0.0;
            }
        }
        found += row ? 1 : 0;
        if (row) fastest = std::max(fastest, std::hypot(north[*row], east[*row]));
        last = row;
    }
    const double share = static_cast<double>(found) / static_cast<double>(gnss.rows());
    if (share < some) return Fit::None;
    if (share < least_share) return Fit::Unclear;
    if (twist.name == ros_twist_enu) return Fit::Fits;
    if (length < least_length || !(squares > 0.0)) return fastest < at_rest ? Fit::Fits : Fit::Unclear;
    return off < agrees * squares ? Fit::Fits : off > contradicts * squares ? Fit::Contradicts : Fit::Unclear;
}

/// Adds the velocities to the fixes with the same stamp.
void join(Stream& gnss, const Stream& twist) {
    const std::size_t first = gnss.columns.size();
    for (const char* name : {"vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "std_vn_m_s", "std_ve_m_s", "std_vd_m_s"})
        gnss.columns.push_back({name, std::vector<double>(gnss.rows(), not_given)});
    const RowsByTime rows(twist.time_ns);
    for (std::size_t i = 0; i < gnss.rows(); ++i) {
        const std::optional<std::size_t> row = rows.at(gnss.time_ns[i]);
        if (!row) continue;
        const auto value = [&](std::size_t column) { return twist.columns[column].values[*row]; };
        const std::array<double, 6> v{value(1), value(0), -value(2), value(4), value(3), value(5)};
        for (std::size_t k = 0; k < v.size(); ++k) gnss.columns[first + k].values[i] = v[k];
    }
}

}  // namespace

void join_velocities(Stream& gnss, const std::map<std::string, Stream>& streams, const std::string& file, WarningLog& warnings) {
    for (const auto& [topic, twist] : streams) {
        if ((twist.name != ros_twist && twist.name != ros_twist_enu) || twist.rows() == 0) continue;
        const Fit fit = fit_of(gnss, twist);
        if (fit == Fit::Fits) return join(gnss, twist);
        if (fit == Fit::None) continue;
        warnings.add(file + " ros.twist " + topic,
                     fmt::format("{}: {} has times of the fixes of {}, but {}: left out", file, topic, gnss.source,
                                 fit == Fit::Contradicts
                                     ? "is not their velocity to the east, north and up"
                                     : "whether it is their velocity does not show (few of the times, or too little motion)"));
    }
}

std::optional<Stream> with_attitude(const Stream& gnss, const std::map<std::string, Stream>& streams) {
    constexpr double least_share = 0.9;  // of the fixes
    for (const auto& [topic, attitude] : streams) {
        if (attitude.name != ros_attitude || attitude.rows() == 0) continue;
        const RowsByTime rows(attitude.time_ns);
        Stream s = gnss;
        s.name = "solution";
        s.kind = TableKind::Reference;
        s.source += " with " + attitude.source;
        s.fix.clear();
        const std::size_t first = s.columns.size();
        for (const Stream::Column& c : attitude.columns) s.columns.push_back({c.name, std::vector<double>(s.rows(), not_given)});
        std::size_t found = 0;
        for (std::size_t i = 0; i < s.rows(); ++i) {
            const std::optional<std::size_t> row = rows.at(s.time_ns[i]);
            if (!row) continue;
            ++found;
            for (std::size_t k = 0; k < attitude.columns.size(); ++k)
                s.columns[first + k].values[i] = attitude.columns[k].values[*row];
        }
        if (static_cast<double>(found) >= least_share * static_cast<double>(s.rows())) return s;
    }
    return std::nullopt;
}

void leave_out_zero_velocities(Stream& gnss) {
    const auto is_zero = [&](const char* name) {
        const Stream::Column* column = gnss.find(name);
        return column == nullptr || std::ranges::none_of(column->values, [](double v) { return std::isfinite(v) && v != 0.0; });
    };
    const bool vertical = !is_zero("vel_d_m_s"), level = !is_zero("vel_n_m_s") || !is_zero("vel_e_m_s");
    std::erase_if(gnss.columns, [&](const Stream::Column& c) {
        const bool down = c.name == "vel_d_m_s" || c.name == "std_vd_m_s";
        return down ? !vertical : !level && (c.name.starts_with("vel_") || c.name.starts_with("std_v"));
    });
}

}  // namespace schuler::io::detail
