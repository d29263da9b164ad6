// HDF5 files of tables: groups, two-dimensional tables of doubles that can grow, attributes. Same content, same bytes.
// The HDF5 library is not reentrant: one thread at a time may use these classes.
#pragma once

#include "schuler/io/container/table_writer.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace schuler::io {

using Hdf5Attributes = TableAttributes;

/// Writes beside the wanted name and renames on commit(); without commit() nothing is left behind.
class Hdf5Writer final : public TableWriter {
public:
    /// Throws Error(Input) where the file cannot be made.
    explicit Hdf5Writer(std::filesystem::path path);
    ~Hdf5Writer() override;

    /// Makes an empty table (rows x columns) under a path such as "/solution/position"; the groups on the way are made.
    /// Attributes (units, names of the columns) are texts. Throws Error(Computation) where the path is taken or the disk is full.
    void create_table(const std::string& path, std::size_t columns, const Hdf5Attributes& attributes = {});
    /// Appends rows, row by row in memory; the size must be a multiple of the number of columns.
    void append(const std::string& path, std::span<const double> values);
    /// A complete table at once.
    void table(const std::string& path, std::span<const double> values, std::size_t columns,
               const Hdf5Attributes& attributes = {}) override;
    /// Square matrices as one dataset of rank three in the root group, matrices x size x size, size * size values each.
    void matrices(const std::string& path, std::span<const double> values, std::size_t size,
                  const Hdf5Attributes& attributes = {}) override;
    /// A column of whole numbers (times in ns).
    void integers(const std::string& path, std::span<const std::int64_t> values, const Hdf5Attributes& attributes = {}) override;
    /// A text attribute of an object that exists ("/" is the file itself).
    void attribute(const std::string& path, const std::string& name, const std::string& value) override;
    void commit() override;

private:
    struct File;
    std::unique_ptr<File> file_;
};

struct Hdf5Table {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;  ///< row by row
    [[nodiscard]] double operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

/// Reads what Hdf5Writer wrote. Throws Error(Input): no such file, no HDF5, no such object.
class Hdf5Reader {
public:
    explicit Hdf5Reader(const std::filesystem::path& path);
    ~Hdf5Reader();
    Hdf5Reader(const Hdf5Reader&) = delete;
    Hdf5Reader& operator=(const Hdf5Reader&) = delete;

    [[nodiscard]] Hdf5Table table(const std::string& path) const;
    /// A column of whole numbers.
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& path) const;
    /// Square matrices, one a row.
    [[nodiscard]] Hdf5Table matrices(const std::string& path) const;
    [[nodiscard]] std::string attribute(const std::string& path, const std::string& name) const;
    /// Names in a group, sorted.
    [[nodiscard]] std::vector<std::string> names(const std::string& group) const;

private:
    [[nodiscard]] Hdf5Table read(const std::string& path, int largest_rank) const;
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace schuler::io
