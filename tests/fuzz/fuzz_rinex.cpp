// RINEX observations and navigation and SP3 from arbitrary bytes: an Error or a result, nothing else. The first byte chooses the reader.
#include "schuler/core/error.h"
#include "schuler/io/rinex.h"
#include "schuler/io/sp3.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    namespace io = schuler::io;
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    // a Hatanaka file would start another program
    if (text.find("CRINEX") != std::string_view::npos) return 0;
    const io::TextInput input = io::TextInput::memory(text, "input");
    schuler::WarningLog log;
    try {
        switch (data[0] % 4) {
            case 0: (void)io::read_rinex_observations(input, log); break;
            case 1: (void)io::read_rinex_navigation(input, log); break;
            case 2: (void)io::read_sp3(input, log); break;
            default: (void)io::rinex_kind(input); break;
        }
    } catch (const schuler::Error&) {}
    return 0;
}
