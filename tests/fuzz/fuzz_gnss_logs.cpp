// RTKLIB .pos files and NMEA logs from arbitrary bytes.
#include "schuler/io/receiver/nmea.h"
#include "schuler/io/solution/rtklib_pos.h"

#include "fuzz_target.h"

namespace io = schuler::io;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return schuler::fuzz::run(data, size, [](unsigned choice, const io::TextInput& input, schuler::WarningLog& log) {
        switch (choice % 4) {
            case 0: (void)io::read_rtklib_pos(input, log); break;
            case 1: (void)io::read_nmea(input, log); break;
            case 2: (void)io::is_rtklib_pos(input); break;
            default: (void)io::is_nmea(input); break;
        }
    });
}
