// The files of the page, in the program itself.
#pragma once

#include <span>
#include <string_view>

namespace schuler::serve {

struct Asset {
    std::string_view path;  ///< "/index.html", "/assets/index.js", "/examples/demo.toml"
    std::string_view bytes;
};

/// All files, from the source that the build makes of ui/ and examples/.
[[nodiscard]] std::span<const Asset> assets();

}  // namespace schuler::serve
