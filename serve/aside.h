// Processing of untrusted input in a child of the server, so that the server survives any effect of the input on the process.
#pragma once

#include "serve/forms.h"

#include <string>
#include <string_view>

namespace schuler::serve {

/// First argument of the program in such a child.
inline constexpr std::string_view aside_word = "--aside";

/// Executes the remaining arguments and prints one JSON document; returns the exit status.
///   understand scenario|dataset FILE result of a request body {settings: {...}} or {toml: text}: {answer: ...} or {refusal: {...}}
///   read FOLDER                        reads every column of a run: {"read": true}
///   raw FILE FROM TO POINTS            the columns of a log as they are (raw_columns)
[[nodiscard]] int aside(int count, const char* const* arguments) noexcept;

/// The answer printed by `understand`. @throws Refusal
[[nodiscard]] Json understanding_of(const Json& printed);

[[nodiscard]] std::string_view name_of(Form form);

}  // namespace schuler::serve
