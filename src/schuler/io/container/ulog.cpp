// PX4's ULog, version 1: message definitions, subscriptions, and their data [PX4ULog].
#include "schuler/core/error.h"
#include "schuler/io/bytes.h"
#include "schuler/io/container/raw_table.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>

namespace schuler::io {
namespace {

constexpr std::string_view ulog_magic("ULog\x01\x12\x35", 7);
constexpr std::size_t file_header_size = 16, prefix_size = 3;

enum class Number : std::uint8_t { I8, U8, I16, U16, I32, U32, I64, U64, F32, F64 };

struct Place {
    std::string name;
    std::size_t offset = 0;
    Number type = Number::U8;
};

std::size_t size_of(Number type) {
    static constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return sizes[static_cast<std::size_t>(type)];
}

// clang-format off
std::optional<Number> number_type(std::string_view name) {
    static const std::map<std::string_view, Number> types = {{"int8_t", Number::I8},   {"uint8_t", Number::U8},   {"bool", Number::U8},
                                                             {"char", Number::U8},     {"int16_t", Number::I16},  {"uint16_t", Number::U16},
                                                             {"int32_t", Number::I32}, {"uint32_t", Number::U32}, {"int64_t", Number::I64},
                                                             {"uint64_t", Number::U64}, {"float", Number::F32},   {"double", Number::F64}};
    // clang-format on
    const auto it = types.find(name);
    return it == types.end() ? std::nullopt : std::optional(it->second);
}

double number_at(const char* p, Number type) {
    using detail::load;
    switch (type) {
        case Number::I8: return load<std::int8_t>(p);
        case Number::U8: return load<std::uint8_t>(p);
        case Number::I16: return load<std::int16_t>(p);
        case Number::U16: return load<std::uint16_t>(p);
        case Number::I32: return load<std::int32_t>(p);
        case Number::U32: return load<std::uint32_t>(p);
        case Number::I64: return static_cast<double>(load<std::int64_t>(p));
        case Number::U64: return static_cast<double>(load<std::uint64_t>(p));
        case Number::F32: return static_cast<double>(load<float>(p));
        case Number::F64: return load<double>(p);
    }
    return 0.0;
}

class UlogReader {
public:
    UlogReader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

    RawTables tables;
    std::set<std::string> topics;
    std::size_t dropouts = 0, damaged = 0, first_damaged = 0, cut_at = 0;
    double dropped_seconds = 0.0;
    int version = 0;

    void read() {
        if (bytes_.size() < file_header_size)
            throw input_error(fmt::format("the header of the ULog is cut at byte {}", bytes_.size()), place_in(file_),
                              "copy the log completely");
        version = static_cast<unsigned char>(bytes_[7]);
        std::size_t at = file_header_size;
        while (at + prefix_size <= bytes_.size()) {
            const std::size_t size = detail::load<std::uint16_t>(bytes_.data() + at);
            const char type = bytes_[at + 2];
            if (!is_type(type)) {
                at = recovered(at);
                continue;
            }
            if (size > bytes_.size() - at - prefix_size) {
                cut_at = at;
                break;
            }
            message(type, bytes_.substr(at + prefix_size, size));
            at += prefix_size + size;
        }
        if (at < bytes_.size() && cut_at == 0) cut_at = at;
    }

private:
    struct Field {
        std::string type, name;
        std::size_t count = 1;
    };
    struct Subscription {
        std::size_t table = 0;
        std::size_t size = 0;  ///< bytes required by its fields
        std::vector<Place> places;
    };

    static bool is_type(char c) { return std::string_view("BFIMPQADRLCSO").find(c) != std::string_view::npos; }

    /// After damage: the next position with two consecutive messages.
    std::size_t recovered(std::size_t from) {
        if (damaged++ == 0) first_damaged = from;
        for (std::size_t at = from + 1; at + prefix_size <= bytes_.size(); ++at) {
            if (!is_type(bytes_[at + 2])) continue;
            const std::size_t next = at + prefix_size + detail::load<std::uint16_t>(bytes_.data() + at);
            if (next + prefix_size > bytes_.size() || !is_type(bytes_[next + 2])) continue;
            const std::size_t third = next + prefix_size + detail::load<std::uint16_t>(bytes_.data() + next);
            if (third + prefix_size <= bytes_.size() && is_type(bytes_[third + 2])) return at;
        }
        return bytes_.size();
    }

    void message(char type, std::string_view body) {
        if (type == 'D' && body.size() >= 2) {
            data(detail::load<std::uint16_t>(body.data()), body.substr(2));
        } else if (type == 'F') {
            define(body);
        } else if (type == 'A' && body.size() > 3) {
            subscribe(static_cast<unsigned char>(body[0]), detail::load<std::uint16_t>(body, 1), std::string(body.substr(3)));
        } else if (type == 'R' && body.size() >= 2) {
            if (const auto id = detail::load<std::uint16_t>(body.data()); id < subscriptions_.size()) subscriptions_[id].reset();
        } else if (type == 'O' && body.size() >= 2) {
            ++dropouts;
            dropped_seconds += 1e-3 * detail::load<std::uint16_t>(body.data());
        }
    }

