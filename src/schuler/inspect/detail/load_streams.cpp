// Instruments in logs read as a whole by room io: containers, receivers' solutions.
#include "schuler/core/log.h"
#include "schuler/inspect/detail/recognise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::inspect::detail {
namespace {

/// Meaning of the columns of a stream, determined as for a table.
io::ColumnPlan plan_of(const io::Stream& stream, const std::string& time_name, const ReadAs& as) {
    io::TableLayout layout;
    layout.names.push_back(time_name);
    for (const io::Stream::Column& column : stream.columns) layout.names.push_back(column.name);
    if (!stream.fix.empty()) layout.names.emplace_back("fix");
    layout.columns = layout.data_columns = static_cast<int>(layout.names.size());
    return io::match_columns(layout, stream.kind, as.overrides);
}

std::vector<double> scaled(const std::vector<double>& values, const io::ColumnMatch& match) {
    if (match.factor == 1.0 && match.offset == 0.0) return values;
    std::vector<double> out;
    out.reserve(values.size());
    for (const double v : values) out.push_back(v * match.factor + match.offset);
    return out;
}

}  // namespace

std::vector<std::string> explained_columns(const LoadedFile& file) {
    std::vector<std::string> out;
    const io::StreamPath where = io::stream_path(file.path);
    const io::Format* format = nullptr;
    try {
        format = io::format_of(where.file);
    } catch (const Error&) {
        return out;
    }
    if (format != nullptr) out.push_back(fmt::format("format {} ({}), recognised by its content", format->name, format->title));
    else out.emplace_back("of no format that is known (schuler help formats)");
    if (format != nullptr && format->name == "csv" && where.stream.empty() && file.plan.matches.empty() &&
        file.plan.unused.empty()) {
        try {
            const std::vector<std::string> names = io::inspect_table(io::TextInput(where.file)).names;
            if (!names.empty())
                out.push_back(
                    fmt::format("columns without a known name: {}; state their meaning in [imu] or [gnss] columns = {{ ... }}",
                                fmt::join(names, ", ")));
        } catch (const Error&) {  // not a table
        }
    }
    for (const io::ColumnMatch& m : file.plan.matches) {
        std::string line = fmt::format("{} <- {} ({}", m.canonical, m.file_name, io::name_of(m.certainty));
        if (m.canonical.find("time") == std::string::npos && m.factor != 1.0) line += fmt::format(", times {:.9g}", m.factor);
        if (m.canonical.find("time") != std::string::npos)
            line += m.time_unit == io::TimeUnit::Seconds        ? ", seconds"
                    : m.time_unit == io::TimeUnit::Milliseconds ? ", milliseconds"
                    : m.time_unit == io::TimeUnit::Microseconds ? ", microseconds"
                                                                : ", nanoseconds";
        if (m.degrees_minutes) line += ", degrees and minutes";
        if (m.height != io::HeightKind::Unstated) line += fmt::format(", {}", io::name_of(m.height));
        line += m.unit_stated ? ")" : ", unit judged by value)";
        out.push_back(std::move(line));
    }
    if (file.week) out.push_back(fmt::format("{}: GPS week {} of the first row", file.week_column, *file.week));
    if (file.plan.unused.empty()) return out;
    std::string unused;
    for (const std::string& name : file.plan.unused) unused += (unused.empty() ? "" : ", ") + name;
    out.push_back("not used: " + unused);
    return out;
}

void take_stream(LoadedFile& file, const io::Stream& stream, io::Clock clock) {
    const std::string time_name(io::time_name(clock));
    file.plan = plan_of(stream, time_name, file.as);
    if (stream.own_frame) {
        file.report.kind = "trajectory";
        file.report.contents.push_back(stream.source +
                                       ": attitude and position in a local frame that is unrelated to the other logs");
    } else {
        file.table = stream.kind;
    }
    file.time_ns = stream.time_ns;
    file.fix = stream.fix;
    file.gps_time = clock == io::Clock::Gps;
    file.by_arrival = stream.by_arrival;
    for (const io::ColumnMatch& match : file.plan.matches) {
        const auto column = std::ranges::find(stream.columns, match.file_name, &io::Stream::Column::name);
        if (column != stream.columns.end()) file.columns[match.canonical] = scaled(column->values, match);
    }
    file.report.columns.push_back(time_name);
    for (const io::Stream::Column& column : stream.columns) file.report.columns.push_back(column.name);
}

