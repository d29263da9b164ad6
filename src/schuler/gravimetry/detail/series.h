// Taylor series in time with fifty decimal digits: derivatives along a motion to any order.
#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

#include <array>
#include <cstddef>
#include <utility>

namespace schuler::gravimetry::detail {

using Real = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;

/// Coefficients of t^0 to t^32, sufficient for the 33 blocks of the observability matrix.
class Series {
public:
    static constexpr std::size_t terms = 33;

    Series() = default;
    Series(const Real& constant) { c_[0] = constant; }  // NOLINT: implicit conversion of a constant
    [[nodiscard]] static Series line(const Real& start, const Real& rate) {
        Series s(start);
        s.c_[1] = rate;
        return s;
    }
    [[nodiscard]] Real& operator[](std::size_t n) { return c_[n]; }
    [[nodiscard]] const Real& operator[](std::size_t n) const { return c_[n]; }

    Series& operator+=(const Series& b) {
        for (std::size_t n = 0; n < terms; ++n) c_[n] += b.c_[n];
        return *this;
    }
    friend Series operator+(Series a, const Series& b) { return a += b; }
    friend Series operator-(const Series& a) { return a * Real(-1); }
    friend Series operator-(const Series& a, const Series& b) { return a + b * Real(-1); }
    friend Series operator*(Series a, const Real& b) {
        for (Real& c : a.c_) c *= b;
        return a;
    }
    friend Series operator*(const Series& a, const Series& b) {
        Series p;
        for (std::size_t i = 0; i < terms; ++i) {
            if (a.c_[i].is_zero()) continue;
            for (std::size_t j = 0; i + j < terms; ++j)
                if (!b.c_[j].is_zero()) p.c_[i + j] += a.c_[i] * b.c_[j];
        }
        return p;
    }

private:
    std::array<Real, terms> c_{};
};

/// (sin, cos): s' = c x', c' = -s x'.
[[nodiscard]] inline std::pair<Series, Series> sin_cos(const Series& x) {
    Series s(sin(x[0])), c(cos(x[0]));
    for (std::size_t n = 1; n < Series::terms; ++n) {
        for (std::size_t k = 1; k <= n; ++k) {
            const Real slope = x[k] * static_cast<int>(k);
            s[n] += slope * c[n - k];
            c[n] -= slope * s[n - k];
        }
        s[n] /= static_cast<int>(n);
        c[n] /= static_cast<int>(n);
    }
    return {s, c};
}

/// x^a for x[0] > 0: x y' = a x' y.
[[nodiscard]] inline Series power(const Series& x, const Real& a) {
    Series y(pow(x[0], a));
    for (std::size_t n = 1; n < Series::terms; ++n) {
        for (std::size_t k = 1; k <= n; ++k) y[n] += (a * static_cast<int>(k) - static_cast<int>(n - k)) * x[k] * y[n - k];
        y[n] /= x[0] * static_cast<int>(n);
    }
    return y;
}

/// The series whose derivative is x.
[[nodiscard]] inline Series integral(const Real& start, const Series& x) {
    Series y(start);
    for (std::size_t n = 1; n < Series::terms; ++n) y[n] = x[n - 1] / static_cast<int>(n);
    return y;
}

}  // namespace schuler::gravimetry::detail
