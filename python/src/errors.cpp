// schuler::Error as the exception schuler.Error with its parts as attributes.
#include "arrays.h"

namespace schuler::python {
namespace {

py::object place_or_none(long number) { return number > 0 ? py::object(py::int_(number)) : py::none(); }
py::object text_or_none(const std::string& text) { return text.empty() ? py::object(py::none()) : py::object(py::str(text)); }

void raise(const Error& e, const py::object& type) {
    const py::object error = type(py::str(e.what()));
    error.attr("kind") = e.kind() == ErrorKind::Input ? "input" : "computation";
    error.attr("what") = e.reason();
    error.attr("file") = text_or_none(e.place().file);
    error.attr("line") = place_or_none(e.place().line);
    error.attr("column") = place_or_none(e.place().column);
    error.attr("key") = text_or_none(e.place().key);
    error.attr("hint") = text_or_none(e.hint());
    PyErr_SetObject(type.ptr(), error.ptr());
}

}  // namespace

void bind_errors(py::module_& m) {
    static py::object& type =
        *new py::object(py::module_::import("schuler._error").attr("Error"));  // never destroyed: the interpreter may be gone
    m.attr("Error") = type;
    py::register_exception_translator([](std::exception_ptr thrown) {
        try {
            if (thrown) std::rethrow_exception(thrown);
        } catch (const Error& e) {
            raise(e, type);
        }
    });
}

}  // namespace schuler::python
