#include "arrays.h"

namespace schuler::python {
namespace {

std::string expected_shape(py::ssize_t width) {
    return width == 1 ? std::string("(n,), or one number") : fmt::format("(n, {0}), or ({0},)", width);
}

}  // namespace

std::string shape_text(const py::array& array) {
    std::string out;
    for (py::ssize_t i = 0; i < array.ndim(); ++i) out += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
    return "(" + out + (array.ndim() == 1 ? ",)" : ")");
}

Input::Input(const char* name, const py::object& values, py::ssize_t width) : name_(name) {
    if (values.is_none()) return;
    held_ = py::array_t<double>::ensure(values);
    if (!held_) {
        PyErr_Clear();
        throw input_error("is not an array of numbers", {{}, 0, 0, name}, "give an array of " + expected_shape(width));
    }
    const py::ssize_t rank = held_.ndim(), of_one = width == 1 ? 0 : 1;
    one_ = rank == of_one;
    if ((!one_ && rank != of_one + 1) || (width > 1 && held_.shape(rank - 1) != width))
        throw input_error(fmt::format("has the shape {}", shape_text(held_)), {{}, 0, 0, name},
                          "give an array of " + expected_shape(width));
    data_ = reinterpret_cast<const char*>(held_.data());
    rows_ = one_ ? 1 : held_.shape(0);
    row_stride_ = one_ ? 0 : held_.strides(0);
    column_stride_ = width > 1 ? held_.strides(rank - 1) : 0;
}

void Input::expect_rows(py::ssize_t n, bool broadcast) {
    if (!given() || rows_ == n || (broadcast && one_)) return;
    throw input_error(fmt::format("has {} rows, and there are {} times", rows_, n), {{}, 0, 0, name_},
                      "give one row for each time");
}

Times::Times(const char* name, const py::object& values) : held_(py::array::ensure(values)) {
    const SourcePlace place{{}, 0, 0, name};
    const char* hint = "give seconds (numbers with a fraction) or nanoseconds (whole numbers)";
    if (!held_) {
        PyErr_Clear();
        throw input_error("is not an array of numbers", place, hint);
    }
    const char kind = held_.dtype().kind();
    if (kind == 'i' || kind == 'u') {
        held_ = py::array_t<std::int64_t>::ensure(held_);
        whole_ = true;
    } else if (kind == 'f') {
        held_ = py::array_t<double>::ensure(held_);
    } else {
        throw input_error("holds no numbers", place, hint);
    }
    if (held_.ndim() > 1)
        throw input_error(fmt::format("has the shape {}", shape_text(held_)), place, "give an array of (n,), or one number");
    one_ = held_.ndim() == 0;
    data_ = static_cast<const char*>(held_.data());
    rows_ = one_ ? 1 : held_.shape(0);
    stride_ = one_ ? 0 : held_.strides(0);
    for (py::ssize_t i = 0; !whole_ && i < rows_; ++i)
        if (!std::isfinite(*reinterpret_cast<const double*>(data_ + i * stride_)))
            throw input_error(fmt::format("number {} is not finite", i), place, hint);
}

}  // namespace schuler::python
