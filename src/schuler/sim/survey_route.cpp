#include "schuler/sim/survey_route.h"

#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/sim/detail/require.h"

#include <algorithm>
#include <cmath>

namespace schuler::sim {

namespace {

using Eigen::Vector2d;

constexpr double roll_per_lateral_accel = 0.102;  // a coordinated turn, rad/(m/s^2)
constexpr double smoothing_margin = 1.25;         // the smoothed curve exceeds the planned acceleration by up to a fifth
constexpr double slowest_turn = 20.0;             // s to travel one radius: a limit for ships, independent of bank
constexpr double leg_per_tangent = 2.3;           // a route permits a corner at most 0.45 of a leg

using detail::require;

void check(const SurveyPattern& p) {
    const auto positive = [](double x) { return std::isfinite(x) && x > 0.0; };
    require(positive(p.speed), "trajectory.speed_m_s", "is not positive", "give metres a second");
    require(std::isfinite(p.heading), "trajectory.heading_deg", "is not a number", "give degrees");
    require(p.lines >= 1 && p.lines <= 1000, "trajectory.survey.lines", "is not a valid number of lines", "give 1 to 1000");
    require(p.ties >= 0 && p.ties <= 1000, "trajectory.survey.ties", "is not a valid number of tie lines", "give 0 to 1000");
    require(positive(p.length), "trajectory.survey.length_m", "is not a length", "give metres");
    require(positive(p.spacing), "trajectory.survey.spacing_m", "is not a spacing", "give metres");
    require(std::isfinite(p.overrun) && p.overrun >= 0.0, "trajectory.survey.overrun_m", "is not a length", "give metres");
    require(positive(p.bank) && p.bank <= 1.05, "trajectory.survey.bank_deg", "is not a valid bank angle",
            "give 1 to 60 degrees");
    require(std::isfinite(p.standstill) && p.standstill >= 0.0, "trajectory.standstill_s", "is not a duration", "give seconds");
}

/// Places corners in axes along the first line (x) and to the right of it (y), relative to the start of its run-in.
class Course {
public:
    Course(RoutePath& route, const SurveyPattern& p, double radius, double overrun)
        : route_(route),
          speed_(p.speed),
          radius_(radius),
          overrun_(overrun),
          c_(std::cos(p.heading)),
          s_(std::sin(p.heading)),
          at_(-overrun, 0.0) {}

    void to(const Vector2d& p) {
        longest_ += (p - at_).norm();
        at_ = p;
        const double x = p.x() + overrun_;
        route_.waypoints.push_back({c_ * x - s_ * p.y(), s_ * x + c_ * p.y(), 0.0, speed_, 0.0});
    }
    /// From the end of a line along `ahead` to the next one, `apart` metres towards `side`, in the opposite direction.
    void turn(const Vector2d& end, const Vector2d& ahead, const Vector2d& side, double apart) {
        if (apart >= leg_per_tangent * radius_) {
            const Vector2d corner = end + (overrun_ + radius_) * ahead;
            to(corner);
            to(corner + apart * side);
            return;
        }
        // Thirty degrees away from the next line, then around: the legs have the length required by the corners of 120 degrees.
        const double away = 30.0 * units::deg, leg = leg_per_tangent * radius_ * std::tan(60.0 * units::deg);
        const Vector2d corner = end + (overrun_ + radius_ * std::tan(0.5 * away)) * ahead;
        const Vector2d outer = corner + leg * std::cos(away) * ahead, aside = leg * std::sin(away) * side;
        to(corner);
        to(outer - aside);
        to(outer + apart * side + aside);
        to(corner + apart * side);
    }
    /// The length of the polygon: larger than that of the rounded course.
    [[nodiscard]] double longest() const { return longest_; }
    /// Upper limit of the reduction by rounding.
    [[nodiscard]] double cut() const { return 1.4 * radius_ * static_cast<double>(route_.waypoints.size()); }

private:
    RoutePath& route_;
    double speed_, radius_, overrun_, c_, s_;
    Vector2d at_;
    double longest_ = 0.0;
};

}  // namespace

RoutePath survey_route(const SurveyPattern& p) {
    check(p);
    RoutePath route;
    route.start = p.start;
    route.standstill = p.standstill;
    route.start_speed = p.standstill > 0.0 ? 0.0 : p.speed;
    const double radius =
        std::max(smoothing_margin * roll_per_lateral_accel * p.speed * p.speed / p.bank, slowest_turn * p.speed);
    route.corner_radius = radius;
    route.knot_spacing = std::clamp(radius / 30.0, 0.5, 50.0);
    route.lateral_accel = smoothing_margin * p.speed * p.speed / radius;  // turns do not reduce the speed
    route.longitudinal_accel = 1.0;
    route.roll_per_lateral_accel = roll_per_lateral_accel;
    route.pitch_per_accel = 0.0;

    const double overrun = std::max(p.overrun, 0.15 * radius), width = p.spacing * (p.lines - 1);
    const Vector2d x(1.0, 0.0), y(0.0, 1.0);
    Course course(route, p, radius, overrun);
    Vector2d end, ahead;
    for (int i = 0; i < p.lines; ++i) {
        ahead = i % 2 == 0 ? x : Vector2d(-x);
        end = {i % 2 == 0 ? p.length : 0.0, p.spacing * i};
        if (i + 1 < p.lines) course.turn(end, ahead, y, p.spacing);
    }
    if (p.ties > 0) {
        // Around the far corner of the area to the nearest tie line.
        const double between = p.length / p.ties, least = leg_per_tangent * radius;
        const double out = std::max(overrun + radius, least - 0.5 * between), over = std::max(overrun + radius, least);
        const Vector2d back = -ahead;
        course.to(end + out * ahead);
        course.to(end + out * ahead + over * y);
        end += 0.5 * between * back;
        course.to(end + over * y);
        for (int j = 0; j < p.ties; ++j) {
            ahead = j % 2 == 0 ? Vector2d(-y) : y;
            end += width * ahead;
            if (j + 1 == p.ties) break;
            course.turn(end, ahead, back, between);
            end += between * back;
        }
    }
    course.to(end + (overrun + radius + std::max(0.0, p.duration * p.speed - course.longest() + course.cut())) * ahead);
    return route;
}

}  // namespace schuler::sim
