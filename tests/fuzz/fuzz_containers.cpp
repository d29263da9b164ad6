// Logs of autopilots, robots and receivers from arbitrary bytes.
#include "schuler/io/container/compression.h"
#include "schuler/io/formats.h"

#include "fuzz_target.h"

#include <array>

namespace io = schuler::io;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return schuler::fuzz::run(data, size, [](unsigned choice, const io::TextInput& input, schuler::WarningLog& log) {
        static constexpr std::array names = {"ulog", "dataflash", "mcap", "rosbag",   "novatel",  "ubx", "sbet",
                                             "tum",  "euroc",     "gpx",  "waypoint", "ulog2csv", "imr", "vectornav"};
        static constexpr std::array methods = {"zstd", "lz4", "bz2"};
        const std::size_t kind = choice % (names.size() + methods.size());
        if (kind >= names.size()) {
            (void)io::decompressed(input.content(), methods[kind - names.size()], size_t{1} << 20);
            return;
        }
        const io::StreamLog streams = io::format_named(names[kind])->read(input, log);
        for (const io::Stream& stream : streams.streams) {
            const std::string table = io::table_text(stream, streams.clock);
            if (table.size() < stream.rows() || stream.find(stream.columns.front().name)->values.size() != stream.rows())
                __builtin_trap();
        }
    });
}
