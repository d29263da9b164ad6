#include "serve/results.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/io/container/hdf5_file.h"
#include "schuler/io/text/split.h"
#include "schuler/report/decimate.h"
#include "serve/csv_columns.h"
#include "serve/message.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <span>

namespace schuler::serve {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t most_kept_values = 100'000'000;  // 800 MB
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string group_of(const std::string& path) { return path.substr(0, path.rfind('/')); }

fs::path h5_of(const fs::path& folder) {
    std::error_code ec;
    if (!fs::is_regular_file(folder / "run.h5", ec))
        throw Refusal{404, "this run has no run.h5", "run it again with all outputs"};
    return folder / "run.h5";
}

const CsvGroup* csv_group(const std::string& name) {
    const auto it = std::ranges::find_if(csv_groups(), [&](const CsvGroup& g) { return name == g.group; });
    return it == csv_groups().end() ? nullptr : &*it;
}

/// The CSV file with the table, or none.
fs::path csv_of(const fs::path& folder, const std::string& path) {
    std::error_code ec;
    const CsvGroup* g = csv_group(group_of(path));
    return g == nullptr || (g->alone && fs::is_regular_file(folder / "run.h5", ec)) ? fs::path{} : folder / g->file;
}

/// Changes with the file.
std::string key_of(const fs::path& folder, const std::string& path) {
    const fs::path csv = csv_of(folder, path), file = csv.empty() ? h5_of(folder) : csv;
    std::error_code ec;
    return fmt::format("{}|{}|{}|{}", file.string(), fs::last_write_time(file, ec).time_since_epoch().count(),
                       fs::file_size(file, ec), path);
}

double origin_of(const io::Hdf5Reader& file) { return std::strtod(file.attribute("/", "origin_s").c_str(), nullptr); }

ColumnTable read_table(const fs::path& folder, const std::string& path) {
    if (const fs::path csv = csv_of(folder, path); !csv.empty()) {
        ColumnTable out = csv_columns(csv, path.ends_with("/time_s"));
        if (path.ends_with("/time_s") && csv_group(group_of(path))->absolute) {
            const double origin = origin_of(io::Hdf5Reader(h5_of(folder)));
            for (double& t : out.columns.at(0)) t -= origin;
        }
        return out;
    }
    const io::Hdf5Reader file(h5_of(folder));
    ColumnTable out;
    out.columns = file.columns(path);
    const bool time = path.ends_with("/time_s");
    out.names = time ? std::vector<std::string>{"time"} : io::split(file.attribute(path, "columns"), ',');
    out.units = io::split(file.attribute(path, "units"), ',');
    out.names.resize(out.columns.size());
    out.units.resize(out.columns.size(), out.units.empty() ? "" : out.units.front());
    if (time) {
        const double shift = origin_of(file);
        for (std::vector<double>& column : out.columns)
            for (double& t : column) t -= shift;
    }
    return out;
}

/// Groups with a time axis, their names from the root, one level of subgroups too.
std::vector<std::string> groups_of(const io::Hdf5Reader& file) {
    std::vector<std::string> out;
    for (const std::string& name : file.names("/")) {
        std::vector<std::string> inner;
        try {
            inner = file.names("/" + name);
        } catch (const Error&) {
            continue;  // a table, not a group
        }
        if (std::ranges::find(inner, "time_s") != inner.end()) {
            out.push_back("/" + name);
            continue;
        }
        for (const std::string& sub : inner) out.push_back("/" + name + "/" + sub);
    }
    return out;
}

void append(std::string& out, const std::vector<double>& values, const std::vector<std::size_t>& rows) {
    out += '[';
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i > 0) out += ',';
        const double x = values[rows[i]];
        if (std::isfinite(x)) fmt::format_to(std::back_inserter(out), "{}", x);
        else out += "null";
    }
    out += ']';
}

/// Rows to send: all, or the extremes in each bucket of every column with numbers there.
std::vector<std::size_t> chosen_rows(std::size_t first, std::size_t last, const std::vector<const std::vector<double>*>& values,
                                     std::size_t points) {
    // of too many rows the extremes: the first of them alone would be taken for all
    if (points == 0) points = last - first <= most_whole_rows ? most_whole_rows : most_rows;
    std::vector<std::size_t> rows;
    if (last - first > points) {
        std::vector<std::span<const double>> channels;
        for (const auto* v : values) {
            const std::span<const double> part(v->data() + first, last - first);
            if (std::ranges::any_of(part, [](double x) { return std::isfinite(x); })) channels.push_back(part);
        }
        rows = report::decimate(channels, points * std::max<std::size_t>(1, channels.size()));
        for (std::size_t& r : rows) r += first;
    }
    if (rows.empty())
        for (std::size_t r = first; r < last && rows.size() < std::max(points, most_rows); ++r) rows.push_back(r);
    return rows;
}

