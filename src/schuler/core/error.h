// The single typed error of the library, and the status returned by hot paths.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace schuler {

/// Origin of the fault; determines the exit status at the command line (Input: 2, Computation: 1).
enum class ErrorKind { Input, Computation };

/// Location of the fault in the user's input. Empty or zero members are unknown.
struct SourcePlace {
    std::string file{};
    long line = 0;      ///< 1-based
    long column = 0;    ///< 1-based column of a table (not a character position)
    std::string key{};  ///< key of a settings file, or the name of a column or option
};

/// Thrown by constructors and readers. what() is one line: `file:line: key: description; hint`.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, std::string what, SourcePlace place = {}, std::string hint = {});

    [[nodiscard]] ErrorKind kind() const { return kind_; }
    [[nodiscard]] const std::string& reason() const { return reason_; }
    [[nodiscard]] const SourcePlace& place() const { return place_; }
    [[nodiscard]] const std::string& hint() const { return hint_; }

private:
    ErrorKind kind_;
    std::string reason_;
    SourcePlace place_;
    std::string hint_;
};

/// The input or a setting is invalid.
[[nodiscard]] inline Error input_error(std::string what, SourcePlace place = {}, std::string hint = {}) {
    return {ErrorKind::Input, std::move(what), std::move(place), std::move(hint)};
}

/// The computation failed although its input was valid.
[[nodiscard]] inline Error computation_error(std::string what, std::string hint = {}) {
    return {ErrorKind::Computation, std::move(what), {}, std::move(hint)};
}

}  // namespace schuler
