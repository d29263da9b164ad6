// Tables and the CSV family from arbitrary bytes.
#include "schuler/io/solution/solution_csv.h"
#include "schuler/io/text/csv/csv_recording.h"

#include "fuzz_target.h"

namespace io = schuler::io;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return schuler::fuzz::run(data, size, [](unsigned choice, const io::TextInput& input, schuler::WarningLog& log) {
        switch (choice % 7) {
            case 0: (void)io::read_imu_csv(input, {}, log); break;
            case 1: (void)io::read_gnss_csv(input, {}, log); break;
            case 2: (void)io::read_baro_csv(input, {}, log); break;
            case 3: (void)io::read_mag_csv(input, {}, log); break;
            case 4: (void)io::read_reference_csv(input, {}, log); break;
            case 5: (void)io::read_solution_csv(input, log); break;
            default: (void)io::guess_table_kind(io::inspect_table(input)); break;
        }
    });
}
