// MCAP, the container of ROS 2 and Foxglove: records, chunks, channels and messages [MCAP].
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/bytes.h"
#include "schuler/io/container/compression.h"
#include "schuler/io/container/detail/mcap_records.h"
#include "schuler/io/container/mcap_write.h"
#include "schuler/io/container/ros_messages.h"
#include "schuler/io/detail/dated.h"
#include "schuler/io/detail/little_endian.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <map>

namespace schuler::io {
namespace {

using detail::mcap_magic;
using enum detail::McapOp;
constexpr std::size_t record_head = 9;

/// A sequentially read body; beyond its end everything is empty, and ok() false.
class Body {
public:
    explicit Body(std::string_view bytes) : bytes_(bytes) {}
    template <class T>
    T number() {
        ok_ = ok_ && bytes_.size() - at_ >= sizeof(T);
        if (!ok_) return T{};
        at_ += sizeof(T);
        return detail::load<T>(bytes_.data() + at_ - sizeof(T));
    }
    std::string_view text(std::uint64_t size) {
        ok_ = ok_ && size <= bytes_.size() - at_;
        if (!ok_) return {};
        at_ += size;
        return bytes_.substr(at_ - size, size);
    }
    std::string_view text() { return text(number<std::uint32_t>()); }
    [[nodiscard]] std::string_view rest() const { return bytes_.substr(at_); }
    [[nodiscard]] bool ok() const { return ok_; }

private:
    std::string_view bytes_;
    std::size_t at_ = 0;
    bool ok_ = true;
};

class McapReader {
public:
    explicit McapReader(std::string file) : file_(std::move(file)) {}

    RosMessages messages;
    std::size_t cut_at = 0, damaged = 0, first_damaged = 0;

    void read(std::string_view bytes) {
        std::size_t at = mcap_magic.size();
        while (at + record_head <= bytes.size()) {
            const auto op = static_cast<unsigned char>(bytes[at]);
            const auto size = detail::load<std::uint64_t>(bytes.data() + at + 1);
            if (size > bytes.size() - at - record_head) {
                cut_at = at;
                return;
            }
            const std::string_view body = bytes.substr(at + record_head, size);
            if (op == DataEnd || op == Footer) return;
            if (op == Chunk) chunk(body, at);
            else record(op, body, at);
            at += record_head + size;
        }
        cut_at = at;
    }

private:
    struct Known {
        std::string topic, type;
        bool wanted = false;
        RosLayout layout = RosLayout::Cdr;
    };

    void bad(std::size_t at) {
        if (damaged++ == 0) first_damaged = at;
    }

    void record(unsigned char op, std::string_view bytes, std::size_t at) {
        Body body(bytes);
        if (op == Message) {
            const auto channel = body.number<std::uint16_t>();
            (void)body.number<std::uint32_t>();
            const auto logged = body.number<std::uint64_t>();
            (void)body.number<std::uint64_t>();
            const auto it = channels_.find(channel);
            if (!body.ok() || it == channels_.end()) return bad(at);
            if (it->second.wanted)
                messages.add(it->second.topic, it->second.type, it->second.layout, body.rest(),
                             static_cast<std::int64_t>(logged));
        } else if (op == Schema) {
            const auto id = body.number<std::uint16_t>();
            const std::string_view name = body.text();
            if (body.ok()) schemas_[id] = name;
        } else if (op == Channel) {
            const auto id = body.number<std::uint16_t>(), schema = body.number<std::uint16_t>();
            const std::string_view topic = body.text(), encoding = body.text();
            if (!body.ok()) return bad(at);
            Known known{std::string(topic), schemas_[schema], false, encoding == "ros1" ? RosLayout::Packed : RosLayout::Cdr};
            known.wanted = RosMessages::is_read(known.type) && (encoding == "cdr" || encoding == "ros1");
            messages.mention(known.topic, known.type.empty() ? std::string(encoding) : known.type);
            channels_[id] = std::move(known);
        }
    }

