#include "schuler/inspect/detail/loaded_file.h"

#include "schuler/core/error.h"
#include "schuler/inspect/detail/recognise.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/fix_codes.h"
#include "schuler/io/text/held_rows.h"
#include "schuler/io/text/lonely_samples.h"
#include "schuler/io/text/number.h"
#include "schuler/io/text/open_dates.h"
#include "schuler/io/text/repair_times.h"
#include "schuler/io/text/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace schuler::inspect::detail {
namespace {

// Fields requested from the table reader: the time first, then every other matched column.
std::vector<io::FieldRequest> requests_of(const io::ColumnPlan& plan) {
    std::vector<io::FieldRequest> requests;
    const auto add = [&](const io::ColumnMatch& match) {
        io::FieldRequest r = io::request_of(match);
        r.required = match.canonical == "time_s";
        requests.push_back(std::move(r));
    };
    add(*plan.find("time_s"));
    for (const io::ColumnMatch& match : plan.matches) {
        if (match.canonical != "time_s") add(match);
    }
    return requests;
}

// A column being filled; `slot` is its index among the requests.
struct Sink {
    std::size_t slot;
    io::FieldKind kind;
    std::vector<double>* values;
};

std::vector<Sink> sinks_of(LoadedFile& file, std::size_t expected) {
    std::vector<Sink> sinks;
    std::size_t slot = 1;
    for (const io::ColumnMatch& match : file.plan.matches) {
        if (match.canonical == "time_s") continue;
        const io::FieldKind kind = io::request_of(match).kind;
        std::vector<double>* values = nullptr;
        if (kind != io::FieldKind::Text) {
            values = &file.columns[match.canonical];
            values->reserve(expected);
        }
        sinks.push_back({slot++, kind, values});
    }
    return sinks;
}

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void LoadedFile::problem(Level level, std::string text, std::string hint) {
    report.problems.push_back({level, std::move(text), std::move(hint)});
}

void LoadedFile::add_to_times(double seconds) {
    const std::int64_t ns = Duration::from_seconds(seconds).ns;
    for (std::int64_t& t : time_ns) t += ns;
    cadence_origin_ns += ns;
    report.start_s += seconds;
    report.stop_s += seconds;
}

Eigen::Vector3d LoadedFile::vector(const std::string& x, const std::string& y, const std::string& z, std::size_t row) const {
    const auto value = [&](const std::string& name) {
        const auto it = columns.find(name);
        return it == columns.end() ? missing : it->second[row];
    };
    return {value(x), value(y), value(z)};
}

void read_table(LoadedFile& file, const io::TableLayout& layout) {
    const io::ColumnMatch* fix = file.plan.find("fix");
    const io::FixCodes codes = io::FixCodes::for_column(
        fix != nullptr ? fix->file_name : "fix", file.as.fix_codes, file.path.string(),
        io::count_fix_codes(io::TextInput(file.path), layout, file.plan), file.plan.find("carrier_solution") != nullptr);
    if (fix != nullptr) {
        file.fix_table = codes.table();
        file.fix_by_evidence = codes.by_evidence();
    }
    const std::vector<Sink> sinks = sinks_of(file, layout.estimated_rows);
    std::size_t without_time = 0, unknown_codes = 0;
    std::string unknown_code;
    try {
        io::TableReader reader(io::TextInput(file.path), layout, requests_of(file.plan));
        while (reader.next()) {
            const std::int64_t ns = reader.time_ns(0);
            if (!reader.row_ok() || ns == io::TableReader::no_time) {
                ++without_time;
                continue;
            }
            file.time_ns.push_back(ns);
            for (const Sink& sink : sinks) {
                if (sink.kind == io::FieldKind::Text) {
                    file.fix.push_back(codes.of(reader.text(sink.slot)));
                    if (!reader.text(sink.slot).empty())
                        file.fix_codes.try_emplace(std::string(reader.text(sink.slot)), file.fix.back());
                    if (file.fix.back() == FixType::Unknown && unknown_codes++ == 0) unknown_code = reader.text(sink.slot);
                } else if (sink.kind == io::FieldKind::Time) {
                    const std::int64_t t = reader.time_ns(sink.slot);
                    sink.values->push_back(t == io::TableReader::no_time ? missing : static_cast<double>(t - ns) * 1e-9);
                } else {
                    const double x = reader.number(sink.slot);  // a value not explained by any unit is an outlier
                    sink.values->push_back(std::abs(x) < 1e15 ? x : missing);
                }
            }
        }
        if (reader.last_line_dropped()) {
            file.problem(Level::Warning, "the last line looks cut in the middle of a number and was left out",
                         "copy the log completely");
        }
    } catch (const Error& e) {
        file.problem(Level::Error, e.reason(),
                     e.hint().empty() ? "copy the log completely, or delete the damaged line" : e.hint());
    }
    if (without_time > 0) {
        if (const io::ColumnMatch* time = file.plan.find("time_s"); time != nullptr)
            if (const std::string readings = io::readings_of_open_date(layout, time->column); !readings.empty())
                file.problem(Level::Error, readings, "write the dates with the year first (2024-03-05 14:00:00.25)");
        file.problem(Level::Warning, fmt::format("{} rows without a usable time were left out", without_time),
                     "look at their time column");
    }
    if (unknown_codes > 0) {
        file.problem(Level::Warning,
                     fmt::format("{} rows have a fix code that is not known (\"{}\")", unknown_codes, unknown_code),
                     fmt::format("state its meaning: [gnss] fix_codes = {{ {} = \"autonomous\" }}",
                                 unknown_code.empty() ? "1" : unknown_code));
    }
}

void take_cadence(LoadedFile& file) {
    file.cadence_origin_ns = file.time_ns.front();
    std::vector<double> seconds;
    seconds.reserve(file.time_ns.size());
    for (const std::int64_t ns : file.time_ns) seconds.push_back(static_cast<double>(ns - file.cadence_origin_ns) * 1e-9);
    file.cadence = cadence_of(seconds);
    const Cadence& c = file.cadence;
    file.report.rows = c.rows;
    file.report.rate_hz = c.rate_hz;
    file.report.gaps = c.gaps.size();
    file.report.duplicates = c.duplicates;
    const double origin = static_cast<double>(file.cadence_origin_ns) * 1e-9;
    file.report.holes.clear();
    for (const Gap& gap : c.gaps) file.report.holes.push_back({origin + gap.start, gap.length});
    file.report.start_s = origin + c.start;
    file.report.stop_s = origin + c.stop;
}

namespace {

void report_cadence(LoadedFile& file) {
    const Cadence& c = file.cadence;
    const double origin = static_cast<double>(file.cadence_origin_ns) * 1e-9;
    const bool raw = !file.table && !file.report.contents.empty();
    const bool sampled = raw || file.table == io::TableKind::Imu || file.table == io::TableKind::Gnss;
    if (!c.gaps.empty() && sampled) {
        const auto longest =
            std::max_element(c.gaps.begin(), c.gaps.end(), [](const Gap& a, const Gap& b) { return a.length < b.length; });
        file.problem(longest->length > 0.1 ? Level::Warning : Level::Info,
                     fmt::format("{} gap{}, the longest {:.3g} s after t = {:.2f} s", c.gaps.size(),
                                 c.gaps.size() == 1 ? "" : "s", longest->length, origin + longest->start),
                     "nothing to do: gaps are bridged with growing uncertainty; check the logger if they were not expected");
    }
    const double share = static_cast<double>(c.missing) / static_cast<double>(c.missing + c.rows);
    if (share > 0.01 && file.table == io::TableKind::Imu) {
        file.problem(Level::Warning,
                     fmt::format("{} of {} samples are missing ({:.0f} %) against the median step of {:.4g} s", c.missing,
                                 c.missing + c.rows, 100.0 * share, c.step),
                     "log with more bandwidth if you can; the motion between samples is interpolated");
    } else if (c.irregular > 0.05 && file.table == io::TableKind::Imu) {
        file.problem(Level::Info,
                     fmt::format("the step is irregular: {:.0f} % of the steps differ from {:.4g} s by more than a quarter",
                                 100.0 * c.irregular, c.step),
                     "nothing to do: the time stamps are used as they are");
    }
    if (c.backwards > 0) {
        file.problem(c.backwards * 10 > c.rows ? Level::Error : Level::Warning,
                     fmt::format("the time goes backwards {} times", c.backwards),
                     c.backwards * 10 > c.rows ? "name another time column: columns = { time_s = \"...\" }"
                                               : "nothing to do: rows are sorted by time");
    }
    if (c.duplicates > 0) {
        file.problem(c.duplicates * 20 > c.rows ? Level::Warning : Level::Info,
                     fmt::format("{} rows repeat the time of the row before", c.duplicates),
                     "nothing to do: exact repetitions are dropped");
    }
    if (c.rows < 2 && !raw)
        file.problem(Level::Error, fmt::format("only {} usable row{}", c.rows, c.rows == 1 ? "" : "s"),
                     "check that the log was copied completely");
}

/// The first of the sample rows' cells in this column that is text and no number; empty for a stream, or if there is none.
std::string first_text(const LoadedFile& file, const io::ColumnMatch& match) {
    if (file.computed || !io::stream_path(file.path).stream.empty()) return {};
    try {
        const io::TableLayout layout = io::inspect_table(io::TextInput(file.path));
        for (const std::vector<std::string>& row : layout.sample) {
            const auto column = static_cast<std::size_t>(match.column);
            if (column < row.size() && !io::is_missing_value(row[column]) && std::isnan(io::number_from(row[column])))
                return row[column].substr(0, 40);
        }
    } catch (const Error&) {
        // no table of text
    }
    return {};
}

void report_missing_values(LoadedFile& file) {
    for (const auto& [name, values] : file.columns) {
        const auto n =
            static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); }));
        if (n == 0 || values.empty() || file.table == io::TableKind::Reference) continue;
        const double share = static_cast<double>(n) / static_cast<double>(values.size());
        constexpr double many = 0.05, most = 0.5;
        const io::ColumnMatch* match = file.plan.find(name);
        const std::string text = share > many && match != nullptr ? first_text(file, *match) : std::string();
        file.problem(
            share > many ? Level::Warning : Level::Info,
            fmt::format("{} of {} rows have no number in {}{}", n, values.size(), match != nullptr ? match->file_name : name,
                        text.empty() ? "" : fmt::format(", the first '{}'", text)),
            !text.empty()  ? "write plain numbers with a decimal point and without marks of thousands (1521.17, 1.5e-3)"
            : share > most ? "if another column has it, name that one: columns = { ... }"
                           : "nothing to do where they are few: such rows are left out");
    }
}

}  // namespace

