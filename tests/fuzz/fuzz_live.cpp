// Live streams: any bytes in pieces of any size, with pauses and broken connections between them.
#include "schuler/live/decoder.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

namespace live = schuler::live;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < 3) return 0;
    const auto format = static_cast<live::StreamFormat>(data[0] % 7);
    const auto instrument = static_cast<live::Instrument>(data[1] % live::instrument_count);
    const std::size_t piece = 1 + data[2];
    const auto decoder = live::make_decoder(format, instrument, {});
    std::string_view bytes(reinterpret_cast<const char*>(data) + 3, size - 3);
    std::vector<live::Sample> samples;
    for (std::size_t count = 1; !bytes.empty(); ++count) {
        const std::size_t now = std::min(piece, bytes.size());
        decoder->take(bytes.substr(0, now), samples);
        bytes.remove_prefix(now);
        if (count % 5 == 0 && decoder->waiting()) decoder->quiet(samples);
        if (count % 31 == 0) decoder->reset();
        (void)decoder->satellites().renewed();
    }
    decoder->quiet(samples);
    // nothing comes of nothing: the shortest sample of any format is longer than a byte
    if (samples.size() > size || decoder->counters().garbage > size || decoder->counters().example.size() > 2000) std::abort();
    return 0;
}
