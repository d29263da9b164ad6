// Second-order Taylor arithmetic in time: value, first and second derivative. The tests' way to exact kinematics.
#pragma once

#include <cmath>

namespace schuler::ins::test {

struct Jet {
    double v = 0.0, d = 0.0, dd = 0.0;
    Jet() = default;
    Jet(double value) : v(value) {}  // NOLINT: numbers are constants
    Jet(double value, double first, double second) : v(value), d(first), dd(second) {}
};

inline Jet time_jet(double t) { return {t, 1.0, 0.0}; }
/// f(a) from f, f', f'' at a.v.
inline Jet chain(const Jet& a, double f, double f1, double f2) { return {f, f1 * a.d, f1 * a.dd + f2 * a.d * a.d}; }

inline Jet operator-(const Jet& a) { return {-a.v, -a.d, -a.dd}; }
inline Jet operator+(const Jet& a, const Jet& b) { return {a.v + b.v, a.d + b.d, a.dd + b.dd}; }
inline Jet operator-(const Jet& a, const Jet& b) { return {a.v - b.v, a.d - b.d, a.dd - b.dd}; }
inline Jet operator*(const Jet& a, const Jet& b) {
    return {a.v * b.v, a.d * b.v + a.v * b.d, a.dd * b.v + 2.0 * a.d * b.d + a.v * b.dd};
}
inline Jet sin(const Jet& a) { return chain(a, std::sin(a.v), std::cos(a.v), -std::sin(a.v)); }
inline Jet cos(const Jet& a) { return chain(a, std::cos(a.v), -std::sin(a.v), -std::cos(a.v)); }
inline Jet inverse_sqrt(const Jet& a) {
    const double f = 1.0 / std::sqrt(a.v);
    return chain(a, f, -0.5 * f / a.v, 0.75 * f / (a.v * a.v));
}
inline Jet asin(const Jet& a) {
    const double w = 1.0 / std::sqrt(1.0 - a.v * a.v);
    return chain(a, std::asin(a.v), w, a.v * w * w * w);
}
inline Jet atan(const Jet& a) {
    const double w = 1.0 / (1.0 + a.v * a.v);
    return chain(a, std::atan(a.v), w, -2.0 * a.v * w * w);
}
/// Angle of (x, y), from the derivative of the angle: theta' = (x y' - y x')/(x^2 + y^2).
inline Jet atan2(const Jet& y, const Jet& x) {
    const double r2 = x.v * x.v + y.v * y.v;
    const double n = x.v * y.d - y.v * x.d;
    const double nd = x.v * y.dd - y.v * x.dd;
    const double r2d = 2.0 * (x.v * x.d + y.v * y.d);
    return {std::atan2(y.v, x.v), n / r2, (nd - n / r2 * r2d) / r2};
}

}  // namespace schuler::ins::test
