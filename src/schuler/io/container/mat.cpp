// MAT-files of MATLAB and Octave: the structures of NaveGo, the matrices of PSINS, and columns with the names of docs/files.md.
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/formats.h"
#include "schuler/io/own_files.h"
#include "schuler/io/place.h"
#include "schuler/io/text/table.h"
#include "schuler/io/unpacked_file.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>

namespace schuler::io {
namespace {

using File = std::unique_ptr<mat_t, int (*)(mat_t*)>;
using MatVariable = std::unique_ptr<matvar_t, void (*)(matvar_t*)>;

struct Matrix {
    std::string name;
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;  ///< column by column
    [[nodiscard]] double operator()(std::size_t row, std::size_t column) const { return values[column * rows + row]; }
};
/// A structure, or the top-level variables of the file.
struct Group {
    std::string name;
    std::vector<Matrix> matrices;
    [[nodiscard]] const Matrix* find(std::initializer_list<std::string_view> names) const {
        for (const std::string_view wanted : names)
            for (const Matrix& m : matrices)
                if (m.name == wanted) return &m;
        return nullptr;
    }
};

template <class T>
std::vector<double> doubles_of(const void* data, std::size_t count) {
    const T* from = static_cast<const T*>(data);
    return {from, from + count};
}

std::optional<Matrix> matrix_of(const matvar_t& v) {
    if (v.rank != 2 || v.data == nullptr || v.isComplex != 0 || v.dims == nullptr) return std::nullopt;
    Matrix m;
    m.name = v.name != nullptr ? v.name : "";
    m.rows = v.dims[0];
    m.columns = v.dims[1];
    const std::size_t n = m.rows * m.columns;
    if (n == 0 || v.nbytes < n * static_cast<std::size_t>(v.data_size)) return std::nullopt;
    switch (v.data_type) {
        case MAT_T_DOUBLE: m.values = doubles_of<double>(v.data, n); break;
        case MAT_T_SINGLE: m.values = doubles_of<float>(v.data, n); break;
        case MAT_T_INT8: m.values = doubles_of<std::int8_t>(v.data, n); break;
        case MAT_T_UINT8: m.values = doubles_of<std::uint8_t>(v.data, n); break;
        case MAT_T_INT16: m.values = doubles_of<std::int16_t>(v.data, n); break;
        case MAT_T_UINT16: m.values = doubles_of<std::uint16_t>(v.data, n); break;
        case MAT_T_INT32: m.values = doubles_of<std::int32_t>(v.data, n); break;
        case MAT_T_UINT32: m.values = doubles_of<std::uint32_t>(v.data, n); break;
        case MAT_T_INT64: m.values = doubles_of<std::int64_t>(v.data, n); break;
        case MAT_T_UINT64: m.values = doubles_of<std::uint64_t>(v.data, n); break;
        default: return std::nullopt;
    }
    if (v.class_type == MAT_C_CHAR || v.class_type == MAT_C_CELL || v.class_type == MAT_C_STRUCT) return std::nullopt;
    if (m.rows == 1 && m.columns > 3) std::swap(m.rows, m.columns);  // a long row is a column
    return m;
}

/// Structures and matrices, nested to a few levels.
void collect(matvar_t& v, std::vector<Group>& groups, std::size_t into, int depth) {
    constexpr int deepest = 4;
    constexpr unsigned most_fields = 10'000;
    if (v.class_type != MAT_C_STRUCT) {
        if (auto m = matrix_of(v)) groups[into].matrices.push_back(std::move(*m));
        return;
    }
    const unsigned fields = Mat_VarGetNumberOfFields(&v);
    if (depth >= deepest || v.data == nullptr || v.rank < 2 || v.dims[0] * v.dims[1] != 1 || fields > most_fields) return;
    const std::size_t own = groups.size();
    groups.push_back({v.name != nullptr ? v.name : "", {}});
    for (unsigned i = 0; i < fields; ++i)
        if (matvar_t* field = Mat_VarGetStructFieldByIndex(&v, i, 0)) collect(*field, groups, own, depth + 1);
}

std::int64_t ns(double seconds) { return std::abs(seconds) < 9e9 ? Time::from_seconds(seconds).ns : 0; }
bool is_column(const Matrix* m, std::size_t rows, std::size_t columns = 1) {
    return m != nullptr && m->rows == rows && m->columns == columns;
}

constexpr std::initializer_list<const char*> rate_columns = {"gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s",
                                                             "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2"};
constexpr std::initializer_list<const char*> increment_columns = {"dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad",
                                                                  "dv_x_m_s",     "dv_y_m_s",     "dv_z_m_s"};

/// NaveGo: t in s, wb in rad/s, fb in m/s^2, forward-right-down; positions in radians, velocities north, east, down.
bool add_navego(const Group& g, StreamLog& log) {
    const Matrix* t = g.find({"t"});
    if (t == nullptr || t->columns != 1 || t->rows < 2) return false;
    const std::size_t n = t->rows;
    const Matrix *wb = g.find({"wb"}), *fb = g.find({"fb"});
    if (is_column(wb, n, 3) && is_column(fb, n, 3)) {
        Stream s("imu", TableKind::Imu, g.name + ".wb, .fb", rate_columns);
        for (std::size_t i = 0; i < n; ++i)
            s.add(ns((*t)(i, 0)), {(*wb)(i, 0), (*wb)(i, 1), (*wb)(i, 2), (*fb)(i, 0), (*fb)(i, 1), (*fb)(i, 2)});
        log.add(std::move(s));
        return true;
    }
    const Matrix *lat = g.find({"lat"}), *lon = g.find({"lon"}), *h = g.find({"h"}), *vel = g.find({"vel", "vel_n"});
    if (!is_column(lat, n) || !is_column(lon, n) || !is_column(h, n)) return false;
    if (std::ranges::any_of(lat->values, [](double x) { return std::abs(x) > 1.6; })) return false;  // no radians
    const auto v = [&](std::size_t i, std::size_t k) { return is_column(vel, n, 3) ? (*vel)(i, k) : not_given; };
    const Matrix *roll = g.find({"roll"}), *pitch = g.find({"pitch"}), *yaw = g.find({"yaw", "heading"});
    if (is_column(roll, n) && is_column(pitch, n) && is_column(yaw, n)) {
        Stream s("reference", TableKind::Reference, g.name,
                 {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg", "pitch_deg",
                  "heading_deg"});
        for (std::size_t i = 0; i < n; ++i)
            s.add(ns((*t)(i, 0)), {(*lat)(i, 0) / units::deg, (*lon)(i, 0) / units::deg, (*h)(i, 0), v(i, 0), v(i, 1), v(i, 2),
                                   (*roll)(i, 0) / units::deg, (*pitch)(i, 0) / units::deg, (*yaw)(i, 0) / units::deg});
        log.add(std::move(s));
        return true;
    }
    const Matrix *stdm = g.find({"stdm"}), *stdv = g.find({"stdv"});
    const auto sigma = [](const Matrix* m, std::size_t k) {
        return m != nullptr && m->values.size() == 3 && m->values[k] > 0.0 ? m->values[k] : not_given;
    };
    Stream s("gnss", TableKind::Gnss, g.name,
             {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "std_n_m", "std_e_m",
              "std_d_m", "std_vn_m_s", "std_ve_m_s", "std_vd_m_s"});
    for (std::size_t i = 0; i < n; ++i)
        s.add(ns((*t)(i, 0)), {(*lat)(i, 0) / units::deg, (*lon)(i, 0) / units::deg, (*h)(i, 0), v(i, 0), v(i, 1), v(i, 2),
                               sigma(stdm, 0), sigma(stdm, 1), sigma(stdm, 2), sigma(stdv, 0), sigma(stdv, 1), sigma(stdv, 2)});
    log.add(std::move(s));
    return true;
}

/// PSINS: axes right-forward-up, navigation frame east-north-up, yaw anticlockwise; the time is the last column.
void add_psins(const Group& g, StreamLog& log) {
    for (const Matrix& m : g.matrices) {
        const auto last = [&](std::size_t i) { return ns(m(i, m.columns - 1)); };
        bool ascending = m.rows > 2 && m.columns > 1;
        for (std::size_t i = 1; ascending && i < m.rows; ++i) ascending = m(i, m.columns - 1) > m(i - 1, m.columns - 1);
        if (!ascending) continue;
        const std::string source = g.name.empty() ? m.name : g.name + "." + m.name;
        if (m.name.starts_with("imu") && m.columns == 7) {
            Stream s("imu", TableKind::Imu, source + " (PSINS increments)", increment_columns);
            for (std::size_t i = 0; i < m.rows; ++i) s.add(last(i), {m(i, 1), m(i, 0), -m(i, 2), m(i, 4), m(i, 3), -m(i, 5)});
            log.add(std::move(s));
        } else if ((m.name.starts_with("gps") || m.name.starts_with("gnss")) && (m.columns == 4 || m.columns == 7)) {
            const std::size_t p = m.columns - 4;
            Stream s("gnss", TableKind::Gnss, source,
                     {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s"});
            for (std::size_t i = 0; i < m.rows; ++i)
                s.add(last(i), {m(i, p) / units::deg, m(i, p + 1) / units::deg, m(i, p + 2), p > 0 ? m(i, 1) : not_given,
                                p > 0 ? m(i, 0) : not_given, p > 0 ? -m(i, 2) : not_given});
            log.add(std::move(s));
        } else if (m.name.starts_with("avp") && m.columns == 10) {
            Stream s("reference", TableKind::Reference, source,
                     {"lat_deg", "lon_deg", "height_ellipsoidal_m", "vel_n_m_s", "vel_e_m_s", "vel_d_m_s", "roll_deg",
                      "pitch_deg", "heading_deg"});
            for (std::size_t i = 0; i < m.rows; ++i) {
                const double heading = std::fmod(360.0 - m(i, 2) / units::deg, 360.0);
                s.add(last(i), {m(i, 6) / units::deg, m(i, 7) / units::deg, m(i, 8), m(i, 4), m(i, 3), -m(i, 5),
                                m(i, 1) / units::deg, m(i, 0) / units::deg, heading < 0.0 ? heading + 360.0 : heading});
            }
            log.add(std::move(s));
        }
    }
}

/// Columns of equal length named as in text tables.
bool add_named(const Group& g, StreamLog& log) {
    const auto time = std::ranges::find_if(g.matrices, [](const Matrix& m) {
        return m.columns == 1 && m.rows > 1 && (m.name == "time_s" || m.name == "time" || m.name == "t");
    });
    if (time == g.matrices.end()) return false;
    TableLayout layout;
    std::vector<const Matrix*> columns;
    for (const Matrix& m : g.matrices) {
        if (m.columns != 1 || m.rows != time->rows) continue;
        layout.names.push_back(m.name);
        columns.push_back(&m);
    }
    layout.columns = static_cast<int>(columns.size());
    auto kind = guess_table_kind(layout);
    if (!kind || *kind == TableKind::Ranges || *kind == TableKind::Stations) return false;
    const auto attitude = [&](const Matrix* m) { return m->name == "roll_deg"; };
    if (*kind == TableKind::Gnss && std::ranges::any_of(columns, attitude)) kind = TableKind::Reference;
    Stream s(std::string(name_of(*kind)), *kind, g.name.empty() ? "columns by their names" : g.name, {});
    for (std::size_t i = 0; i < time->rows; ++i) s.time_ns.push_back(ns((*time)(i, 0)));
    for (const Matrix* m : columns)
        if (m != &*time) s.columns.push_back({m->name, m->values});
    log.add(std::move(s));
    return true;
}

/// Where the variables of a file begin (bytes), as far as each ends where the next one begins; and where that is no longer so.
struct VariablePlaces {
    std::vector<std::size_t> starts;
    std::optional<std::size_t> damaged;
};

/// The library does not tell a cut or shifted variable from the end of the file, and returns its memory as values. The lengths of the
/// variables tell: behind each must follow another one, or nothing. Of version 7.3 HDF5 tells by itself.
std::optional<VariablePlaces> variable_places(const std::string& file) {
    constexpr std::size_t header = 128, tag = 8;
    constexpr std::uint32_t matrix = 14, compressed = 15;
    std::ifstream in(file, std::ios::binary);
    std::array<char, header> head{};
    if (!in.read(head.data(), header)) return std::nullopt;
    const bool big_endian = head[header - 2] == 'M' && head[header - 1] == 'I';
    if (!big_endian && !(head[header - 2] == 'I' && head[header - 1] == 'M')) return std::nullopt;
    if (head[big_endian ? header - 4 : header - 3] != 1) return std::nullopt;  // 7.3
    const auto number = [&](const char* bytes) {
        std::uint32_t x = 0;
        for (std::size_t i = 0; i < 4; ++i) x = x << 8U | static_cast<unsigned char>(bytes[big_endian ? i : 3 - i]);
        return x;
    };
    std::error_code ec;
    const std::size_t size = std::filesystem::file_size(file, ec);
    VariablePlaces places;
    for (std::size_t at = header; at < size;) {
        std::array<char, tag> bytes{};
        in.seekg(static_cast<std::streamoff>(at));
        const bool whole = static_cast<bool>(in.read(bytes.data(), tag));
        const std::uint32_t type = number(bytes.data()), length = number(bytes.data() + 4);
        if (whole && type != matrix && type != compressed) {  // the one before is too long or too short
            places.damaged = places.starts.empty() ? header : places.starts.back();
            if (!places.starts.empty()) places.starts.pop_back();
            break;
        }
        if (!whole || length > size - at - tag) {
            places.damaged = at;
            break;
        }
        places.starts.push_back(at);
        at += tag + length;
    }
    return places;
}

StreamLog read_mat(const TextInput& input, WarningLog& warnings) {
    if (input.in_memory()) throw input_error("a MAT-file cannot be read from memory", place_in(input.name()), "give the file");
    const UnpackedFile unpacked(input);
    const File file(Mat_Open(unpacked.path().c_str(), MAT_ACC_RDONLY), Mat_Close);
    if (!file)
        throw input_error("is not a MAT-file, or damaged", place_in(input.name()), "save it with -v7 and copy it completely");
    std::vector<Group> groups(1);
    std::string names;
    const std::optional<VariablePlaces> places = variable_places(unpacked.path());
    std::optional<std::size_t> damaged = places ? places->damaged : std::nullopt;
    for (std::size_t n = 0; !places || n < places->starts.size(); ++n) {
        const MatVariable v(Mat_VarReadNext(file.get()), Mat_VarFree);
        if (!v) {
            if (places) damaged = places->starts[n];
            break;
        }
        names += (names.empty() ? "" : ", ") + std::string(v->name != nullptr ? v->name : "");
        collect(*v, groups, 0, 0);
    }
    if (damaged)
        warnings.add(input.name() + " mat.damaged",
                     fmt::format("{}: is cut or damaged at byte {}: the variables from there on are left out; copy it completely",
                                 input.name(), *damaged));
    StreamLog log;
    for (const Group& g : groups) {
        if (add_navego(g, log)) continue;
        add_psins(g, log);
        (void)add_named(g, log);
    }
    if (log.streams.empty())
        throw input_error(
            "holds no variables that are known", place_in(input.name()),
            fmt::format(
                "structures of NaveGo (t, wb, fb; t, lat, lon, h, vel), matrices of PSINS (imu, gps, avp) and columns with the names of docs/files.md are; it "
                "has {}",
                names.empty() ? "none, or is cut" : names + (damaged ? ", and is cut or damaged behind them" : "")));
    return log;
}

void write_mat(const std::filesystem::path& path, std::span<const SolutionRow> rows, const std::string&) {
    check_overwrite(path);
    const std::filesystem::path beside = create_beside(path);
    {
        const File file(Mat_CreateVer(beside.c_str(), "MATLAB 5.0 MAT-file, written by schuler", MAT_FT_MAT5), Mat_Close);
        if (!file) throw input_error("cannot be written", place_in(path.string()), "choose a folder that can be");
        std::vector<double> values(rows.size());
        bool good = true;
        const auto put = [&](const char* name, auto value) {
            for (std::size_t i = 0; i < rows.size(); ++i) values[i] = value(rows[i]);
            std::array<std::size_t, 2> size = {rows.size(), 1};
            const MatVariable v(
                Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size.data(), values.data(), MAT_F_DONT_COPY_DATA),
                Mat_VarFree);
            good = good && v && Mat_VarWrite(file.get(), v.get(), MAT_COMPRESSION_NONE) == 0;
        };
        put("time_s", [](const SolutionRow& r) { return r.time.seconds(); });
        put("lat_deg", [](const SolutionRow& r) { return r.position.lat / units::deg; });
        put("lon_deg", [](const SolutionRow& r) { return r.position.lon / units::deg; });
        put("height_m", [](const SolutionRow& r) { return r.position.h; });
        static constexpr std::array<const char*, 15> names = {
            "vel_n_m_s", "vel_e_m_s",  "vel_d_m_s",  "roll_deg",   "pitch_deg",    "heading_deg",   "std_n_m",        "std_e_m",
            "std_d_m",   "std_vn_m_s", "std_ve_m_s", "std_vd_m_s", "std_roll_deg", "std_pitch_deg", "std_heading_deg"};
        static constexpr std::array members = {&SolutionRow::v_eb_n, &SolutionRow::rpy, &SolutionRow::std_position,
                                               &SolutionRow::std_velocity, &SolutionRow::std_rpy};
        for (std::size_t k = 0; k < names.size(); ++k) {
            const auto member = members[k / 3];
            const double unit = k / 3 == 1 || k / 3 == 4 ? units::deg : 1.0;
            const auto axis = static_cast<Eigen::Index>(k % 3);
            put(names[k], [=](const SolutionRow& r) { return (r.*member)(axis) / unit; });
        }
        if (!good) {
            std::filesystem::remove(beside);
            throw input_error("cannot be written completely", place_in(path.string()), "is the disk full?");
        }
    }
    std::filesystem::rename(beside, path);
    note_own_file(path);
}

}  // namespace

extern const Format mat_format;
const Format mat_format = {
    .name = "mat",
    .title = "MAT-file (MATLAB, Octave)",
    .extensions = ".mat",
    .holds =
        "structures of NaveGo (`t`, `wb`, `fb`; `t`, `lat`, `lon`, `h`, `vel`, `stdm`, `stdv`; with `roll`, `pitch`, `yaw` a reference), matrices of PSINS "
        "(`imu`, `gps`, `avp`), and column vectors with the names below; versions 5 and 7.3",
    .time = "as in the file, s",
    .recognise = [](const FileHead& head) { return head.starts_with("MATLAB 5") || head.starts_with("MATLAB 7"); },
    .read = read_mat,
    .write = write_mat};

}  // namespace schuler::io
