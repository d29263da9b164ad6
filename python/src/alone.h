// The HDF5 library is not thread-safe: functions that may use it are serialised and run without the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include <mutex>

namespace schuler::python {

inline std::mutex& one_at_a_time() {
    static std::mutex mutex;
    return mutex;
}

/// Calls f() without the interpreter's lock, and never from two threads at once.
template <class F>
auto alone(F f) {
    const pybind11::gil_scoped_release release;  // released first: its holder may acquire the other lock
    const std::lock_guard lock(one_at_a_time());
    return f();
}

}  // namespace schuler::python
