#include "schuler/io/container/hdf5_file.h"

#include "schuler/io/atomic_file.h"
#include "schuler/io/own_files.h"
#include "schuler/io/place.h"
#include "schuler/io/regular_file.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <utility>

namespace schuler::io {
namespace {

/// An HDF5 identifier, closed at the end of its scope.
class Handle {
public:
    using Close = herr_t (*)(hid_t);
    Handle() = default;
    Handle(hid_t id, Close close) : id_(id), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    Handle& operator=(Handle&& other) noexcept {
        std::swap(id_, other.id_);
        std::swap(close_, other.close_);
        return *this;
    }
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    [[nodiscard]] hid_t id() const { return id_; }
    [[nodiscard]] bool ok() const { return id_ >= 0; }
    /// Releases the identifier without closing it.
    void abandon() { id_ = -1; }

private:
    hid_t id_ = -1;
    Close close_ = nullptr;
};

/// The library prints its own error stack unless disabled, and cleans up at program exit, where it crashes for a file that could
/// not be written (a full disk): every identifier is therefore closed here by its own scope.
void prepare_library() {
    static const herr_t no_cleanup = H5dont_atexit();
    (void)no_cleanup;
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

// Space is allocated in chunks of rows: large for long tables, at most the table itself if its length is known.
constexpr hsize_t chunk_rows_unknown = 1024;
constexpr hsize_t chunk_rows_most = 4096;

}  // namespace

struct Hdf5Writer::File {
    std::filesystem::path path, temporary;
    Handle file;

    /// The file is abandoned as it is: closing it would write, fail, and leave the library in an invalid state.
    [[nodiscard]] Error failed(const std::string& what, const std::string& object) {
        file.abandon();
        return input_error(fmt::format("{} cannot be {}", object, what), place_in(path.string()), "make room on the disk");
    }

