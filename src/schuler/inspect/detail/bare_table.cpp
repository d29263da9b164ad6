// Tables of numbers without a header line, by value.
#include "schuler/inspect/detail/bare_table.h"

#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/inspect/detail/robust.h"
#include "schuler/io/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::inspect::detail {
namespace {

// Numbers of the sample rows of a table without header, column by column.
std::vector<std::vector<double>> sample_columns(const io::TableLayout& layout) {
    std::vector<std::vector<double>> columns(static_cast<std::size_t>(std::max(0, layout.columns)));
    for (const std::vector<std::string>& row : layout.sample) {
        for (std::size_t i = 0; i < columns.size(); ++i)
            columns[i].push_back(i < row.size() ? io::number_from(row[i]) : std::nan(""));
    }
    return columns;
}

double largest(const std::vector<double>& values) {
    double m = 0.0;
    for (const double v : values) m = std::max(m, std::isfinite(v) ? std::abs(v) : 1e300);
    return m;
}

bool ascending(const std::vector<double>& values) {
    for (std::size_t i = 1; i < values.size(); ++i) {
        if (!(values[i] > values[i - 1])) return false;
    }
    return values.size() >= 2;
}

// True if these columns are latitude, longitude (deg) and height of a position on the Earth.
bool is_place(const std::vector<std::vector<double>>& c, std::size_t at) {
    const double lat = median(c[at]), lon = median(c[at + 1]), h = median(c[at + 2]);
    const bool steady =
        quantile(c[at], 1.0) - quantile(c[at], 0.0) < 0.5 && quantile(c[at + 1], 1.0) - quantile(c[at + 1], 0.0) < 0.5;
    return steady && std::abs(lat) > 0.5 && std::abs(lat) <= 90.0 && std::abs(lon) <= 360.0 && h > -1000.0 && h < 60000.0;
}

// Four adjacent columns from `first` on are a unit quaternion.
bool is_rotation(const std::vector<std::vector<double>>& c, std::size_t first) {
    for (std::size_t i = 0; i < c[0].size(); ++i) {
        const double norm = std::hypot(std::hypot(c[first][i], c[first + 1][i]), std::hypot(c[first + 2][i], c[first + 3][i]));
        if (!(std::abs(norm - 1.0) < 1e-3)) return false;
    }
    return true;
}

// Four adjacent columns are a unit quaternion: an attitude, whatever else the numbers could be.
bool has_rotation(const std::vector<std::vector<double>>& c) {
    for (std::size_t first = 1; first + 4 <= c.size(); ++first)
        if (is_rotation(c, first)) return true;
    return false;
}

/// A column of text, such as the names of images, is none of a log of numbers.
bool all_numbers(const std::vector<std::vector<double>>& c) {
    return std::ranges::all_of(c, [](const std::vector<double>& column) {
        return std::ranges::any_of(column, [](double x) { return std::isfinite(x); });
    });
}

/// Over the sample the position of a trajectory (columns 1 to 3) goes where its velocity (4 to 6, north, east, down) leads.
bool goes_with_velocity(const std::vector<std::vector<double>>& c) {
    Eigen::Vector3d led = Eigen::Vector3d::Zero();
    double path = 0.0;
    const std::size_t last = c[0].size() - 1;
    const auto velocity = [&](std::size_t i) { return Eigen::Vector3d(c[4][i], c[5][i], c[6][i]); };
    for (std::size_t i = 1; i <= last; ++i) {
        const Eigen::Vector3d step = 0.5 * (velocity(i) + velocity(i - 1)) * (c[0][i] - c[0][i - 1]);
        led += step;
        path += step.norm();
    }
    const auto place = [&](std::size_t i) { return Geodetic{c[1][i] * units::deg, c[2][i] * units::deg, c[3][i]}; };
    const Eigen::Vector3d gone = earth::ned_difference(earth::Earth{}, place(last), place(0));
    constexpr double digits = 2.0, share = 0.3;  // m, of positions with five decimals; of turns and coarse steps
    return (gone - led).norm() < digits + share * path;
}

// True for rates of a portable instrument: neither positions nor growing angles.
bool could_be_rates(const std::vector<std::vector<double>>& c, double step, bool increments) {
    constexpr double fastest = 35.0;  // rad/s, 2000 deg/s
    constexpr double as_degrees = 57.3;
    for (std::size_t k = 1; k <= 3; ++k)
        if (std::abs(median(c[k])) > fastest * (increments ? step : as_degrees)) return false;
    return true;
}

/// Share of the columns from `first` on that scatter from row to row as sensors do. Positions, velocities and angles of a trajectory change
/// steadily: within a window their successive differences are small against their deviations from the mean (von Neumann's ratio).
bool scatters(const std::vector<std::vector<double>>& c, std::size_t first) {
    constexpr std::size_t window = 10;
    constexpr double steady = 0.15;  // 1 for white noise, 0.06 for a straight line
    std::size_t noisy = 0, varying = 0;
    for (std::size_t k = first; k < first + 6; ++k) {
        double differences = 0.0, deviations = 0.0;
        for (std::size_t i = 0; i + window <= c[k].size(); i += window) {
            double mean = 0.0;
            for (std::size_t j = i; j < i + window; ++j) mean += c[k][j] / static_cast<double>(window);
            for (std::size_t j = i; j < i + window; ++j) {
                deviations += std::pow(c[k][j] - mean, 2);
                if (j > i) differences += std::pow(c[k][j] - c[k][j - 1], 2);
            }
        }
        if (!(deviations > 0.0)) continue;
        ++varying;
        noisy += differences > 2.0 * steady * deviations ? 1 : 0;
    }
    return 2 * noisy >= varying && noisy > 0;
}

void name_columns(LoadedFile& file, std::initializer_list<const char*> names) {
    int column = 0;
    for (const char* name : names) {
        io::ColumnMatch match;
        match.canonical = name;
        match.file_name = fmt::format("#{}", column + 1);
        match.column = column++;
        match.unit_stated = true;  // checked by value if relevant
        file.plan.matches.push_back(match);
        file.column_map[name] = match.file_name;
    }
}

}  // namespace

