// Receiver solutions in formats that room io reads as a whole: RTKLIB .pos and NMEA.
#include "schuler/core/log.h"
#include "schuler/core/units.h"
#include "schuler/inspect/detail/recognise.h"
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/solution/rtklib_pos.h"

#include <fmt/format.h>

#include <cmath>

namespace schuler::inspect::detail {
namespace {

void add_column(LoadedFile& file, const char* canonical, std::vector<double> values,
                io::HeightKind height = io::HeightKind::Unstated) {
    bool any = false;
    for (const double v : values) any = any || std::isfinite(v);
    if (!any) return;
    io::ColumnMatch match;
    match.canonical = match.file_name = canonical;
    match.unit_stated = true;
    match.certainty = io::Certainty::Exact;
    match.height = height;
    file.plan.matches.push_back(match);
    file.columns[canonical] = std::move(values);
}

template <class Value>
std::vector<double> each(const std::vector<GnssFix>& fixes, Value value) {
    std::vector<double> values;
    values.reserve(fixes.size());
    for (const GnssFix& fix : fixes) values.push_back(value(fix));
    return values;
}

void take_fixes(LoadedFile& file, const std::vector<GnssFix>& fixes, io::HeightKind height) {
    file.table = file.plan.kind = io::TableKind::Gnss;
    for (const GnssFix& fix : fixes) {
        file.time_ns.push_back(fix.time.ns);
        file.fix.push_back(fix.fix);
    }
    io::ColumnMatch time;
    time.canonical = time.file_name = "time_s";
    time.unit_stated = true;
    time.certainty = io::Certainty::Exact;
    file.plan.matches.push_back(time);
    add_column(file, "lat_deg", each(fixes, [](const GnssFix& f) { return f.position.lat / units::deg; }));
    add_column(file, "lon_deg", each(fixes, [](const GnssFix& f) { return f.position.lon / units::deg; }));
    add_column(file, "height_m", each(fixes, [](const GnssFix& f) { return f.position.h; }), height);
    static constexpr const char* velocity[] = {"vel_n_m_s", "vel_e_m_s", "vel_d_m_s"};
    static constexpr const char* sigma[] = {"std_n_m", "std_e_m", "std_d_m"};
    static constexpr const char* sigma_velocity[] = {"std_vn_m_s", "std_ve_m_s", "std_vd_m_s"};
    for (int axis = 0; axis < 3; ++axis) {
        add_column(file, velocity[axis], each(fixes, [=](const GnssFix& f) { return f.velocity_n(axis); }));
        add_column(file, sigma[axis], each(fixes, [=](const GnssFix& f) { return f.std_position(axis); }));
        add_column(file, sigma_velocity[axis], each(fixes, [=](const GnssFix& f) { return f.std_velocity(axis); }));
    }
}

}  // namespace

void read_receiver_solution(LoadedFile& file) {
    WarningLog log;
    if (file.report.kind == "nmea") {
        const io::NmeaLog nmea = io::read_nmea(io::TextInput(file.path), log);
        take_fixes(file, nmea.fixes, nmea.height);
        file.gps_time = nmea.has_date;
        file.fix_table = "NMEA quality";
        if (!nmea.has_date) {
            file.problem(Level::Warning, "no sentence gives the date: times are seconds of the UTC day",
                         "log RMC or ZDA sentences too, or give [time] date = ...");
        }
    } else {
        const io::RtklibPos pos = io::read_rtklib_pos(io::TextInput(file.path), log);
        take_fixes(file, pos.fixes, pos.height);
        file.gps_time = true;
        file.fix_table = "RTKLIB Q";
    }
    for (const io::ColumnMatch& match : file.plan.matches) file.report.columns.push_back(match.canonical);
    for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
}

}  // namespace schuler::inspect::detail
