#include "schuler/io/container/mat_file.h"

#include "schuler/io/atomic_file.h"
#include "schuler/io/own_files.h"
#include "schuler/io/place.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <map>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

namespace schuler::io {
namespace {

constexpr const char* header = "MATLAB 5.0 MAT-file, written by schuler";
constexpr std::size_t most_bytes = 2'000'000'000;  // of one variable, whose size is a 32-bit number

/// A matrix in column order, as in the file.
template <class T>
struct MatrixNode {
    std::vector<std::size_t> size;
    std::vector<T> values;
};

/// A variable or a field: a matrix, a text, or a nested struct.
struct Node {
    std::variant<std::monostate, MatrixNode<double>, MatrixNode<std::int64_t>, std::string> data;
    std::map<std::string, Node> fields;
};

struct Free {
    void operator()(matvar_t* v) const { Mat_VarFree(v); }
    void operator()(mat_t* file) const { Mat_Close(file); }
};
using Variable = std::unique_ptr<matvar_t, Free>;

std::size_t size_of(const Node& node) {
    std::size_t sum = 64;
    if (const auto* m = std::get_if<MatrixNode<double>>(&node.data)) sum += 8 * m->values.size();
    if (const auto* m = std::get_if<MatrixNode<std::int64_t>>(&node.data)) sum += 8 * m->values.size();
    if (const auto* t = std::get_if<std::string>(&node.data)) sum += t->size();
    for (const auto& [name, field] : node.fields) sum += size_of(field);
    return sum;
}

/// Refers to the numbers of the node, which must outlive it. Null if memory is insufficient.
Variable variable_of(const char* name, const Node& node) {
    constexpr int keep = MAT_F_DONT_COPY_DATA;
    const auto matrix = [&](const auto& m, matio_classes kind, matio_types type) {
        std::vector<std::size_t> size = m.size;
        void* values = const_cast<void*>(static_cast<const void*>(m.values.data()));  // NOLINT: the library reads it only
        return Variable(Mat_VarCreate(name, kind, type, static_cast<int>(size.size()), size.data(), values, keep));
    };
    if (const auto* m = std::get_if<MatrixNode<double>>(&node.data)) return matrix(*m, MAT_C_DOUBLE, MAT_T_DOUBLE);
    if (const auto* m = std::get_if<MatrixNode<std::int64_t>>(&node.data)) return matrix(*m, MAT_C_INT64, MAT_T_INT64);
    if (const auto* text = std::get_if<std::string>(&node.data)) {
        std::array<std::size_t, 2> size{text->empty() ? 0U : 1U, text->size()};
        void* characters = const_cast<void*>(static_cast<const void*>(text->data()));  // NOLINT: likewise
        return Variable(Mat_VarCreate(name, MAT_C_CHAR, MAT_T_UINT8, 2, size.data(), characters, keep));
    }
    std::vector<const char*> names;
    for (const auto& [field, inner] : node.fields) names.push_back(field.c_str());
    std::array<std::size_t, 2> one{1, 1};
    Variable structure(Mat_VarCreateStruct(name, 2, one.data(), names.data(), static_cast<unsigned>(names.size())));
    for (const auto& [field, inner] : node.fields) {
        Variable value = variable_of(field.c_str(), inner);
        if (!structure || !value) return {};
        Mat_VarSetStructFieldByName(structure.get(), field.c_str(), 0, value.release());  // transfers ownership
    }
    return structure;
}

}  // namespace

struct MatWriter::File {
    std::filesystem::path path, temporary;
    Node root;

    /// The node of a path such as "/innovations/baro/sigma", created if missing.
    Node& at(const std::string& object) {
        Node* node = &root;
        for (std::size_t begin = 0; begin < object.size();) {
            const std::size_t end = std::min(object.find('/', begin), object.size());
            if (end > begin) node = &node->fields[object.substr(begin, end - begin)];
            begin = end + 1;
        }
        return *node;
    }

    template <class T>
    void put(const std::string& object, MatrixNode<T> matrix, const TableAttributes& attributes, MatWriter& writer) {
        Node& node = at(object);
        if (node.data.index() != 0 || !node.fields.empty())
            throw computation_error(fmt::format("{}: {} is there already", path.string(), object));
        node.data = std::move(matrix);
        for (const auto& [name, value] : attributes) writer.attribute(object, name, value);
    }
};

MatWriter::MatWriter(std::filesystem::path path) : file_(std::make_unique<File>()) {
    file_->path = std::move(path);
    check_overwrite(file_->path);
    file_->temporary = create_beside(file_->path);
}

MatWriter::~MatWriter() {
    std::error_code ignored;
    if (!file_->temporary.empty()) std::filesystem::remove(file_->temporary, ignored);
}

void MatWriter::table(const std::string& path, std::span<const double> values, std::size_t columns,
                      const TableAttributes& attributes) {
    const std::size_t rows = columns > 0 ? values.size() / columns : 0;
    MatrixNode<double> m{{rows, columns}, std::vector<double>(values.size())};
    for (std::size_t i = 0; i < rows; ++i)
        for (std::size_t j = 0; j < columns; ++j) m.values[j * rows + i] = values[i * columns + j];
    file_->put(path, std::move(m), attributes, *this);
}

void MatWriter::matrices(const std::string& path, std::span<const double> values, std::size_t size,
                         const TableAttributes& attributes) {
    const std::size_t count = size > 0 ? values.size() / (size * size) : 0;
    MatrixNode<double> m{{size, size, count}, std::vector<double>(values.size())};
    for (std::size_t k = 0; k < count; ++k)
        for (std::size_t i = 0; i < size; ++i)
            for (std::size_t j = 0; j < size; ++j) m.values[(k * size + j) * size + i] = values[(k * size + i) * size + j];
    file_->put(path, std::move(m), attributes, *this);
}

void MatWriter::integers(const std::string& path, std::span<const std::int64_t> values, const TableAttributes& attributes) {
    file_->put(path, MatrixNode<std::int64_t>{{values.size(), 1}, {values.begin(), values.end()}}, attributes, *this);
}

void MatWriter::attribute(const std::string& path, const std::string& name, const std::string& value) {
    const std::size_t slash = path.rfind('/');
    const std::string group = path.substr(0, slash), object = path.substr(slash + 1);
    if (object.empty()) file_->at("/" + name).data = value;
    else if (const Node& node = file_->at(path); node.data.index() == 0)  // of a group
        file_->at(path + "/about/" + name).data = value;
    else file_->at(group + "/about/" + object + "/" + name).data = value;
}

void MatWriter::commit() {
    {
        const std::unique_ptr<mat_t, Free> file(Mat_CreateVer(file_->temporary.c_str(), header, MAT_FT_MAT5));
        if (!file) throw input_error("cannot be written", place_in(file_->path.string()), "choose another place with -o");
        for (const auto& [name, node] : file_->root.fields) {
            if (size_of(node) > most_bytes)
                throw computation_error(fmt::format("{}: {} is larger than a MAT-file can hold", file_->path.string(), name),
                                        "give a smaller --output-rate, or use run.h5");
            const Variable variable = variable_of(name.c_str(), node);
            if (!variable || Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_NONE) != 0)
                throw input_error(fmt::format("{} cannot be written", name), place_in(file_->path.string()),
                                  "make room on the disk");
        }
    }
    std::error_code error;
    check_overwrite(file_->path);
    std::filesystem::rename(file_->temporary, file_->path, error);
    if (error)
        throw computation_error(fmt::format("{}: cannot be renamed to its name: {}", file_->path.string(), error.message()));
    file_->temporary.clear();
    note_own_file(file_->path);
}

}  // namespace schuler::io
