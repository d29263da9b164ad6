#include "schuler/theory/modes.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/theory/decomposition.h"

#include <fmt/format.h>

#include <unsupported/Eigen/MatrixFunctions>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace schuler::theory {
namespace {

using Complex = std::complex<double>;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXcd;
using Eigen::VectorXd;

constexpr int loop_integral = 9;

struct LoopGains {
    double k1 = 0.0, k2 = 0.0, k3 = 0.0;
};

/// Gains that make s^2 + k1 s + (k2 - c) or s^3 + k1 s^2 + (k2 - c) s + k3 a Butterworth polynomial of 1/tau; c: instability,
/// 1/s^2.
LoopGains gains(VerticalChannel channel, double tau, double c) {
    switch (channel) {
        case VerticalChannel::Fixed:
        case VerticalChannel::Free: break;
        case VerticalChannel::SecondOrder: return {std::numbers::sqrt2 / tau, 1.0 / (tau * tau) + c, 0.0};
        case VerticalChannel::ThirdOrder: return {2.0 / tau, 2.0 / (tau * tau) + c, 1.0 / (tau * tau * tau)};
    }
    return {};
}

/// Natural scales: R, sqrt(g R) and 1 rad make the elements of F comparable.
Vector10 natural_scale() {
    Vector10 s;
    s << 1.0, 1.0, 6.4e6, 7900.0, 7900.0, 7900.0, 1.0, 1.0, 1.0, 9.8;
    return s;
}

/// Dynamic states, without longitude (on which nothing depends): indices of Vector10.
std::vector<int> moving_states(VerticalChannel channel) {
    std::vector<int> out{d_lat, d_ve, d_vn, a_e, a_n, a_u};
    if (channel != VerticalChannel::Fixed) out.insert(out.end(), {d_h, d_vu});
    if (channel == VerticalChannel::ThirdOrder) out.push_back(loop_integral);
    return out;
}

bool is_vertical(int state) { return state == d_h || state == d_vu || state == loop_integral; }

void check(const LevelFlight& f, const Vector9& x, const ConstantErrors& c) {
    const auto refuse = [](const char* key, const std::string& what, const std::string& hint) {
        throw input_error(what, {{}, 0, 0, key}, hint);
    };
    if (!(std::abs(f.position.lat) <= 89.9 * units::deg) || !std::isfinite(f.position.lon))
        refuse("latitude-deg", "the local level has no north here", "give a latitude within 89.9 deg");
    if (!(f.position.h >= -500.0 && f.position.h <= 1e6))
        refuse("height",
               f.position.h < 0.0 ? "under the ground, where the gravity model does not hold" : "the height is out of range",
               "give -500 m to 1000 km");
    if (!f.v_enu.allFinite() || f.v_enu.norm() > 2e4)
        refuse("ve, --vn, --vh", "the velocity is out of range", "give up to 20 km/s");
    if (!x.allFinite() || !c.gyro.allFinite() || !c.accel.allFinite() || !std::isfinite(c.baro))
        refuse("", "an error is not a finite number", "give numbers");
    if (!(f.time_constant > 0.0) || !std::isfinite(f.time_constant))
        refuse("baro-time", "the time constant is not positive", "give seconds, for example 100");
    if (f.vertical == VerticalChannel::Fixed && (x(d_h) != 0.0 || x(d_vu) != 0.0 || c.accel.z() != 0.0 || c.baro != 0.0))
        refuse("vertical", "vertical errors do nothing while the height is held fixed", "use free, second or third");
    if ((f.vertical == VerticalChannel::Free) && c.baro != 0.0)
        refuse("vertical", "a free vertical channel has no barometer", "use second or third");
}

}  // namespace

VerticalChannel vertical_channel_from_name(const std::string& name) {
    constexpr std::array<std::pair<const char*, VerticalChannel>, 4> known{{{"fixed", VerticalChannel::Fixed},
                                                                            {"free", VerticalChannel::Free},
                                                                            {"second", VerticalChannel::SecondOrder},
                                                                            {"third", VerticalChannel::ThirdOrder}}};
    for (const auto& [text, value] : known)
        if (name == text) return value;
    throw input_error(fmt::format("unknown vertical channel \"{}\"", name), {{}, 0, 0, "vertical"},
                      "use fixed, free, second or third");
}

