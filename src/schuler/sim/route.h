// A vehicle along waypoints: a smooth curve, a smooth motion along it, and the resulting attitude.
#pragma once

#include "schuler/sim/path_kinds.h"
#include "schuler/sim/uniform_spline.h"

#include <vector>

namespace schuler::sim {

/// Equidistant control values of the curve (north, east, up over the length u) and of the motion (u over time).
struct RoutePlan {
    double length_spacing;                ///< m
    std::vector<double> north, east, up;  ///< m, at u = -3, -2, ... spacings: see lead
    double time_spacing;                  ///< s
    std::vector<double> length;           ///< m, at t = 0, 1, ... spacings
    static constexpr int lead = 3;        ///< knots before the start, so that the start itself is on a straight line
    double lead_time = 0.0;               ///< s of `length` before the start, if that is not at rest
};

/// Rounds the corners and plans speeds and stops. Throws Error(Input) that names a waypoint that cannot be reached.
[[nodiscard]] RoutePlan plan_route(const RoutePath& settings);

/// Heights of the plan over the ground: never below the clearance, never steeper than the slope, smoothed as set.
void drape(RoutePlan& plan, const Drape& settings, const LocalChart& chart);

/// The path of a plan. It is smooth because the plan's values are control values of quintic splines; position is the curve at the
/// current length, and velocity and higher derivatives follow by differentiation.
class Route final : public TruthPath {
public:
    Route(const RoutePath& settings, const earth::Ellipsoid& ellipsoid);
    [[nodiscard]] Kinematics at(double t) const override;

private:
    Route(const RoutePath& settings, const earth::Ellipsoid& ellipsoid, const RoutePlan& plan);

    RoutePath s_;
    earth::Ellipsoid ellipsoid_;
    LocalChart chart_;
    double lead_, lead_time_;
    UniformSpline north_, east_, up_, length_;
};

}  // namespace schuler::sim
