#include "schuler/io/streams.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/fixed_point.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::io {
namespace {

const char* word_of(FixType fix) {
    switch (fix) {
        case FixType::None: return "none";
        case FixType::Autonomous: return "autonomous";
        case FixType::Differential: return "differential";
        case FixType::RtkFixed: return "rtk_fixed";
        case FixType::RtkFloat: return "rtk_float";
        case FixType::Unknown: return "";
    }
    return "";
}

}  // namespace

std::string_view time_name(Clock clock) {
    switch (clock) {
        case Clock::Gps: return "time_gps_s";
        case Clock::SecondsOfWeek: return "gps_sow_s";
        case Clock::Unix: return "time_utc_s";
        case Clock::Boot: return "time_s";
    }
    return "time_s";
}

Stream::Stream(std::string stream_name, TableKind of_kind, std::string made_of, std::initializer_list<const char*> names)
    : name(std::move(stream_name)), source(std::move(made_of)), kind(of_kind) {
    for (const char* column : names) columns.push_back({column, {}});
}

void Stream::add(std::int64_t ns, std::initializer_list<double> values) {
    time_ns.push_back(ns);
    std::size_t i = 0;
    for (const double value : values) columns[i++].values.push_back(value);
}

const Stream::Column* Stream::find(std::string_view column) const {
    const auto it = std::ranges::find(columns, column, &Column::name);
    return it == columns.end() ? nullptr : &*it;
}

const Stream* StreamLog::find(std::string_view name) const {
    const auto it = std::ranges::find(streams, name, &Stream::name);
    return it == streams.end() ? nullptr : &*it;
}

void StreamLog::add(Stream stream) {
    if (stream.rows() == 0) return;
    std::erase_if(stream.columns, [](const Stream::Column& c) {
        return std::ranges::none_of(c.values, [](double v) { return std::isfinite(v); });
    });
    if (stream.columns.empty()) return;
    const std::string stem = stream.name;
    auto number = std::ranges::count_if(streams, [&](const Stream& s) { return s.name.starts_with(stem); });
    for (; find(stream.name) != nullptr; ++number) stream.name = fmt::format("{}{}", stem, std::max<std::ptrdiff_t>(number, 1));
    streams.push_back(std::move(stream));
}

std::string table_text(const Stream& stream, Clock clock) {
    std::string text(time_name(clock));
    for (const Stream::Column& c : stream.columns) text += "," + c.name;
    if (!stream.fix.empty()) text += ",fix";
    text += '\n';
    text.reserve(text.size() + stream.rows() * (stream.columns.size() * 14 + 20));
    char cell[io::widest_number];
    for (std::size_t i = 0; i < stream.rows(); ++i) {
        text.append(cell, put_seconds(cell, stream.time_ns[i]));
        for (const Stream::Column& c : stream.columns) {
            text += ',';
            if (std::isfinite(c.values[i])) fmt::format_to(std::back_inserter(text), "{}", c.values[i]);
        }
        if (!stream.fix.empty()) text.append(",").append(word_of(stream.fix[i]));
        text += '\n';
    }
    return text;
}

Stream stream_of(const std::vector<GnssFix>& fixes, HeightKind height, std::string source) {
    const char* height_name = height == HeightKind::Ellipsoidal ? "height_ellipsoidal_m"
                              : height == HeightKind::Msl       ? "height_msl_m"
                                                                : "height_m";
    Stream s("gnss", TableKind::Gnss, std::move(source),
             {"lat_deg", "lon_deg", height_name, "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "std_n_m", "std_e_m", "std_d_m",
              "std_vn_m_s", "std_ve_m_s", "std_vd_m_s", "satellites"});
    for (const GnssFix& f : fixes) {
        const auto &v = f.velocity_n, &p = f.std_position, &sv = f.std_velocity;
        s.add(f.time.ns,
              {f.position.lat / units::deg, f.position.lon / units::deg, f.position.h, v.x(), v.y(), v.z(), p.x(), p.y(), p.z(),
               sv.x(), sv.y(), sv.z(), f.satellites < 0 ? not_given : static_cast<double>(f.satellites)});
        s.fix.push_back(f.fix);
    }
    return s;
}

StreamPath stream_path(const std::filesystem::path& path) {
    const std::string text = path.string();
    const std::size_t mark = text.rfind('#');
    std::error_code ec;
    if (mark == std::string::npos || std::filesystem::exists(path, ec)) return {path, {}};
    const std::filesystem::path file = text.substr(0, mark);
    if (!std::filesystem::exists(file, ec)) return {path, {}};
    return {file, text.substr(mark + 1)};
}

const Stream& stream_of_log(const StreamLog& log, const StreamPath& where) {
    if (const Stream* stream = log.find(where.stream)) return *stream;
    std::string names;
    for (const Stream& s : log.streams) names += (names.empty() ? "" : ", ") + s.name;
    throw input_error(fmt::format("holds no stream \"{}\"", where.stream), place_in(where.file.string()),
                      names.empty() ? "it holds none that is used" : "it holds " + names);
}

TextInput LogFiles::open(const std::filesystem::path& path, WarningLog& warnings) {
    StreamPath where = stream_path(path);
    if (where.stream.empty()) {
        // a track is not a table; the other files of one log have their own readers
        std::error_code ec;
        const Format* format = std::filesystem::is_regular_file(path, ec) ? format_of(path) : nullptr;
        if (format == nullptr || format->name != "gpx") return {path};
        where.stream = "gnss";
    }
    if (const auto have = tables_.find(path); have != tables_.end()) return TextInput::memory(have->second, path.string());
    auto log = logs_.find(where.file);
    if (log == logs_.end()) {
        const Format* format = format_of(where.file);
        if (format == nullptr || format->read == nullptr)
            throw input_error("is not a log of several instruments", place_in(where.file.string()),
                              "give the file name without # and what follows");
        log = logs_.emplace(where.file, format->read(TextInput(where.file), warnings)).first;
    }
    const Stream& stream = stream_of_log(log->second, where);
    return TextInput::memory(tables_.emplace(path, table_text(stream, log->second.clock)).first->second, path.string());
}

}  // namespace schuler::io
