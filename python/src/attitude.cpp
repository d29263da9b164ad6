// Rotations of whole arrays: the functions of math/rotation.h, one row at a time.
#include "arrays.h"

#include "schuler/math/rotation.h"

namespace schuler::python {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// Rows of `in` numbers to rows of `out` numbers: (..., in) to (..., out), with a last axis of 9 as 3 x 3.
template <class F>
py::array rows(const char* name, const py::object& values, py::ssize_t in, bool matrix_in, py::ssize_t out, F f) {
    const auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(values);
    const std::string expected = matrix_in ? "(..., 3, 3)" : in == 1 ? std::string("(...)") : fmt::format("(..., {})", in);
    if (!array) {
        PyErr_Clear();
        throw input_error("is not an array of numbers", {{}, 0, 0, name}, "give an array of " + expected);
    }
    std::vector<py::ssize_t> shape(array.shape(), array.shape() + array.ndim());
    const std::vector<py::ssize_t> last = matrix_in ? std::vector<py::ssize_t>{3, 3}
                                          : in == 1 ? std::vector<py::ssize_t>{}
                                                    : std::vector{in};
    if (shape.size() < last.size() || !std::equal(last.rbegin(), last.rend(), shape.rbegin()))
        throw input_error(fmt::format("has the shape {}", shape_text(array)), {{}, 0, 0, name}, "give an array of " + expected);
    shape.resize(shape.size() - last.size());
    if (out == 9) shape.insert(shape.end(), {3, 3});
    if (out > 1 && out < 9) shape.push_back(out);
    py::array_t<double> result(shape);
    const double* from = array.data();
    double* to = result.mutable_data();
    const py::ssize_t n = array.size() / in;
    {
        const py::gil_scoped_release release;
        for (py::ssize_t i = 0; i < n; ++i) f(from + i * in, to + i * out);
    }
    return result;
}

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
Eigen::Map<const Vector3d> vector(const double* p) { return Eigen::Map<const Vector3d>(p); }
Matrix3d matrix(const double* p) { return Eigen::Map<const RowMajor>(p); }
Quaterniond quaternion(const double* p) { return {p[0], p[1], p[2], p[3]}; }
void put(const Matrix3d& m, double* to) { Eigen::Map<RowMajor>{to} = m; }
void put(const Quaterniond& q, double* to) {
    to[0] = q.w();
    to[1] = q.x();
    to[2] = q.y();
    to[3] = q.z();
}

}  // namespace

void bind_attitude(py::module_& m) {
    m.def(
        "dcm_from_rpy",
        [](const py::object& rpy) {
            return rows("rpy", rpy, 3, false, 9, [](const double* a, double* b) { put(math::dcm_from_rpy(vector(a)), b); });
        },
        py::arg("rpy"),
        "C_nb, (..., 3, 3), body forward-right-down to north-east-down, from roll, pitch, heading (..., 3), rad.");
    m.def(
        "rpy_from_dcm",
        [](const py::object& C_nb) {
            return rows("C_nb", C_nb, 9, true, 3,
                        [](const double* a, double* b) { put_vector(math::rpy_from_dcm(matrix(a)), b); });
        },
        py::arg("C_nb"),
        "Roll, pitch, heading (..., 3), rad, of C_nb (..., 3, 3). Heading from 0 to 2 pi; at a pitch of 90 deg the roll is zero.");
    m.def(
        "quaternion_from_rpy",
        [](const py::object& rpy) {
            return rows("rpy", rpy, 3, false, 4,
                        [](const double* a, double* b) { put(math::quaternion_from_rpy(vector(a)), b); });
        },
        py::arg("rpy"), "Hamilton quaternion q_nb (..., 4), scalar first, from roll, pitch, heading (..., 3), rad.");
    m.def(
        "rpy_from_quaternion",
        [](const py::object& q_nb) {
            return rows("q_nb", q_nb, 4, false, 3,
                        [](const double* a, double* b) { put_vector(math::rpy_from_quaternion(quaternion(a)), b); });
        },
        py::arg("q_nb"), "Roll, pitch, heading (..., 3), rad, of unit quaternions (..., 4), scalar first.");
    m.def(
        "dcm_from_quaternion",
        [](const py::object& q) {
            return rows("q", q, 4, false, 9,
                        [](const double* a, double* b) { put(Matrix3d(quaternion(a).toRotationMatrix()), b); });
        },
        py::arg("q"), "Rotation matrices (..., 3, 3) of unit quaternions (..., 4), scalar first.");
    m.def(
        "quaternion_from_dcm",
        [](const py::object& C) {
            return rows("C", C, 9, true, 4, [](const double* a, double* b) { put(Quaterniond(matrix(a)), b); });
        },
        py::arg("C"), "Unit quaternions (..., 4), scalar first, of rotation matrices (..., 3, 3).");
    m.def(
        "dcm_from_rotation_vector",
        [](const py::object& r) {
            return rows("r", r, 3, false, 9,
                        [](const double* a, double* b) { put(math::dcm_from_rotation_vector(vector(a)), b); });
        },
        py::arg("r"), "Exp([r x]), (..., 3, 3), of rotation vectors (..., 3), rad.");
    m.def(
        "quaternion_from_rotation_vector",
        [](const py::object& r) {
            return rows("r", r, 3, false, 4,
                        [](const double* a, double* b) { put(math::quaternion_from_rotation_vector(vector(a)), b); });
        },
        py::arg("r"), "Unit quaternions (..., 4), scalar first, of rotation vectors (..., 3), rad.");
    m.def(
        "rotation_vector_from_quaternion",
        [](const py::object& q) {
            return rows("q", q, 4, false, 3,
                        [](const double* a, double* b) { put_vector(math::rotation_vector_from_quaternion(quaternion(a)), b); });
        },
        py::arg("q"), "Rotation vectors (..., 3), rad, at most pi long, of unit quaternions (..., 4), scalar first.");
    m.def(
        "skew",
        [](const py::object& v) {
            return rows("v", v, 3, false, 9, [](const double* a, double* b) { put(math::skew(vector(a)), b); });
        },
        py::arg("v"), "[v x], (..., 3, 3): skew(a) @ b is the cross product of a and b.");
    m.def(
        "wrap_pi",
        [](const py::object& angle) {
            return rows("angle", angle, 1, false, 1, [](const double* a, double* b) { *b = math::wrap_pi(*a); });
        },
        py::arg("angle"), "Angles, rad, of any shape, as ones above -pi, at most pi.");
    m.def(
        "wrap_2pi",
        [](const py::object& angle) {
            return rows("angle", angle, 1, false, 1, [](const double* a, double* b) { *b = math::wrap_2pi(*a); });
        },
        py::arg("angle"), "Angles, rad, of any shape, as ones from 0, below 2 pi.");
}

}  // namespace schuler::python
