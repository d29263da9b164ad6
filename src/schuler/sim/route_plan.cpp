#include "schuler/core/error.h"
#include "schuler/sim/route.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace schuler::sim {

namespace {

constexpr double spacing_t = 0.5;       // s between control values of the motion
constexpr double tangent_share = 0.45;  // largest fraction of a leg used for the rounding of one corner

using Eigen::Vector2d;

Error key_error(std::string key, std::string what, const char* hint) {
    return input_error(std::move(what), {.file = {}, .line = 0, .column = 0, .key = std::move(key)}, hint);
}

Error waypoint_error(std::size_t index, std::string what, const char* hint) {
    return key_error(fmt::format("trajectory.waypoints[{}]", index), std::move(what), hint);
}

/// A point on the rounded polyline.
struct RoadPoint {
    Vector2d at;
    double up, curvature, speed;
};

/// A piece of the rounded polyline: a straight line or an arc, length metres long.
struct Piece {
    Vector2d from, direction;  ///< at its start
    double length, curvature;  ///< 1/m, positive to the right
    double up_from, up_to, speed;
    double stop;  ///< s at rest at its middle (arcs, which may have no length)

    [[nodiscard]] RoadPoint at(double s) const {
        const double angle = curvature * s;
        const Vector2d right(-direction.y(), direction.x());  // north-east components rotated clockwise seen from above
        const Vector2d moved = curvature == 0.0
                                   ? Vector2d(s * direction)
                                   : Vector2d((std::sin(angle) * direction + (1.0 - std::cos(angle)) * right) / curvature);
        const double part = length > 0.0 ? s / length : 0.0;
        return {from + moved, up_from + part * (up_to - up_from), curvature, speed};
    }
};

void check(const RoutePath& s) {
    const auto positive = [](double value, const char* key) {
        if (!(std::isfinite(value) && value > 0.0)) throw key_error(key, "is not a positive number", "give a positive number");
    };
    positive(s.corner_radius, "trajectory.corner_radius_m");
    positive(s.lateral_accel, "trajectory.lateral_accel_m_s2");
    positive(s.longitudinal_accel, "trajectory.longitudinal_accel_m_s2");
    positive(s.knot_spacing, "trajectory.knot_spacing_m");
    if (!(std::isfinite(s.standstill) && s.standstill >= 0.0)) {
        throw key_error("trajectory.standstill_s", "is not a duration", "give seconds");
    }
    if (!(std::isfinite(s.start_speed) && s.start_speed >= 0.0))
        throw key_error("trajectory.start_speed_m_s", "is not a speed", "give metres a second");
    if (s.start_speed > 0.0 && s.standstill > 0.0)
        throw key_error("trajectory.start_speed_m_s", "contradicts a standstill at the start", "leave out one of them");
    if (s.waypoints.empty()) throw key_error("trajectory.waypoints", "no waypoints", "give at least one");
    for (std::size_t i = 0; i < s.waypoints.size(); ++i) {
        const Waypoint& w = s.waypoints[i];
        if (!std::isfinite(w.north + w.east + w.up)) throw waypoint_error(i, "is not a number", "give metres north, east and up");
        if (!(std::isfinite(w.speed) && w.speed > 0.0)) throw waypoint_error(i, "has no positive speed", "give metres a second");
        if (!(std::isfinite(w.stop) && w.stop >= 0.0)) throw waypoint_error(i, "has a negative stop", "give seconds");
    }
}

std::vector<Piece> rounded(const RoutePath& s) {
    std::vector<Piece> pieces;
    Vector2d corner = Vector2d::Zero();
    double corner_up = 0.0, used = 0.0;  // metres of the current leg already used by the previous corner
    for (std::size_t i = 0; i < s.waypoints.size(); ++i) {
        const Waypoint& w = s.waypoints[i];
        const Vector2d leg = Vector2d(w.north, w.east) - corner;
        const double length = leg.norm();
        constexpr double rounding = 1e-9;
        if (length < (1.0 - rounding) * 10.0 * s.knot_spacing)
            throw waypoint_error(i, fmt::format("is less than {:g} m from the one before", 10.0 * s.knot_spacing),
                                 "leave it out");
        const Vector2d direction = leg / length;
        double radius = 0.0, turn = 0.0, tangent = 0.0;
        if (i + 1 < s.waypoints.size()) {
            const Vector2d next = Vector2d(s.waypoints[i + 1].north, s.waypoints[i + 1].east) - Vector2d(w.north, w.east);
            turn = std::atan2(direction.x() * next.y() - direction.y() * next.x(), direction.dot(next));
            if (std::abs(turn) > 2.8) throw waypoint_error(i, "requires a turn sharper than 160 deg", "make it two corners");
            const double slope = std::tan(0.5 * std::abs(turn));
            tangent = std::min(s.corner_radius * slope, tangent_share * std::min(length, next.norm()));
            radius = slope > 1e-9 ? tangent / slope : 0.0;
            if (radius > 0.0 && radius < 3.0) throw waypoint_error(i, "leaves a corner radius below 3 m", "lengthen the legs");
        }
        const double straight = length - used - tangent;
        pieces.push_back({corner + used * direction, direction, straight, 0.0, corner_up, w.up, w.speed, 0.0});
        const double curvature = radius > 0.0 ? (turn > 0.0 ? 1.0 : -1.0) / radius : 0.0;
        const double stop = i + 1 < s.waypoints.size() ? w.stop : 0.0;
        pieces.push_back(
            {corner + (length - tangent) * direction, direction, radius * std::abs(turn), curvature, w.up, w.up, w.speed, stop});
        corner = {w.north, w.east};
        corner_up = w.up;
        used = tangent;
    }
    return pieces;
}

/// The road sampled at equal lengths, with a straight segment before the start and after the end, and the stops.
struct Road {
    std::vector<RoadPoint> points;                      ///< spacing_u apart, the first at u = 0
    std::vector<std::pair<std::size_t, double>> stops;  ///< index of a point, seconds
};

Road sampled(const std::vector<Piece>& pieces, double spacing_u) {
    Road road;
    double behind = 0.0;  // length of the completed pieces
    std::size_t k = 0;
    for (const Piece& piece : pieces) {
        for (; static_cast<double>(k) * spacing_u < behind + piece.length; ++k) {
            road.points.push_back(piece.at(static_cast<double>(k) * spacing_u - behind));
        }
        if (piece.stop > 0.0) {
            const auto middle = static_cast<std::size_t>(std::lround((behind + 0.5 * piece.length) / spacing_u));
            road.stops.emplace_back(middle, piece.stop);
        }
        behind += piece.length;
    }
    return road;
}

/// Speed at each point: limits of leg and corner, then the limits of braking and acceleration.
std::vector<double> speeds(const Road& road, const RoutePath& s) {
    std::vector<double> v;
    for (const RoadPoint& p : road.points) {
        const double corner = p.curvature != 0.0 ? std::sqrt(s.lateral_accel / std::abs(p.curvature)) : p.speed;
        v.push_back(std::min(p.speed, corner));
    }
    v.front() = std::min(s.start_speed, v.front());
    v.back() = 0.0;
    for (const auto& [index, seconds] : road.stops) v[index] = 0.0;
    const double gain = 2.0 * s.longitudinal_accel * s.knot_spacing;
    for (std::size_t i = 1; i < v.size(); ++i) v[i] = std::min(v[i], std::sqrt(v[i - 1] * v[i - 1] + gain));
    for (std::size_t i = v.size() - 1; i-- > 0;) v[i] = std::min(v[i], std::sqrt(v[i + 1] * v[i + 1] + gain));
    return v;
}

/// Three knots, if the path does not start at rest.
double lead_time_of(const RoutePath& s) { return s.start_speed > 0.0 ? RoutePlan::lead * spacing_t : 0.0; }

/// Distance travelled at equidistant times, with constant acceleration between points.
std::vector<double> motion(const Road& road, const std::vector<double>& v, const RoutePath& s) {
    // The spline spreads each value over three knots to either side: a standstill needs six more knots for its duration.
    constexpr double spread = 6.0 * spacing_t;
    std::vector<double> length;
    const double spacing_u = s.knot_spacing;
    // In motion from the start on: with the same speed before it.
    for (double before = lead_time_of(s); before > 0.0; before -= spacing_t) length.push_back(-before * v.front());
    const auto knot_time = [&] { return static_cast<double>(length.size()) * spacing_t - lead_time_of(s); };
    double t = s.standstill > 0.0 ? s.standstill + spread : 0.0;
    const auto hold_until = [&](double time, double at) {
        while (knot_time() < time) length.push_back(at);
    };
    hold_until(t, 0.0);
    auto stop = road.stops.begin();
    for (std::size_t i = 0; i + 1 < v.size(); ++i) {
        const double u = static_cast<double>(i) * spacing_u;
        if (stop != road.stops.end() && stop->first == i) {
            t += stop->second + spread;
            hold_until(t, u);
            ++stop;
        }
        const double accel = (v[i + 1] * v[i + 1] - v[i] * v[i]) / (2.0 * spacing_u);
        const double step = 2.0 * spacing_u / (v[i] + v[i + 1]);
        for (double knot; (knot = knot_time()) < t + step;) {
            const double since = knot - t;
            length.push_back(u + v[i] * since + 0.5 * accel * since * since);
        }
        t += step;
    }
    const double end = static_cast<double>(v.size() - 1) * spacing_u;
    length.insert(length.end(), 6, end);
    return length;
}

}  // namespace

RoutePlan plan_route(const RoutePath& settings) {
    check(settings);
    const std::vector<Piece> pieces = rounded(settings);
    const Road road = sampled(pieces, settings.knot_spacing);
    RoutePlan plan{settings.knot_spacing, {}, {}, {}, spacing_t, motion(road, speeds(road, settings), settings),
                   lead_time_of(settings)};
    const auto add = [&plan](const Vector2d& at, double up) {
        plan.north.push_back(at.x());
        plan.east.push_back(at.y());
        plan.up.push_back(up);
    };
    const RoadPoint& first = road.points.front();
    const RoadPoint& second = road.points[1];
    for (int k = RoutePlan::lead; k > 0; --k) {
        add(first.at - k * (second.at - first.at), first.up - k * (second.up - first.up));
    }
    for (const RoadPoint& p : road.points) add(p.at, p.up);
    const RoadPoint& last = road.points.back();
    const RoadPoint& before = road.points[road.points.size() - 2];
    for (int k = 1; k <= RoutePlan::lead; ++k) add(last.at + k * (last.at - before.at), last.up + k * (last.up - before.up));
    return plan;
}

}  // namespace schuler::sim