void read_one_stream(LoadedFile& file, const io::Format& format) {
    WarningLog log;
    const io::StreamLog streams = format.read(io::TextInput(file.path), log);
    file.report.kind = format.name;
    if (streams.streams.empty()) return;
    take_stream(file, streams.streams.front(), streams.clock);
    if (format.name == "nmea") {
        file.fix_table = "NMEA quality";
        if (streams.clock != io::Clock::Gps)
            file.problem(Level::Warning, "no sentence gives the date: times are seconds of the UTC day",
                         "log RMC or ZDA sentences too, or give [time] date = ...");
    } else if (format.name == "rtklib_pos") {
        file.fix_table = "RTKLIB Q";
    }
    for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
}

std::vector<LoadedFile> load_streams(const std::filesystem::path& path, const std::string& name, const io::Format& format) {
    std::vector<LoadedFile> files;
    const auto add = [&](const std::string& stream) -> LoadedFile& {
        LoadedFile& file = files.emplace_back();
        file.path = stream.empty() ? path : std::filesystem::path(path.string() + "#" + stream);
        file.report.path = stream.empty() ? name : name + "#" + stream;
        file.report.kind = format.name;
        file.report.start_s = file.report.stop_s = std::nan("");
        return file;
    };
    WarningLog log;
    io::StreamLog streams;
    try {
        streams = format.read(io::TextInput(path), log);
    } catch (const std::exception& e) {
        const auto* error = dynamic_cast<const Error*>(&e);
        add("").problem(Level::Error, error != nullptr ? error->reason() : std::string(e.what()),
                        error != nullptr ? error->hint() : "");
        return files;
    }
    for (const io::Stream& stream : streams.streams) {
        LoadedFile& file = add(stream.name);
        file.report.kind = io::name_of(stream.kind);
        file.report.contents.push_back("of " + stream.source);
        if (files.size() == 1) {
            file.report.contents.insert(file.report.contents.end(), streams.contents.begin(), streams.contents.end());
            for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
        }
        take_stream(file, stream, streams.clock);
        if (!file.fix.empty()) file.fix_table = fmt::format("those of {}", format.title);
        finish(file);
    }
    return files;
}

LoadedFile load_computed(const ComputedFixes& computed) {
    LoadedFile file;
    file.computed = true;
    file.path = file.report.path = computed.source;
    file.report.kind = io::name_of(io::TableKind::Gnss);
    file.report.start_s = file.report.stop_s = std::nan("");
    take_stream(file, io::stream_of(computed.fixes, io::HeightKind::Ellipsoidal, computed.source), io::Clock::Gps);
    finish(file);
    return file;
}

LoadedFile load_given_stream(const std::filesystem::path& path, const std::string& name, const ReadAs& as) {
    LoadedFile file;
    file.path = path;
    file.as = as;
    file.report.path = name;
    file.report.kind = "unknown";
    file.report.start_s = file.report.stop_s = std::nan("");
    const io::StreamPath where = io::stream_path(path);
    try {
        const io::Format* format = io::format_of(where.file);
        if (format == nullptr || format->read == nullptr) return file;
        WarningLog log;
        const io::StreamLog streams = format->read(io::TextInput(where.file), log);
        const io::Stream* stream = streams.find(where.stream);
        if (stream == nullptr || stream->kind != as.kind) return file;  // the loader reports the error
        file.report.kind = io::name_of(stream->kind);
        take_stream(file, *stream, streams.clock);
        for (const std::string& warning : log.summary()) file.problem(Level::Warning, warning, "");
        finish(file);
    } catch (const Error& e) {
        file.problem(Level::Error, e.reason(), e.hint());
        file.table.reset();
    }
    return file;
}

}  // namespace schuler::inspect::detail
