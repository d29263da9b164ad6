// Bags of ROS 1, version 2.0, and databases of ROS 2 (rosbag2, SQLite) [RosBag].
#include "schuler/core/error.h"
#include "schuler/io/bytes.h"
#include "schuler/io/container/compression.h"
#include "schuler/io/container/ros_messages.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/unpacked_file.h"

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <memory>

namespace schuler::io {
namespace {

constexpr std::string_view bag_magic = "#ROSBAG V2.0\n", sqlite_magic("SQLite format 3\0", 16);

/// Fields "name=value" of a record's header.
std::map<std::string, std::string_view, std::less<>> fields_of(std::string_view header) {
    std::map<std::string, std::string_view, std::less<>> fields;
    while (header.size() >= 4) {
        const std::size_t size = detail::load<std::uint32_t>(header.data());
        if (size > header.size() - 4) break;
        const std::string_view field = header.substr(4, size);
        const std::size_t equals = field.find('=');
        if (equals != std::string_view::npos) fields.emplace(std::string(field.substr(0, equals)), field.substr(equals + 1));
        header.remove_prefix(4 + size);
    }
    return fields;
}

class BagReader {
public:
    explicit BagReader(std::string file) : file_(std::move(file)) {}
    RosMessages messages;
    std::size_t cut_at = 0, damaged_chunks = 0, first_damaged = 0;  ///< bytes from the start of the file; chunks

    void read(std::string_view bytes) { records(bytes, bag_magic.size(), true); }

private:
    struct Connection {
        std::string topic, type;
        bool wanted = false;
    };

    void records(std::string_view bytes, std::size_t at, bool outside) {
        while (at + 8 <= bytes.size()) {
            const std::size_t header = detail::load<std::uint32_t>(bytes.data() + at);
            if (header > bytes.size() - at - 8) break;
            const std::size_t data = detail::load<std::uint32_t>(bytes.data() + at + 4 + header);
            if (data > bytes.size() - at - 8 - header) break;
            record(bytes.substr(at + 4, header), bytes.substr(at + 8 + header, data), outside ? at : 0, outside);
            at += 8 + header + data;
        }
        if (outside && at < bytes.size()) cut_at = at;
    }

    void record(std::string_view header, std::string_view data, std::size_t at, bool outside) {
        const auto fields = fields_of(header);
        const auto text = [&](std::string_view name) {
            const auto it = fields.find(name);
            return it == fields.end() ? std::string_view{} : it->second;
        };
        const std::string_view op = text("op");
        if (op.size() != 1) return;
        switch (op[0]) {
            case 2: {  // a message
                const auto it = connections_.find(detail::load<std::uint32_t>(text("conn"), 0));
                if (it == connections_.end() || !it->second.wanted) return;
                const std::string_view time = text("time");
                const std::int64_t logged =
                    std::int64_t{detail::load<std::uint32_t>(time, 0)} * 1'000'000'000 + detail::load<std::uint32_t>(time, 4);
                messages.add(it->second.topic, it->second.type, RosLayout::Packed, data, logged);
                return;
            }
            case 5: {  // a chunk
                if (!outside) return;
                const std::string_view method = text("compression");
                if (method.empty() || method == "none") return records(data, 0, false);
                try {
                    const std::string own = decompressed(data, method, detail::load<std::uint32_t>(text("size"), 0));
                    records(own, 0, false);
                } catch (const Error& e) {
                    if (is_compression(method)) {
                        if (damaged_chunks++ == 0) first_damaged = at;
                        return;
                    }
                    throw input_error(fmt::format("the chunk at byte {}: {}", at, e.reason()), place_in(file_), e.hint());
                }
                return;
            }
            case 7: {  // a connection
                const auto inner = fields_of(data);
                const auto type = inner.find("type");
                Connection c{std::string(text("topic")), type == inner.end() ? std::string() : std::string(type->second), false};
                c.wanted = RosMessages::is_read(c.type);
                messages.mention(c.topic, c.type);
                connections_[detail::load<std::uint32_t>(text("conn"), 0)] = std::move(c);
                return;
            }
            default: return;
        }
    }

