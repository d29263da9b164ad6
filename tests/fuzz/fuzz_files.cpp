// Formats that are read from a place on the disk: databases, containers of libraries, folders, recordings of samples, compressed files; and
// the tables of their own kinds.
#include "schuler/io/bytes.h"
#include "schuler/io/formats.h"
#include "schuler/io/raw_input.h"
#include "schuler/io/receiver/if_file.h"
#include "schuler/io/rinex/compact_rinex.h"
#include "schuler/io/text/csv/csv_events.h"
#include "schuler/io/text/csv/csv_grid.h"
#include "schuler/io/text/csv/csv_instruments.h"

#include "fuzz_target.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <complex>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace {

namespace fs = std::filesystem;
namespace io = schuler::io;

/// A folder of this process, emptied for every input.
const fs::path& place() {
    static const fs::path folder = [] {
        const fs::path memory = fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
        return memory / ("schuler-fuzz-" + std::to_string(getpid()));
    }();
    fs::remove_all(folder);
    fs::create_directories(folder);
    return folder;
}

fs::path written(const std::string& name, std::string_view bytes) {
    const fs::path file = place() / name;
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file;
}

/// The parts between bytes 0xFE as files of a folder.
fs::path folder_of(std::string_view bytes, std::initializer_list<const char*> names) {
    const fs::path& folder = place();
    for (const char* name : names) {
        const std::string_view part = bytes.substr(0, bytes.find('\xfe'));
        bytes.remove_prefix(std::min(bytes.size(), part.size() + 1));
        fs::create_directories((folder / name).parent_path());
        std::ofstream(folder / name, std::ios::binary).write(part.data(), static_cast<std::streamsize>(part.size()));
    }
    return folder;
}

void read_as(const char* format, const fs::path& path, schuler::WarningLog& log) {
    const io::StreamLog streams = io::format_named(format)->read(io::TextInput(path), log);
    for (const io::Stream& stream : streams.streams)
        if (io::table_text(stream, streams.clock).size() < stream.rows()) __builtin_trap();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    return schuler::fuzz::run(data, size, [](unsigned choice, const io::TextInput& input, schuler::WarningLog& log) {
        const std::string_view bytes = input.content();
        switch (choice % 16) {
            case 0: read_as("rosbag2", written("a.db3", bytes), log); break;
            case 1: read_as("mat", written("a.mat", bytes), log); break;
            case 2: read_as("hdf5", written("a.h5", bytes), log); break;
            case 3:
                read_as("kitti", folder_of(bytes, {"timestamps.txt", "data/0000000000.txt", "data/0000000001.txt"}), log);
                break;
            case 4:
                read_as("phone", folder_of(bytes, {"Gyroscope.csv", "Accelerometer.csv", "Magnetometer.csv"}) / "Gyroscope.csv",
                        log);
                break;
            case 5: (void)io::read_grid_csv(input, {"up_mgal"}, 1e-5); break;
            case 6: (void)io::read_events_csv(input); break;
            case 7: (void)io::read_gauges_csv(input); break;
            case 8: (void)io::read_dvl_csv(input); break;
            case 9: (void)io::read_compass_csv(input); break;
            case 10: (void)io::read_odometer_csv(input); break;
            case 11: {
                static constexpr std::array formats = {"ibyte", "ubyte", "ishort", "gr_complex"};
                io::IfFile file(written("a.bin", bytes), formats[choice / 16 % formats.size()], choice / 64);
                std::array<std::complex<std::int8_t>, 64> samples;
                while (file.read(samples)) {}
                break;
            }
            case 12: (void)io::read_bytes(io::TextInput(written("a.csv.gz", bytes))); break;
            case 13: (void)io::format_of(written("a.txt", bytes)); break;
            case 14:
                // decoding one is left to another program
                if (!io::is_compact_rinex(bytes)) (void)io::read_raw_input(written("a.obs", bytes), {}, log);
                break;
            default: {  // whatever it is taken for
                const fs::path file = written("a.log", bytes);
                const io::Format* format = io::format_of(file);
                if (format != nullptr && format->read != nullptr) (void)format->read(io::TextInput(file), log);
            }
        }
    });
}
