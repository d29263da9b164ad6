// The HDF5 library is not made for several threads: what may use it runs alone, and without the interpreter's lock.
#pragma once

#include <pybind11/pybind11.h>

#include <mutex>

namespace schuler::python {

inline std::mutex& one_at_a_time() {
    static std::mutex mutex;
    return mutex;
}

/// f() without the interpreter's lock, while no other thread is in here.
template <class F>
auto alone(F f) {
    const pybind11::gil_scoped_release release;  // before the other: who has that one takes this one now and then
    const std::lock_guard lock(one_at_a_time());
    return f();
}

}  // namespace schuler::python
