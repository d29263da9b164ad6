// Gyroscope, accelerometer and magnetometer in a table each, as loggers of telephones write them: one log of an IMU at the gyroscope's
// times, and one of the field.
#include "schuler/core/error.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/streams.h"
#include "schuler/io/text/table.h"
#include "schuler/math/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <system_error>

namespace schuler::io {
namespace {

namespace fs = std::filesystem;

constexpr std::array axes = {"x", "y", "z"};
constexpr const char* rate = "gyro_{}_rad_s";
constexpr const char* force = "accel_{}_m_s2";
constexpr const char* field = "mag_{}_ut";

bool has_word(const fs::path& file, std::initializer_list<std::string_view> any) {
    const std::string name = file.filename().string();
    return std::ranges::any_of(words_of_name(name.substr(0, name.find('.'))),
                               [&](const std::string& word) { return std::ranges::find(any, word) != any.end(); });
}
bool is_gyroscope(const fs::path& file) { return has_word(file, {"gyroscope", "gyro", "gyr"}); }
bool is_accelerometer(const fs::path& file) {
    return has_word(file, {"accelerometer", "accel", "acc", "acceleration"}) && !has_word(file, {"linear", "user", "without"});
}

bool is_magnetometer(const fs::path& file) {
    return has_word(file, {"magnetometer", "mag", "magnetic"}) && !has_word(file, {"uncalibrated", "uncal", "raw"});
}

/// Tables beside `gyroscope` whose name states the instrument, by name.
std::vector<fs::path> beside(const fs::path& gyroscope, bool (*is_instrument)(const fs::path&)) {
    std::vector<fs::path> found;
    std::error_code failure;
    const fs::path folder = gyroscope.has_parent_path() ? gyroscope.parent_path() : fs::path(".");
    for (fs::directory_iterator it(folder, failure), end; !failure && it != end; it.increment(failure)) {
        std::error_code odd;
        if (it->is_regular_file(odd) && it->path().extension() == gyroscope.extension() && is_instrument(it->path()) &&
            !is_gyroscope(it->path()))
            found.push_back(it->path());
    }
    std::ranges::sort(found);
    return found;
}

/// One instrument of three axes.
struct Instrument {
    std::vector<std::int64_t> t;
    std::vector<std::array<double, 3>> values;
    bool unit_stated = false;
    std::string time_column;
};

struct Columns {
    TableLayout layout;
    ColumnPlan plan;
    [[nodiscard]] const ColumnMatch* axis(const char* quantity, const char* name) const {
        return plan.find(fmt::format(fmt::runtime(quantity), name));
    }
    [[nodiscard]] bool complete(const char* quantity) const {
        return std::ranges::all_of(axes, [&](const char* name) { return axis(quantity, name) != nullptr; });
    }
};

Columns columns_of(const fs::path& file, const char* quantity, TableKind kind = TableKind::Imu) {
    TableLayout layout = inspect_table(TextInput(file));
    ColumnOverrides names;
    for (const char* axis : axes) {
        const auto bare = std::ranges::find_if(layout.names, [&](const std::string& name) {
            const std::vector<std::string> words = words_of_name(name);
            return !words.empty() && words.front() == axis;
        });
        if (bare != layout.names.end()) names.columns[fmt::format(fmt::runtime(quantity), axis)] = *bare;
    }
    if (names.columns.size() != 3) names.columns.clear();
    ColumnPlan plan = match_columns(layout, kind, names);
    return {std::move(layout), std::move(plan)};
}

Instrument read_instrument(const fs::path& file, const Columns& columns, const char* quantity) {
    const ColumnMatch* time = columns.plan.find("time_s");
    const SourcePlace header = place_in(file.string(), columns.layout.header_line);
    if (time == nullptr) throw input_error("has no column of the time", header, "name the columns time_s, x, y, z");
    Instrument instrument;
    instrument.time_column = time->file_name;
    std::vector<FieldRequest> requests{request_of(*time)};
    for (const char* axis : axes) {
        const ColumnMatch* match = columns.axis(quantity, axis);
        if (match == nullptr)
            throw input_error(fmt::format("has no column of the {} axis", axis), header, "name the columns time_s, x, y, z");
        requests.push_back(request_of(*match));
        instrument.unit_stated = match->unit_stated;
    }
    TableReader reader(TextInput(file), columns.layout, requests);
    while (reader.next()) {
        if (!reader.row_ok() || reader.time_ns(0) == TableReader::no_time) continue;
        if (!instrument.t.empty() && reader.time_ns(0) <= instrument.t.back()) continue;  // a logger's repetition
        instrument.t.push_back(reader.time_ns(0));
        instrument.values.push_back({reader.number(1), reader.number(2), reader.number(3)});
    }
    return instrument;
}

/// In m/s^2, g or mg: the mean of a log of any motion is near gravity.
bool shows_gravity(const Instrument& accelerometer) {
    std::vector<double> norms;
    for (const auto& v : accelerometer.values) norms.push_back(std::hypot(v[0], v[1], v[2]));
    if (norms.empty()) return false;
    const double norm = math::median(std::move(norms));
    constexpr double low = 0.7, high = 1.4, g = 9.8, thousand = 1e3;
    return std::ranges::any_of(std::array{g, 1.0, thousand},
                               [&](double unit) { return norm > low * unit && norm < high * unit; });
}

/// The values of the accelerometer at the times of the gyroscope, linear between its samples; none across a gap.
Stream joined(const Instrument& gyroscope, const Instrument& accelerometer) {
    Stream stream;
    stream.name = "imu";
    stream.kind = TableKind::Imu;
    for (const char* axis : axes)
        stream.columns.push_back({fmt::format("gyro_{}{}", axis, gyroscope.unit_stated ? "_rad_s" : ""), {}});
    for (const char* axis : axes)
        stream.columns.push_back({fmt::format("accel_{}{}", axis, accelerometer.unit_stated ? "_m_s2" : ""), {}});
    std::vector<double> steps;
    for (std::size_t i = 1; i < accelerometer.t.size(); ++i)
        steps.push_back(static_cast<double>(accelerometer.t[i] - accelerometer.t[i - 1]));
    if (steps.empty()) return stream;
    constexpr double gap = 3.0;
    const double longest = gap * math::median(std::move(steps));
    for (std::size_t i = 0, k = 1; i < gyroscope.t.size(); ++i) {
        while (k < accelerometer.t.size() && accelerometer.t[k] < gyroscope.t[i]) ++k;
        if (k == accelerometer.t.size()) break;
        const std::int64_t from = accelerometer.t[k - 1];
        const auto step = static_cast<double>(accelerometer.t[k] - from);
        if (gyroscope.t[i] < from || step > longest) continue;
        const double share = static_cast<double>(gyroscope.t[i] - from) / step;
        stream.time_ns.push_back(gyroscope.t[i]);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            stream.columns[axis].values.push_back(gyroscope.values[i][axis]);
            stream.columns[axis + 3].values.push_back((1.0 - share) * accelerometer.values[k - 1][axis] +
                                                      share * accelerometer.values[k][axis]);
        }
    }
    return stream;
}

/// The field, if a table of it has time in common with the IMU. Phones log microtesla.
std::optional<Stream> magnetometer(const fs::path& gyroscope, const Stream& imu) {
    for (const fs::path& candidate : beside(gyroscope, is_magnetometer)) {
        const Columns columns = columns_of(candidate, field, TableKind::Mag);
        if (!columns.complete(field) || columns.plan.find("time_s") == nullptr) continue;
        const Instrument read = read_instrument(candidate, columns, field);
        Stream stream("mag", TableKind::Mag, candidate.filename().string(), {"mag_x_ut", "mag_y_ut", "mag_z_ut"});
        for (std::size_t i = 0; i < read.t.size(); ++i)
            stream.add(read.t[i], {read.values[i][0], read.values[i][1], read.values[i][2]});
        const bool meets = stream.rows() > 0 && imu.rows() > 0 && stream.time_ns.front() <= imu.time_ns.back() &&
                           stream.time_ns.back() >= imu.time_ns.front();
        if (meets) return stream;
    }
    return std::nullopt;
}

StreamLog read_phone_tables(const TextInput& input, WarningLog& warnings) {
    const fs::path file(input.name());
    const Instrument gyroscope = read_instrument(file, columns_of(file, rate), rate);
    std::string other_clock, no_gravity, other_columns;
    for (const fs::path& candidate : beside(file, is_accelerometer)) {
        const Columns columns = columns_of(candidate, force);
        if (!columns.complete(force)) {
            other_columns = candidate.filename().string();
            continue;
        }
        const Instrument accelerometer = read_instrument(candidate, columns, force);
        if (!shows_gravity(accelerometer)) {
            no_gravity = candidate.filename().string();
            continue;
        }
        Stream stream = joined(gyroscope, accelerometer);
        if (2 * stream.rows() < gyroscope.t.size()) {
            other_clock = candidate.filename().string();
            continue;
        }
        stream.source = fmt::format("{} and {}", file.filename().string(), candidate.filename().string());
        const std::size_t without = gyroscope.t.size() - stream.rows();
        if (without > 0)
            warnings.add(input.name() + " phone.alone",
                         fmt::format("{}: rows without an acceleration beside them: left out", input.name()), without);
        StreamLog log;
        constexpr double dated = 1e9;  // s
        log.clock =
            !stream.time_ns.empty() && static_cast<double>(stream.time_ns.front()) * 1e-9 > dated ? Clock::Unix : Clock::Boot;
        log.contents.push_back("accelerations at the gyroscope's times, linear between their samples");
        std::optional<Stream> mag = magnetometer(file, stream);
        log.add(std::move(stream));
        if (mag) log.add(std::move(*mag));
        return log;
    }
    throw input_error(!other_clock.empty()  ? fmt::format("has hardly any time in common with {}", other_clock)
                      : !no_gravity.empty() ? fmt::format("is a gyroscope alone: {} beside it does not show gravity", no_gravity)
                      : !other_columns.empty()
                          ? fmt::format("is a gyroscope alone: {} beside it has no columns of an accelerometer", other_columns)
                          : std::string("is a gyroscope alone"),
                      place_in(input.name()),
                      !other_clock.empty() ? "give both the same clock, or join them into one table"
                                           : "put the table of the accelerometer itself (with gravity) into the same folder");
}

}  // namespace

extern const Format phone_format;
const Format phone_format = {
    .name = "phone",
    .title = "Gyroscope and accelerometer in a table each",
    .extensions = "Gyroscope.csv",
    .holds =
        "the IMU of a telephone: `Gyroscope.csv` (time, x, y, z) with `Accelerometer.csv` beside it, whose values are interpolated to its "
        "times; one that shows no gravity (linear acceleration) is of no use; `Magnetometer.csv` beside them (uT)",
    .time = "as its columns say",
    .recognise =
        [](const FileHead& head) {
            if (head.path.extension() != ".csv" && head.path.extension() != ".txt") return false;
            if (!is_gyroscope(head.path) || is_accelerometer(head.path) || beside(head.path, is_accelerometer).empty())
                return false;
            const std::string first = head.bytes.substr(0, head.bytes.find('\n'));
            const bool names = std::ranges::any_of(first, [](unsigned char c) { return std::isalpha(c) != 0; });
            return names && std::ranges::none_of(words_of_name(first), [](const std::string& word) {
                       return (word.starts_with("acc") && word != "accuracy") || word.starts_with("lat");
                   });
        },
    .read = read_phone_tables};

}  // namespace schuler::io
