// Compressed files for libraries that open a file by its name.
#pragma once

#include "schuler/io/text/text_input.h"

#include <string>

namespace schuler::io {

/// The file itself, or where it is compressed (.gz) an unpacked copy in the temporary folder, removed with this object.
class UnpackedFile {
public:
    /// @throws Error(Input): as read_bytes; the temporary folder cannot be written
    explicit UnpackedFile(const TextInput& input);
    ~UnpackedFile();
    UnpackedFile(const UnpackedFile&) = delete;
    UnpackedFile& operator=(const UnpackedFile&) = delete;

    [[nodiscard]] const std::string& path() const { return path_; }

private:
    std::string path_;
    bool temporary_ = false;
};

}  // namespace schuler::io
