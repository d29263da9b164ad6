// A recorded trajectory as a path: smooth, exact, near the recording.
#include "schuler/core/error.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/path_kinds.h"
#include "schuler/sim/uniform_spline.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace schuler::sim {

namespace {

/// Six channels at equal intervals: latitude, longitude, height (from the first point), roll, pitch, heading.
using Channels = std::array<std::vector<double>, 6>;

void check(const RecordedPath& s) {
    const auto fail = [](std::string what, const char* key, const char* hint) {
        return input_error(std::move(what), {.file = {}, .line = 0, .column = 0, .key = key}, hint);
    };
    if (s.points.size() < 2)
        throw fail("the recorded trajectory has fewer than two points", "trajectory.file", "give another file");
    if (!(std::isfinite(s.spacing) && s.spacing > 0.0))
        throw fail("is not a time", "trajectory.smoothing_s", "give the seconds between the points kept");
    for (std::size_t i = 0; i < s.points.size(); ++i) {
        const RecordedPoint& p = s.points[i];
        if (!std::isfinite(p.time + p.position.lat + p.position.lon + p.position.h))
            throw fail(fmt::format("point {} of the recorded trajectory is not a number", i + 1), "trajectory.file",
                       "leave it out");
        if (i > 0 && !(p.time > s.points[i - 1].time))
            throw fail(fmt::format("point {} of the recorded trajectory is not later than the one before", i + 1),
                       "trajectory.file", "sort it by time");
    }
    if (s.points.back().time - s.points.front().time < 8.0 * s.spacing)
        throw fail(fmt::format("the recorded trajectory lasts {:.3g} s", s.points.back().time - s.points.front().time),
                   "trajectory.file", "give a longer one, or a smaller trajectory.smoothing_s");
}

/// The angle nearest to `before` among those that differ by whole turns.
double unwrapped(double angle, double before) { return before + math::wrap_pi(angle - before); }

/// The points at equal intervals, interpolated linearly between the recorded ones.
Channels gridded(const RecordedPath& s) {
    Channels out;
    const RecordedPoint& first = s.points.front();
    const double span = s.points.back().time - first.time;
    const auto count = static_cast<std::size_t>(std::floor(span / s.spacing + 1e-9)) + 1;
    std::vector<double> heading{first.rpy.z()};
    for (std::size_t i = 1; i < s.points.size(); ++i) heading.push_back(unwrapped(s.points[i].rpy.z(), heading.back()));
    std::size_t i = 1;
    for (std::size_t k = 0; k < count; ++k) {
        const double t = first.time + static_cast<double>(k) * s.spacing;
        while (i + 1 < s.points.size() && s.points[i].time < t) ++i;
        const RecordedPoint &a = s.points[i - 1], &b = s.points[i];
        const double part = std::clamp((t - a.time) / (b.time - a.time), 0.0, 1.0);
        const auto between = [part](double x, double y) { return x + part * (y - x); };
        out[0].push_back(between(a.position.lat, b.position.lat) - first.position.lat);
        const double lon_a = math::wrap_pi(a.position.lon - first.position.lon);
        out[1].push_back(between(lon_a, lon_a + math::wrap_pi(b.position.lon - a.position.lon)));
        out[2].push_back(between(a.position.h, b.position.h) - first.position.h);
        out[3].push_back(between(a.rpy.x(), b.rpy.x()));
        out[4].push_back(between(a.rpy.y(), b.rpy.y()));
        out[5].push_back(between(heading[i - 1], heading[i]));
    }
    return out;
}

/// Attitude of a body that moves along its x axis, banked in turns, if not in the recording.
void add_attitude(Channels& c, const RecordedPath& s, const earth::Ellipsoid& ellipsoid) {
    constexpr double least_move = 0.5;  // m between two points, below which the course is unknown
    double course = 0.0;
    bool known = false;
    for (std::size_t k = 0; k < c[0].size(); ++k) {
        const std::size_t a = k > 0 ? k - 1 : k, b = std::min(k + 1, c[0].size() - 1);
        const double span = static_cast<double>(b - a) * s.spacing;
        const earth::Radii r = earth::radii(ellipsoid, s.points.front().position.lat + c[0][k]);
        const double north = (c[0][b] - c[0][a]) * r.meridian;
        const double east = (c[1][b] - c[1][a]) * r.prime_vertical * std::cos(s.points.front().position.lat + c[0][k]);
        const double level = std::hypot(north, east), before = course;
        const bool moves = level > least_move;
        if (moves) course = known ? unwrapped(std::atan2(east, north), course) : std::atan2(east, north);
        c[5][k] = course;
        c[4][k] = moves ? std::atan2(c[2][b] - c[2][a], level) : 0.0;
        c[3][k] = moves && known ? s.roll_per_lateral_accel * level / span * (course - before) / s.spacing : 0.0;
        if (moves && !known) std::fill(c[5].begin(), c[5].begin() + static_cast<std::ptrdiff_t>(k), course);
        known = known || moves;
    }
}

/// Additional spline points beyond either end.
constexpr int margin = 3;

/// Linear continuation beyond both ends: a recording that starts or ends in motion does so without a jerk.
std::vector<double> continued(const std::vector<double>& c) {
    std::vector<double> out;
    out.reserve(c.size() + 2 * margin);
    for (int k = margin; k > 0; --k) out.push_back(c[0] + k * (c[0] - c[1]));
    out.insert(out.end(), c.begin(), c.end());
    const double last = c.back(), step = last - c[c.size() - 2];
    for (int k = 1; k <= margin; ++k) out.push_back(last + k * step);
    return out;
}

class Recorded final : public TruthPath {
public:
    Recorded(const RecordedPath& s, const earth::Ellipsoid& ellipsoid)
        : ellipsoid_(ellipsoid), start_(s.points.front().position), lead_(margin * s.spacing) {
        Channels channels = gridded(s);
        if (!std::ranges::all_of(s.points, [](const RecordedPoint& p) { return p.rpy.allFinite(); }))
            add_attitude(channels, s, ellipsoid);
        for (const std::vector<double>& c : channels) splines_.emplace_back(s.spacing, continued(c));
    }
    Kinematics at(double since_first) const override {
        const double t = since_first + lead_;
        const GeodeticJet<3> p{start_.lat + splines_[0].at(t).to<3>(), start_.lon + splines_[1].at(t).to<3>(),
                               start_.h + splines_[2].at(t).to<3>()};
        const VelocityJet<2> v = velocity(ellipsoid_, p);
        return kinematics({p.lat.to<1>(), p.lon.to<1>(), p.h.to<1>()}, {v.north.to<1>(), v.east.to<1>(), v.up.to<1>()},
                          {splines_[3].at(t).to<1>(), splines_[4].at(t).to<1>(), splines_[5].at(t).to<1>()});
    }

private:
    earth::Ellipsoid ellipsoid_;
    Geodetic start_;
    double lead_;
    std::vector<UniformSpline> splines_;
};

}  // namespace

std::unique_ptr<const TruthPath> make_motion(const RecordedPath& s, const earth::Ellipsoid& ellipsoid) {
    check(s);
    return std::make_unique<Recorded>(s, ellipsoid);
}

}  // namespace schuler::sim