namespace {

/// Removes rows, given by ascending indices.
void erase_rows(LoadedFile& file, const std::vector<std::size_t>& which) {
    const auto erase = [&](auto& rows) {
        std::size_t kept = 0, s = 0;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            if (s < which.size() && which[s] == i) ++s;
            else rows[kept++] = rows[i];
        }
        rows.resize(kept);
    };
    erase(file.time_ns);
    for (auto& [name, values] : file.columns) erase(values);
    if (!file.fix.empty()) erase(file.fix);
}

/// The readers omit such rows; here they are reported before a run.
void drop_strays(LoadedFile& file) {
    const io::TimeRepair repair = io::repair_times(file.time_ns);
    if (repair.rollovers > 0) {
        file.problem(Level::Warning, fmt::format("the time restarts after {:.0f} s", static_cast<double>(repair.period) * 1e-9),
                     "nothing to do: it is carried on");
    }
    if (repair.excursions > 0) {
        file.problem(Level::Warning,
                     fmt::format("{} rows are stamped by a clock that was off by {:.9g} s for a while", repair.away,
                                 static_cast<double>(repair.step) * 1e-9),
                     "nothing to do: they are moved back to where they lie evenly between the others");
    }
    if (repair.strays.empty()) return;
    erase_rows(file, repair.strays);
    file.problem(Level::Warning, fmt::format("{} rows have a stamp far from those around them", repair.strays.size()),
                 "nothing to do: they are left out");
}

