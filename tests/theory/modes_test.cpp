// Modes of the level error dynamics against what physics says of them, and paper A's cases with the whole model.
#include "schuler/theory/modes.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace schuler::theory {
namespace {

LevelFlight at_rest(double lat_deg, VerticalChannel vertical = VerticalChannel::Fixed) {
    LevelFlight f;
    f.position = {lat_deg * units::deg, 0.5, 0.0};
    f.vertical = vertical;
    return f;
}

std::map<std::string, Mode> named(const ModalAnalysis& a) {
    std::map<std::string, Mode> out;
    for (const Mode& m : a.modes) out[m.name] = m;
    EXPECT_EQ(out.size(), a.modes.size()) << "a name stands twice";
    return out;
}

TEST(Modes, AtRest) {
    Vector9 x = Vector9::Zero();
    x(a_e) = 1e-4;
    for (const double lat_deg : {20.0, 50.45, -70.0}) {
        const ModalAnalysis a = LevelAnalysis(at_rest(lat_deg), x, {}).modes();
        const std::map<std::string, Mode> m = named(a);
        const double u = earth::wgs84.w_ie, ws = std::sqrt(9.81 / 6.38e6), s = std::abs(std::sin(lat_deg * units::deg));
        // The Foucault turn of the pendulum's plane, but for the flattening, which splits the two channels by (e^2/2 ws)^2/8.
        EXPECT_NEAR(a.foucault / (u * s), 1.0, lat_deg == 20.0 ? 6e-3 : 1e-3) << lat_deg;
        EXPECT_NEAR(a.foucault_expected, u * s, 1e-15);
        EXPECT_NEAR(m.at("24-hour").root.imag() / u, 1.0, 1e-9) << lat_deg;
        EXPECT_NEAR(0.5 * (m.at("Schuler, slower").root.imag() + m.at("Schuler, faster").root.imag()) / ws, 1.0, 4e-3) << lat_deg;
        for (const auto& [name, mode] : m) EXPECT_LT(std::abs(mode.root.real()), 1e-15) << name;
    }
}

TEST(Modes, TheirSumIsTheSolution) {
    // Amplitudes bound the motion, and a mode alone moves with its amplitude: a static error in the sum would show.
    Vector9 x;
    x << 0.0, 1e-6, 0.0, 0.3, -0.2, 0.0, 2e-5, -3e-5, 1e-4;
    const ConstantErrors constant{{1e-8, -2e-8, 3e-8}, {1e-4, -2e-4, 0.0}, 0.0};
    LevelFlight flight = at_rest(40.0);
    flight.v_enu = {200.0, 0.0, 0.0};
    const LevelAnalysis analysis(flight, x, constant);
    const ModalAnalysis a = analysis.modes();
    const double hours = 200.0;
    const std::vector<ErrorsAt> history = analysis.history(hours * units::hour, 8000);
    Vector9 high = Vector9::Constant(-1e300), low = -high;
    for (const ErrorsAt& e : history) {
        const Vector9 oscillating = e.errors - a.offset - a.drift * e.t;
        high = high.cwiseMax(oscillating);
        low = low.cwiseMin(oscillating);
    }
    Vector9 sum = Vector9::Zero();
    for (const Mode& m : a.modes) sum += m.amplitude;
    for (const int i : {d_lat, d_ve, d_vn, a_e, a_n, a_u, d_lon}) {
        EXPECT_NEAR(0.5 * (high(i) - low(i)) / sum(i), 1.0, 0.02) << i;  // incommensurable: the sum is nearly reached
        if (i == d_lon) continue;
        EXPECT_NEAR((high(i) + low(i)) / sum(i), 0.0, 0.03) << i;  // about the offset
    }
}

TEST(Modes, HistoryIsTheDifferentialEquation) {
    const ConstantErrors constant{{1e-8, -2e-8, 3e-8}, {1e-4, -2e-4, 3e-4}, 5.0};
    Vector9 x;
    x << 1e-6, 1e-6, 3.0, 0.3, -0.2, 0.1, 2e-5, -3e-5, 1e-4;
    LevelFlight flight = at_rest(-33.0, VerticalChannel::ThirdOrder);
    flight.v_enu = {150.0, 80.0, 0.0};
    const LevelAnalysis analysis(flight, x, constant);
    Vector10 z = Vector10::Zero();
    z.head<9>() = x;
    const Matrix10& F = analysis.dynamics();
    const double dt = 0.5;
    for (int k = 0; k < 7200; ++k) {
        const auto rate = [&](const Vector10& y) { return Vector10(F * y + analysis.driving()); };
        const Vector10 k1 = rate(z), k2 = rate(z + 0.5 * dt * k1), k3 = rate(z + 0.5 * dt * k2), k4 = rate(z + dt * k3);
        z += dt / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    }
    const Vector9 last = analysis.history(3600.0, 7).back().errors;
    for (int i = 2; i < 9; ++i) EXPECT_NEAR(last(i), z(i), 1e-8 * std::abs(z(i)) + 1e-14) << i;
}

TEST(Modes, VerticalChannelAndItsLoops) {
    const double c = 2.0 * 9.78 / 6.378e6;
    LevelFlight flight = at_rest(45.0, VerticalChannel::Free);
    Vector9 x = Vector9::Zero();
    x(d_h) = 1.0;
    const LevelAnalysis free(flight, x, {});
    const std::map<std::string, Mode> m = named(free.modes());
    EXPECT_NEAR(m.at("vertical, growing").root.real(), std::sqrt(c), 0.01 * std::sqrt(c));
    EXPECT_NEAR(m.at("vertical, decaying").root.real(), -std::sqrt(c), 0.01 * std::sqrt(c));
    EXPECT_NEAR(free.vertical_roots(VerticalChannel::Free)[0].real(), m.at("vertical, growing").root.real(), 1e-5);
    EXPECT_NEAR(free.history(3600.0, 1).back().errors(d_h) / std::cosh(3600.0 * m.at("vertical, growing").root.real()), 1.0,
                0.01);

    // A constant accelerometer error: the second-order loop keeps a tau^2 of height error, the third-order one nothing.
    const ConstantErrors constant{Eigen::Vector3d::Zero(), {0.0, 0.0, 1e-3}, 0.0};
    flight.vertical = VerticalChannel::SecondOrder;
    EXPECT_NEAR(LevelAnalysis(flight, x, constant).history(3000.0, 1).back().errors(d_h), 10.0, 0.01);
    flight.vertical = VerticalChannel::ThirdOrder;
    const LevelAnalysis third(flight, x, constant);
    EXPECT_NEAR(third.history(3000.0, 1).back().errors(d_h), 0.0, 0.01);
    for (const std::complex<double> root : third.vertical_roots(VerticalChannel::ThirdOrder))
        EXPECT_NEAR(std::abs(root), 0.01, 1e-12);
    for (const Mode& mode : third.modes().modes) {
        EXPECT_LT(mode.root.real(), 1e-8) << mode.name;
        EXPECT_NEAR(mode.name.starts_with("vertical") ? std::abs(mode.root) : 0.01, 0.01, 1e-5) << mode.name;
    }
    // A wrong barometer is followed.
    EXPECT_NEAR(LevelAnalysis(flight, Vector9::Zero(), {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), 7.0})
                    .history(3000.0, 1)
                    .back()
                    .errors(d_h),
                7.0, 0.01);
}

