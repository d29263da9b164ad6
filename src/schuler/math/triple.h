// Vectors and quaternions as plain numbers, for the few functions that run at every inertial sample.
//
// Eigen reads a Vector3d as a packet of two numbers and a single one. If they were written one by one immediately before, the read waits
// until they have left the processor's store buffer. Plain numbers remain in registers.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>

namespace schuler::math {

struct Triple {
    double x, y, z;

    Triple(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
    explicit Triple(const Eigen::Vector3d& v) : x(v.x()), y(v.y()), z(v.z()) {}

    [[nodiscard]] double squared_norm() const { return x * x + y * y + z * z; }
    [[nodiscard]] Triple cross(const Triple& b) const { return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x}; }
    [[nodiscard]] Eigen::Vector3d vector() const { return {x, y, z}; }
};

[[nodiscard]] inline Triple operator+(const Triple& a, const Triple& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
[[nodiscard]] inline Triple operator-(const Triple& a, const Triple& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
[[nodiscard]] inline Triple operator*(double k, const Triple& a) { return {k * a.x, k * a.y, k * a.z}; }

/// C v.
[[nodiscard]] inline Triple product(const Eigen::Matrix3d& C, const Triple& v) {
    return {C(0, 0) * v.x + C(0, 1) * v.y + C(0, 2) * v.z, C(1, 0) * v.x + C(1, 1) * v.y + C(1, 2) * v.z,
            C(2, 0) * v.x + C(2, 1) * v.y + C(2, 2) * v.z};
}
/// Column of a matrix of three rows.
template <class Matrix>
[[nodiscard]] Triple column(const Matrix& m, Eigen::Index j) {
    return {m(0, j), m(1, j), m(2, j)};
}
/// Adds to a column of a matrix of three rows, or to a vector.
template <class Matrix>
void add_to(Matrix& m, const Triple& t, Eigen::Index j = 0) {
    m(0, j) += t.x;
    m(1, j) += t.y;
    m(2, j) += t.z;
}

/// Hamilton quaternion.
struct Quad {
    double w;
    Triple v;

    Quad(double w_, const Triple& v_) : w(w_), v(v_) {}
    explicit Quad(const Eigen::Quaterniond& q) : w(q.w()), v(q.x(), q.y(), q.z()) {}

    [[nodiscard]] double squared_norm() const { return w * w + v.squared_norm(); }
    [[nodiscard]] Eigen::Quaterniond quaternion() const { return {w, v.x, v.y, v.z}; }
};

[[nodiscard]] inline Quad operator+(const Quad& a, const Quad& b) { return {a.w + b.w, a.v + b.v}; }
[[nodiscard]] inline Quad operator*(double k, const Quad& a) { return {k * a.w, k * a.v}; }
[[nodiscard]] inline Quad operator*(const Quad& a, const Quad& b) {
    return {a.w * b.w - (a.v.x * b.v.x + a.v.y * b.v.y + a.v.z * b.v.z), a.w * b.v + b.w * a.v + a.v.cross(b.v)};
}

/// Cosine of half the angle of a rotation vector of squared norm n2 (rad^2), and sine of half the angle over the angle.
struct HalfAngle {
    double cosine, sine_ratio;
};
[[nodiscard]] inline HalfAngle half_angle(double n2) {
    if (n2 < 1e-2) {  // series: the next terms are below 1e-17
        const double x = 0.25 * n2;
        return {1.0 - x * (1.0 / 2 - x * (1.0 / 24 - x * (1.0 / 720 - x * (1.0 / 40320 - x * (1.0 / 3628800))))),
                0.5 * (1.0 - x * (1.0 / 6 - x * (1.0 / 120 - x * (1.0 / 5040 - x * (1.0 / 362880)))))};
    }
    const double n = std::sqrt(n2);
    return {std::cos(0.5 * n), std::sin(0.5 * n) / n};
}

}  // namespace schuler::math
