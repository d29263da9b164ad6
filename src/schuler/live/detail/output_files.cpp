#include "schuler/live/detail/output_files.h"

#include "schuler/core/error.h"
#include "schuler/io/container/mcap_write.h"
#include "schuler/io/own_files.h"
#include "schuler/io/solution/solution_csv.h"
#include "schuler/live/endpoint.h"

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace schuler::live::detail {

namespace fs = std::filesystem;

namespace {

/// Initial bytes of every file of a format.
std::string beginning_of(MessageFormat format) {
    switch (format) {
        case MessageFormat::Csv: return std::string(io::solution_csv_header()) + "\n";
        case MessageFormat::Json: return "{\"type\":";
        case MessageFormat::Nmea: return "$";
        case MessageFormat::Mcap: return io::mcap_begin();
        case MessageFormat::Shared: break;
    }
    return {};
}

void check_is_no_source(const LiveSettings& settings, const std::string& path, std::string_view key) {
    for (const SourceSettings& source : settings.sources) {
        constexpr std::string_view scheme = "file:";
        if (!source.from.starts_with(scheme)) continue;
        std::error_code ec;
        if (fs::equivalent(path, source.from.substr(scheme.size()), ec) && !ec)
            throw input_error(fmt::format("{} is a source of this run", path), {settings.file, 0, 0, std::string(key)},
                              "choose another file");
    }
}

void check_begins(const LiveSettings& settings, const std::string& path, const std::string& expected) {
    std::error_code ec;
    if (!fs::is_regular_file(path, ec) || fs::file_size(path, ec) == 0 || ec) return;
    std::string begin(expected.size(), '\0');
    std::ifstream(path, std::ios::binary).read(begin.data(), static_cast<std::streamsize>(begin.size()));
    if (begin != expected)
        throw input_error(fmt::format("{} exists and does not begin as a file of this output does", path),
                          {settings.file, 0, 0, "output.to"}, "choose another file, or remove it: outputs are appended");
}

}  // namespace

void check_output_files(const LiveSettings& settings) {
    for (const OutputSettings& o : settings.outputs) {
        if (o.to.medium != Medium::File) continue;
        check_is_no_source(settings, o.to.path, "output.to");
        check_begins(settings, o.to.path, beginning_of(o.format));
        std::error_code ec;
        if (o.format == MessageFormat::Mcap && o.limits.keep < 1 && fs::is_regular_file(o.to.path, ec) &&
            fs::file_size(o.to.path, ec) > 0)
            throw input_error(fmt::format("{} exists, and no older file is kept", o.to.path),
                              {settings.file, 0, 0, "output.keep"}, "choose another file, or keep at least 1");
    }
    if (settings.log != "none" && settings.log != "stderr") check_is_no_source(settings, settings.log, "live.log");
    if (!settings.state.empty()) {
        check_is_no_source(settings, settings.state, "live.state");
        io::check_overwrite(settings.state);
    }
}

}  // namespace schuler::live::detail
