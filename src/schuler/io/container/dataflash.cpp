// ArduPilot's DataFlash logs: binary (.bin), their text form (.log), and the tables written by mavlogdump [ArduPilotLog].
#include "schuler/core/error.h"
#include "schuler/io/bytes.h"
#include "schuler/io/container/raw_table.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/text/number.h"
#include "schuler/io/text/split.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

namespace schuler::io {
namespace {

constexpr std::string_view mark("\xa3\x95", 2);
constexpr std::size_t header_size = 3, format_size = 89;
constexpr unsigned char format_type = 128;

/// Size of a field and the factor to the unit of the text logs.
struct FieldType {
    std::size_t size = 0;
    double factor = 1.0;
};
std::optional<FieldType> field_type(char c) {
    switch (c) {
        case 'b':
        case 'B':
        case 'M': return FieldType{1};
        case 'h':
        case 'H': return FieldType{2};
        case 'c':
        case 'C': return FieldType{2, 0.01};
        case 'i':
        case 'I':
        case 'f': return FieldType{4};
        case 'n': return FieldType{4};
        case 'e':
        case 'E': return FieldType{4, 0.01};
        case 'L': return FieldType{4, 1e-7};
        case 'd':
        case 'q':
        case 'Q': return FieldType{8};
        case 'N': return FieldType{16};
        case 'Z':
        case 'a': return FieldType{64};
        default: return std::nullopt;
    }
}
bool is_number(char c) { return c != 'n' && c != 'N' && c != 'Z' && c != 'a'; }

double number_at(const char* p, char type) {
    using detail::load;
    switch (type) {
        case 'b': return load<std::int8_t>(p);
        case 'B':
        case 'M': return load<std::uint8_t>(p);
        case 'h': return load<std::int16_t>(p);
        case 'H': return load<std::uint16_t>(p);
        case 'c': return 0.01 * load<std::int16_t>(p);
        case 'C': return 0.01 * load<std::uint16_t>(p);
        case 'i': return load<std::int32_t>(p);
        case 'I': return load<std::uint32_t>(p);
        case 'e': return 0.01 * load<std::int32_t>(p);
        case 'E': return 0.01 * load<std::uint32_t>(p);
        case 'L': return 1e-7 * load<std::int32_t>(p);
        case 'f': return static_cast<double>(load<float>(p));
        case 'd': return load<double>(p);
        case 'q': return static_cast<double>(load<std::int64_t>(p));
        case 'Q': return static_cast<double>(load<std::uint64_t>(p));
        default: return std::nan("");
    }
}

std::vector<std::string> trimmed_parts(std::string_view text) {
    std::vector<std::string> parts;
    for (const std::string_view part : split<std::string_view>(text, ',')) parts.emplace_back(trimmed(part));
    return parts;
}

/// The messages of a log as tables: one per message, numbered for several instances ("I", "Instance", or IMU2 of older logs).
class Tables {
public:
    struct Message {
        std::string name, types;
        std::vector<std::string> fields;
        std::size_t size = 0;
        bool wanted = false;
        int instance_field = -1;
        int first_instance = 0;
        std::map<int, std::size_t> table_of;
        // the offset of each number in a binary message
        std::vector<std::size_t> offsets;
    };

    static Message message(std::string name, std::string types, std::vector<std::string> fields) {
        Message m{std::move(name), std::move(types), std::move(fields), 0, false, -1, 0, {}, {}};
        const std::size_t stem = m.name.find_last_not_of("0123456789");
        const bool numbered = stem != std::string::npos && stem + 1 < m.name.size() && m.name.size() - stem - 1 == 1 &&
                              is_ardupilot_message(m.name.substr(0, stem + 1));
        if (numbered) {
            m.first_instance = m.name.back() - '1';
            m.name.resize(stem + 1);
        }
        m.wanted = is_ardupilot_message(m.name);
        for (std::size_t i = 0; i < m.fields.size(); ++i)
            if (m.fields[i] == "I" || m.fields[i] == "Instance" ||
                (m.fields[i] == "C" && (m.name.starts_with("XKF") || m.name.starts_with("NKF"))))
                m.instance_field = static_cast<int>(i);
        std::size_t at = 0;
        for (std::size_t i = 0; i < m.types.size(); ++i) {
            m.offsets.push_back(at);
            const auto type = field_type(m.types[i]);
            if (!type) {
                m.wanted = false;
                break;
            }
            at += type->size;
        }
        m.size = at;
        return m;
    }

