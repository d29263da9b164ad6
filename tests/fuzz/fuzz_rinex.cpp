// RINEX observations and navigation, SP3 and ANTEX from arbitrary bytes.
#include "schuler/io/rinex/antex.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/io/rinex/sp3.h"

#include "fuzz_target.h"

namespace io = schuler::io;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return schuler::fuzz::run(data, size, [](unsigned choice, const io::TextInput& input, schuler::WarningLog& log) {
        // a Hatanaka file would start another program
        if (input.content().find("CRINEX") != std::string_view::npos) return;
        switch (choice % 4) {
            case 0: (void)io::read_rinex_observations(input, log); break;
            case 1: (void)io::read_rinex_navigation(input, log); break;
            case 2: (void)io::read_sp3(input, log); break;
            default:
                (void)io::rinex_kind(input);
                (void)io::read_antex(input, log);
                break;
        }
    });
}
