#include "schuler/dataset/paths.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

#include <cctype>
#include <cstdlib>

namespace schuler::dataset {

namespace fs = std::filesystem;

std::string with_environment(const std::string& path, const std::string& key) {
    std::string out;
    for (std::size_t i = 0; i < path.size(); ++i) {
        if (path[i] != '$') {
            out += path[i];
            continue;
        }
        const bool braces = i + 1 < path.size() && path[i + 1] == '{';
        std::size_t begin = i + (braces ? 2 : 1), end = begin;
        while (end < path.size() && (std::isalnum(static_cast<unsigned char>(path[end])) != 0 || path[end] == '_')) ++end;
        const std::string name = path.substr(begin, end - begin);
        const char* value = name.empty() ? nullptr : std::getenv(name.c_str());
        if (value == nullptr) {
            throw input_error(fmt::format("environment variable ${} in \"{}\" is not set", name, path), {{}, 0, 0, key},
                              fmt::format("export {}=... or write the path out", name.empty() ? "NAME" : name));
        }
        out += value;
        i = end - 1 + (braces && end < path.size() && path[end] == '}' ? 1 : 0);
    }
    return out;
}

fs::path resolved(const fs::path& folder, const std::string& file, const std::string& key) {
    const fs::path path = with_environment(file, key);
    return path.is_absolute() ? path : folder / path;
}

}  // namespace schuler::dataset
