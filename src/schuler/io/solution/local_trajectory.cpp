// Trajectories in a local frame: TUM (time, position, quaternion x y z w) and EuRoC ground truth. Files written here state the
// origin of their east-north-up frame in a comment; files with this comment are read back as positions on the Earth.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/dated.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/detail/last_number.h"
#include "schuler/io/text/fixed_point.h"
#include "schuler/io/text/number.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace schuler::io {
namespace {

constexpr std::string_view origin_words = "# east-north-up about latitude ";

/// Up to `most` numbers of a line, separated by commas or blanks; fewer if there is other text.
std::size_t numbers(std::string_view line, std::span<double> out) {
    std::size_t n = 0;
    while (n < out.size()) {
        const std::size_t start = line.find_first_not_of(" ,\t");
        if (start == std::string_view::npos) break;
        line.remove_prefix(start);
        const std::size_t end = std::min(line.find_first_of(" ,\t"), line.size());
        out[n] = number_from(line.substr(0, end));
        if (std::isnan(out[n]) && line.substr(0, end) != "nan") break;
        ++n;
        line.remove_prefix(end);
    }
    return line.find_first_not_of(" ,\t") == std::string_view::npos ? n : n + 1;
}

bool is_unit(double w, double x, double y, double z) { return std::abs(std::sqrt(w * w + x * x + y * y + z * z) - 1.0) < 0.01; }

bool is_tum(const FileHead& head) {
    if (head.folder) return false;
    std::size_t rows = 0;
    double before = -1e300;
    for (Lines lines(head.bytes); lines.next() && rows < 30;) {
        const std::string_view line = lines.line();
        if (line.empty() || line.front() == '#') continue;
        if (lines.peek() == '\0' && rows > 0) break;  // may be truncated at the end of the head
        std::array<double, 9> v{};
        if (numbers(line, v) != 8 || !is_unit(v[7], v[4], v[5], v[6]) || v[0] <= before) return false;
        before = v[0];
        ++rows;
    }
    return rows > 0;
}

bool is_euroc_truth(const FileHead& head) {
    return head.bytes.substr(0, 400).find("p_RS_R_x") != std::string::npos &&
           head.bytes.substr(0, 400).find("q_RS_w") != std::string::npos;
}

std::optional<Geodetic> origin_in(std::string_view line) {
    if (!line.starts_with(origin_words)) return std::nullopt;
    double lat = 0.0, lon = 0.0, h = 0.0;
    if (std::sscanf(std::string(line).c_str(), "# east-north-up about latitude %lf deg, longitude %lf deg, height %lf m", &lat,
                    &lon, &h) != 3)
        return std::nullopt;
    return Geodetic{lat * units::deg, lon * units::deg, h};
}

StreamLog read_local(const TextInput& input, WarningLog& warnings, bool euroc) {
    const std::string bytes = read_bytes(input);
    const char* name = euroc ? "EuRoC ground truth" : "TUM trajectory";
    Stream s("trajectory", TableKind::Reference, name,
             {"local_x_m", "local_y_m", "local_z_m", "quat_sensor_to_enu_w", "quat_sensor_to_enu_x", "quat_sensor_to_enu_y",
              "quat_sensor_to_enu_z"});
    std::optional<Geodetic> origin;
    std::size_t bad = 0;
    long first_bad = 0;
    bool epochs = true;
    detail::LastNumber above;
    std::size_t columns = 0;
    for (Lines lines(bytes); lines.next();) {
        const std::string_view line = lines.line();
        if (line.empty()) continue;
        if (line.front() == '#') {
            if (const auto found = origin_in(line)) origin = found;
            continue;
        }
        std::array<double, 18> v{};
        const std::size_t n = numbers(line, v);
        std::int64_t ns = 0;
        const std::string_view time = line.substr(0, std::min(line.find_first_of(" ,\t"), line.size()));
        const bool timed = nanoseconds_from(time, euroc ? TimeUnit::Nanoseconds : TimeUnit::Seconds, ns);
        const std::array<double, 4> q = euroc ? std::array{v[4], v[5], v[6], v[7]} : std::array{v[7], v[4], v[5], v[6]};
        if (!timed || n < 8 || !is_unit(q[0], q[1], q[2], q[3])) {
            if (bad++ == 0) first_bad = lines.number();
            continue;
        }
        const detail::LastNumber last = detail::last_number(line);
        const bool unended = lines.peek() == '\0' && !bytes.ends_with('\n');
        if (unended && s.rows() > 0 && (n < columns || detail::may_be_cut(above, last))) {
            warnings.add(input.name() + " trajectory.cut", fmt::format("{}: {}", input.name(), detail::cut_text(lines.number())));
            break;
        }
        above = last;
        columns = n;
        constexpr std::int64_t year_2001 = 1'000'000'000'000'000'000;
        epochs = epochs && ns > year_2001;
        s.add(ns, {v[1], v[2], v[3], q[0], q[1], q[2], q[3]});
    }
    if (s.rows() == 0)
        throw input_error(fmt::format("holds no row of a {}", name), place_in(input.name(), first_bad),
                          "rows have a time, a position and a unit quaternion");
    if (bad > 0)
        warnings.add(input.name() + " trajectory.bad",
                     fmt::format("{}: damaged rows, the first in line {}: skipped", input.name(), first_bad), bad);
    StreamLog log;
    log.clock = epochs ? Clock::Unix : Clock::Boot;
    s.own_frame = !origin;
    if (origin) {
        // written by Schuler: degrees instead of the coordinates
        s.name = "reference";
        s.columns[0].name = "lat_deg";
        s.columns[1].name = "lon_deg";
        s.columns[2].name = "height_ellipsoidal_m";
        const Ecef start = earth::ecef_from_geodetic(earth::wgs84, *origin);
        const Eigen::Matrix3d C_en = earth::C_en(origin->lat, origin->lon);
        for (std::size_t i = 0; i < s.rows(); ++i) {
            const Eigen::Vector3d ned(s.columns[1].values[i], s.columns[0].values[i], -s.columns[2].values[i]);
            const Geodetic p = earth::geodetic_from_ecef(earth::wgs84, Ecef{start.r + C_en * ned});
            s.columns[0].values[i] = p.lat / units::deg;
            s.columns[1].values[i] = p.lon / units::deg;
            s.columns[2].values[i] = p.h;
        }
    }
    log.add(std::move(s));
    return log;
}

StreamLog read_tum(const TextInput& input, WarningLog& warnings) { return read_local(input, warnings, false); }
StreamLog read_euroc_truth(const TextInput& input, WarningLog& warnings) { return read_local(input, warnings, true); }

/// Rows in the east-north-up frame of the first one, with the comment that states its position.
template <class Put>
std::string local_rows(std::span<const SolutionRow> rows, Put put) {
    const Geodetic origin = rows.front().position;
    const Ecef start = earth::ecef_from_geodetic(earth::wgs84, origin);
    const Eigen::Matrix3d C_ne = earth::C_en(origin.lat, origin.lon).transpose();
    Eigen::Matrix3d ned_to_enu;  // north-east-down to east-north-up, and vice versa
    ned_to_enu << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
    std::string out = fmt::format("{}{:.17g} deg, longitude {:.17g} deg, height {:.17g} m\n", origin_words,
                                  origin.lat / units::deg, origin.lon / units::deg, origin.h);
    for (const SolutionRow& r : rows) {
        const Eigen::Vector3d p = ned_to_enu * (C_ne * (earth::ecef_from_geodetic(earth::wgs84, r.position).r - start.r));
        const Eigen::Vector3d rpy = r.rpy.allFinite() ? r.rpy : Eigen::Vector3d::Zero();
        Eigen::Quaterniond q(ned_to_enu * math::dcm_from_rpy(rpy));
        if (q.w() < 0.0) q.coeffs() = -q.coeffs();
        put(out, r, p, q, Eigen::Vector3d(ned_to_enu * r.v_eb_n));
    }
    return out;
}

void refuse_empty(std::span<const SolutionRow> rows) {
    if (rows.empty()) throw input_error("there is no row to write", {}, "choose a trajectory with positions");
}

void write_tum(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
    refuse_empty(rows);
    char cell[widest_number];
    write_file(path, local_rows(rows, [&](std::string& out, const SolutionRow& r, const Eigen::Vector3d& p,
                                          const Eigen::Quaterniond& q, const Eigen::Vector3d&) {
                   out.append(cell, put_seconds(cell, detail::ns_since_1970(r.time)));
                   fmt::format_to(std::back_inserter(out), " {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}\n", p.x(), p.y(),
                                  p.z(), q.x(), q.y(), q.z(), q.w());
               }));
}

void write_euroc(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
    refuse_empty(rows);
    std::string text =
        "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], "
        "v_RS_R_z [m s^-1]\n";
    text += local_rows(rows, [](std::string& out, const SolutionRow& r, const Eigen::Vector3d& p, const Eigen::Quaterniond& q,
                                const Eigen::Vector3d& v) {
        fmt::format_to(std::back_inserter(out), "{},{:.6f},{:.6f},{:.6f},{:.9f},{:.9f},{:.9f},{:.9f},{:.6f},{:.6f},{:.6f}\n",
                       detail::ns_since_1970(r.time), p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z(), v.x(), v.y(), v.z());
    });
    write_file(path, text);
}

}  // namespace

extern const Format tum_format, euroc_format;
const Format tum_format = {
    .name = "tum",
    .title = "TUM trajectory",
    .extensions = ".tum",
    .holds =
        "time, position, unit quaternion: a trajectory in a frame of its own, never an IMU. Written in the east-north-up frame of the first row, which a comment "
        "locates, so that Schuler reads it back as positions on the Earth",
    .time = "as in the file; dated times are written as UTC from 1970",
    .recognise = is_tum,
    .read = read_tum,
    .write = write_tum};
const Format euroc_format = {
    .name = "euroc",
    .title = "EuRoC ground truth",
    .extensions = ".euroc",
    .holds =
        "`p_RS_R`, `q_RS`: a trajectory in a frame of its own; the IMU table (`w_RS_S`, `a_RS_S`) is a table of text. Folders of ASL are looked through. Written as "
        "`tum` is",
    .time = "nanoseconds, UTC from 1970",
    .recognise = is_euroc_truth,
    .read = read_euroc_truth,
    .write = write_euroc};

}  // namespace schuler::io
