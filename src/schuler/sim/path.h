// Truth paths: position, velocity, acceleration, attitude and attitude rate as exact functions of time.
#pragma once

#include "schuler/core/nav_state.h"
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

namespace schuler::sim {

/// State of a truth path at one instant. Velocity is the exact derivative of position, and so on.
struct Kinematics {
    Geodetic position;         ///< of the IMU
    Eigen::Vector3d v_eb_n;    ///< m/s
    Eigen::Vector3d dv_eb_n;   ///< time derivative of the components of v_eb_n, m/s^2
    Eigen::Vector3d rpy;       ///< roll, pitch, heading [0, 2 pi), rad
    Eigen::Vector3d rpy_rate;  ///< rad/s
};

/// At rest on the Earth.
struct StaticPath {
    Geodetic start;
    Eigen::Vector3d rpy = Eigen::Vector3d::Zero();  ///< rad
};

/// The normal of the ellipsoid rotates at a constant rate in a plane (on a sphere: a great circle at constant speed), the height
/// is constant, the body is level and heads along the track. Must not pass a pole.
struct GreatCirclePath {
    Geodetic start;
    double heading = 0.0;  ///< at the start, rad
    double speed = 200.0;  ///< at the start, m/s; later it varies due to the flattening
};

/// One coordinate of paper A's flight: start + rate t + amplitude sin(2 pi t / period + phase).
struct Oscillation {
    double rate = 0.0;       ///< rad/s or m/s
    double amplitude = 0.0;  ///< rad or m
    double period = 600.0;   ///< s
    double phase = 0.0;      ///< rad
};

/// Paper A, (4.2.1) to (4.2.5), with its numbers as defaults. The paper writes the height as h0 - dh cos(w t + d): the phase here
/// is d - pi/2.
struct PaperAPath {
    Geodetic start{55.0 * units::deg, 30.0 * units::deg, 5000.0};  ///< phi0, lambda0, h0 (the mean height)
    Oscillation lat{0.0, 0.004, 600.0, 0.0};
    Oscillation lon{4e-5, 0.0, 600.0, 0.0};
    Oscillation height{0.0, 5000.0, 600.0, -90.0 * units::deg};
    double roll_per_accel = 0.02;  ///< K of (4.2.5), rad/(m/s^2); a coordinated turn has about 0.102
};

/// A corner of a route, in metres from the start of the path along its meridian and parallel.
struct Waypoint {
    double north = 0.0;   ///< m
    double east = 0.0;    ///< m
    double up = 0.0;      ///< m
    double speed = 14.0;  ///< limit on the leg that ends here, m/s
    double stop = 0.0;    ///< s at rest here (0: no stop)
};

/// Small motion of the body on its suspension while the vehicle moves. Roll and pitch oscillate a quarter period apart at the
/// same frequency (a coning motion), the height at 1.31 times that frequency.
struct Vibration {
    double frequency = 12.0;  ///< Hz
    double angle = 0.0;       ///< amplitude of roll and pitch, rad
    double accel = 0.0;       ///< amplitude of the vertical acceleration, m/s^2
};

/// Height above ground instead of the waypoints' heights.
struct Drape {
    std::function<double(double lat, double lon)> ground;  ///< height of the ground, m; rad
    double clearance = 300.0;                              ///< m, maintained everywhere
    double slope = 0.05;                                   ///< steepest climb and descent
    double smoothing = 600.0;                              ///< m over which slopes change
};

/// A wheeled vehicle (or an aircraft, by its coefficients) along waypoints: straight legs, rounded corners, speeds limited by the
/// lateral and longitudinal acceleration, stops. The x axis points along the velocity (except for dive and vibration). At rest
/// before the first and after the last waypoint; the first leg starts at `start`, which is not in the list.
struct RoutePath {
    Geodetic start;
    std::vector<Waypoint> waypoints;         ///< at least one
    double standstill = 30.0;                ///< s at rest at the start
    double corner_radius = 15.0;             ///< m
    double lateral_accel = 2.0;              ///< planned in corners (exceeded by up to a fifth due to smoothing), m/s^2
    double longitudinal_accel = 1.5;         ///< acceleration and braking, m/s^2
    double roll_per_lateral_accel = -0.005;  ///< rad/(m/s^2): cars roll outwards (negative), a coordinated turn has 0.102
    double pitch_per_accel = 0.003;          ///< rad/(m/s^2): nose up during acceleration
    Vibration vibration;
    double knot_spacing = 2.0;  ///< m between control points of the curve: extent of the smoothing of a bend
    double start_speed = 0.0;   ///< m/s; not zero: initially in motion, without a standstill
    std::optional<Drape> drape{};
};

/// A figure of eight about its crossing point `start`: Gerono's lemniscate, entered along its long axis, banked.
struct FigureEightPath {
    Geodetic start;
    double heading = 0.0;                    ///< of the long axis, rad
    double length = 2000.0, width = 1000.0;  ///< m
    double height_amplitude = 0.0;           ///< m, one loop above and one below the start
    double period = 120.0;                   ///< s of one figure
    double roll_per_lateral_accel = 0.102;   ///< rad/(m/s^2)
};

/// amplitude sin(2 pi t / period + phase).
struct Wave {
    double amplitude = 0.0;  ///< rad or m
    double period = 8.0;     ///< s
    double phase = 0.0;      ///< rad
};

/// A ship on a steady course in waves.
struct ShipPath {
    Geodetic start;
    double heading = 0.0;  ///< rad
    double speed = 6.0;    ///< m/s
    Wave roll{0.08, 9.0, 0.0}, pitch{0.03, 6.5, 1.0}, yaw{0.02, 17.0, 2.0}, heave{1.0, 7.0, 0.5};
};

/// A move of a turntable: every angle changes by its part, with a smooth start and stop of one second each.
struct TableMove {
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< of roll, pitch, heading, rad
    double duration = 10.0;                          ///< s
    double dwell = 0.0;                              ///< s at rest after it
};
struct TablePath {
    Geodetic start;
    Eigen::Vector3d rpy = Eigen::Vector3d::Zero();  ///< rad
    std::vector<TableMove> moves;                   ///< at least one
    double standstill = 30.0;                       ///< s before the first
};

/// A point of a recorded trajectory; NaN angles: not recorded.
struct RecordedPoint {
    double time;  ///< s
    Geodetic position;
    Eigen::Vector3d rpy;  ///< rad
};
/// A recording used as a path: a smooth path near its points (they are control values of a spline, resampled at `spacing`).
/// Without recorded attitude the body points along its motion and banks.
struct RecordedPath {
    std::vector<RecordedPoint> points;      ///< in time order
    double spacing = 1.0;                   ///< s
    double roll_per_lateral_accel = 0.102;  ///< rad/(m/s^2), if no attitude is recorded
};

using PathSettings =
    std::variant<StaticPath, GreatCirclePath, PaperAPath, RoutePath, FigureEightPath, ShipPath, TablePath, RecordedPath>;

/// An analytic motion. Immutable: any number of threads may read it.
class TruthPath {
public:
    TruthPath() = default;
    TruthPath(const TruthPath&) = delete;
    TruthPath& operator=(const TruthPath&) = delete;
    virtual ~TruthPath() = default;

