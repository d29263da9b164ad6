// Example paths of every kind, and the body in inertial space by means that share nothing with the room under test.
#pragma once

#include "schuler/core/samples.h"
#include "schuler/core/units.h"
#include "schuler/sim/path.h"

#include <Eigen/Core>
#include <GeographicLib/Geocentric.hpp>

#include <cmath>
#include <string>
#include <vector>

namespace schuler::sim::testing {

using units::deg;

inline RoutePath example_route() {
    RoutePath route;
    route.start = {47.0 * deg, 8.5 * deg, 430.0};
    route.standstill = 20.0;
    // clang-format off
    route.waypoints = {{200.0, 0.0, 2.0, 14.0, 0.0},      {220.0, 300.0, 10.0, 16.0, 12.0}, {-100.0, 320.0, 8.0, 13.0, 0.0},
                       {-300.0, 320.0, -4.0, 13.0, 20.0}, {-260.0, -100.0, 0.0, 15.0, 0.0}, {0.0, -60.0, 0.0, 12.0, 0.0}};
    // clang-format on
    return route;
}

struct NamedPath {
    std::string name;
    PathSettings settings;
    double step;       ///< of the numerical derivatives, s
    double tolerance;  ///< of accelerations, m/s^2: the rounding of positions is 2e-9 m over step^2, and truncation
};

inline std::vector<NamedPath> all_paths() {
    RoutePath vibrating = example_route();
    vibrating.vibration = {3.0, 0.3 * deg, 0.4};
    RoutePath aircraft;
    aircraft.start = {-33.0 * deg, 151.0 * deg, 1500.0};
    aircraft.standstill = 0.0;
    aircraft.corner_radius = 1500.0;
    aircraft.lateral_accel = 4.0;
    aircraft.roll_per_lateral_accel = 0.102;
    aircraft.waypoints = {{9000.0, 0.0, 300.0, 90.0, 0.0}, {9000.0, 8000.0, 0.0, 80.0, 0.0}, {0.0, 12000.0, 500.0, 90.0, 0.0}};
    FigureEightPath eight{{-12.0 * deg, 77.0 * deg, 400.0}, 0.7, 1800.0, 900.0, 60.0, 90.0, 0.102};
    ShipPath ship{
        {54.0 * deg, -20.0 * deg, 12.0}, 2.2, 7.0, {0.1, 9.0, 0.1}, {0.04, 6.5, 1.0}, {0.02, 17.0, 2.0}, {1.5, 7.0, 0.5}};
    TablePath table{{48.0 * deg, 11.0 * deg, 500.0}, {0.1, -0.2, 1.0}, {}, 10.0};
    table.moves = {{{0.0, 0.0, 2.0}, 15.0, 5.0},
                   {{0.5, 0.3, -1.0}, 40.0, 10.0},
                   {{-2.0, 0.0, 0.0}, 90.0, 10.0},
                   {{0.0, 0.9, 6.0}, 200.0, 0.0}};
    RecordedPath recorded;  // an aircraft that climbs and weaves, as a receiver would have logged it
    for (int k = 0; k <= 400; ++k) {
        const double t = k;
        recorded.points.push_back(
            {t, {0.9 + 2e-5 * t, 1.0 + 3e-4 * std::sin(t / 60.0), 2000.0 + 2.0 * t}, Eigen::Vector3d::Constant(not_given)});
    }
    RecordedPath with_attitude = recorded;
    for (RecordedPoint& p : with_attitude.points) p.rpy = {0.1 * std::sin(p.time / 9.0), 0.05, 6.2 + 0.01 * p.time};
    const FlightPhase phase{{40.0 * deg, -3.0 * deg, 300.0}, 1.0, 120.0, 900.0, 20.0, 280.0};
    return {{"figure_eight", eight, 0.05, 1e-5},
            {"ship", ship, 0.05, 1e-5},
            {"table", table, 0.02, 3e-5},
            {"recorded", recorded, 0.05, 1e-5},
            {"recorded_attitude", with_attitude, 0.05, 1e-5},
            {"takeoff", takeoff_route(phase), 0.02, 3e-5},
            {"holding", holding_route(phase), 0.02, 3e-5},
            {"approach", approach_route(phase), 0.02, 3e-5},
            {"static", StaticPath{{-75.0 * deg, 100.0 * deg, 3000.0}, {0.3, -0.2, 4.0}}, 0.5, 1e-7},
            {"great_circle", GreatCirclePath{{50.0 * deg, 179.9 * deg, 8000.0}, 70.0 * deg, 240.0}, 0.5, 2e-7},
            {"paper_a", PaperAPath{}, 0.5, 2e-7},
            {"route", example_route(), 0.02, 3e-5},
            {"vibrating_route", vibrating, 0.004, 1e-3},
            {"aircraft_route", aircraft, 0.02, 3e-5}};
}

/// Rotation about the third axis, components of the rotated frame to the fixed one.
inline Eigen::Matrix3d about_z(double angle) {
    Eigen::Matrix3d R;
    R << std::cos(angle), -std::sin(angle), 0.0, std::sin(angle), std::cos(angle), 0.0, 0.0, 0.0, 1.0;
    return R;
}

inline Eigen::Vector3d ecef(const Geodetic& p) {
    double x, y, z;
    GeographicLib::Geocentric::WGS84().Forward(p.lat / deg, p.lon / deg, p.h, x, y, z);
    return {x, y, z};
}

/// North, east, down axes in Earth-fixed components.
inline Eigen::Matrix3d level_axes(const Geodetic& p) {
    const double sp = std::sin(p.lat), cp = std::cos(p.lat), sl = std::sin(p.lon), cl = std::cos(p.lon);
    Eigen::Matrix3d C;
    C.col(0) << -sp * cl, -sp * sl, cp;
    C.col(1) << -sl, cl, 0.0;
    C.col(2) << -cp * cl, -cp * sl, -sp;
    return C;
}

/// Body axes in local-level components from their meaning: turn by heading, then nose up by pitch, then right side down by roll.
inline Eigen::Matrix3d body_axes(const Eigen::Vector3d& rpy) {
    const Eigen::Matrix3d turn = about_z(rpy.z());
    Eigen::Matrix3d nose, bank;
    nose << std::cos(rpy.y()), 0.0, std::sin(rpy.y()), 0.0, 1.0, 0.0, -std::sin(rpy.y()), 0.0, std::cos(rpy.y());
    bank << 1.0, 0.0, 0.0, 0.0, std::cos(rpy.x()), -std::sin(rpy.x()), 0.0, std::sin(rpy.x()), std::cos(rpy.x());
    return turn * nose * bank;
}

/// First derivative of f at t: central differences of sixth order.
template <typename F>
auto slope(const F& f, double t, double h) {
    return ((45.0 * (f(t + h) - f(t - h)) - 9.0 * (f(t + 2 * h) - f(t - 2 * h)) + (f(t + 3 * h) - f(t - 3 * h))) / (60.0 * h))
        .eval();
}

/// Second derivative of f at t: central differences of fourth order.
template <typename F>
Eigen::Vector3d bend(const F& f, double t, double h) {
    const Eigen::Vector3d here = f(t);
    const Eigen::Vector3d near_pair = (f(t + h) - here) + (f(t - h) - here);
    const Eigen::Vector3d far_pair = (f(t + 2 * h) - here) + (f(t - 2 * h) - here);
    return (16.0 * near_pair - far_pair) / (12.0 * h * h);
}

}  // namespace schuler::sim::testing
