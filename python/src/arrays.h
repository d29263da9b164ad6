// NumPy arrays in the bindings: read in place with any strides; returned without a copy.
#pragma once

#include "schuler/core/error.h"
#include "schuler/core/time.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <fmt/format.h>
#include <Eigen/Core>

#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace schuler::python {

namespace py = pybind11;

/// "(100, 3)"
[[nodiscard]] std::string shape_text(const py::array& array);

/// User data, one row per sample: of shape (n, width), or (width,) for one sample; with width 1 of shape (n,) or ().
/// An array of doubles is read in place; other types convertible by NumPy are converted.
class Input {
public:
    Input() = default;
    /// None gives NaN everywhere. @throws Error(Input) with `name` for another shape, or for values that are not numbers
    Input(const char* name, const py::object& values, py::ssize_t width);

    [[nodiscard]] bool given() const { return data_ != nullptr; }
    [[nodiscard]] bool one() const { return one_; }  ///< a single sample
    [[nodiscard]] py::ssize_t rows() const { return rows_; }
    /// @throws Error(Input) if the number of rows differs from n; with `broadcast` a single sample applies to all of them
    void expect_rows(py::ssize_t n, bool broadcast = false);

    [[nodiscard]] double at(py::ssize_t row, py::ssize_t column = 0) const {
        if (data_ == nullptr) return std::nan("");
        return *reinterpret_cast<const double*>(data_ + row * row_stride_ + column * column_stride_);
    }
    [[nodiscard]] Eigen::Vector3d vector(py::ssize_t row) const { return {at(row, 0), at(row, 1), at(row, 2)}; }

private:
    const char* name_ = "";
    py::array_t<double> held_;
    const char* data_ = nullptr;
    py::ssize_t rows_ = 0, row_stride_ = 0, column_stride_ = 0;
    bool one_ = true;
};

/// Writes a vector to a row of three numbers.
inline void put_vector(const Eigen::Vector3d& v, double* to) { Eigen::Map<Eigen::Vector3d>{to} = v; }

/// User instants: integers are nanoseconds, others seconds, on the data's own axis.
class Times {
public:
    Times(const char* name, const py::object& values);

    [[nodiscard]] bool one() const { return one_; }
    [[nodiscard]] py::ssize_t rows() const { return rows_; }
    [[nodiscard]] Time at(py::ssize_t row) const {
        const char* p = data_ + row * stride_;
        return whole_ ? Time{*reinterpret_cast<const std::int64_t*>(p)} : Time::from_seconds(*reinterpret_cast<const double*>(p));
    }

private:
    py::array held_;
    const char* data_ = nullptr;
    py::ssize_t rows_ = 0, stride_ = 0;
    bool one_ = true, whole_ = false;
};

/// A vector's memory as an array of this shape; the array owns it. `width` 0: of rank one.
template <class T>
py::array_t<T> array_of(std::vector<T> values, py::ssize_t width = 0) {
    auto* held = new std::vector<T>(std::move(values));
    const py::capsule owner(held, [](void* p) { delete static_cast<std::vector<T>*>(p); });
    const auto size = static_cast<py::ssize_t>(held->size());
    if (width == 0) return py::array_t<T>(std::vector<py::ssize_t>{size}, held->data(), owner);
    return py::array_t<T>(std::vector<py::ssize_t>{size / width, width}, held->data(), owner);
}

/// An Eigen matrix or vector as an array, copied.
template <class Derived>
py::array_t<double> array_of(const Eigen::MatrixBase<Derived>& m) {
    if constexpr (Derived::ColsAtCompileTime == 1) {
        py::array_t<double> out(m.rows());
        for (Eigen::Index i = 0; i < m.rows(); ++i) out.mutable_at(i) = m(i);
        return out;
    } else {
        py::array_t<double> out(std::vector<py::ssize_t>{m.rows(), m.cols()});
        for (Eigen::Index i = 0; i < m.rows(); ++i)
            for (Eigen::Index j = 0; j < m.cols(); ++j) out.mutable_at(i, j) = m(i, j);
        return out;
    }
}

/// A view of a member of each row of `rows`, without a copy; `owner` keeps the rows alive. `count` numbers per row (0: rank one).
template <class T, class Row>
py::array view_of(const std::vector<Row>& rows, const T* first, py::ssize_t count, const py::handle& owner) {
    const auto n = static_cast<py::ssize_t>(rows.size());
    std::vector<py::ssize_t> shape{n}, strides{static_cast<py::ssize_t>(sizeof(Row))};
    if (count > 0) {
        shape.push_back(count);
        strides.push_back(static_cast<py::ssize_t>(sizeof(T)));
    }
    py::array out =
        rows.empty() ? py::array(py::dtype::of<T>(), shape) : py::array(py::dtype::of<T>(), shape, strides, first, owner);
    out.attr("setflags")(py::arg("write") = false);
    return out;
}

void bind_errors(py::module_& m);
void bind_commands(py::module_& m);
void bind_files(py::module_& m);
void bind_recording(py::module_& m);
void bind_navigator(py::module_& m);
void bind_ahrs(py::module_& m);
void bind_attitude(py::module_& m);
void bind_earth(py::module_& m);

}  // namespace schuler::python
