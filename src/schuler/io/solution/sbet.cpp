// Smoothed best estimates of trajectory (SBET): records of seventeen doubles without a header.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/bytes.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::io {
namespace {

constexpr std::size_t fields = 17, record_size = fields * sizeof(double);
using SbetRecord = std::array<double, fields>;

SbetRecord record_at(std::string_view bytes, std::size_t row) {
    return detail::load<SbetRecord>(bytes.data() + row * record_size);
}

bool is_record(const SbetRecord& r) {
    constexpr double pi = std::numbers::pi;
    const auto angle = [](double x) { return std::abs(x) <= 2.0 * pi + 1e-9; };
    return r[0] >= 0.0 && r[0] < 4e9 && std::abs(r[1]) <= 0.5 * pi && angle(r[2]) && std::abs(r[3]) < 1e6 &&
           std::abs(r[4]) < 1e4 && std::abs(r[5]) < 1e4 && std::abs(r[6]) < 1e4 && (angle(r[7]) || std::isnan(r[7])) &&
           (angle(r[8]) || std::isnan(r[8])) && (std::abs(r[9]) < 20.0 || std::isnan(r[9])) && std::abs(r[10]) < 20.0 &&
           (r[1] != 0.0 || r[2] != 0.0);
}

bool is_sbet(const FileHead& head) {
    const std::string_view bytes = head.bytes;
    if (bytes.size() < record_size) return false;
    if (bytes.size() < 65'536 && bytes.size() % record_size != 0 && head.extension != ".sbet" && head.extension != ".out")
        return false;
    double before = -1.0;
    for (std::size_t i = 0; i < bytes.size() / record_size && i < 50; ++i) {
        const SbetRecord r = record_at(bytes, i);
        if (!is_record(r) || r[0] < before) return false;
        before = r[0];
    }
    return true;
}

/// Velocities are in the wander frame: x north, y west, z up for zero wander angle, as written by Applanix; other programs write y east, or
/// z down. The positions of the file show which: the displacement between records half a second apart has the direction of the velocity.
struct Signs {
    double east = -1.0, down = -1.0;  ///< of the velocities' y and z
    bool east_shown = false, down_shown = false;
};
Signs signs_of(std::string_view bytes) {
    const std::size_t rows = bytes.size() / record_size;
    std::size_t apart = 1;
    constexpr double long_enough = 0.5;  // s
    while (apart + 1 < rows && record_at(bytes, apart)[0] - record_at(bytes, 0)[0] < long_enough) ++apart;
    struct Agreement {
        double together = 0.0, way = 0.0, velocity = 0.0;
        void add(double w, double v) { together += w * v, way += w * w, velocity += v * v; }
        [[nodiscard]] bool clear() const {
            constexpr double clear = 0.3;  // of the correlation
            return std::abs(together) > clear * std::sqrt(way * velocity);
        }
        [[nodiscard]] double sign() const { return clear() && together > 0.0 ? 1.0 : -1.0; }
    } east, down;
    constexpr std::size_t most = 20'000;
    for (std::size_t i = 0, step = std::max<std::size_t>(1, rows / most); i + apart < rows; i += step) {
        const SbetRecord a = record_at(bytes, i), b = record_at(bytes, i + apart);
        const double dt = b[0] - a[0];
        if (!is_record(a) || !is_record(b) || !(dt > 0.0) || dt > 10.0) continue;
        const earth::Radii radii = earth::radii(earth::wgs84, a[1]);
        const double to_east =
            std::remainder(b[2] - a[2], 2.0 * std::numbers::pi) * (radii.prime_vertical + a[3]) * std::cos(a[1]) / dt;
        const double fallen = (a[3] - b[3]) / dt;
        const double c = std::cos(a[10]), w = std::sin(a[10]);
        const double slope = -w * a[4];  // contribution of the velocity's x to the east due to the wander angle
        east.add(to_east - slope, c * 0.5 * (a[5] + b[5]));
        down.add(fallen, 0.5 * (a[6] + b[6]));
    }
    return {east.sign(), down.sign(), east.clear(), down.clear()};
}

StreamLog read_sbet(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    StreamLog log;
    Stream s("reference", TableKind::Reference, "SBET",
             {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg",
              "heading_deg"});
    std::size_t damaged = 0, first = 0;
    double latest = 0.0, across = 0.0, upright = 0.0;
    const Signs signs = signs_of(bytes);
    for (std::size_t i = 0; i < bytes.size() / record_size; ++i) {
        const SbetRecord r = record_at(bytes, i);
        if (!is_record(r)) {
            if (damaged++ == 0) first = i * record_size;
            continue;
        }
        // the wander frame is rotated relative to north by the wander angle: heading is the platform heading minus it
        const double c = std::cos(r[10]), w = std::sin(r[10]), y = signs.east * r[5];
        s.add(Duration::from_seconds(r[0]).ns,
              {r[1] / units::deg, r[2] / units::deg, r[3], c * r[4] + w * y, -w * r[4] + c * y, signs.down * r[6],
               r[7] / units::deg, r[8] / units::deg, math::wrap_2pi(r[9] - r[10]) / units::deg});
        latest = std::max(latest, r[0]);
        across += r[5] * r[5];
        upright += r[6] * r[6];
    }
    constexpr double week = 604'800.0;
    log.clock = latest <= 2.0 * week ? Clock::SecondsOfWeek : Clock::Gps;
    if (damaged > 0)
        warnings.add(input.name() + " sbet.damaged",
                     fmt::format("{}: damaged records, the first at byte {}: skipped", input.name(), first), damaged);
    if (bytes.size() % record_size != 0)
        warnings.add(input.name() + " sbet.cut", fmt::format("{}: the file is cut in the record at byte {}: read up to there",
                                                             input.name(), bytes.size() / record_size * record_size));
    constexpr double matters = 0.05;  // m/s RMS
    const auto tell = [&](bool shown, double squares, const char* component, const char* taken) {
        if (shown || squares <= matters * matters * static_cast<double>(s.rows())) return;
        warnings.add(
            fmt::format("{} sbet.signs.{}", input.name(), component),
            fmt::format(
                "{}: its positions do not show the sign of the velocities' {} component: taken for {}, as Applanix writes it",
                input.name(), component, taken));
    };
    tell(signs.east_shown, across, "second", "west");
    tell(signs.down_shown, upright, "third", "up");
    log.add(std::move(s));
    if (log.streams.empty())
        throw input_error("holds no record of an SBET", place_in(input.name()),
                          "records have 17 doubles: time, latitude, longitude, ...");
    return log;
}

void write_sbet(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
    std::string out;
    out.reserve(rows.size() * record_size);
    constexpr std::int64_t week = 604'800'000'000'000;
    for (const SolutionRow& r : rows) {
        const bool dated = r.time.ns > 2 * week;
        const SbetRecord record = {Duration{dated ? r.time.ns % week : r.time.ns}.seconds(),
                                   r.position.lat,
                                   r.position.lon,
                                   r.position.h,
                                   r.v_eb_n.x(),
                                   -r.v_eb_n.y(),
                                   -r.v_eb_n.z(),
                                   r.rpy.x(),
                                   r.rpy.y(),
                                   r.rpy.z()};
        detail::store(out, record);
    }
    write_file(path, out);
}

}  // namespace

extern const Format sbet_format;
const Format sbet_format = {
    .name = "sbet",
    .title = "SBET",
    .extensions = ".sbet .out",
    .holds =
        "position, velocity and attitude (the wander angle taken out) as reference; accelerations and rates are not an IMU's and are left; written with "
        "seconds of the week, velocities north, west, up, wander angle, accelerations and rates zero",
    .time = "seconds of the GPS week",
    .recognise = is_sbet,
    .read = read_sbet,
    .write = write_sbet};

}  // namespace schuler::io