/// Likewise: rows of another instrument between the fixes of one table, and fixes held over such rows.
void drop_between_fixes(LoadedFile& file) {
    if (!file.has("lat_deg") || !file.has("lon_deg")) return;
    std::vector<std::size_t> blank;
    for (std::size_t i = 0; i < file.time_ns.size(); ++i)
        if (std::isnan(file["lat_deg"][i]) && std::isnan(file["lon_deg"][i])) blank.push_back(i);
    if (blank.size() == file.time_ns.size()) return;
    if (!blank.empty()) {
        erase_rows(file, blank);
        file.problem(Level::Info, fmt::format("{} rows without a position are left out", blank.size()), "");
    }
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    std::vector<bool> repeats(file.time_ns.size(), false);
    for (std::size_t i = 1; i < repeats.size(); ++i)
        repeats[i] =
            std::ranges::all_of(std::array{"lat_deg", "lon_deg", "height_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s"},
                                [&](const char* name) { return !file.has(name) || same(file[name][i], file[name][i - 1]); });
    const std::vector<std::size_t> held = io::held_rows(repeats);
    if (held.empty()) return;
    erase_rows(file, held);
    file.problem(Level::Warning,
                 fmt::format("{} rows repeat the fix before, which is held over the rows of a faster log", held.size()),
                 "nothing to do: each fix is taken once; its time is that of the first row that has it");
}

