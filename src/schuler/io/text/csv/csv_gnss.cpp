#include "schuler/core/units.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/io/place.h"
#include "schuler/io/text/csv/csv_recording.h"
#include "schuler/io/text/detail/position_columns.h"
#include "schuler/io/text/fix_codes.h"
#include "schuler/io/text/held_rows.h"
#include "schuler/io/text/idle_velocities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace schuler::io {

using detail::optional_number;
using detail::PositionColumns;
using detail::RowAudit;
using detail::SampleColumns;

namespace detail {

PositionColumns::PositionColumns(SampleColumns& columns, bool required) : section_(columns.section()) {
    geodetic_ = columns.has("lat_deg") || columns.has("lon_deg");
    ecef_ = !geodetic_ && columns.has("ecef_x_m") && columns.has("ecef_y_m") && columns.has("ecef_z_m");
    if (required && !geodetic_ && !ecef_) throw columns.missing("lat_deg");
    const auto needed = [&](const char* name) {
        if (geodetic_ && required && !columns.has(name)) throw columns.missing(name);
    };
    needed("lat_deg");
    needed("lon_deg");
    needed("height_m");
    lat_ = columns.add("lat_deg", false, units::deg);
    lon_ = columns.add("lon_deg", false, units::deg);
    height_ = columns.add("height_m", false);
    x_ = columns.add("ecef_x_m", false);
    y_ = columns.add("ecef_y_m", false);
    z_ = columns.add("ecef_z_m", false);
    vn_ = columns.add("vel_n_m_s", false);
    ve_ = columns.add("vel_e_m_s", false);
    vd_ = columns.add("vel_d_m_s", false);
}

Geodetic PositionColumns::position(const TableReader& row) const {
    if (!geodetic_) {
        const Eigen::Vector3d r(optional_number(row, x_), optional_number(row, y_), optional_number(row, z_));
        const double distance = r.norm();
        if (!ecef_ || std::isnan(distance) || distance == 0.0) return {not_given, not_given, not_given};
        if (distance < 6.3e6 || distance > 1e8) {
            throw row.field_error(
                x_, fmt::format("the position lies {:.6g} m from the Earth's centre", distance),
                fmt::format("is the unit km? write [{}] scale = {{ ecef_m = 1000 }}, or name the right columns", section_));
        }
        return earth::geodetic_from_ecef(earth::wgs84, Ecef{r});
    }
    Geodetic p{optional_number(row, lat_), optional_number(row, lon_), optional_number(row, height_)};
    constexpr double quarter = 0.5 * std::numbers::pi;
    if (std::abs(p.lat) > quarter + 1e-9) {
        throw row.field_error(
            lat_, fmt::format("a latitude of {:.8g} deg", p.lat / units::deg),
            fmt::format(
                "is it longitude, in degrees and minutes (ddmm.mmmm), or in units of 1e-7 deg? write [{0}] columns = {{ lat_deg = ... }} or [{0}] scale = "
                "{{ lat_deg = 1e-7, lon_deg = 1e-7 }}",
                section_));
    }
    if (std::abs(p.lon) > 4.0 * quarter + 1e-9) {
        throw row.field_error(
            lon_, fmt::format("a longitude of {:.8g} deg", p.lon / units::deg),
            fmt::format("is it in units of 1e-7 deg? write [{}] scale = {{ lat_deg = 1e-7, lon_deg = 1e-7 }}", section_));
    }
    if (std::abs(p.h) > 1e8) {
        throw row.field_error(height_, fmt::format("a height of {:.6g} m", p.h),
                              fmt::format("is the unit mm? write [{}] scale = {{ height_m = 0.001 }}", section_));
    }
    if (p.lon > 2.0 * quarter) p.lon -= 4.0 * quarter;
    if (p.lon < -2.0 * quarter) p.lon += 4.0 * quarter;
    return p;
}

Eigen::Vector3d PositionColumns::velocity_n(const TableReader& row) const {
    return {optional_number(row, vn_), optional_number(row, ve_), optional_number(row, vd_)};
}

}  // namespace detail