    /// At t seconds from the start, t >= 0.
    [[nodiscard]] virtual Kinematics at(double t) const = 0;
};

/// Builds a path on an ellipsoid. Throws Error(Input) that names the invalid setting.
[[nodiscard]] std::unique_ptr<const TruthPath> make_path(const PathSettings& settings, const earth::Ellipsoid& ellipsoid);

/// Throws Error(Input), key "trajectory", if the path passes below `ground` (m) within `duration` seconds; checked every second.
void require_above_ground(const TruthPath& path, double duration, double ground);

/// A town drive of about `duration` seconds: blocks of 80 to 400 m, right-angled and oblique corners, hills, stops at lights.
/// The same seed gives the same route.
[[nodiscard]] RoutePath town_route(const Geodetic& start, double duration, std::uint64_t seed);

/// A phase of an airliner's flight.
struct FlightPhase {
    Geodetic start;                ///< initial position
    double heading = 0.0;          ///< rad, initial
    double speed = 130.0;          ///< m/s: reached after take-off, constant in a holding pattern, initial in an approach
    double height_change = 900.0;  ///< m, climbed after take-off or descended in an approach
    double standstill = 30.0;      ///< s before take-off
    double duration = 600.0;       ///< s, minimum duration of the phase
};
/// Take-off run, climb with a turn of 45 degrees, level flight.
[[nodiscard]] RoutePath takeoff_route(const FlightPhase& phase);
/// Right-hand racetracks: legs of a minute, turns at three degrees per second.
[[nodiscard]] RoutePath holding_route(const FlightPhase& phase);
/// Downwind leg, base leg, glide path of three degrees, landing run to rest.
[[nodiscard]] RoutePath approach_route(const FlightPhase& phase);

/// The truth as a navigation state.
[[nodiscard]] NavState nav_state(const Kinematics& kinematics, Time time);

}  // namespace schuler::sim
