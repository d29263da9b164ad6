// KF-GINS projects and text files from arbitrary bytes.
#include "schuler/io/solution/kfgins.h"

#include "fuzz_target.h"

namespace io = schuler::io;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return schuler::fuzz::run(data, size, [](unsigned choice, const io::TextInput& input, schuler::WarningLog& log) {
        switch (choice % 4) {
            case 0: (void)io::read_kfgins_project(input, "/"); break;
            case 1: (void)io::read_kfgins_imu(input, log); break;
            case 2: (void)io::read_kfgins_gnss(input, log); break;
            default: (void)io::is_kfgins_project(input); break;
        }
    });
}