std::string json_string(const std::string& text) { return Json(text).dump(-1, ' ', false, Json::error_handler_t::replace); }

Geodetic position(const ColumnTable& t, std::size_t r) {
    return {t.columns[0][r] * units::deg, t.columns[1][r] * units::deg, t.columns[2][r]};
}

double wrapped_deg(double x) { return x - 360.0 * std::round(x / 360.0); }

}  // namespace

std::string series_text(const ColumnTable& time, const std::vector<const std::vector<double>*>& values,
                        const SeriesRequest& request, const std::vector<std::string>& units) {
    const auto& t = time.columns.front();
    std::size_t first = 0, last = t.size();
    if (request.to > request.from) {
        // one row beyond each end, so that lines reach the edges of the plot
        first = static_cast<std::size_t>(std::lower_bound(t.begin(), t.end(), request.from) - t.begin());
        last = static_cast<std::size_t>(std::upper_bound(t.begin(), t.end(), request.to) - t.begin());
        if (first > 0) --first;
        if (last < t.size()) ++last;
        last = std::max(first, last);
    }
    const std::vector<std::size_t> rows = chosen_rows(first, last, values, request.points);
    std::string out = fmt::format("{{\"rows\":{},\"thinned\":{},\"time_s\":", last - first, rows.size() < last - first);
    append(out, t, rows);
    out += ",\"columns\":{";
    for (std::size_t c = 0; c < values.size(); ++c) {
        out += (c > 0 ? "," : "") + json_string(request.columns[c]) + ":";
        append(out, *values[c], rows);
    }
    out += "},\"units\":{";
    for (std::size_t c = 0; c < values.size(); ++c)
        out += (c > 0 ? "," : "") + json_string(request.columns[c]) + ":" + json_string(units[c]);
    return out + "}}";
}

Results::Table Results::kept(const std::string& key) {
    const auto it = std::ranges::find(kept_, key, &Kept::key);
    if (it == kept_.end()) return nullptr;
    kept_.splice(kept_.begin(), kept_, it);
    return kept_.front().table;
}

Results::Table Results::keep(const std::string& key, ColumnTable table) {
    kept_.push_front({key, std::make_shared<const ColumnTable>(std::move(table))});
    const Table made = kept_.front().table;
    std::size_t values = 0;
    for (auto it = kept_.begin(); it != kept_.end();) {
        values += it->table->rows() * it->table->columns.size();
        it = values > most_kept_values && it != kept_.begin() ? kept_.erase(it) : std::next(it);
    }
    return made;
}

Results::Table Results::table(const fs::path& folder, const std::string& path) {
    const std::string key = key_of(folder, path);
    if (Table found = kept(key)) return found;
    try {
        return keep(key, read_table(folder, path));
    } catch (const Error& e) {
        throw Refusal{404, fmt::format("no table {} in this run: {}", path, e.reason())};
    }
}

Results::Table Results::local(const fs::path& folder, const std::string& group, const fs::path& origin) {
    const std::string key = key_of(folder, group + "/local") + key_of(origin, "");
    if (Table found = kept(key)) return found;
    const Table from = table(origin, "/solution/position"), here = table(folder, group + "/position");
    if (from->rows() == 0) throw Refusal{404, "this run has no positions"};
    const Geodetic zero = position(*from, 0);
    const earth::Earth earth;
    ColumnTable out{
        std::vector<std::vector<double>>(3, std::vector<double>(here->rows(), nan)), {"north", "east", "up"}, {"m", "m", "m"}};
    for (std::size_t r = 0; r < here->rows(); ++r) {
        const Eigen::Vector3d ned = earth::ned_difference(earth, position(*here, r), zero);
        out.columns[0][r] = ned.x();
        out.columns[1][r] = ned.y();
        out.columns[2][r] = -ned.z();
    }
    return keep(key, std::move(out));
}

