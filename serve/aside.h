// Work on input that nobody vouches for, done by a child of the server: whatever the input does to the process, the server goes on.
#pragma once

#include "serve/forms.h"

#include <string>
#include <string_view>

namespace schuler::serve {

/// First argument of the program in such a child.
inline constexpr std::string_view aside_word = "--aside";

/// Carries out the rest of the arguments and prints one JSON document; returns the exit status.
///   understand scenario|dataset FILE   what a request body {settings: {...}} or {toml: text} comes to: {answer: ...} or {refusal: {...}}
///   read FOLDER                        reads every column of a run: {"read": true}
[[nodiscard]] int aside(int count, const char* const* arguments) noexcept;

/// The answer in what `understand` has printed. @throws Refusal
[[nodiscard]] Json understanding_of(const Json& printed);

[[nodiscard]] std::string_view name_of(Form form);

}  // namespace schuler::serve
