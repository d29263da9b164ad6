#include "schuler/sim/exact_flight.h"

#include "schuler/core/error.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

namespace schuler::sim {
namespace {

constexpr double most_bytes = 100e6;

// Equality of the settings of paths. The bindings name every member, so that a new one does not compile before it is compared.
bool same(const Geodetic& a, const Geodetic& b) {
    const auto& [lat, lon, h] = a;
    return lat == b.lat && lon == b.lon && h == b.h;
}
bool same(const StaticPath& a, const StaticPath& b) {
    const auto& [start, rpy] = a;
    return same(start, b.start) && rpy == b.rpy;
}
bool same(const GreatCirclePath& a, const GreatCirclePath& b) {
    const auto& [start, heading, speed] = a;
    return same(start, b.start) && heading == b.heading && speed == b.speed;
}
bool same(const Oscillation& a, const Oscillation& b) {
    const auto& [rate, amplitude, period, phase] = a;
    return rate == b.rate && amplitude == b.amplitude && period == b.period && phase == b.phase;
}
bool same(const PaperAPath& a, const PaperAPath& b) {
    const auto& [start, lat, lon, height, roll] = a;
    return same(start, b.start) && same(lat, b.lat) && same(lon, b.lon) && same(height, b.height) && roll == b.roll_per_accel;
}
bool same(const Waypoint& a, const Waypoint& b) {
    const auto& [north, east, up, speed, stop] = a;
    return north == b.north && east == b.east && up == b.up && speed == b.speed && stop == b.stop;
}
bool same(const Vibration& a, const Vibration& b) {
    const auto& [frequency, angle, accel] = a;
    return frequency == b.frequency && angle == b.angle && accel == b.accel;
}
bool same(const TableMove& a, const TableMove& b) {
    const auto& [turn, duration, dwell] = a;
    return turn == b.turn && duration == b.duration && dwell == b.dwell;
}
bool same(const RecordedPoint& a, const RecordedPoint& b) {  // angles that were not recorded are NaN: then it is computed again
    const auto& [time, position, rpy] = a;
    return time == b.time && same(position, b.position) && rpy == b.rpy;
}
template <class T>
bool same_list(const std::vector<T>& a, const std::vector<T>& b) {
    return std::ranges::equal(a, b, [](const T& x, const T& y) { return same(x, y); });
}
bool same(const RoutePath& a, const RoutePath& b) {
    const auto& [start, waypoints, standstill, radius, lateral, longitudinal, roll, pitch, vibration, spacing, speed, drape] = a;
    if (drape || b.drape) return false;  // a ground given as a function cannot be compared
    return same(start, b.start) && same_list(waypoints, b.waypoints) && standstill == b.standstill && radius == b.corner_radius &&
           lateral == b.lateral_accel && longitudinal == b.longitudinal_accel && roll == b.roll_per_lateral_accel &&
           pitch == b.pitch_per_accel && same(vibration, b.vibration) && spacing == b.knot_spacing && speed == b.start_speed;
}
bool same(const FigureEightPath& a, const FigureEightPath& b) {
    const auto& [start, heading, length, width, height, period, roll] = a;
    return same(start, b.start) && heading == b.heading && length == b.length && width == b.width &&
           height == b.height_amplitude && period == b.period && roll == b.roll_per_lateral_accel;
}
bool same(const Wave& a, const Wave& b) {
    const auto& [amplitude, period, phase] = a;
    return amplitude == b.amplitude && period == b.period && phase == b.phase;
}
bool same(const ShipPath& a, const ShipPath& b) {
    const auto& [start, heading, speed, roll, pitch, yaw, heave] = a;
    return same(start, b.start) && heading == b.heading && speed == b.speed && same(roll, b.roll) && same(pitch, b.pitch) &&
           same(yaw, b.yaw) && same(heave, b.heave);
}
bool same(const TablePath& a, const TablePath& b) {
    const auto& [start, rpy, moves, standstill] = a;
    return same(start, b.start) && rpy == b.rpy && same_list(moves, b.moves) && standstill == b.standstill;
}
bool same(const RecordedPath& a, const RecordedPath& b) {
    const auto& [points, spacing, roll] = a;
    return same_list(points, b.points) && spacing == b.spacing && roll == b.roll_per_lateral_accel;
}
bool same(const PathSettings& a, const PathSettings& b) {
    if (a.index() != b.index()) return false;
    return std::visit([&](const auto& path) { return same(path, std::get<std::decay_t<decltype(path)>>(b)); }, a);
}
bool same(const earth::Earth& a, const earth::Earth& b) {
    const auto& [ellipsoid, gravity] = a;
    const auto& [axis, flattening, gm, rotation] = ellipsoid;
    const earth::Ellipsoid& e = b.ellipsoid;
    return axis == e.a && flattening == e.f && gm == e.gm && rotation == e.w_ie && gravity == b.gravity;
}

}  // namespace

std::size_t imu_samples(const Scenario& s) { return static_cast<std::size_t>(std::floor(s.duration * s.imu.rate + 1e-6)); }

std::size_t reference_epochs(const Scenario& s) {
    return static_cast<std::size_t>(std::floor(s.duration * s.reference_rate + 1e-6)) + 1;
}

ExactFlight::ExactFlight(const Scenario& s)
    : path_(s.path), earth_(s.earth), duration_(s.duration), rate_(s.imu.rate), reference_rate_(s.reference_rate) {
    const std::unique_ptr<const TruthPath> path = make_path(s.path, s.earth.ellipsoid);
    const std::size_t samples = imu_samples(s), epochs = reference_epochs(s);
    increments_.reserve(samples);
    for (std::size_t k = 1; k <= samples; ++k)
        increments_.push_back(
            exact_increment(s.earth, *path, static_cast<double>(k - 1) / s.imu.rate, static_cast<double>(k) / s.imu.rate));
    reference_.reserve(epochs);
    for (std::size_t k = 0; k < epochs; ++k) reference_.push_back(path->at(static_cast<double>(k) / s.reference_rate));
}

bool ExactFlight::is_of(const Scenario& s) const {
    return s.duration == duration_ && s.imu.rate == rate_ && s.reference_rate == reference_rate_ && same(s.earth, earth_) &&
           same(s.path, path_);
}

std::shared_ptr<const ExactFlight> exact_flight(const Scenario& s) {
    const double bytes = s.duration * (s.imu.rate * sizeof(ExactIncrement) + s.reference_rate * sizeof(Kinematics));
    if (!(bytes <= most_bytes && s.duration > 0.0 && s.imu.rate > 0.0 && s.reference_rate > 0.0)) return nullptr;
    try {
        return std::make_shared<const ExactFlight>(s);
    } catch (const Error&) {
        return nullptr;
    }
}

}  // namespace schuler::sim
