// The compiled part of the Python package `schuler`: it passes values on and contains no algorithms.
#include "arrays.h"

PYBIND11_MODULE(_schuler, m) {
    using namespace schuler::python;
    m.doc() = "Compiled part of the package schuler; use that.";
    m.attr("__version__") = SCHULER_VERSION;
    bind_errors(m);
    bind_commands(m);
    bind_files(m);
    bind_recording(m);
    bind_navigator(m);
    bind_ahrs(m);
    bind_attitude(m);
    bind_earth(m);
}
