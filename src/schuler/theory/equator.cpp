#include "schuler/theory/equator.h"

#include "schuler/core/error.h"
#include "schuler/theory/detail/hyperbolic.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace schuler::theory {
namespace {

using Complex = std::complex<double>;
using Matrix4 = Eigen::Matrix4d;
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

void check(const char* key, double value, double low, double high, const char* unit, const char* why) {
    if (std::isfinite(value) && value >= low && value <= high) return;
    throw input_error(std::isfinite(value) ? fmt::format("{:g} {} is out of range{}", value, unit, value < low ? why : "")
                                           : std::string("not a finite number"),
                      {{}, 0, 0, key}, fmt::format("give {:g} to {:g} {}", low, high, unit));
}

double checked_radius(double height, const PaperCEarth& earth) {
    check("height", height, -500.0, 1e8, "m", ": under the ground, where the gravity of paper C does not hold");
    return earth.a + height;
}

/// The square of the east-vertical block is two 2 x 2 blocks: on (v_h, lon) with diagonal (p, q), on (v_e, height) with (r, a24).
struct Squared {
    double p, q, r;
    double h_by_lon, lon_by_h, e_by_height, height_by_e;
};

Squared squared(const EquatorConstants& c, double v) {
    return {c.a24 - 2.0 * c.w_n * c.k,
            -c.a_h / c.R,
            -2.0 * c.w_n * c.k - c.a_h / c.R,
            -2.0 * c.w_n * c.a_h,
            -2.0 * c.w_n / c.R,
            -c.k * c.a24 + c.a_h * v / (c.R * c.R),
            2.0 * c.w_n};
}

/// Contributions of the two roots: diagonals of the spectral projectors of the squared block, cosh and sinh(x t)/x of the roots.
template <class T>
struct Modes {
    T difference;                                     ///< rho1 - rho2
    T first_h, first_lon, first_e, first_height;      ///< diagonal of the projector on the first root
    T second_h, second_lon, second_e, second_height;  ///< on the second
};

/// Between the limits the small differences follow from (rho - p)(rho - q) = product of the off-diagonals, without cancellation.
Modes<double> modes_within(const EquatorConstants& c, const Squared& s) {
    const double r1 = c.rho1.real(), r2 = c.rho2.real(), d = r1 - r2;
    const double m = s.h_by_lon * s.lon_by_h, n = s.e_by_height * s.height_by_e;
    return {d,
            (s.p - r2) / d,
            m / ((s.p - r2) * d),
            n / ((c.a24 - r2) * d),
            (c.a24 - r2) / d,
            m / ((r1 - s.q) * d),
            (r1 - s.q) / d,
            (r1 - s.r) / d,
            n / ((r1 - s.r) * d)};
}

Modes<Complex> modes_beyond(const EquatorConstants& c, const Squared& s, Complex r1, Complex r2) {
    const Complex d = r1 - r2;
    return {d,
            (s.p - r2) / d,
            (s.q - r2) / d,
            (s.r - r2) / d,
            (c.a24 - r2) / d,
            (r1 - s.p) / d,
            (r1 - s.q) / d,
            (r1 - s.r) / d,
            (r1 - c.a24) / d};
}

/// Even and odd functions of the roots at t.
template <class T>
struct RootFunctions {
    T even1, even2, even_difference;  ///< cosh(x1 t), cosh(x2 t), first minus second
    T odd1, odd2, odd_difference;     ///< sinh(x t)/x
};

RootFunctions<double> functions_within(double beta, double mu, double t) {
    const double sh = std::sinh(0.5 * beta * t), s = std::sin(0.5 * mu * t);
    return {std::cosh(beta * t),     std::cos(mu * t),
            2.0 * (sh * sh + s * s), std::sinh(beta * t) / beta,
            std::sin(mu * t) / mu,   detail::sinh_minus_argument(beta * t) / beta + detail::argument_minus_sin(mu * t) / mu};
}

RootFunctions<Complex> functions_beyond(Complex r1, Complex r2, double t) {
    const Complex x1 = std::sqrt(r1), x2 = std::sqrt(r2);
    const auto odd = [t](Complex x) { return std::abs(x) * t < 1e-6 ? Complex(t) : std::sinh(x * t) / x; };
    RootFunctions<Complex> f{std::cosh(x1 * t), std::cosh(x2 * t), {}, odd(x1), odd(x2), {}};
    f.even_difference = f.even1 - f.even2;
    f.odd_difference = f.odd1 - f.odd2;
    return f;
}

/// exp(A4 t) of z = (v_h, v_e, height, lon), math.md 1.4: even part, plus A4 times the odd one.
template <class T>
Matrix4 block(const EquatorConstants& c, double v, const Squared& s, const Modes<T>& m, const RootFunctions<T>& f) {
    const auto re = [](const T& x) { return std::real(x); };
    const auto even = [&](const T& first, const T& second) { return re(first * f.even1 + second * f.even2); };
    const auto odd = [&](const T& first, const T& second) { return re(first * f.odd1 + second * f.odd2); };
    const double even_mix = re(f.even_difference / m.difference), odd_mix = re(f.odd_difference / m.difference);
    Matrix4 E = Matrix4::Zero(), Y = Matrix4::Zero(), A = Matrix4::Zero();
    E(0, 0) = even(m.first_h, m.second_h), E(0, 3) = s.h_by_lon * even_mix;
    E(3, 0) = s.lon_by_h * even_mix, E(3, 3) = even(m.first_lon, m.second_lon);
    E(1, 1) = even(m.first_e, m.second_e), E(1, 2) = s.e_by_height * even_mix;
    E(2, 1) = s.height_by_e * even_mix, E(2, 2) = even(m.first_height, m.second_height);
    Y(0, 0) = odd(m.first_h, m.second_h), Y(0, 3) = s.h_by_lon * odd_mix;
    Y(3, 0) = s.lon_by_h * odd_mix, Y(3, 3) = odd(m.first_lon, m.second_lon);
    Y(1, 1) = odd(m.first_e, m.second_e), Y(1, 2) = s.e_by_height * odd_mix;
    Y(2, 1) = s.height_by_e * odd_mix, Y(2, 2) = odd(m.first_height, m.second_height);
    A(0, 1) = 2.0 * c.w_n, A(0, 2) = c.a24;
    A(1, 0) = -c.k, A(1, 3) = -c.a_h;
    A(2, 0) = 1.0;
    A(3, 1) = 1.0 / c.R, A(3, 2) = -v / (c.R * c.R);
    // A and Y commute: each element is taken from the product with less cancellation.
    const Matrix4 absolute_AY = A.cwiseAbs() * Y.cwiseAbs(), absolute_YA = Y.cwiseAbs() * A.cwiseAbs();
    return E + (absolute_AY.array() <= absolute_YA.array()).select(A * Y, Y * A);
}

}  // namespace