LevelAnalysis::LevelAnalysis(const LevelFlight& flight, const Vector9& initial, const ConstantErrors& constant)
    : flight_(flight), F_(Matrix10::Zero()), d_(Vector10::Zero()), x_(Vector10::Zero()) {
    check(flight, initial, constant);
    const earth::Radii r = earth::radii(flight.earth.ellipsoid, flight.position.lat);
    east_ = (r.prime_vertical + flight.position.h) * std::cos(flight.position.lat);
    north_ = r.meridian + flight.position.h;
    F_.topLeftCorner<9, 9>() = level_error_dynamics(flight.earth, flight.position, flight.v_enu,
                                                    steady_level_force(flight.earth, flight.position, flight.v_enu));
    x_.head<9>() = initial;
    d_.segment<3>(d_ve) = constant.accel;
    d_.segment<3>(a_e) = -constant.gyro;
    if (flight.vertical == VerticalChannel::Fixed) {
        for (const int i : {d_h, d_vu}) {
            F_.row(i).setZero();
            F_.col(i).setZero();
        }
        return;
    }
    const LoopGains k = gains(flight.vertical, flight.time_constant, F_(d_vu, d_h));
    F_(d_h, d_h) -= k.k1;
    F_(d_vu, d_h) -= k.k2;
    d_(d_h) += k.k1 * constant.baro;
    d_(d_vu) += k.k2 * constant.baro;
    if (flight.vertical == VerticalChannel::ThirdOrder) {
        F_(d_vu, loop_integral) = -1.0;
        F_(loop_integral, d_h) = k.k3;
        d_(loop_integral) = -k.k3 * constant.baro;
    }
}

Vector9 LevelAnalysis::in_metres(const Vector10& x) const {
    Vector9 out = x.head<9>();
    out(d_lon) *= east_;
    out(d_lat) *= north_;
    return out;
}

std::vector<ErrorsAt> LevelAnalysis::history(double duration, int count) const {
    if (!(duration >= 0.0) || !std::isfinite(duration) || count < 1)
        throw input_error("the time is unusable", {{}, 0, 0, "time"}, "give seconds, not negative");
    const double dt = duration / count;
    const Vector10 scale = natural_scale();
    MatrixXd M = MatrixXd::Zero(11, 11);
    M.topLeftCorner<10, 10>() = scale.cwiseInverse().asDiagonal() * F_ * scale.asDiagonal() * dt;
    M.topRightCorner<10, 1>() = d_.cwiseQuotient(scale) * dt;
    const MatrixXd step = M.exp();
    Eigen::Matrix<double, 11, 1> z;
    z << x_.cwiseQuotient(scale), 1.0;
    std::vector<ErrorsAt> out;
    for (int k = 0; k <= count; ++k) {
        if (k > 0) z = (step * z).eval();
        const Vector10 x = z.head<10>().cwiseProduct(scale);
        if (!x.allFinite()) throw computation_error("the errors exceed the range of numbers", "give a shorter time");
        out.push_back({dt * k, in_metres(x)});
    }
    return out;
}

std::vector<Complex> LevelAnalysis::vertical_roots(VerticalChannel channel) const {
    const Matrix9 F = level_error_dynamics(flight_.earth, flight_.position, flight_.v_enu,
                                           steady_level_force(flight_.earth, flight_.position, flight_.v_enu));
    const double c = F(d_vu, d_h);
    if (channel == VerticalChannel::Fixed) return {};
    if (channel == VerticalChannel::Free) return {std::sqrt(Complex(c)), -std::sqrt(Complex(c))};
    const LoopGains k = gains(channel, flight_.time_constant, c);
    const int n = channel == VerticalChannel::ThirdOrder ? 3 : 2;
    const double tau = flight_.time_constant;  // roots in units of 1/tau
    MatrixXd companion = MatrixXd::Zero(n, n);
    companion(0, 0) = -k.k1 * tau, companion(0, 1) = -(k.k2 - c) * tau * tau;
    companion(1, 0) = 1.0;
    if (n == 3) companion(0, 2) = -k.k3 * tau * tau * tau, companion(2, 1) = 1.0;
    const VectorXcd roots = companion.eigenvalues() / tau;
    return {roots.begin(), roots.end()};
}