    std::string file_;
    std::map<std::uint32_t, Connection> connections_;
};

StreamLog finished(const TextInput& input, RosMessages& messages, WarningLog& warnings) {
    StreamLog log;
    messages.finish(log, input.name(), warnings);
    if (messages.damaged > 0)
        warnings.add(input.name() + " ros.damaged", fmt::format("{}: damaged messages: skipped", input.name()), messages.damaged);
    if (log.streams.empty())
        throw input_error(
            "holds no instrument that is used", place_in(input.name()),
            (messages.topics().empty() ? std::string("it has no topic") : "it has the topics " + messages.topics()) +
                "; sensor_msgs Imu, NavSatFix, MagneticField, FluidPressure and nav_msgs Odometry are read, and the twists of fixes");
    return log;
}

StreamLog read_bag(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    if (!bytes.starts_with(bag_magic))
        throw input_error("is not a ROS bag of version 2.0: its first line differs", place_in(input.name()),
                          "convert older bags with `rosbag migrate`");
    BagReader reader(input.name());
    reader.read(bytes);
    if (reader.cut_at > 0)
        warnings.add(input.name() + " bag.cut",
                     fmt::format("{}: the bag is cut in the record at byte {}: read up to there", input.name(), reader.cut_at));
    if (reader.damaged_chunks > 0)
        warnings.add(input.name() + " bag.damaged",
                     fmt::format("{}: damaged chunks, the first at byte {}: skipped", input.name(), reader.first_damaged),
                     reader.damaged_chunks);
    if (reader.damaged_chunks > 0 && reader.messages.topics().empty())
        throw input_error(fmt::format("is damaged, the first time at byte {}, and nothing of use is left", reader.first_damaged),
                          place_in(input.name()), "copy the log completely");
    return finished(input, reader.messages, warnings);
}

using Database = std::unique_ptr<sqlite3, decltype(&sqlite3_close)>;
using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

StreamLog read_db3(const TextInput& input, WarningLog& warnings) {
    if (input.in_memory()) throw input_error("a database cannot be read from memory", place_in(input.name()), "give the file");
    const UnpackedFile unpacked(input);
    sqlite3* raw = nullptr;
    // immutable: no files are written beside it, and read-only folders are permitted
    const std::string uri = "file:" + [&] {
        std::string escaped;
        for (const char c : unpacked.path())
            escaped += c == '%' ? "%25" : c == '?' ? "%3f" : c == '#' ? "%23" : std::string(1, c);
        return escaped;
    }() + "?immutable=1";
    const int opened = sqlite3_open_v2(uri.c_str(), &raw, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    const Database database(raw, sqlite3_close);
    const auto refuse = [&](const char* what) {
        return input_error(fmt::format("{} ({})", what, raw != nullptr ? sqlite3_errmsg(raw) : "no memory"),
                           place_in(input.name()), "is it a database of rosbag2, copied completely?");
    };
    if (opened != SQLITE_OK) throw refuse("the database cannot be opened");
    const auto prepare = [&](const char* query) {
        sqlite3_stmt* statement = nullptr;
        if (sqlite3_prepare_v2(database.get(), query, -1, &statement, nullptr) != SQLITE_OK)
            throw refuse("the database has no tables of rosbag2");
        return Statement(statement, sqlite3_finalize);
    };
    RosMessages messages;
    struct Topic {
        std::string name, type;
    };
    std::map<std::int64_t, Topic> topics;
    const Statement names = prepare("SELECT id, name, type FROM topics");
    const auto text = [](const Statement& s, int column) {
        const unsigned char* value = sqlite3_column_text(s.get(), column);
        return value == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(value));
    };
    while (sqlite3_step(names.get()) == SQLITE_ROW) {
        Topic topic{text(names, 1), text(names, 2)};
        messages.mention(topic.name, topic.type);
        if (RosMessages::is_read(topic.type)) topics.emplace(sqlite3_column_int64(names.get(), 0), std::move(topic));
    }
    const Statement rows = prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY id");
    int state = SQLITE_ROW;
    while ((state = sqlite3_step(rows.get())) == SQLITE_ROW) {
        const auto it = topics.find(sqlite3_column_int64(rows.get(), 0));
        if (it == topics.end()) continue;
        const auto* blob = static_cast<const char*>(sqlite3_column_blob(rows.get(), 2));
        const std::string_view data(blob, blob == nullptr ? 0 : static_cast<std::size_t>(sqlite3_column_bytes(rows.get(), 2)));
        messages.add(it->second.name, it->second.type, RosLayout::Cdr, data, sqlite3_column_int64(rows.get(), 1));
    }
    if (state != SQLITE_DONE)
        warnings.add(input.name() + " db3.damaged", fmt::format("{}: the database is damaged ({}): read up to there",
                                                                input.name(), sqlite3_errmsg(database.get())));
    return finished(input, messages, warnings);
}

}  // namespace

extern const Format ros_bag_format, ros_db3_format;
const Format ros_bag_format = {
    .name = "rosbag",
    .title = "ROS 1 bag",
    .extensions = ".bag",
    .holds =
        "by topic: `sensor_msgs` Imu (gyros and accelerometers in a topic each are joined), NavSatFix (and the twist with its stamps as its velocity), `gps_msgs` GPSFix, MagneticField, FluidPressure; `nav_msgs` Odometry and `geometry_msgs` poses as trajectories in a frame of "
        "their own; bzip2 and LZ4",
    .time = "UTC from 1970 (the headers' stamps), or the clock of a simulation",
    .recognise = [](const FileHead& head) { return head.starts_with("#ROSBAG V"); },
    .read = read_bag};
const Format ros_db3_format = {.name = "rosbag2",
                               .title = "ROS 2 database",
                               .extensions = ".db3",
                               .holds = "as `mcap`, of the tables `topics` and `messages`; its folder may be given",
                               .time = "UTC from 1970 (the headers' stamps), or the clock of a simulation",
                               .recognise = [](const FileHead& head) { return head.starts_with(sqlite_magic); },
                               .read = read_db3};

}  // namespace schuler::io