/// East and north errors as angles times paper A's R_3, and the largest distance up to a time with its instant.
Eigen::Vector2d by_R3(const Vector9& x, double lat_) {
    const earth::Radii r = earth::radii(earth::wgs84, lat_);
    return 6371000.0 * Eigen::Vector2d(x(d_lon) / r.prime_vertical, x(d_lat) / r.meridian);
}
std::pair<double, double> farthest(const LevelFlight& flight, LevelError error, double size, double until) {
    Vector9 x = Vector9::Zero();
    x(error) = size;
    std::pair<double, double> out{0.0, 0.0};
    for (const ErrorsAt& e : LevelAnalysis(flight, x, {}).history(until, 5000)) {
        const double distance = by_R3(e.errors, flight.position.lat).norm();
        if (distance > out.first) out = {distance, e.t};
    }
    return out;
}

TEST(Modes, PaperASection41WithTheWholeModel) {
    // math.md 2.10: latitude 50.45 deg, height fixed, horizontal distances. There on a sphere with g0: 5e-4 is the ellipsoid.
    const LevelFlight kyiv = at_rest(50.45);
    const double period = 84.4 * 60.0;
    const auto [tilt_east, when] = farthest(kyiv, a_e, 1e-3, period);
    EXPECT_NEAR(tilt_east, 12690.0, 6.0);
    EXPECT_NEAR(when / 60.0, 42.1, 0.1);
    EXPECT_NEAR(farthest(kyiv, a_n, 1e-3, period).first, 12716.0, 6.0);
    EXPECT_NEAR(farthest(kyiv, a_u, 1e-3, period).first, 1481.0, 2.0);
    EXPECT_NEAR(farthest(kyiv, d_ve, 1.0, period).first, 804.0, 1.0);
    const auto after_an_hour = [&](const Eigen::Vector3d& drift) {
        const ConstantErrors constant{drift * 0.01 * units::deg_per_hour, Eigen::Vector3d::Zero(), 0.0};
        return by_R3(LevelAnalysis(kyiv, Vector9::Zero(), constant).history(3600.0, 1).back().errors, kyiv.position.lat);
    };
    EXPECT_LT((after_an_hour({1.0, 0.0, 0.0}) - Eigen::Vector2d(-174.0, -1334.9)).norm(), 1.0);
    EXPECT_LT((after_an_hour({0.0, 1.0, 0.0}) - Eigen::Vector2d(1338.1, -174.4)).norm(), 1.0);
    EXPECT_NEAR(after_an_hour({0.0, 0.0, 1.0}).norm(), 81.0, 0.5);
}

TEST(Modes, UnusableStates) {
    EXPECT_THROW(LevelAnalysis(at_rest(90.0), Vector9::Zero(), {}), Error);
    EXPECT_THROW(LevelAnalysis(at_rest(std::nan("")), Vector9::Zero(), {}), Error);
    Vector9 x = Vector9::Zero();
    x(d_h) = 1.0;
    EXPECT_THROW(LevelAnalysis(at_rest(45.0), x, {}), Error);  // a height error with the height fixed
    EXPECT_THROW((void)vertical_channel_from_name("fourth"), Error);
}

}  // namespace
}  // namespace schuler::theory