    void chunk(std::string_view bytes, std::size_t at) {
        Body body(bytes);
        (void)body.number<std::uint64_t>();
        (void)body.number<std::uint64_t>();
        const auto size = body.number<std::uint64_t>();
        const auto check = body.number<std::uint32_t>();  // zero: no check sum
        const std::string_view method = body.text();
        const std::string_view packed = body.text(body.number<std::uint64_t>());
        if (!body.ok()) return bad(at);
        std::string own;
        std::string_view records = packed;
        if (!method.empty() && method != "none") {
            try {
                own = decompressed(packed, method, size);
            } catch (const Error& e) {
                if (is_compression(method)) return bad(at);
                throw input_error(fmt::format("the chunk at byte {}: {}", at, e.reason()), place_in(file_), e.hint());
            }
            records = own;
        }
        if (check != 0 && ::crc32(0, reinterpret_cast<const Bytef*>(records.data()), static_cast<uInt>(records.size())) != check)
            return bad(at);
        std::size_t inside = 0;
        while (inside + record_head <= records.size()) {
            const auto length = detail::load<std::uint64_t>(records.data() + inside + 1);
            if (length > records.size() - inside - record_head) return bad(at);
            record(static_cast<unsigned char>(records[inside]), records.substr(inside + record_head, length), at);
            inside += record_head + length;
        }
    }

    std::string file_;
    std::map<std::uint16_t, std::string> schemas_;
    std::map<std::uint16_t, Known> channels_;
};

StreamLog read_mcap(const TextInput& input, WarningLog& warnings) {
    const std::string bytes = read_bytes(input);
    if (!bytes.starts_with(mcap_magic))
        throw input_error("is not an MCAP file: its first bytes differ", place_in(input.name()), "choose a .mcap file");
    McapReader reader(input.name());
    reader.read(bytes);
    StreamLog log;
    reader.messages.finish(log, input.name(), warnings);
    const std::size_t damaged = reader.damaged + reader.messages.damaged;
    if (damaged > 0)
        warnings.add(input.name() + " mcap.damaged",
                     fmt::format("{}: damaged records, the first at byte {}: skipped", input.name(), reader.first_damaged),
                     damaged);
    if (reader.cut_at > 0)
        warnings.add(input.name() + " mcap.cut",
                     fmt::format("{}: the file is cut in the record at byte {}: read up to there", input.name(), reader.cut_at));
    if (log.streams.empty() && reader.damaged > 0)
        throw input_error(fmt::format("is damaged, the first time at byte {}, and nothing of use is left", reader.first_damaged),
                          place_in(input.name()), "copy the log completely");
    if (log.streams.empty())
        throw input_error("holds no instrument that is used", place_in(input.name()),
                          "it has the topics " + reader.messages.topics() +
                              "; sensor_msgs Imu, NavSatFix, MagneticField, FluidPressure and nav_msgs Odometry are read");
    return log;
}

void write_mcap(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
    std::string out = mcap_begin();
    std::uint32_t number = 0;
    for (const SolutionRow& r : rows)
        if (!append_mcap(out, r, number++))
            throw input_error("a row has a time before zero, which MCAP cannot hold", {}, "give an output with another clock");
    write_file(path, out + mcap_end());
}

}  // namespace

extern const Format mcap_format;
const Format mcap_format = {
    .name = "mcap",
    .title = "MCAP (ROS 2, Foxglove)",
    .extensions = ".mcap",
    .holds =
        "by topic: `sensor_msgs` Imu (gyros and accelerometers in a topic each are joined), NavSatFix (and the twist with its stamps as its velocity), `gps_msgs` GPSFix, MagneticField, FluidPressure; `nav_msgs` Odometry and `geometry_msgs` poses as trajectories in a frame of "
        "their own; zstd and LZ4. Written: NavSatFix, the attitude (body to east-north-up) as QuaternionStamped and the velocity (east, north, up) as TwistWithCovarianceStamped, and so read back",
    .time = "UTC from 1970 (the headers' stamps), or the clock of a simulation",
    .recognise = [](const FileHead& head) { return head.starts_with(mcap_magic); },
    .read = read_mcap,
    .write = write_mcap};

}  // namespace schuler::io