// Tables of numbers without a header line: the formats of the KF-GINS program and similar ones, by value.
bool recognise_without_header(LoadedFile& file, const io::TableLayout& layout) {
    const std::vector<std::vector<double>> c = sample_columns(layout);
    if (c.size() < 7 || !ascending(c[0]) || !all_numbers(c)) return false;
    const bool week_first = c.size() >= 8 && largest(c[0]) < 5000.0 && std::floor(c[0][0]) == c[0][0];
    if (!week_first && (c.size() == 7 || c.size() == 13) && is_place(c, 1)) {
        file.report.kind = "kfgins_gnss";
        file.table = io::TableKind::Gnss;
        file.plan.kind = io::TableKind::Gnss;
        if (c.size() == 7) name_columns(file, {"time_s", "lat_deg", "lon_deg", "height_m", "std_n_m", "std_e_m", "std_d_m"});
        else {
            name_columns(file, {"time_s", "lat_deg", "lon_deg", "height_m", "std_n_m", "std_e_m", "std_d_m", "vel_n_m_s",
                                "vel_e_m_s", "vel_d_m_s", "std_vn_m_s", "std_ve_m_s", "std_vd_m_s"});
        }
        return true;
    }
    if (c.size() == 10 && is_place(c, 1) && !is_rotation(c, 1) && goes_with_velocity(c)) {
        file.report.kind = "kfgins_reference";
        file.table = io::TableKind::Reference;
        file.plan.kind = io::TableKind::Reference;
        name_columns(file, {"time_s", "lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg",
                            "pitch_deg", "heading_deg"});
        return true;
    }
    if (c.size() >= 7 && c.size() <= 9 && !has_rotation(c)) {
        std::vector<double> steps, norms;
        for (std::size_t i = 0; i < c[0].size(); ++i) {
            if (i > 0) steps.push_back(c[0][i] - c[0][i - 1]);
            norms.push_back(std::hypot(c[4][i], c[5][i], c[6][i]));
        }
        const double norm = median(norms), step = median(steps);
        const bool increments = std::abs(norm / step / 9.8 - 1.0) < 0.3 && std::abs(norm / 9.8 - 1.0) > 0.5;
        if (!increments && std::abs(norm / 9.8 - 1.0) > 0.3) return false;
        if (!could_be_rates(c, step, increments) || quantile(norms, 0.9) > 4.0 * norm) return false;
        if (!increments && !scatters(c, 1)) return false;  // a trajectory at the height of gravity
        file.report.kind = increments ? "kfgins_imu" : "imu";
        file.table = io::TableKind::Imu;
        file.plan.kind = io::TableKind::Imu;
        if (increments)
            name_columns(file, {"time_s", "dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_m_s", "dv_y_m_s", "dv_z_m_s"});
        else
            name_columns(
                file, {"time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"});
        if (!increments)
            file.problem(Level::Warning, "no header line: the columns were taken for time, gyro x y z, accel x y z",
                         "put a header line first");
        return true;
    }
    return false;
}

}  // namespace schuler::inspect::detail