    void make_groups(const std::string& object) {
        const Handle plist(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
        H5Pset_obj_track_times(plist.id(), false);
        for (std::size_t slash = object.find('/', 1); slash != std::string::npos; slash = object.find('/', slash + 1)) {
            const std::string group = object.substr(0, slash);
            if (H5Lexists(file.id(), group.c_str(), H5P_DEFAULT) > 0) continue;
            const Handle made(H5Gcreate2(file.id(), group.c_str(), H5P_DEFAULT, plist.id(), H5P_DEFAULT), H5Gclose);
            if (!made.ok()) throw failed("made", group);
        }
    }

    /// An extendable table without rows; `rows` is the expected number, 0 if unknown.
    void make(const std::string& object, hid_t type, hsize_t columns, hsize_t rows) {
        make_groups(object);
        const std::array<hsize_t, 2> size = {0, columns}, limit = {H5S_UNLIMITED, columns},
                                     chunk = {rows > 0 ? std::min(rows, chunk_rows_most) : chunk_rows_unknown, columns};
        const Handle space(H5Screate_simple(2, size.data(), limit.data()), H5Sclose);
        const Handle plist(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        H5Pset_obj_track_times(plist.id(), false);
        H5Pset_chunk(plist.id(), 2, chunk.data());
        const Handle made(H5Dcreate2(file.id(), object.c_str(), type, space.id(), H5P_DEFAULT, plist.id(), H5P_DEFAULT),
                          H5Dclose);
        if (!made.ok()) throw failed("made", object);
    }

    void append(const std::string& object, hid_t type, const void* values, std::size_t count) {
        const Handle data(H5Dopen2(file.id(), object.c_str(), H5P_DEFAULT), H5Dclose);
        const Handle old(data.ok() ? H5Dget_space(data.id()) : -1, H5Sclose);
        std::array<hsize_t, 2> size{};
        if (!old.ok() || H5Sget_simple_extent_dims(old.id(), size.data(), nullptr) != 2) throw failed("found", object);
        if (count == 0) return;
        if (size[1] == 0 || count % size[1] != 0)
            throw computation_error(fmt::format("{}: {} values are not whole rows of {}", object, count, size[1]));
        const std::array<hsize_t, 2> added = {count / size[1], size[1]}, start = {size[0], 0},
                                     larger = {size[0] + added[0], size[1]};
        if (H5Dset_extent(data.id(), larger.data()) < 0) throw failed("written", object);
        const Handle file_space(H5Dget_space(data.id()), H5Sclose), memory(H5Screate_simple(2, added.data(), nullptr), H5Sclose);
        H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, start.data(), nullptr, added.data(), nullptr);
        if (H5Dwrite(data.id(), type, memory.id(), file_space.id(), H5P_DEFAULT, values) < 0) throw failed("written", object);
    }
};

Hdf5Writer::Hdf5Writer(std::filesystem::path path) : file_(std::make_unique<File>()) {
    prepare_library();
    file_->path = std::move(path);
    check_overwrite(file_->path);
    file_->temporary = create_beside(file_->path);
    const Handle plist(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    H5Pset_obj_track_times(plist.id(), false);
    file_->file = Handle(H5Fcreate(file_->temporary.c_str(), H5F_ACC_TRUNC, plist.id(), H5P_DEFAULT), H5Fclose);
    if (!file_->file.ok()) {
        std::error_code ignored;
        std::filesystem::remove(file_->temporary, ignored);
        throw input_error("cannot be written", place_in(file_->path.string()),
                          "make room on the disk, or choose another place with -o");
    }
}

Hdf5Writer::~Hdf5Writer() {
    file_->file = Handle();
    std::error_code ignored;
    if (!file_->temporary.empty()) std::filesystem::remove(file_->temporary, ignored);
}

void Hdf5Writer::create_table(const std::string& path, std::size_t columns, const Hdf5Attributes& attributes) {
    file_->make(path, H5T_IEEE_F64LE, columns, 0);
    for (const auto& [name, value] : attributes) attribute(path, name, value);
}

void Hdf5Writer::append(const std::string& path, std::span<const double> values) {
    file_->append(path, H5T_NATIVE_DOUBLE, values.data(), values.size());
}

void Hdf5Writer::table(const std::string& path, std::span<const double> values, std::size_t columns,
                       const Hdf5Attributes& attributes) {
    file_->make(path, H5T_IEEE_F64LE, columns, columns > 0 ? values.size() / columns : 0);
    for (const auto& [name, value] : attributes) attribute(path, name, value);
    append(path, values);
}

void Hdf5Writer::matrices(const std::string& path, std::span<const double> values, std::size_t size,
                          const Hdf5Attributes& attributes) {
    const hsize_t extent[3] = {values.size() / (size * size), size, size};
    const Handle space(H5Screate_simple(3, extent, nullptr), H5Sclose);
    const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(properties.id(), false);  // identical content, identical bytes
    const Handle made(
        H5Dcreate2(file_->file.id(), path.c_str(), H5T_IEEE_F64LE, space.id(), H5P_DEFAULT, properties.id(), H5P_DEFAULT),
        H5Dclose);
    if (!made.ok() || H5Dwrite(made.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
        throw file_->failed("made", path);
    for (const auto& [name, value] : attributes) attribute(path, name, value);
}

void Hdf5Writer::integers(const std::string& path, std::span<const std::int64_t> values, const Hdf5Attributes& attributes) {
    file_->make(path, H5T_STD_I64LE, 1, values.size());
    for (const auto& [name, value] : attributes) attribute(path, name, value);
    file_->append(path, H5T_NATIVE_INT64, values.data(), values.size());
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, const std::string& value) {
    const Handle object(H5Oopen(file_->file.id(), path.c_str(), H5P_DEFAULT), H5Oclose);
    const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), value.size() + 1);
    H5Tset_cset(type.id(), H5T_CSET_UTF8);
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    if (!object.ok()) throw file_->failed("found", path);
    const Handle made(H5Acreate2(object.id(), name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!made.ok() || H5Awrite(made.id(), type.id(), value.c_str()) < 0) throw file_->failed("made", path + "@" + name);
}

void Hdf5Writer::commit() {
    if (H5Fflush(file_->file.id(), H5F_SCOPE_GLOBAL) < 0) throw file_->failed("written", "it");
    file_->file = Handle();
    std::error_code error;
    check_overwrite(file_->path);
    std::filesystem::rename(file_->temporary, file_->path, error);
    if (error)
        throw computation_error(fmt::format("{}: cannot be renamed to its name: {}", file_->path.string(), error.message()));
    file_->temporary.clear();
    note_own_file(file_->path);
}

struct Hdf5Reader::File {
    std::string name;
    Handle file;
    [[nodiscard]] Error no_such(const std::string& object) const {
        return input_error("there is no such object", place_in(name, 0, 0, object), "look at the names in the file");
    }
    [[nodiscard]] Error damaged(const std::string& object) const {
        return input_error("cannot be read: the file is damaged there", place_in(name, 0, 0, object),
                           "check that it was copied completely");
    }
    /// Number of values stated by an object, if memory is sufficient for them.
    [[nodiscard]] std::size_t count(hid_t space, const std::string& object) const {
        constexpr hssize_t most = hssize_t{1} << 30;
        const hssize_t points = H5Sget_simple_extent_npoints(space);
        if (points < 0 || points > most) throw damaged(object);
        return static_cast<std::size_t>(points);
    }
};

Hdf5Reader::Hdf5Reader(const std::filesystem::path& path, const std::string& display_name) : file_(std::make_unique<File>()) {
    prepare_library();
    file_->name = display_name.empty() ? path.string() : display_name;
    check_regular_file(path);
    file_->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    if (!file_->file.ok())
        throw input_error("is not an HDF5 file, or a damaged one", place_in(file_->name), "check that it was copied completely");
}

Hdf5Reader::~Hdf5Reader() = default;

Hdf5Table Hdf5Reader::table(const std::string& path) const { return read(path, 2); }

Hdf5Table Hdf5Reader::matrices(const std::string& path) const { return read(path, 3); }

Hdf5Table Hdf5Reader::read(const std::string& path, int largest_rank) const {
    const Handle data(H5Dopen2(file_->file.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.ok()) throw file_->no_such(path);
    const Handle space(H5Dget_space(data.id()), H5Sclose);
    std::array<hsize_t, 3> size = {0, 1, 1};
    if (H5Sget_simple_extent_ndims(space.id()) > largest_rank)
        throw file_->no_such(fmt::format("{} with {} dimensions", path, largest_rank));
    H5Sget_simple_extent_dims(space.id(), size.data(), nullptr);
    Hdf5Table result;
    const std::size_t count = file_->count(space.id(), path);
    result.rows = size[0];
    result.columns = size[1] * size[2];
    if (count != 0 && (result.rows > count || result.columns > count || result.rows * result.columns != count))
        throw file_->damaged(path);
    result.values.resize(count);
    if (!result.values.empty() &&
        H5Dread(data.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, result.values.data()) < 0) {
        throw input_error("cannot be read", place_in(file_->name, 0, 0, path), "check that it was copied completely");
    }
    return result;
}

std::size_t Hdf5Reader::read_rows(const std::string& path, std::vector<std::vector<double>>* columns) const {
    const Handle data(H5Dopen2(file_->file.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.ok()) throw file_->no_such(path);
    const Handle space(H5Dget_space(data.id()), H5Sclose);
    std::array<hsize_t, 2> size = {0, 1};
    const int rank = H5Sget_simple_extent_ndims(space.id());
    if (rank < 1 || rank > 2) throw file_->no_such(path + " with rows and columns");
    H5Sget_simple_extent_dims(space.id(), size.data(), nullptr);
    const std::size_t count = file_->count(space.id(), path), wide = size[1];
    if (count != 0 && (size[0] > count || wide > count || size[0] * wide != count)) throw file_->damaged(path);
    if (columns != nullptr) columns->assign(count == 0 ? 0 : wide, std::vector<double>(size[0]));
    std::vector<double> block(std::min<std::size_t>(size[0], chunk_rows_most) * (count == 0 ? 0 : wide));
    for (std::size_t first = 0; first < size[0] && count != 0; first += chunk_rows_most) {
        const std::array<hsize_t, 2> start = {first, 0}, part = {std::min<hsize_t>(size[0] - first, chunk_rows_most), wide};
        const Handle memory(H5Screate_simple(rank, part.data(), nullptr), H5Sclose);
        H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start.data(), nullptr, part.data(), nullptr);
        if (H5Dread(data.id(), H5T_NATIVE_DOUBLE, memory.id(), space.id(), H5P_DEFAULT, block.data()) < 0)
            throw input_error("cannot be read", place_in(file_->name, 0, 0, path), "check that it was copied completely");
        if (columns == nullptr) continue;
        for (std::size_t c = 0; c < wide; ++c) {
            double* to = (*columns)[c].data() + first;
            for (std::size_t r = 0; r < part[0]; ++r) to[r] = block[r * wide + c];
        }
    }
    return size[0];
}

std::vector<std::vector<double>> Hdf5Reader::columns(const std::string& path) const {
    std::vector<std::vector<double>> out;
    read_rows(path, &out);
    return out;
}

std::size_t Hdf5Reader::read_through(const std::string& path) const { return read_rows(path, nullptr); }

std::vector<std::int64_t> Hdf5Reader::integers(const std::string& path) const {
    const Handle data(H5Dopen2(file_->file.id(), path.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.ok()) throw file_->no_such(path);
    const Handle space(H5Dget_space(data.id()), H5Sclose);
    std::vector<std::int64_t> values(file_->count(space.id(), path));
    if (!values.empty() && H5Dread(data.id(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
        throw input_error("cannot be read", place_in(file_->name, 0, 0, path), "check that it was copied completely");
    return values;
}

std::string Hdf5Reader::attribute(const std::string& path, const std::string& name) const {
    const Handle found(H5Aopen_by_name(file_->file.id(), path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (!found.ok()) throw file_->no_such(path + "@" + name);
    const Handle type(H5Aget_type(found.id()), H5Tclose), space(H5Aget_space(found.id()), H5Sclose);
    constexpr std::size_t longest = 1'000'000;
    if (file_->count(space.id(), path) != 1 || H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0 ||
        H5Tget_size(type.id()) > longest)
        throw file_->damaged(path + "@" + name);
    std::string value(H5Tget_size(type.id()), '\0');
    if (H5Aread(found.id(), type.id(), value.data()) < 0) throw file_->no_such(path + "@" + name);
    value.resize(value.find('\0') == std::string::npos ? value.size() : value.find('\0'));
    return value;
}

std::vector<std::string> Hdf5Reader::names(const std::string& group) const {
    const Handle opened(H5Gopen2(file_->file.id(), group.c_str(), H5P_DEFAULT), H5Gclose);
    H5G_info_t info;
    if (!opened.ok() || H5Gget_info(opened.id(), &info) < 0) throw file_->no_such(group);
    std::vector<std::string> result;
    for (hsize_t i = 0; i < info.nlinks; ++i) {
        const ssize_t length = H5Lget_name_by_idx(opened.id(), ".", H5_INDEX_NAME, H5_ITER_INC, i, nullptr, 0, H5P_DEFAULT);
        constexpr ssize_t longest = 65'536;
        if (length < 0 || length > longest) throw file_->damaged(group);
        std::string name(static_cast<std::size_t>(length) + 1, '\0');
        H5Lget_name_by_idx(opened.id(), ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(), name.size(), H5P_DEFAULT);
        name.pop_back();
        result.push_back(std::move(name));
    }
    return result;
}

}  // namespace schuler::io