SpeedLimits speed_limits(double height, const PaperCEarth& earth) {
    const double R = checked_radius(height, earth);
    const double turning = earth.u * R;
    const double root = std::sqrt(turning * turning + earth.g_eo * earth.a * earth.a / R);
    return {root - turning, root + turning};
}

EquatorFlight::EquatorFlight(double speed, double height, const PaperCEarth& earth) : speed_(speed), height_(height) {
    c_.R = checked_radius(height, earth);
    check("speed", speed, -1e5, 1e5, "m/s", "");
    const double R = c_.R, v = speed;
    c_.g = earth.g_eo * earth.a * earth.a / (R * R);
    c_.w_n = std::fma(earth.u, R, v) / R;  // exact if the speed cancels the Earth's rotation
    c_.k = earth.u + c_.w_n;
    c_.a_h = c_.g - 2.0 * earth.u * v - v * v / R;
    c_.a24 = 2.0 * c_.g / R - (v / R) * (v / R);
    c_.omega = std::sqrt(c_.g / R);
    // rho^2 + B rho - C = 0
    const double B = 2.0 * c_.w_n * c_.k - c_.a24 + c_.a_h / R;
    const double C = (c_.a24 + 2.0 * c_.w_n * v / R) * c_.a_h / R;
    const Complex D = std::sqrt(Complex(B * B + 4.0 * C));
    within_ = C > 0.0;
    if (within_) {
        const double larger = 0.5 * (std::abs(B) + D.real());
        c_.rho1 = B <= 0.0 ? larger : C / larger;
        c_.rho2 = B <= 0.0 ? -C / larger : -larger;
    } else {
        c_.rho1 = 0.5 * (-B + D);
        c_.rho2 = 0.5 * (-B - D);
    }
    c_.beta3 = within_ ? std::sqrt(c_.rho1.real()) : no_number;
    c_.mu = within_ ? std::sqrt(-c_.rho2.real()) : no_number;
}

std::array<Complex, 6> EquatorFlight::roots() const {
    const Complex north(0.0, c_.omega), first = std::sqrt(c_.rho1), second = std::sqrt(c_.rho2);
    const Complex zero(0.0, 0.0);  // 0 - x has no negative zeros
    return {north, zero - north, first, zero - first, second, zero - second};
}

