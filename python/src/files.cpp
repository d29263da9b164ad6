// Tables of run.h5.
#include "alone.h"
#include "arrays.h"

#include "schuler/io/container/hdf5_file.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace schuler::python {
namespace {

using Path = std::filesystem::path;
using io::Hdf5Reader;

py::object table(const Path& path, const std::string& name, const std::string& form) {
    if (form == "integers") return array_of(alone([&] { return Hdf5Reader(path).integers(name); }));
    io::Hdf5Table table =
        alone([&] { return form == "matrices" ? Hdf5Reader(path).matrices(name) : Hdf5Reader(path).table(name); });
    const auto rows = static_cast<py::ssize_t>(table.rows), columns = static_cast<py::ssize_t>(table.columns);
    py::array_t<double> out = array_of(std::move(table.values), columns > 1 ? columns : 0);
    if (form != "matrices") return out;
    const auto size = static_cast<py::ssize_t>(std::lround(std::sqrt(static_cast<double>(columns))));
    return out.reshape({rows, size, size});
}

}  // namespace

void bind_files(py::module_& m) {
    m.def(
        "h5_names",
        [](const Path& path, const std::string& group) { return alone([&] { return Hdf5Reader(path).names(group); }); },
        py::arg("path"), py::arg("group"), "Names in a group, sorted.");
    m.def(
        "h5_attribute",
        [](const Path& path, const std::string& object, const std::string& name) {
            return alone([&] { return Hdf5Reader(path).attribute(object, name); });
        },
        py::arg("path"), py::arg("object"), py::arg("name"), "A text attribute.");
    m.def("h5_table", &table, py::arg("path"), py::arg("object"), py::arg("form") = "table",
          "(n, columns), or (n,) of one column; form \"integers\": (n,) whole numbers; form \"matrices\": (n, size, size)");
}

}  // namespace schuler::python
