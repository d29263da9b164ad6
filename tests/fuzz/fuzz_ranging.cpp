// Ranges, stations and 1090 MHz logs from arbitrary bytes: an Error or a result, nothing else. The first byte chooses the reader.
#include "schuler/core/error.h"
#include "schuler/io/receiver/adsb.h"
#include "schuler/io/text/csv/csv_ranges.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    namespace io = schuler::io;
    if (size == 0) return 0;
    const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
    const io::TextInput input = io::TextInput::memory(bytes, "input");
    schuler::WarningLog log;
    try {
        switch (data[0] % 3) {
            case 0: (void)io::ranges_csv(io::read_ranges_csv(input, {}, log).log); break;
            case 1: (void)io::stations_csv(io::read_stations_csv(input, {}, log)); break;
            default: (void)io::stations_of(io::read_adsb(input, schuler::Geodetic{0.9, 0.5, 0.0}, log)); break;
        }
    } catch (const schuler::Error&) {}
    return 0;
}