Json Results::channels(const fs::path& folder) {
    const std::lock_guard lock(mutex_);
    Json out = Json::array();
    std::error_code ec;
    const auto add_group = [&](const std::string& group, const Json& columns) {
        const auto& t = table(folder, group + "/time_s")->columns.at(0);
        out.push_back({{"group", group},
                       {"rows", t.size()},
                       {"start_s", t.empty() ? Json(nullptr) : Json(t.front())},
                       {"stop_s", t.empty() ? Json(nullptr) : Json(t.back())},
                       {"columns", columns}});
    };
    for (const CsvGroup& g : csv_groups()) {
        const bool h5 = fs::is_regular_file(folder / "run.h5", ec);
        if (!fs::is_regular_file(folder / g.file, ec) || (g.alone && h5) || (g.absolute && !h5)) continue;
        const std::string path = std::string(g.group) + "/table";
        const Table all = table(folder, path);
        Json columns = Json::array();
        for (std::size_t c = 0; c < all->names.size(); ++c)
            columns.push_back({{"id", path + ":" + all->names[c]}, {"name", all->names[c]}, {"unit", all->units[c]}});
        add_group(g.group, columns);
    }
    if (!out.empty() && !fs::is_regular_file(folder / "run.h5", ec)) return out;
    std::vector<std::pair<std::string, std::vector<std::string>>> groups;
    {
        const io::Hdf5Reader file(h5_of(folder));
        for (const std::string& group : groups_of(file)) groups.emplace_back(group, file.names(group));
    }
    for (const auto& [group, names] : groups) {
        Json columns = Json::array();
        const auto add = [&](const std::string& path, const std::vector<std::string>& labels,
                             const std::vector<std::string>& units) {
            for (std::size_t c = 0; c < labels.size(); ++c)
                columns.push_back(
                    {{"id", path + ":" + labels[c]}, {"name", labels[c]}, {"unit", units[std::min(c, units.size() - 1)]}});
        };
        const io::Hdf5Reader file(h5_of(folder));
        for (const std::string& name : names) {
            if (name.starts_with("time_")) continue;
            const std::string path = group + "/" + name;
            const std::vector<std::string> labels = io::split(file.attribute(path, "columns"), ',');
            add(path, labels, io::split(file.attribute(path, "units"), ','));
            if (labels.front() == "number")
                columns[columns.size() - labels.size()]["names"] = io::split(file.attribute(path, "names"), ',');
            if (name == "position" && labels.front() == "lat") add(group + "/local", {"north", "east", "up"}, {"m"});
        }
        add_group(group, columns);
    }
    return out;
}

bool Results::has_tables(const fs::path& folder) {
    std::error_code ec;
    const auto there = [&](const CsvGroup& g) { return !g.absolute && fs::is_regular_file(folder / g.file, ec); };
    return fs::is_regular_file(folder / "run.h5", ec) || std::ranges::any_of(csv_groups(), there);
}

void Results::read_all(const fs::path& folder) {
    std::set<std::string> paths;
    for (const Json& group : channels(folder))
        for (const Json& column : group["columns"]) {
            const std::string id = column["id"].get<std::string>(), path = id.substr(0, id.rfind(':'));
            if (!path.ends_with("/local")) paths.insert(path);  // those are computed
        }
    const std::lock_guard lock(mutex_);
    for (const std::string& path : paths) {
        const std::size_t rows = table(folder, group_of(path) + "/time_s")->rows();
        try {
            const bool same = csv_of(folder, path).empty() ? io::Hdf5Reader(h5_of(folder)).read_through(path) == rows
                                                           : read_table(folder, path).rows() == rows;
            if (!same) throw Refusal{404, "the tables of this group differ in length"};
        } catch (const Error& e) {
            throw Refusal{404, fmt::format("no table {} in this run: {}", path, e.reason())};
        }
    }
}

