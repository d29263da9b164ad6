// Truncated Taylor series in time: exact derivatives of truth paths by arithmetic on series.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace schuler::sim {

/// A function of time to order N about an instant: c[k] is its k-th derivative divided by k!.
/// Recurrences: Griewank and Walther 2008, Evaluating Derivatives, tables 13.1 and 13.2.
template <int N>
struct Jet {
    std::array<double, N + 1> c{};

    Jet() = default;
    Jet(double constant) { c[0] = constant; }  // NOLINT: implicit conversion of constants

    /// The independent variable at t.
    [[nodiscard]] static Jet variable(double t) {
        Jet x(t);
        if constexpr (N > 0) x.c[1] = 1.0;
        return x;
    }
    [[nodiscard]] double value() const { return c[0]; }
    [[nodiscard]] double rate() const {
        static_assert(N >= 1);
        return c[1];
    }

    /// The same function to a lower order.
    template <int M>
    [[nodiscard]] Jet<M> to() const {
        static_assert(M <= N);
        Jet<M> out;
        for (std::size_t k = 0; k <= M; ++k) out.c[k] = c[k];
        return out;
    }

    Jet& operator+=(const Jet& o) {
        for (std::size_t k = 0; k <= N; ++k) c[k] += o.c[k];
        return *this;
    }
    Jet& operator-=(const Jet& o) {
        for (std::size_t k = 0; k <= N; ++k) c[k] -= o.c[k];
        return *this;
    }
    friend Jet operator+(Jet a, const Jet& b) { return a += b; }
    friend Jet operator-(Jet a, const Jet& b) { return a -= b; }
    friend Jet operator-(const Jet& a) { return Jet(0.0) - a; }
    friend Jet operator*(const Jet& a, const Jet& b) {
        Jet p;
        for (std::size_t k = 0; k <= N; ++k) {
            for (std::size_t j = 0; j <= k; ++j) p.c[k] += a.c[j] * b.c[k - j];
        }
        return p;
    }
    friend Jet operator/(const Jet& a, const Jet& b) {
        Jet q;
        for (std::size_t k = 0; k <= N; ++k) {
            double rest = a.c[k];
            for (std::size_t j = 0; j < k; ++j) rest -= q.c[j] * b.c[k - j];
            q.c[k] = rest / b.c[0];
        }
        return q;
    }
};

/// Time derivative, of one order less.
template <int N>
[[nodiscard]] Jet<N - 1> derivative(const Jet<N>& a) {
    Jet<N - 1> d;
    for (std::size_t k = 0; k < N; ++k) d.c[k] = static_cast<double>(k + 1) * a.c[k + 1];
    return d;
}

template <int N>
struct SinCos {
    Jet<N> sin, cos;
};

template <int N>
[[nodiscard]] SinCos<N> sincos(const Jet<N>& a) {
    SinCos<N> out{std::sin(a.c[0]), std::cos(a.c[0])};
    for (std::size_t k = 1; k <= N; ++k) {
        double s = 0.0, c = 0.0;
        for (std::size_t j = 1; j <= k; ++j) {
            const double weight = static_cast<double>(j) * a.c[j];
            s += weight * out.cos.c[k - j];
            c -= weight * out.sin.c[k - j];
        }
        out.sin.c[k] = s / static_cast<double>(k);
        out.cos.c[k] = c / static_cast<double>(k);
    }
    return out;
}

/// Square root of a jet with a positive value.
template <int N>
[[nodiscard]] Jet<N> sqrt(const Jet<N>& a) {
    Jet<N> r(std::sqrt(a.c[0]));
    for (std::size_t k = 1; k <= N; ++k) {
        double rest = a.c[k];
        for (std::size_t j = 1; j < k; ++j) rest -= r.c[j] * r.c[k - j];
        r.c[k] = rest / (2.0 * r.c[0]);
    }
    return r;
}

/// Angle of the point (x, y), not both zero.
template <int N>
[[nodiscard]] Jet<N> atan2(const Jet<N>& y, const Jet<N>& x) {
    Jet<N> angle(std::atan2(y.c[0], x.c[0]));
    if constexpr (N > 0) {
        const Jet<N - 1> xs = x.template to<N - 1>(), ys = y.template to<N - 1>();
        const Jet<N - 1> rate = (xs * derivative(y) - ys * derivative(x)) / (xs * xs + ys * ys);
        for (std::size_t k = 1; k <= N; ++k) angle.c[k] = rate.c[k - 1] / static_cast<double>(k);
    }
    return angle;
}

/// f(u) for f given by its Taylor series about the value of u.
template <int N>
[[nodiscard]] Jet<N> compose(const Jet<N>& f, Jet<N> u) {
    u.c[0] = 0.0;
    Jet<N> out(f.c[N]);
    for (std::size_t k = N; k-- > 0;) out = out * u + f.c[k];
    return out;
}

}  // namespace schuler::sim
