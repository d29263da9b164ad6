// Tables and the CSV family from arbitrary bytes: an Error or a result, nothing else. The first byte chooses the reader.
#include "schuler/core/error.h"
#include "schuler/io/csv_recording.h"
#include "schuler/io/solution_csv.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    namespace io = schuler::io;
    if (size == 0) return 0;
    const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
    const io::TextInput input = io::TextInput::memory(text, "input.csv");
    schuler::WarningLog log;
    try {
        switch (data[0] % 7) {
            case 0: (void)io::read_imu_csv(input, {}, log); break;
            case 1: (void)io::read_gnss_csv(input, {}, log); break;
            case 2: (void)io::read_baro_csv(input, {}, log); break;
            case 3: (void)io::read_mag_csv(input, {}, log); break;
            case 4: (void)io::read_reference_csv(input, {}, log); break;
            case 5: (void)io::read_solution_csv(input, log); break;
            default: (void)io::guess_table_kind(io::inspect_table(input)); break;
        }
    } catch (const schuler::Error&) {}
    return 0;
}