std::string Results::series(const fs::path& folder, const SeriesRequest& request, const fs::path& origin) {
    std::unique_lock lock(mutex_);
    std::string group;
    std::vector<const std::vector<double>*> values;
    std::vector<std::string> units;
    std::vector<Table> alive;
    if (request.columns.empty() || request.columns.size() > 64) throw Refusal{422, "request 1 to 64 columns", {}, "columns"};
    for (const std::string& id : request.columns) {
        const std::size_t colon = id.rfind(':');
        const std::string path = id.substr(0, colon == std::string::npos ? 0 : colon);
        if (path.size() < 4 || path.front() != '/' || path.rfind('/') == 0 || path.find('\0') != std::string::npos)
            throw Refusal{422, fmt::format("\"{}\" is not a column", id), "take the ids of /channels", "columns"};
        if (!group.empty() && group_of(path) != group)
            throw Refusal{422, "columns of different groups have different times", "request one group at a time", "columns"};
        group = group_of(path);
        alive.push_back(path == group + "/local" ? local(folder, group, origin) : table(folder, path));
        const Table& t = alive.back();
        const auto name = std::ranges::find(t->names, id.substr(colon + 1));
        if (name == t->names.end())
            throw Refusal{404, fmt::format("there is no column {}", id), "take the ids of /channels", "columns"};
        values.push_back(&t->columns[static_cast<std::size_t>(name - t->names.begin())]);
        units.push_back(t->units[static_cast<std::size_t>(name - t->names.begin())]);
    }
    const Table time = table(folder, group + "/time_s");
    for (const auto* v : values)
        if (v->size() != time->rows()) throw Refusal{404, "the tables of this group differ in length"};
    lock.unlock();  // nothing is read from here on: others need not wait
    return series_text(*time, values, request, units);
}

Results::Table Results::subtracted(const fs::path& folder, const fs::path& other) {
    const std::string key = key_of(folder, "-") + key_of(other, "");
    if (Table found = kept(key)) return found;
    const auto all = [&](const fs::path& from) {
        return std::array<Table, 4>{table(from, "/solution/time_s"), table(from, "/solution/position"),
                                    table(from, "/solution/velocity"), table(from, "/solution/attitude")};
    };
    const auto a = all(folder), b = all(other);
    // absolute times: the origins of two runs may differ
    const double shift = origin_of(io::Hdf5Reader(h5_of(folder))) - origin_of(io::Hdf5Reader(h5_of(other)));
    const auto &ta = a[0]->columns[0], &tb = b[0]->columns[0];
    ColumnTable out{std::vector<std::vector<double>>(9, std::vector<double>(ta.size(), nan)),
                    {"north", "east", "down", "v_north", "v_east", "v_down", "roll", "pitch", "heading"},
                    {"m", "m", "m", "m/s", "m/s", "m/s", "deg", "deg", "deg"}};
    const earth::Earth earth;
    std::size_t j = 0;
    for (std::size_t i = 0; i < ta.size(); ++i) {
        const double t = ta[i] + shift;
        while (j + 2 < tb.size() && tb[j + 1] <= t) ++j;
        if (tb.size() < 2 || t < tb.front() - 1e-6 || t > tb.back() + 1e-6) continue;
        const double part = std::clamp((t - tb[j]) / (tb[j + 1] - tb[j]), 0.0, 1.0);
        if (tb[j + 1] - tb[j] > 1.5) continue;  // the other run has no data there
        const Eigen::Vector3d from = earth::ned_difference(earth, position(*b[1], j), position(*a[1], i));
        const Eigen::Vector3d to = earth::ned_difference(earth, position(*b[1], j + 1), position(*a[1], i));
        const Eigen::Vector3d away = -(from + part * (to - from));
        for (std::size_t c = 0; c < 3; ++c) {
            out.columns[c][i] = away[static_cast<Eigen::Index>(c)];
            const auto &v = b[2]->columns[c], &angle = b[3]->columns[c];
            out.columns[3 + c][i] = a[2]->columns[c][i] - (v[j] + part * (v[j + 1] - v[j]));
            out.columns[6 + c][i] = wrapped_deg(a[3]->columns[c][i] - angle[j] - part * wrapped_deg(angle[j + 1] - angle[j]));
        }
    }
    return keep(key, std::move(out));
}

std::string Results::difference(const fs::path& folder, const fs::path& other, const SeriesRequest& request) {
    std::unique_lock lock(mutex_);
    const Table made = subtracted(folder, other), time = table(folder, "/solution/time_s");
    lock.unlock();
    SeriesRequest all = request;
    all.columns.clear();
    std::vector<const std::vector<double>*> values;
    for (std::size_t c = 0; c < made->columns.size(); ++c) {
        all.columns.push_back("difference:" + made->names[c]);
        values.push_back(&made->columns[c]);
    }
    return series_text(*time, values, all, made->units);
}

}  // namespace schuler::serve