    RawTable& table(Message& m, int instance) {
        const auto [it, is_new] = m.table_of.try_emplace(instance, tables.size());
        if (is_new) {
            tables.push_back({m.name, instance, m.fields, {}});
            tables.back().values.resize(m.fields.size());
        }
        return tables[it->second];
    }

    RawTables tables;
};

class BinaryReader {
public:
    explicit BinaryReader(std::string_view bytes) : bytes_(bytes) {}
    Tables tables;
    std::set<std::string> names;
    std::size_t damaged = 0, first_damaged = 0, messages = 0;
    std::size_t cut_at = 0;  ///< byte of an incomplete last message; 0: none

    void read() {
        messages_[format_type] = Tables::message("FMT", "BBnNZ", {"Type", "Length", "Name", "Format", "Columns"});
        lengths_[format_type] = format_size;
        std::size_t at = 0;
        while (at + header_size <= bytes_.size()) {
            const bool good = bytes_[at] == mark[0] && bytes_[at + 1] == mark[1];
            const auto type = static_cast<unsigned char>(bytes_[at + 2]);
            const std::size_t length = good ? lengths_[type] : 0;
            if (length == 0) {
                at = recovered(at);
                continue;
            }
            if (at + length > bytes_.size()) {
                cut_at = at;
                return;
            }
            ++messages;
            const std::string_view body = bytes_.substr(at + header_size, length - header_size);
            if (type == format_type) define(body);
            else if (messages_[type] && messages_[type]->wanted) take(*messages_[type], body);
            at += length;
        }
    }

private:
    std::size_t recovered(std::size_t from) {
        if (damaged++ == 0) first_damaged = from;
        for (std::size_t at = bytes_.find(mark, from + 1); at != std::string_view::npos && at + header_size <= bytes_.size();
             at = bytes_.find(mark, at + 1)) {
            const std::size_t length = lengths_[static_cast<unsigned char>(bytes_[at + 2])];
            if (length > 0 && (at + length >= bytes_.size() || bytes_.substr(at + length, 2) == mark)) return at;
        }
        return bytes_.size();
    }

    static std::string text(std::string_view bytes) {
        return std::string(bytes.substr(0, std::min(bytes.find('\0'), bytes.size())));
    }

    void define(std::string_view body) {
        const auto type = static_cast<unsigned char>(body[0]), length = static_cast<unsigned char>(body[1]);
        if (type == format_type || length < header_size) return;
        const std::string name = text(body.substr(2, 4));
        names.insert(name);
        Tables::Message m = Tables::message(name, text(body.substr(6, 16)), trimmed_parts(text(body.substr(22, 64))));
        m.wanted = m.wanted && m.size + header_size <= length && m.types.size() >= m.fields.size();  // names may be cut
        lengths_[type] = length;
        const std::optional<Tables::Message>& before = messages_[type];
        // a log of several boots repeats its message definitions: the same tables are continued
        if (before && before->name == m.name && before->types == m.types && before->fields == m.fields &&
            before->first_instance == m.first_instance)
            return;
        messages_[type] = std::move(m);
    }

    void take(Tables::Message& m, std::string_view body) {
        int instance = m.first_instance;
        if (m.instance_field >= 0) {
            const auto i = static_cast<std::size_t>(m.instance_field);
            instance = static_cast<int>(number_at(body.data() + m.offsets[i], m.types[i]));
        }
        RawTable& t = tables.table(m, instance);
        for (std::size_t i = 0; i < m.fields.size(); ++i)
            t.values[i].push_back(is_number(m.types[i]) ? number_at(body.data() + m.offsets[i], m.types[i]) : std::nan(""));
    }

