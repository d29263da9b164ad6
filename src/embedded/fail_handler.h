// What becomes of an unusable setting where there are no exceptions: only in schuler_embedded, see docs/embed.md.
#pragma once

namespace schuler {

/// Called with the line that Error::what() would be. It must not return: what called it has no way to go on.
using FailHandler = void (*)(const char* what);

/// Sets what `fail` calls and returns what it called before; none (the default, or a handler that returns): std::abort.
FailHandler set_fail_handler(FailHandler handler);

}  // namespace schuler
