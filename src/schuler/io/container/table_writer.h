// Files of tables: groups, two-dimensional tables, attributes, independent of the format.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

namespace schuler::io {

using TableAttributes = std::map<std::string, std::string>;

/// Writes to a temporary name; no file remains without commit().
class TableWriter {
public:
    TableWriter() = default;
    virtual ~TableWriter() = default;
    TableWriter(const TableWriter&) = delete;
    TableWriter& operator=(const TableWriter&) = delete;

    /// A complete table (rows x columns, in row order) under a path such as "/solution/position"; parent groups are created.
    /// Attributes (units, names of the columns) are texts. Throws Error(Input) if the path exists or the disk is full.
    virtual void table(const std::string& path, std::span<const double> values, std::size_t columns,
                       const TableAttributes& attributes) = 0;
    /// Square matrices, size * size values each.
    virtual void matrices(const std::string& path, std::span<const double> values, std::size_t size,
                          const TableAttributes& attributes) = 0;
    /// A column of integers (times in ns).
    virtual void integers(const std::string& path, std::span<const std::int64_t> values, const TableAttributes& attributes) = 0;
    /// A text attribute of an existing object ("/" is the file itself).
    virtual void attribute(const std::string& path, const std::string& name, const std::string& value) = 0;
    virtual void commit() = 0;
};

}  // namespace schuler::io
