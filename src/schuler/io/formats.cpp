#include "schuler/io/formats.h"

#include "schuler/core/error.h"
#include "schuler/io/bytes.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace schuler::io {

// In the order in which they are tried: formats with a signature first, text tables last.
#define SCHULER_FORMATS(FORMAT)      \
    FORMAT(rinex_observation_format) \
    FORMAT(rinex_navigation_format)  \
    FORMAT(sp3_format)               \
    FORMAT(antex_format)             \
    FORMAT(ulog_format)              \
    FORMAT(dataflash_format)         \
    FORMAT(mcap_format)              \
    FORMAT(ros_bag_format)           \
    FORMAT(ros_db3_format)           \
    FORMAT(mat_format)               \
    FORMAT(hdf5_format)              \
    FORMAT(imr_format)               \
    FORMAT(novatel_format)           \
    FORMAT(ubx_format)               \
    FORMAT(rtcm3_format)             \
    FORMAT(vectornav_format)         \
    FORMAT(sbet_format)              \
    FORMAT(kfgins_yaml_format)       \
    FORMAT(toml_format)              \
    FORMAT(rtklib_pos_format)        \
    FORMAT(adsb_format)              \
    FORMAT(nmea_format)              \
    FORMAT(gpx_format)               \
    FORMAT(igc_format)               \
    FORMAT(kitti_format)             \
    FORMAT(waypoint_format)          \
    FORMAT(ulog2csv_format)          \
    FORMAT(phone_format)             \
    FORMAT(euroc_format)             \
    FORMAT(tum_format)               \
    FORMAT(kml_format)               \
    FORMAT(geojson_format)           \
    FORMAT(kfgins_table_format)      \
    FORMAT(csv_format)

#define SCHULER_DECLARED(name) extern const Format name;
#define SCHULER_LISTED(name) &name,
SCHULER_FORMATS(SCHULER_DECLARED)

std::span<const Format* const> formats() {
    static constexpr std::array all = {SCHULER_FORMATS(SCHULER_LISTED)};
    return all;
}

FileHead::FileHead(const std::filesystem::path& file) : path(file) {
    std::error_code ec;
    folder = std::filesystem::is_directory(file, ec);
    std::filesystem::path name = file.filename();
    if (name.extension() == ".gz") name = name.stem();
    extension = name.extension().string();
    std::ranges::transform(extension, extension.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    constexpr std::size_t enough = 65'536;
    if (!folder) bytes = read_head(TextInput(file), enough);
    if (is_utf16(bytes)) bytes = utf8_of_utf16(bytes);
}

const Format* format_of(const std::filesystem::path& file) {
    const FileHead head(file);
    for (const Format* format : formats())
        if (format->recognise != nullptr && format->folder == head.folder && format->recognise(head)) return format;
    return nullptr;
}

const Format* format_named(std::string_view name) {
    const auto it = std::ranges::find(formats(), name, &Format::name);
    return it == formats().end() ? nullptr : *it;
}

const Format* format_to_write(const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    if (extension.empty()) return nullptr;
    const Format* best = nullptr;
    std::size_t best_place = 0;
    for (const Format* format : formats()) {
        if (format->write == nullptr) continue;
        std::size_t place = 0;  // the first name of a format is its own
        for (std::string_view rest = format->extensions; !rest.empty(); ++place) {
            const std::size_t end = std::min(rest.find(' '), rest.size());
            if (rest.substr(0, end) == extension && (best == nullptr || place < best_place)) best = format, best_place = place;
            rest.remove_prefix(std::min(end + 1, rest.size()));
        }
    }
    return best;
}

}  // namespace schuler::io
