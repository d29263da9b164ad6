#include "schuler/core/error.h"

#include <fmt/format.h>

namespace schuler {
namespace {

std::string one_line(const std::string& what, const SourcePlace& place, const std::string& hint) {
    std::string text;
    if (!place.file.empty()) {
        text += place.file;
        if (place.line > 0) text += fmt::format(":{}", place.line);
        text += ": ";
    } else if (place.line > 0) {
        text += fmt::format("line {}: ", place.line);
    }
    if (place.column > 0) text += fmt::format("column {}{}", place.column, place.key.empty() ? ": " : " ");
    if (!place.key.empty()) text += fmt::format("{}: ", place.key);
    text += what;
    if (!hint.empty()) text += fmt::format("; {}", hint);
    return text;
}

}  // namespace

Error::Error(ErrorKind kind, std::string what, SourcePlace place, std::string hint)
    : std::runtime_error(one_line(what, place, hint)),
      kind_(kind),
      reason_(std::move(what)),
      place_(std::move(place)),
      hint_(std::move(hint)) {}

}  // namespace schuler