/// Likewise.
void drop_lonely(LoadedFile& file) {
    if (!file.has("gyro_x_rad_s") || !file.has("accel_x_m_s2")) return;
    std::vector<double> rates, forces;
    for (std::size_t i = 0; i < file.time_ns.size(); ++i) {
        rates.push_back(file.vector("gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", i).cwiseAbs().maxCoeff());
        forces.push_back(file.vector("accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2", i).cwiseAbs().maxCoeff());
    }
    const std::vector<std::size_t> lonely = io::lonely_samples(rates, forces);
    if (lonely.empty()) return;
    erase_rows(file, lonely);
    file.problem(Level::Warning, fmt::format("{} single samples are far beyond all others", lonely.size()),
                 "nothing to do: they are left out");
}

/// As the readers do, which drop exact repetitions.
void spread_times(LoadedFile& file) {
    if (!std::ranges::is_sorted(file.time_ns)) return;
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    std::vector<std::int64_t> times;
    std::vector<std::size_t> place;  // of a row among the distinct ones
    for (std::size_t i = 0; i < file.time_ns.size(); ++i) {
        const bool repeats = i > 0 && file.time_ns[i] == file.time_ns[i - 1] &&
                             std::ranges::all_of(file.columns, [&](const auto& c) { return same(c.second[i], c.second[i - 1]); });
        if (!repeats) times.push_back(file.time_ns[i]);
        place.push_back(times.size() - 1);
    }
    const std::size_t n = io::spread_equal_times(times);
    if (n == 0) return;
    for (std::size_t i = 0; i < place.size(); ++i) file.time_ns[i] = times[place[i]];
    file.problem(Level::Warning, fmt::format("{} rows have the time of another row: it is written too coarsely", n),
                 "they are spread evenly; write the time with all its digits");
}

}  // namespace

LoadedFile load_file(const std::filesystem::path& path, const std::string& name, const ReadAs& as) {
    LoadedFile file;
    file.path = path;
    file.as = as;
    file.report.path = name;
    file.report.kind = "unknown";
    file.report.start_s = file.report.stop_s = missing;
    try {
        recognise_and_read(file);
    } catch (const std::exception& e) {
        const auto* error = dynamic_cast<const Error*>(&e);
        file.problem(Level::Error, error != nullptr ? error->reason() : std::string(e.what()),
                     error != nullptr ? error->hint() : "");
        file.table.reset();
        return file;
    }
    finish(file);
    return file;
}

void finish(LoadedFile& file) {
    if (file.time_ns.empty()) {
        if (file.table) {
            file.problem(Level::Error, "there is no usable row", "check that the log was written and copied completely");
            file.table.reset();
        }
        return;
    }
    if (file.as.time_offset != 0.0) {
        for (std::int64_t& t : file.time_ns) t += Duration::from_seconds(file.as.time_offset).ns;
    }
    drop_strays(file);
    if (file.table == io::TableKind::Gnss) drop_between_fixes(file);
    if (file.table == io::TableKind::Imu) drop_lonely(file);
    if (file.table == io::TableKind::Imu || file.table == io::TableKind::Gnss || file.table == io::TableKind::Mag)
        spread_times(file);
    take_cadence(file);
    report_cadence(file);
    report_missing_values(file);
}

}  // namespace schuler::inspect::detail