    /// "name:type field;type[3] field;..."
    void define(std::string_view text) {
        const std::size_t colon = text.find(':');
        if (colon == std::string_view::npos) return;
        std::vector<Field> fields;
        std::string_view rest = text.substr(colon + 1);
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find(';'), rest.size());
            const std::string_view one = rest.substr(0, end);
            rest.remove_prefix(std::min(end + 1, rest.size()));
            const std::size_t blank = one.find(' ');
            if (blank == std::string_view::npos) continue;
            Field f{std::string(one.substr(0, blank)), std::string(one.substr(blank + 1)), 1};
            if (const std::size_t open = f.type.find('['); open != std::string::npos) {
                f.count = 0;
                for (std::size_t i = open + 1; i < f.type.size() && f.type[i] >= '0' && f.type[i] <= '9' && f.count < 100'000;
                     ++i)
                    f.count = 10 * f.count + static_cast<std::size_t>(f.type[i] - '0');
                f.type.resize(open);
            }
            fields.push_back(std::move(f));
        }
        definitions_[std::string(text.substr(0, colon))] = std::move(fields);
    }

    /// Offsets of the numbers of a message; returns the offset after it. Empty if a definition is missing or refers to itself.
    std::optional<std::size_t> place(const std::string& definition, std::size_t offset, const std::string& prefix,
                                     std::vector<Place>& out, int depth) const {
        const auto it = definitions_.find(definition);
        constexpr int deepest = 8;
        constexpr std::size_t most = 4096;
        if (it == definitions_.end() || depth > deepest) return std::nullopt;
        for (const Field& f : it->second) {
            const auto number = number_type(f.type);
            for (std::size_t i = 0; i < f.count; ++i) {
                const std::string name = prefix + f.name + (f.count > 1 ? fmt::format("[{}]", i) : std::string());
                if (out.size() > most || offset > 65'536) return std::nullopt;
                if (number) {
                    if (f.type != "char" && !f.name.starts_with("_padding")) out.push_back({name, offset, *number});
                    offset += size_of(*number);
                } else {
                    const auto behind = place(f.type, offset, name + ".", out, depth + 1);
                    if (!behind) return std::nullopt;
                    offset = *behind;
                }
            }
        }
        return offset;
    }

    void subscribe(int instance, std::uint16_t id, const std::string& name) {
        topics.insert(name);
        if (subscriptions_.size() <= id) subscriptions_.resize(id + std::size_t{1});
        subscriptions_[id].reset();
        if (!is_px4_topic(name)) return;
        Subscription s;
        if (!place(name, 0, "", s.places, 0) || s.places.empty()) return;
        for (const Place& p : s.places) s.size = std::max(s.size, p.offset + size_of(p.type));
        s.table = tables.size();
        RawTable table{name, instance, {}, {}};
        for (const Place& p : s.places) table.fields.push_back(p.name);
        table.values.resize(s.places.size());
        tables.push_back(std::move(table));
        subscriptions_[id] = std::move(s);
    }

    void data(std::uint16_t id, std::string_view body) {
        if (id >= subscriptions_.size() || !subscriptions_[id]) return;
        const Subscription& s = *subscriptions_[id];
        if (body.size() < s.size) {
            if (damaged++ == 0) first_damaged = static_cast<std::size_t>(body.data() - bytes_.data());
            return;
        }
        RawTable& table = tables[s.table];
        for (std::size_t i = 0; i < s.places.size(); ++i)
            table.values[i].push_back(number_at(body.data() + s.places[i].offset, s.places[i].type));
    }

    std::string_view bytes_;
    std::string file_;
    std::map<std::string, std::vector<Field>> definitions_;
    std::vector<std::optional<Subscription>> subscriptions_;
};

std::string list_of(const std::set<std::string>& names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

StreamLog read_ulog(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    if (!bytes.starts_with(ulog_magic))
        throw input_error("is not a ULog: its first bytes differ", place_in(input.name()), "choose a .ulg file of PX4");
    UlogReader reader(bytes, input.name());
    reader.read();
    StreamLog log = px4_streams(reader.tables);
    if (reader.dropouts > 0)
        log.contents.push_back(
            fmt::format("{} drop-outs of the logger, {:.2f} s in all", reader.dropouts, reader.dropped_seconds));
    if (reader.damaged > 0)
        warnings.add(input.name() + " ulog.damaged",
                     fmt::format("{}: damaged messages, the first at byte {}: skipped", input.name(), reader.first_damaged),
                     reader.damaged);
    if (reader.cut_at > 0)
        warnings.add(input.name() + " ulog.cut",
                     fmt::format("{}: the log is cut in the message at byte {}: read up to there", input.name(), reader.cut_at));
    if (log.streams.empty())
        throw input_error(
            "holds no instrument that is used", place_in(input.name()),
            reader.topics.empty() ? "the log is cut or damaged: it has no data" : "it has the topics " + list_of(reader.topics));
    return log;
}

}  // namespace

extern const Format ulog_format;
const Format ulog_format = {
    .name = "ulog",
    .title = "PX4 ULog",
    .extensions = ".ulg",
    .holds =
        "IMU (`sensor_combined`, else `sensor_gyro` with `sensor_accel`, every instance), GNSS (`vehicle_gps_position`, `sensor_gps`), barometer "
        "(`vehicle_air_data`, `sensor_baro`), magnetometer (`vehicle_magnetometer`, `sensor_mag`), the autopilot's attitude, velocity and position as "
        "reference; drop-outs are counted",
    .time = "boot of the autopilot",
    .recognise = [](const FileHead& head) { return head.starts_with(ulog_magic); },
    .read = read_ulog};

}  // namespace schuler::io
