// The core without exceptions: stands in for core/fail.cpp in schuler_embedded.
#include "schuler/core/fail.h"

#include "embedded/fail_handler.h"

#include <boost/assert/source_location.hpp>

#include <atomic>
#include <cstdlib>
#include <exception>

namespace schuler {

namespace {

std::atomic<FailHandler> handler_in_use{nullptr};

[[noreturn]] void stop(const char* what) {
    if (const FailHandler handler = handler_in_use.load(); handler != nullptr) handler(what);
    std::abort();
}

}  // namespace

FailHandler set_fail_handler(FailHandler handler) { return handler_in_use.exchange(handler); }

void fail(Error error) { stop(error.what()); }  // NOLINT(performance-unnecessary-value-param): as declared

}  // namespace schuler

// What Boost.Math calls instead of throwing. Its arguments are checked before (math/chi_square.cpp).
namespace boost {

[[noreturn]] void throw_exception(const std::exception& e) { schuler::stop(e.what()); }
[[noreturn]] void throw_exception(const std::exception& e, const source_location&) { schuler::stop(e.what()); }

}  // namespace boost