Matrix6 EquatorFlight::dynamics() const {
    Matrix6 A = Matrix6::Zero();
    A(vn, lat) = -c_.g;
    A(vh, ve) = 2.0 * c_.w_n;
    A(vh, theory::height) = c_.a24;
    A(ve, vh) = -c_.k;
    A(ve, lon) = -c_.a_h;
    A(theory::height, vh) = 1.0;
    A(lat, vn) = 1.0 / c_.R;
    A(lon, ve) = 1.0 / c_.R;
    A(lon, theory::height) = -speed_ / (c_.R * c_.R);
    return A;
}

Matrix6 EquatorFlight::transition(double t) const {
    const Squared s = squared(c_, speed_);
    Matrix4 Z;
    if (within_) {
        Z = block(c_, speed_, s, modes_within(c_, s), functions_within(c_.beta3, c_.mu, t));
    } else {
        // Symmetric in the two roots: if they coincide, separating them evenly causes an error of second order in the distance.
        Complex r1 = c_.rho1, r2 = c_.rho2;
        const Complex middle = 0.5 * (r1 + r2);
        if (std::abs(r1 - r2) < 2e-6 * std::abs(middle)) r1 = middle * (1.0 + 1e-6), r2 = middle * (1.0 - 1e-6);
        Z = block(c_, speed_, s, modes_beyond(c_, s, r1, r2), functions_beyond(r1, r2, t));
    }
    constexpr std::array order{vh, ve, theory::height, lon};
    Matrix6 P = Matrix6::Zero();
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) P(order[static_cast<std::size_t>(i)], order[static_cast<std::size_t>(j)]) = Z(i, j);
    const double speed_scale = c_.omega * c_.R;  // sqrt(g R)
    P(vn, vn) = P(lat, lat) = std::cos(c_.omega * t);
    P(vn, lat) = -speed_scale * std::sin(c_.omega * t);
    P(lat, vn) = std::sin(c_.omega * t) / speed_scale;
    return P;
}

namespace {

/// x = p cos + q sin of each error, from the projector on the oscillating root.
struct Quadratures {
    Vector6 p, q;
};

Quadratures quadratures(const EquatorFlight& flight, const Vector6& x) {
    const EquatorConstants& c = flight.constants();
    const double speed_scale = c.omega * c.R;
    Quadratures out{Vector6::Constant(no_number), Vector6::Constant(no_number)};
    out.p(vn) = x(vn), out.q(vn) = -speed_scale * x(lat);
    out.p(lat) = x(lat), out.q(lat) = x(vn) / speed_scale;
    if (!flight.within_limits()) return out;
    const Squared s = squared(c, flight.speed());
    const Modes<double> m = modes_within(c, s);
    out.p(vh) = m.second_h * x(vh) - s.h_by_lon / m.difference * x(lon);
    out.p(lon) = m.second_lon * x(lon) - s.lon_by_h / m.difference * x(vh);
    out.p(ve) = m.second_e * x(ve) - s.e_by_height / m.difference * x(height);
    out.p(height) = m.second_height * x(height) - s.height_by_e / m.difference * x(ve);
    out.q(vh) = (2.0 * c.w_n * out.p(ve) + c.a24 * out.p(height)) / c.mu;
    out.q(ve) = (-c.k * out.p(vh) - c.a_h * out.p(lon)) / c.mu;
    out.q(height) = out.p(vh) / c.mu;
    out.q(lon) = (out.p(ve) / c.R - flight.speed() / (c.R * c.R) * out.p(height)) / c.mu;
    return out;
}

}  // namespace

EquatorFlight::Oscillation EquatorFlight::oscillation(const Vector6& initial) const {
    const Quadratures s = quadratures(*this, initial);
    Oscillation out;
    for (int i = 0; i < 6; ++i) {
        out.amplitude(i) = std::hypot(s.p(i), s.q(i));
        out.phase(i) = out.amplitude(i) > 0.0 ? std::atan2(s.p(i), s.q(i)) : no_number;
    }
    return out;
}

Vector6 EquatorFlight::integration_constants(const Vector6& x) const {
    const Quadratures s = quadratures(*this, x);
    const double sum = x(theory::height) - s.p(theory::height);  // C_3 + C_4
    const double difference = (x(vh) - s.p(vh)) / c_.beta3;      // C_3 - C_4
    Vector6 C;
    C << s.p(lat), s.q(lat), 0.5 * (sum + difference), 0.5 * (sum - difference), s.p(theory::height), s.q(theory::height);
    return C;
}

}  // namespace schuler::theory
