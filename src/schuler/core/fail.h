// Reporting of errors by constructors and settings: the only place where the library throws (or, without exceptions, does not).
#pragma once

#include "schuler/core/error.h"

namespace schuler {

/// Throws the error. In schuler_embedded (docs/embed.md), compiled without exceptions, the handler in src/embedded/fail_handler.h is
/// is called instead. Hot paths do not use this function: they return a status.
[[noreturn]] void fail(Error error);

}  // namespace schuler
