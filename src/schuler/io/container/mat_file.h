// MAT-files of tables for Octave and MATLAB: a struct per group, a matrix per table, with units and names.
#pragma once

#include "schuler/io/container/table_writer.h"

#include <filesystem>
#include <memory>

namespace schuler::io {

/// A group is a struct of the file, a subgroup a struct in it. The attributes of a table `position` are texts in the struct `about`
/// of the group: about.position.units. Those of the file are variables. Version 5, uncompressed; equal content gives equal bytes.
class MatWriter final : public TableWriter {
public:
    /// Throws Error(Input) if the file cannot be created.
    explicit MatWriter(std::filesystem::path path);
    ~MatWriter() override;

    void table(const std::string& path, std::span<const double> values, std::size_t columns,
               const TableAttributes& attributes) override;
    /// As size x size x matrices: x(:, :, k) is one of them.
    void matrices(const std::string& path, std::span<const double> values, std::size_t size,
                  const TableAttributes& attributes) override;
    void integers(const std::string& path, std::span<const std::int64_t> values, const TableAttributes& attributes) override;
    void attribute(const std::string& path, const std::string& name, const std::string& value) override;
    /// Throws Error(Input) if the disk is full, Error(Computation) if a variable exceeds the format's limit (2 GB).
    void commit() override;

private:
    struct File;
    std::unique_ptr<File> file_;
};

}  // namespace schuler::io