namespace {

/// Optional data of a GNSS row beside position and velocity.
struct GnssFields {
    std::size_t time_valid, velocity_time_valid, fix, carrier, satellites;
    std::size_t std_n, std_e, std_d, std_h, std_vn, std_ve, std_vd, std_vel;
};

GnssFields request_fields(SampleColumns& columns) {
    GnssFields f{};
    f.time_valid = columns.add("time_valid_s", false, 1.0, FieldKind::Time);
    f.velocity_time_valid = columns.add("vel_time_valid_s", false, 1.0, FieldKind::Time);
    f.fix = columns.add("fix", false, 1.0, FieldKind::Text);
    f.carrier = columns.add("carrier_solution", false);
    f.satellites = columns.add("satellites", false);
    f.std_n = columns.add("std_n_m", false);
    f.std_e = columns.add("std_e_m", false);
    f.std_d = columns.add("std_d_m", false);
    f.std_h = columns.add("std_h_m", false);
    f.std_vn = columns.add("std_vn_m_s", false);
    f.std_ve = columns.add("std_ve_m_s", false);
    f.std_vd = columns.add("std_vd_m_s", false);
    f.std_vel = columns.add("std_vel_m_s", false);
    return f;
}

double first_given(double a, double b) { return std::isnan(a) ? b : a; }

/// One sigma; a negative one means unknown.
double sigma(double value) { return value < 0.0 ? not_given : value; }

void read_sigmas(const TableReader& row, const GnssFields& f, GnssFix& fix) {
    // A horizontal sigma combines both components.
    const double horizontal = optional_number(row, f.std_h) * std::numbers::sqrt2 / 2.0;
    const double velocity = optional_number(row, f.std_vel);
    fix.std_position = {sigma(first_given(optional_number(row, f.std_n), horizontal)),
                        sigma(first_given(optional_number(row, f.std_e), horizontal)), sigma(optional_number(row, f.std_d))};
    fix.std_velocity = {sigma(first_given(optional_number(row, f.std_vn), velocity)),
                        sigma(first_given(optional_number(row, f.std_ve), velocity)),
                        sigma(first_given(optional_number(row, f.std_vd), velocity))};
}

/// Age of a channel relative to its stamp, from columns with the time of validity.
void read_ages(const TableReader& row, const GnssFields& f, GnssFix& fix) {
    const auto age = [&](std::size_t field) {
        const std::int64_t valid = field == SampleColumns::absent ? TableReader::no_time : row.time_ns(field);
        if (valid == TableReader::no_time) return not_given;
        const double seconds = Duration{fix.time.ns - valid}.seconds();
        constexpr double week = 604'800.0;  // around its end one may have restarted and the other not
        return std::abs(seconds) > 0.5 * week && std::abs(seconds) < 1.5 * week ? seconds - std::copysign(week, seconds)
                                                                                : seconds;
    };
    const double whole = age(f.time_valid);
    fix.position_age = first_given(whole, 0.0);
    fix.velocity_age = first_given(age(f.velocity_time_valid), fix.position_age);
}

/// Codes of fixes not in any table.
class UnknownCodes {
public:
    void add(const std::string& code) { ++counts_[code]; }
    /// Throws if more than a few rows have one: the user must state their meaning, it is not guessed.
    void ask(const std::string& file, const std::string& table, std::size_t rows) const {
        std::size_t n = 0;
        for (const auto& [code, count] : counts_) n += count;
        constexpr std::size_t accidents = 2;
        if (n <= accidents || static_cast<double>(n) <= 0.05 * static_cast<double>(rows)) return;
        throw input_error(
            fmt::format("{} of {} rows have a fix code that is not known: {} (read as {})", n, rows, list(), table),
            place_in(file, 0, 0, "gnss.fix_codes"),
            fmt::format("state its meaning: [gnss] fix_codes = {{ \"{}\" = \"none\" }}, or autonomous, differential, "
                        "rtk_float, rtk_fixed",
                        counts_.begin()->first));
    }
    void tell(const std::string& file, WarningLog& log) const {
        for (const auto& [code, n] : counts_)
            log.add("gnss.fix.unknown",
                    fmt::format("{}: rows whose fix code is not known, the first '{}': skipped (state its meaning in "
                                "[gnss] fix_codes)",
                                file, code),
                    n);
    }

private:
    [[nodiscard]] std::string list() const {
        std::string text;
        for (const auto& [code, n] : counts_) text += fmt::format("{}'{}'", text.empty() ? "" : ", ", code);
        return text;
    }
    std::map<std::string, std::size_t> counts_;
};

/// Fixes written again with every row of a faster log are one fix each.
void drop_held(std::vector<GnssFix>& fixes, RowAudit& audit) {
    using detail::same_value, detail::same_vector;
    std::vector<bool> repeats(fixes.size(), false);
    for (std::size_t i = 1; i < fixes.size(); ++i) {
        const GnssFix &a = fixes[i - 1], &b = fixes[i];
        repeats[i] = a.position.lat == b.position.lat && a.position.lon == b.position.lon &&
                     same_value(a.position.h, b.position.h) && same_vector(a.velocity_n, b.velocity_n);
    }
    const std::vector<std::size_t> held = held_rows(repeats);
    if (held.empty()) return;
    std::size_t kept = 0, next = 0;
    for (std::size_t i = 0; i < fixes.size(); ++i) {
        if (next < held.size() && held[next] == i) ++next;
        else fixes[kept++] = fixes[i];
    }
    fixes.resize(kept);
    audit.counts().used = kept;
    audit.warn("held", "rows that repeat the fix before, which is held over the rows of a faster log: one fix each", held.size());
}

bool no_position(const Geodetic& p) {
    if (std::isnan(p.lat) && std::isnan(p.lon)) return true;
    return p.lat == 0.0 && p.lon == 0.0;  // written by receivers before their first fix
}

}  // namespace

