// HDF5 files of tables: groups, extendable two-dimensional tables of doubles, attributes. Equal content gives equal bytes.
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

/// Writes to a temporary name and renames on commit(); without commit() no file remains.
class Hdf5Writer final : public TableWriter {
public:
    /// Throws Error(Input) if the file cannot be created.
    explicit Hdf5Writer(std::filesystem::path path);
    ~Hdf5Writer() override;

    /// Creates an empty table (rows x columns) under a path such as "/solution/position"; parent groups are created.
    /// Attributes (units, names of the columns) are texts. Throws Error(Input) if the path exists or the disk is full.
    void create_table(const std::string& path, std::size_t columns, const Hdf5Attributes& attributes = {});
    /// Appends rows, in row order; the size must be a multiple of the number of columns.
    void append(const std::string& path, std::span<const double> values);
    /// A complete table in one call.
    void table(const std::string& path, std::span<const double> values, std::size_t columns,
               const Hdf5Attributes& attributes = {}) override;
    /// Square matrices as one dataset of rank three in the root group, matrices x size x size, size * size values each.
    void matrices(const std::string& path, std::span<const double> values, std::size_t size,
                  const Hdf5Attributes& attributes = {}) override;
    /// A column of integers (times in ns).
    void integers(const std::string& path, std::span<const std::int64_t> values, const Hdf5Attributes& attributes = {}) override;
    /// A text attribute of an existing object ("/" is the file itself).
    void attribute(const std::string& path, const std::string& name, const std::string& value) override;
    void commit() override;

private:
    struct File;
    std::unique_ptr<File> file_;
};

struct Hdf5Table {
    std::size_t rows = 0, columns = 0;
    std::vector<double> values;  ///< in row order
    [[nodiscard]] double operator()(std::size_t row, std::size_t column) const { return values[row * columns + column]; }
};

/// Reads files of Hdf5Writer. Throws Error(Input): no such file, not HDF5, no such object.
class Hdf5Reader {
public:
    /// Messages name the file by `display_name`, unless that is empty.
    explicit Hdf5Reader(const std::filesystem::path& path, const std::string& display_name = {});
    ~Hdf5Reader();
    Hdf5Reader(const Hdf5Reader&) = delete;
    Hdf5Reader& operator=(const Hdf5Reader&) = delete;

    [[nodiscard]] Hdf5Table table(const std::string& path) const;
    /// The same column by column, with little memory beyond that of the columns.
    [[nodiscard]] std::vector<std::vector<double>> columns(const std::string& path) const;
    /// Reads a table without keeping it; returns the number of its rows.
    [[nodiscard]] std::size_t read_through(const std::string& path) const;
    /// A column of integers.
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& path) const;
    /// Square matrices, one per row.
    [[nodiscard]] Hdf5Table matrices(const std::string& path) const;
    [[nodiscard]] std::string attribute(const std::string& path, const std::string& name) const;
    /// Names in a group, sorted.
    [[nodiscard]] std::vector<std::string> names(const std::string& group) const;

private:
    [[nodiscard]] Hdf5Table read(const std::string& path, int largest_rank) const;
    /// Returns the number of rows; `columns`: where they go, or null.
    std::size_t read_rows(const std::string& path, std::vector<std::vector<double>>* columns) const;
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace schuler::io
