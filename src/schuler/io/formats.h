// All file formats in one list: recognition, reading and writing. A format is added by its own file and one line in formats.cpp.
#pragma once

#include "schuler/core/log.h"
#include "schuler/core/nav_state.h"
#include "schuler/io/streams.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::io {

/// Input of recognition: the name, and the first bytes as on disk and decompressed.
struct FileHead {
    explicit FileHead(const std::filesystem::path& file);
    std::filesystem::path path;
    std::string extension;  ///< lower case, with its dot; the one before .gz
    std::string bytes;      ///< decompressed; empty for folders
    bool folder = false;

    [[nodiscard]] bool starts_with(std::string_view text) const { return std::string_view(bytes).starts_with(text); }
    [[nodiscard]] bool contains(std::string_view text) const { return bytes.find(text) != std::string::npos; }
};

struct Format {
    std::string_view name;  ///< one word, used in `--to NAME` and in the reports of `inspect`
    std::string_view title;
    std::string_view extensions;  ///< usual extensions, separated by blanks; a file to be written is recognised by the first
    std::string_view holds;       ///< the data read, a sentence for docs/files.md
    std::string_view time;        ///< origin of its times; empty for formats that are only written
    bool (*recognise)(const FileHead&) = nullptr;                ///< never throws on content; null: only written
    StreamLog (*read)(const TextInput&, WarningLog&) = nullptr;  ///< null: read by the readers of tables or of raw measurements
    void (*write)(const std::filesystem::path&, std::span<const SolutionRow>,
                  const std::string& title) = nullptr;  ///< null: not written
    bool one_stream = false;                            ///< the file is one log: its name needs no stream suffix
    bool folder = false;                                ///< the format consists of a folder of files
};

/// All formats, in the order in which they are tried.
[[nodiscard]] std::span<const Format* const> formats();

/// The format of a file or folder by its content; null if none is recognised. @throws Error(Input): no such file, or not readable
[[nodiscard]] const Format* format_of(const std::filesystem::path& file);

/// The format of that name; null if there is none.
[[nodiscard]] const Format* format_named(std::string_view name);

/// The format in which a file of this name is written; null if its extension belongs to none.
[[nodiscard]] const Format* format_to_write(const std::filesystem::path& file);

/// docs/files.md: formats, columns with their synonyms, and codes, from the tables used by the readers.
[[nodiscard]] std::string formats_document();

/// A short form of the same list, for `schuler help formats`.
[[nodiscard]] std::string formats_text();

}  // namespace schuler::io
