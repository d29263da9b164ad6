// RTKLIB .pos files and NMEA logs from arbitrary bytes: an Error or a result, nothing else. The first byte chooses the reader.
#include "schuler/core/error.h"
#include "schuler/io/nmea.h"
#include "schuler/io/rtklib_pos.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    namespace io = schuler::io;
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    const io::TextInput input = io::TextInput::memory(text, "input");
    schuler::WarningLog log;
    try {
        switch (data[0] % 4) {
            case 0: (void)io::read_rtklib_pos(input, log); break;
            case 1: (void)io::read_nmea(input, log); break;
            case 2: (void)io::is_rtklib_pos(input); break;
            default: (void)io::is_nmea(input); break;
        }
    } catch (const schuler::Error&) {}
    return 0;
}
