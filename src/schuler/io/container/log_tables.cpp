// Tables written by ulog2csv from PX4 logs: a file per topic and instance, named accordingly ("flight_sensor_combined_0.csv").
#include "schuler/core/error.h"
#include "schuler/io/bytes.h"
#include "schuler/io/container/raw_table.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/number.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace schuler::io {
namespace {

struct TopicOfFile {
    std::string topic;
    int instance = 0;
};

/// The topic in a file name of ulog2csv; empty if there is none that is read.
std::optional<TopicOfFile> topic_of(const std::filesystem::path& file) {
    std::string stem = file.filename().string();
    stem = stem.substr(0, stem.find('.'));
    const std::size_t mark = stem.rfind('_');
    if (mark == std::string::npos || mark + 1 >= stem.size() || stem.size() - mark > 3) return std::nullopt;
    const double instance = number_from(std::string_view(stem).substr(mark + 1));
    if (!(instance >= 0.0)) return std::nullopt;
    stem.resize(mark);
    for (std::size_t at = 0; at != std::string::npos; at = stem.find('_', at)) {
        if (at > 0) ++at;
        if (is_px4_topic(std::string_view(stem).substr(at))) return TopicOfFile{stem.substr(at), static_cast<int>(instance)};
    }
    return std::nullopt;
}

StreamLog read_table(const TextInput& input, WarningLog& warnings) {
    const auto topic = topic_of(input.name());
    const std::string bytes = read_bytes(input);
    Lines lines(bytes);
    RawTable table;
    std::size_t bad = 0;
    long first_bad = 0;
    std::vector<double> row;
    while (lines.next()) {
        const bool header = table.fields.empty();
        row.clear();
        for (std::string_view rest = lines.line();;) {
            const std::string_view cell = rest.substr(0, std::min(rest.find(','), rest.size()));
            if (header) table.fields.emplace_back(trimmed(cell));
            else row.push_back(number_from(cell));
            if (cell.size() == rest.size()) break;
            rest.remove_prefix(cell.size() + 1);
        }
        if (header) {
            table.values.resize(table.fields.size());
            continue;
        }
        if (row.size() != table.fields.size() || std::isnan(row.front())) {
            if (bad++ == 0) first_bad = lines.number();
            continue;
        }
        for (std::size_t i = 0; i < row.size(); ++i) table.values[i].push_back(row[i]);
    }
    if (bad > 0)
        warnings.add(input.name() + " ulog2csv.bad",
                     fmt::format("{}: damaged rows, the first in line {}: skipped", input.name(), first_bad), bad);
    if (topic) {
        table.name = topic->topic;
        table.instance = topic->instance;
    }
    StreamLog log = px4_streams({table});
    if (log.streams.empty())
        throw input_error("is a table of a PX4 topic that is not an instrument by itself", place_in(input.name()),
                          "put the tables of sensor_combined and vehicle_gps_position into the same folder");
    return log;
}

}  // namespace

extern const Format ulog2csv_format;
const Format ulog2csv_format = {
    .name = "ulog2csv",
    .title = "Tables of ulog2csv",
    .extensions = "_TOPIC_N.csv",
    .holds =
        "what `ulog` holds, a topic a file by its name, `timestamp` in microseconds; setpoints are nothing that was measured",
    .time = "boot of the autopilot",
    .recognise = [](const FileHead& head) { return head.starts_with("timestamp,") && topic_of(head.path).has_value(); },
    .read = read_table};

}  // namespace schuler::io
