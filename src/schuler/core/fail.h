// How constructors and settings refuse: the one place where the library throws or, built without exceptions, does not.
#pragma once

#include "schuler/core/error.h"

namespace schuler {

/// Throws the error. In schuler_embedded (docs/embed.md), which is compiled without exceptions, the handler of src/embedded/fail_handler.h is
/// called with it instead. Hot paths do not come here: they return a status.
[[noreturn]] void fail(Error error);

}  // namespace schuler