GnssTable read_gnss_csv(const TextInput& input, const CsvOptions& options, WarningLog& log) {
    SampleColumns columns(input, TableKind::Gnss, options);
    GnssTable table;
    table.plan = columns.plan();
    columns.add("time_s", true, 1.0, FieldKind::Time);
    const PositionColumns position(columns, true);
    const GnssFields fields = request_fields(columns);
    const ColumnMatch* fix_column = columns.plan().find("fix");
    const FixCodes codes =
        FixCodes::for_column(fix_column != nullptr ? fix_column->file_name : "fix", options.fix_codes, input.name(),
                             count_fix_codes(input, columns.layout(), columns.plan()), columns.has("carrier_solution"));
    UnknownCodes unknown;
    if (fix_column != nullptr) table.fix_table = codes.table();
    const ColumnMatch* height = columns.plan().find("height_m");
    table.height = height != nullptr ? height->height : HeightKind::Ellipsoidal;  // Earth-fixed positions are ellipsoidal

    TableReader reader = columns.reader();
    RowAudit audit(input.name(), columns.section(), log);
    const auto make = [&](const TableReader& row, GnssFix& fix) {
        if (fix_column != nullptr) {
            fix.fix = codes.of(row.text(fields.fix));
            if (fix.fix == FixType::Unknown && !row.text(fields.fix).empty()) {
                unknown.add(std::string(row.text(fields.fix)));
                return false;
            }
            const double carrier = optional_number(row, fields.carrier);  // u-blox: 1 float, 2 fixed
            if (carrier >= 1.0 && fix.fix != FixType::None) fix.fix = carrier >= 2.0 ? FixType::RtkFixed : FixType::RtkFloat;
        }
        fix.position = position.position(row);
        if (fix.fix == FixType::None || no_position(fix.position)) {
            ++audit.counts().without_fix;
            return false;
        }
        if (std::isnan(fix.position.lat) || std::isnan(fix.position.lon) || std::isnan(fix.position.h)) {
            audit.bad_row(row, position.missing_field(fix.position));
            return false;
        }
        fix.velocity_n = position.velocity_n(row);
        read_sigmas(row, fields, fix);
        read_ages(row, fields, fix);
        const double satellites = optional_number(row, fields.satellites);
        fix.satellites = satellites >= 0.0 && satellites < 1000.0 ? static_cast<int>(satellites) : -1;
        return true;
    };
    try {
        table.fixes = detail::read_samples<GnssFix>(reader, audit, columns.layout().estimated_rows, options.time_offset, make);
    } catch (const Error&) {
        unknown.ask(input.name(), codes.table(), audit.counts().read);  // the more informative reason, if applicable
        throw;
    }
    unknown.ask(input.name(), codes.table(), audit.counts().read);
    unknown.tell(input.name(), log);
    audit.warn("no_fix", "rows without a fix: skipped", audit.counts().without_fix);
    detail::put_in_time_order(table.fixes, audit, [](const GnssFix& a, const GnssFix& b) {
        return a.position.lat == b.position.lat && a.position.lon == b.position.lon && a.position.h == b.position.h &&
               detail::same_vector(a.velocity_n, b.velocity_n);
    });
    drop_held(table.fixes, audit);
    if (has_idle_velocities(table.fixes)) {
        for (GnssFix& fix : table.fixes) fix.velocity_n = not_given3();
        audit.warn("idle_velocity", "velocities that are always zero although the positions travel: left out",
                   table.fixes.size());
    }
    table.rows = audit.counts();
    return table;
}

}  // namespace schuler::io