    std::string_view bytes_;
    std::array<std::optional<Tables::Message>, 256> messages_;
    std::array<std::size_t, 256> lengths_{};
};

StreamLog finished(const TextInput& input, Tables tables, const std::set<std::string>& names) {
    StreamLog log = ardupilot_streams(tables.tables);
    if (!log.streams.empty()) return log;
    std::string have;
    for (const std::string& name : names) have += (have.empty() ? "" : ", ") + name;
    throw input_error("holds no instrument that is used", place_in(input.name()),
                      have.empty() ? "the log is cut or damaged: it has no data"
                                   : "it contains the messages " + have + "; log IMU and GPS (LOG_BITMASK)");
}

StreamLog read_binary(const TextInput& input, const std::string& bytes, WarningLog& warnings) {
    BinaryReader reader(bytes);
    reader.read();
    if (reader.damaged > 0)
        warnings.add(input.name() + " dataflash.damaged",
                     fmt::format("{}: damaged messages, the first at byte {}: skipped", input.name(), reader.first_damaged),
                     reader.damaged);
    if (reader.cut_at > 0)
        warnings.add(input.name() + " dataflash.cut",
                     fmt::format("{}: the log is cut in the message at byte {}: read up to there", input.name(), reader.cut_at));
    return finished(input, std::move(reader.tables), reader.names);
}

/// Lines "FMT, 131, 43, IMU, Qffffff, TimeUS,GyrX,..." and "IMU, 1234, 0.1, ...". The numbers are already scaled.
StreamLog read_text_log(const TextInput& input, const std::string& bytes, WarningLog& warnings) {
    Tables tables;
    std::map<std::string, Tables::Message, std::less<>> messages;
    std::set<std::string> names;
    std::size_t damaged = 0;
    long first_damaged = 0;
    std::vector<double> row;
    for (Lines lines(bytes); lines.next();) {
        const std::string_view line = lines.line();
        const std::size_t comma = line.find(',');
        if (comma == std::string_view::npos) continue;
        const std::string_view name = line.substr(0, comma);
        if (name == "FMT") {
            std::vector<std::string> parts = trimmed_parts(line);
            if (parts.size() < 6) continue;
            names.insert(parts[3]);
            std::vector<std::string> fields(parts.begin() + 5, parts.end());
            std::string key = parts[3];
            messages.insert_or_assign(std::move(key), Tables::message(parts[3], parts[4], std::move(fields)));
            continue;
        }
        const auto it = messages.find(name);
        if (it == messages.end() || !it->second.wanted) continue;
        Tables::Message& m = it->second;
        row.clear();
        for (std::string_view rest = line.substr(comma + 1);;) {
            const std::size_t end = std::min(rest.find(','), rest.size());
            std::string_view cell = rest.substr(0, end);
            while (!cell.empty() && cell.front() == ' ') cell.remove_prefix(1);
            row.push_back(number_from(cell));
            if (end == rest.size()) break;
            rest.remove_prefix(end + 1);
        }
        if (row.size() != m.fields.size()) {
            if (damaged++ == 0) first_damaged = lines.number();
            continue;
        }
        const int instance = m.instance_field >= 0 && std::abs(row[static_cast<std::size_t>(m.instance_field)]) < 100.0
                                 ? static_cast<int>(row[static_cast<std::size_t>(m.instance_field)])
                                 : m.first_instance;
        RawTable& t = tables.table(m, instance);
        for (std::size_t i = 0; i < row.size(); ++i) t.values[i].push_back(row[i]);
    }
    if (damaged > 0)
        warnings.add(input.name() + " dataflash.damaged",
                     fmt::format("{}: damaged lines, the first is line {}: skipped", input.name(), first_damaged), damaged);
    return finished(input, std::move(tables), names);
}

StreamLog read_dataflash(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    return bytes.starts_with("FMT,") ? read_text_log(input, bytes, warnings) : read_binary(input, bytes, warnings);
}

}  // namespace

extern const Format dataflash_format;
const Format dataflash_format = {
    .name = "dataflash",
    .title = "ArduPilot DataFlash",
    .extensions = ".bin .log",
    .holds =
        "IMU (`IMU`, `IMU2`, ..., else `GYR` with `ACC`), GNSS (`GPS` with the accuracies of `GPA`, and with its undulation `Und` as ellipsoidal heights), barometer (`BARO`), magnetometer (`MAG`), the "
        "autopilot's attitude, velocity and position (`ATT`, `XKF1` or `NKF1`, `POS`) as reference; binary, or as text",
    .time = "boot of the autopilot",
    .recognise =
        [](const FileHead& head) {
            return (head.starts_with(mark) && head.bytes.size() > header_size) ||
                   (head.starts_with("FMT,") && head.contains("TimeUS")) || (head.starts_with("FMT,") && head.contains("TimeMS"));
        },
    .read = read_dataflash};

}  // namespace schuler::io
