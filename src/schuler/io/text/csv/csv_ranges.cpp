#include "schuler/io/text/csv/csv_ranges.h"

#include "schuler/core/units.h"
#include "schuler/gnss/satellite.h"
#include "schuler/io/text/detail/position_columns.h"
#include "schuler/io/text/detail/sample_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>

namespace schuler::io {
namespace {

using detail::optional_number;
using detail::RowAudit;
using detail::SampleColumns;

/// "G05" and similar; anything else is a station.
bool is_satellite(std::string_view name) {
    return name.size() == 3 && std::string_view("GRECJSI").find(name[0]) != std::string_view::npos &&
           std::isdigit(static_cast<unsigned char>(name[1])) != 0 && std::isdigit(static_cast<unsigned char>(name[2])) != 0;
}

/// One row with its time.
struct TimedRange {
    Time time;
    RangeSample sample;
};

struct Fields {
    std::size_t source, pseudorange, rate, std, std_rate, cn0, x, y, z, vx, vy, vz, clock, clock_rate;
};

Fields request(SampleColumns& c) {
    Fields f{};
    f.source = c.add("source", true, 1.0, FieldKind::Text);
    f.pseudorange = c.add("pseudorange_m", true);
    f.rate = c.add("range_rate_m_s", false);
    f.std = c.add("std_m", false);
    f.std_rate = c.add("std_rate_m_s", false);
    f.cn0 = c.add("cn0_db_hz", false);
    f.x = c.add("tx_x_m", false);
    f.y = c.add("tx_y_m", false);
    f.z = c.add("tx_z_m", false);
    f.vx = c.add("tx_vx_m_s", false);
    f.vy = c.add("tx_vy_m_s", false);
    f.vz = c.add("tx_vz_m_s", false);
    f.clock = c.add("tx_clock_s", false);
    f.clock_rate = c.add("tx_clock_rate", false);
    return f;
}

double or_zero(double x) { return std::isfinite(x) ? x : 0.0; }

/// Epochs from samples in time order.
void group(const std::vector<TimedRange>& rows, RangingLog& log, const RowAudit& audit) {
    std::size_t repeated = 0;
    for (const TimedRange& r : rows) {
        if (log.epochs.empty() || log.epochs.back().time != r.time) log.epochs.push_back({r.time, log.samples.size(), 0});
        RangeEpoch& e = log.epochs.back();
        const auto same = log.of(e);
        if (std::ranges::find(same, r.sample.source, &RangeSample::source) != same.end()) {
            ++repeated;
            continue;
        }
        log.samples.push_back(r.sample);
        ++e.count;
    }
    audit.warn("repeated", "rows with a duplicate source at one time: skipped", repeated);
}

}  // namespace

RangesTable read_ranges_csv(const TextInput& input, const CsvOptions& options, WarningLog& log) {
    SampleColumns columns(input, TableKind::Ranges, options);
    RangesTable table;
    table.plan = columns.plan();
    columns.add("time_s", true, 1.0, FieldKind::Time);
    const Fields f = request(columns);
    TableReader reader = columns.reader();
    RowAudit audit(input.name(), columns.section(), log);
    std::size_t absurd = 0;
    const auto make = [&](const TableReader& row, TimedRange& out) {
        const std::string name(row.text(f.source));
        RangeSample& m = out.sample;
        m.pseudorange = row.number(f.pseudorange);
        if (name.empty() || !(m.pseudorange > 0.0 && m.pseudorange < 1e9) || table.log.sources.size() > 60'000) {
            ++absurd;
            return false;
        }
        m.source = table.log.source(name, !is_satellite(name));
        m.range_rate = optional_number(row, f.rate);
        m.std = optional_number(row, f.std);
        m.std_rate = optional_number(row, f.std_rate);
        m.cn0 = optional_number(row, f.cn0);
        m.tx.r = {optional_number(row, f.x), optional_number(row, f.y), optional_number(row, f.z)};
        m.tx_velocity = {optional_number(row, f.vx), optional_number(row, f.vy), optional_number(row, f.vz)};
        m.tx_clock = or_zero(optional_number(row, f.clock));
        m.tx_clock_rate = or_zero(optional_number(row, f.clock_rate));
        if (is_satellite(name)) m.frequency = gnss::l1_frequency;
        return true;
    };
    auto rows = detail::read_samples<TimedRange>(reader, audit, columns.layout().estimated_rows, options.time_offset, make);
    audit.warn("absurd", "rows without a source or with a pseudorange out of range: skipped", absurd);
    if (audit.counts().out_of_order > 0) std::ranges::stable_sort(rows, {}, &TimedRange::time);
    group(rows, table.log, audit);
    table.rows = audit.counts();
    return table;
}

std::vector<StationRow> read_stations_csv(const TextInput& input, const CsvOptions& options, WarningLog& log) {
    SampleColumns columns(input, TableKind::Stations, options);
    const std::size_t id = columns.add("id", true, 1.0, FieldKind::Text);
    const std::size_t lat = columns.add("lat_deg", true), lon = columns.add("lon_deg", true), h = columns.add("height_m", true);
    TableReader reader = columns.reader();
    RowAudit audit(input.name(), columns.section(), log);
    std::vector<StationRow> out;
    while (reader.next()) {
        audit.read_row();
        if (!reader.row_ok()) {
            audit.bad_row(reader);
            continue;
        }
        const StationRow row{std::string(reader.text(id)),
                             {reader.number(lat) * units::deg, reader.number(lon) * units::deg, reader.number(h)}};
        if (!(std::abs(reader.number(lat)) <= 90.0 && std::abs(reader.number(lon)) <= 360.0 && std::abs(row.position.h) < 1e4))
            throw reader.field_error(lat, fmt::format("{} is at no place on the Earth", row.id),
                                     "give degrees, and metres of height");
        if (std::ranges::find(out, row.id, &StationRow::id) != out.end())
            throw reader.field_error(id, fmt::format("duplicate {}", row.id), "leave one of the rows");
        out.push_back(row);
        audit.time(reader.line(), reader.line());
    }
    audit.finish(reader);
    return out;
}

std::string ranges_csv(const RangingLog& log) {
    std::string out =
        "time_s,source,pseudorange_m,range_rate_m_s,std_m,std_rate_m_s,cn0_db_hz,tx_x_m,tx_y_m,tx_z_m,tx_vx_m_s,tx_vy_m_s,"
        "tx_vz_m_s,tx_clock_s,tx_clock_rate\n";
    const auto number = [&out](double x, int decimals) {
        out += ',';
        if (std::isfinite(x)) fmt::format_to(std::back_inserter(out), "{:.{}f}", x, decimals);
    };
    for (const RangeEpoch& e : log.epochs) {
        for (const RangeSample& m : log.of(e)) {
            fmt::format_to(std::back_inserter(out), "{:.9f},{}", e.time.seconds(), log.sources[m.source].name);
            for (const double x : {m.pseudorange, m.range_rate, m.std, m.std_rate}) number(x, 6);
            number(m.cn0, 1);
            for (int i = 0; i < 3; ++i) number(m.tx.r(i), 6);
            for (int i = 0; i < 3; ++i) number(m.tx_velocity(i), 6);
            fmt::format_to(std::back_inserter(out), ",{:.17g},{:.17g}\n", m.tx_clock, m.tx_clock_rate);
        }
    }
    return out;
}

std::string stations_csv(const std::vector<StationRow>& stations) {
    std::string out = "id,lat_deg,lon_deg,height_m\n";
    for (const StationRow& s : stations)
        out += fmt::format("{},{:.12f},{:.12f},{:.6f}\n", s.id, s.position.lat / units::deg, s.position.lon / units::deg,
                           s.position.h);
    return out;
}

}  // namespace schuler::io
