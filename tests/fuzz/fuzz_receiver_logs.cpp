// UBX, RTCM 3 and raw NovAtel logs from arbitrary bytes.
#include "schuler/io/receiver/novatel_raw.h"
#include "schuler/io/receiver/rtcm3.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/io/rinex/rinex_write.h"

#include "fuzz_target.h"

namespace io = schuler::io;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return schuler::fuzz::run(data, size, [](unsigned choice, const io::TextInput& input, schuler::WarningLog& log) {
        if (choice % 3 == 0) {
            const io::UbxLog ubx = io::read_ubx(input, log);
            (void)io::rinex_observations_text(ubx.observations);
            (void)io::rinex_navigation_text(ubx.navigation);
        } else if (choice % 3 == 2) {
            const io::NovatelRaw novatel = io::read_novatel_raw(input, log);
            (void)io::rinex_observations_text(novatel.observations);
            (void)io::rinex_navigation_text(novatel.navigation);
        } else {
            const io::Rtcm3Log rtcm = io::read_rtcm3(input, schuler::Time::from_gps(2244, 0.0), log);
            (void)io::rinex_observations_text(rtcm.observations);
            (void)io::rinex_navigation_text(rtcm.navigation);
        }
    });
}
