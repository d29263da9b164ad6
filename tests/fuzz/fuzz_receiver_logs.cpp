// UBX and RTCM 3 from arbitrary bytes: an Error or a result, nothing else. The first byte chooses the reader.
#include "schuler/core/error.h"
#include "schuler/io/rinex_write.h"
#include "schuler/io/rtcm3.h"
#include "schuler/io/ubx.h"

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
        if (data[0] % 2 == 0) {
            const io::UbxLog ubx = io::read_ubx(input, log);
            (void)io::rinex_observations_text(ubx.observations);
            (void)io::rinex_navigation_text(ubx.navigation);
        } else {
            const io::Rtcm3Log rtcm = io::read_rtcm3(input, schuler::Time::from_gps(2244, 0.0), log);
            (void)io::rinex_observations_text(rtcm.observations);
            (void)io::rinex_navigation_text(rtcm.navigation);
        }
    } catch (const schuler::Error&) {}
    return 0;
}