namespace {

/// Names by the quantity and its speed; `oscillating`: horizontal pairs, slowest first.
std::string horizontal_name(std::size_t number, std::size_t count) {
    if (number == 0) return "24-hour";
    if (count == 3) return number == 1 ? "Schuler, slower" : "Schuler, faster";
    return "Schuler";
}

}  // namespace

ModalAnalysis LevelAnalysis::modes() const {
    const std::vector<int> states = moving_states(flight_.vertical);
    const auto n = static_cast<Eigen::Index>(states.size());
    const Vector10 scale = natural_scale();
    MatrixXd F(n, n);
    VectorXd x(n), d(n), lon_row(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const int si = states[static_cast<std::size_t>(i)];
        x(i) = x_(si) / scale(si);
        d(i) = d_(si) / scale(si);
        lon_row(i) = F_(d_lon, si) * scale(si);
        for (Eigen::Index j = 0; j < n; ++j) {
            const int sj = states[static_cast<std::size_t>(j)];
            F(i, j) = F_(si, sj) * scale(sj) / scale(si);
        }
    }
    const Decomposition parts = decomposed(F, x, d);
    const MatrixXcd& V = parts.vectors;

    const auto spread = [&](const auto& values) {  // over the dynamic states, in SI
        Vector10 out = Vector10::Zero();
        for (Eigen::Index i = 0; i < n; ++i)
            out(states[static_cast<std::size_t>(i)]) = std::abs(values(i)) * scale(states[static_cast<std::size_t>(i)]);
        return out;
    };
    ModalAnalysis out;
    for (Eigen::Index i = 0; i < n; ++i) {
        const Complex root = parts.root(i);
        if (root.imag() < 0.0) continue;
        const double both = root.imag() > 0.0 ? 2.0 : 1.0;
        Vector10 size = both * spread(parts.part.col(i));
        size(d_lon) = both * std::abs(lon_row.cast<Complex>().dot(parts.part.col(i)) / root);
        double vertical = 0.0;
        for (Eigen::Index k = 0; k < n; ++k)
            if (is_vertical(states[static_cast<std::size_t>(k)])) vertical += std::norm(V(k, i));
        out.modes.push_back({vertical > 0.5 * V.col(i).squaredNorm() ? "vertical" : "", root, in_metres(size)});
    }
    std::ranges::sort(out.modes, {}, [](const Mode& m) { return m.root.imag(); });
    std::vector<double> schuler;
    std::size_t count = 0, number = 0;
    for (const Mode& m : out.modes) count += m.name.empty() && m.root.imag() > 0.0 ? 1 : 0;
    for (Mode& m : out.modes) {
        if (!m.name.empty()) {
            const bool loop = flight_.vertical != VerticalChannel::Free;
            m.name = loop ? "vertical, barometer loop" : m.root.real() > 0.0 ? "vertical, growing" : "vertical, decaying";
        } else if (m.root.imag() > 0.0) {
            if (number > 0) schuler.push_back(m.root.imag());
            m.name = horizontal_name(number++, count);
        } else {
            m.name = "horizontal, not oscillating";
        }
    }
    std::ranges::reverse(out.modes);

    Vector10 offset = Vector10::Zero();
    for (Eigen::Index i = 0; i < n; ++i)
        offset(states[static_cast<std::size_t>(i)]) = parts.constant(i) * scale(states[static_cast<std::size_t>(i)]);
    out.offset = in_metres(offset);
    out.drift = Vector9::Zero();
    out.drift(d_lon) = east_ * lon_row.dot(parts.constant);
    out.foucault = schuler.size() == 2 ? 0.5 * (schuler[1] - schuler[0]) : std::numeric_limits<double>::quiet_NaN();
    out.foucault_expected = std::abs((flight_.earth.ellipsoid.w_ie + flight_.v_enu.x() / east_) * std::sin(flight_.position.lat));
    return out;
}

}  // namespace schuler::theory
