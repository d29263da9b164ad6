#include "schuler/sim/path.h"

#include "schuler/core/error.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/detail/require.h"
#include "schuler/sim/path_kinds.h"
#include "schuler/sim/route.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace schuler::sim {

namespace {

using detail::require;

void require_start(const Geodetic& start) {
    require(std::isfinite(start.lat) && std::isfinite(start.lon) && std::isfinite(start.h), "trajectory.start",
            "the start is not a number", "give latitude, longitude and height");
    require(std::abs(start.lat) < 1.5533, "trajectory.start.lat_deg", "the start is within a degree of a pole",
            "paths are described in latitude and longitude: stay below 89 deg");
}

class AtRest final : public TruthPath {
public:
    explicit AtRest(const StaticPath& settings) {
        require_start(settings.start);
        require(settings.rpy.allFinite(), "trajectory", "the attitude is not a number", "give roll, pitch and heading");
        rest_ = {settings.start, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), settings.rpy, Eigen::Vector3d::Zero()};
        rest_.rpy.z() = math::wrap_2pi(rest_.rpy.z());
    }
    Kinematics at(double) const override { return rest_; }

private:
    Kinematics rest_;
};

class GreatCircle final : public TruthPath {
public:
    GreatCircle(const GreatCirclePath& s, const earth::Ellipsoid& ellipsoid) : ellipsoid_(ellipsoid), h_(s.start.h) {
        require_start(s.start);
        require(std::isfinite(s.heading), "trajectory.heading_deg", "the heading is not a number", "give a number");
        require(std::isfinite(s.speed) && s.speed > 0.0, "trajectory.speed_m_s", "the speed is not positive",
                "use type = \"static\" for a body at rest");
        const Eigen::Matrix3d C_en = earth::C_en(s.start.lat, s.start.lon);
        // Rotation of the normal for the desired speed at the start: v_N = (R_M + h) times its north component, v_E likewise.
        const earth::Radii r = earth::radii(ellipsoid, s.start.lat);
        const Eigen::Vector3d turn(s.speed * std::cos(s.heading) / (r.meridian + h_),
                                   s.speed * std::sin(s.heading) / (r.prime_vertical + h_), 0.0);
        rate_ = turn.norm();
        normal_ = -C_en.col(2);
        tangent_ = C_en * turn.normalized();
        const double highest = std::acos(std::abs(normal_.cross(tangent_).z()));
        require(highest < 1.5533, "trajectory.heading_deg", "the great circle passes within a degree of a pole",
                "choose a heading away from the meridian");
    }
    Kinematics at(double t) const override {
        const SinCos<3> turned = sincos(rate_ * Jet<3>::variable(t));
        std::array<Jet<3>, 3> n;
        for (Eigen::Index i = 0; i < 3; ++i) {
            n[static_cast<std::size_t>(i)] = normal_[i] * turned.cos + tangent_[i] * turned.sin;
        }
        const GeodeticJet<3> p{atan2(n[2], sqrt(n[0] * n[0] + n[1] * n[1])), atan2(n[1], n[0]), Jet<3>(h_)};
        const VelocityJet<2> v = velocity(ellipsoid_, p);
        const AttitudeJet attitude{0.0, 0.0, atan2(v.east, v.north).to<1>()};
        return kinematics({p.lat.to<1>(), p.lon.to<1>(), p.h.to<1>()}, {v.north.to<1>(), v.east.to<1>(), v.up.to<1>()}, attitude);
    }

private:
    earth::Ellipsoid ellipsoid_;
    double h_, rate_ = 0.0;
    Eigen::Vector3d normal_, tangent_;
};

class PaperA final : public TruthPath {
public:
    PaperA(const PaperAPath& s, const earth::Ellipsoid& ellipsoid) : s_(s), ellipsoid_(ellipsoid) {
        require_start(s.start);
        for (const Oscillation* o : {&s.lat, &s.lon, &s.height}) {
            require(std::isfinite(o->period) && o->period > 0.0, "trajectory.period_s", "a period is not positive",
                    "give three periods in seconds");
            require(std::isfinite(o->rate) && std::isfinite(o->amplitude) && std::isfinite(o->phase), "trajectory",
                    "a rate, amplitude or phase is not a number", "give numbers");
        }
    }
    Kinematics at(double t) const override {
        const Jet<3> time = Jet<3>::variable(t);
        const GeodeticJet<3> p{coordinate(s_.start.lat, s_.lat, time), coordinate(s_.start.lon, s_.lon, time),
                               coordinate(s_.start.h, s_.height, time)};
        const VelocityJet<2> v = velocity(ellipsoid_, p);
        const Jet<2> horizontal = sqrt(v.north * v.north + v.east * v.east);
        const Jet<1> vn = v.north.to<1>(), ve = v.east.to<1>();
        const Jet<1> pitch = atan2(v.up, horizontal).to<1>();
        // (4.2.5); cos(pitch) there is of the pitch angle.
        const Jet<1> roll =
            s_.roll_per_accel * (vn * derivative(v.east) - ve * derivative(v.north)) / (horizontal.to<1>() * sincos(pitch).cos);
        return kinematics({p.lat.to<1>(), p.lon.to<1>(), p.h.to<1>()}, {vn, ve, v.up.to<1>()}, {roll, pitch, atan2(ve, vn)});
    }

private:
    static Jet<3> coordinate(double start, const Oscillation& o, const Jet<3>& time) {
        const Jet<3> mean = start + o.rate * time;
        return o.amplitude == 0.0 ? mean : mean + o.amplitude * sincos(2.0 * std::numbers::pi / o.period * time + o.phase).sin;
    }
    PaperAPath s_;
    earth::Ellipsoid ellipsoid_;
};

}  // namespace

Kinematics kinematics(const GeodeticJet<1>& p, const VelocityJet<1>& v, const AttitudeJet& attitude) {
    return {{p.lat.value(), math::wrap_pi(p.lon.value()), p.h.value()},
            {v.north.value(), v.east.value(), -v.up.value()},
            {v.north.rate(), v.east.rate(), -v.up.rate()},
            {attitude.roll.value(), attitude.pitch.value(), math::wrap_2pi(attitude.heading.value())},
            {attitude.roll.rate(), attitude.pitch.rate(), attitude.heading.rate()}};
}

std::unique_ptr<const TruthPath> make_path(const PathSettings& settings, const earth::Ellipsoid& ellipsoid) {
    if (const auto* s = std::get_if<StaticPath>(&settings)) return std::make_unique<AtRest>(*s);
    if (const auto* s = std::get_if<GreatCirclePath>(&settings)) return std::make_unique<GreatCircle>(*s, ellipsoid);
    if (const auto* s = std::get_if<PaperAPath>(&settings)) return std::make_unique<PaperA>(*s, ellipsoid);
    if (const auto* s = std::get_if<RoutePath>(&settings)) {
        require_start(s->start);
        return std::make_unique<Route>(*s, ellipsoid);
    }
    if (const auto* s = std::get_if<RecordedPath>(&settings)) return make_motion(*s, ellipsoid);
    const auto started = [&](const auto& s) {
        require_start(s.start);
        return make_motion(s, ellipsoid);
    };
    if (const auto* s = std::get_if<FigureEightPath>(&settings)) return started(*s);
    if (const auto* s = std::get_if<ShipPath>(&settings)) return started(*s);
    return started(std::get<TablePath>(settings));
}

void require_above_ground(const TruthPath& path, double duration, double ground) {
    constexpr double allowed = 0.5;  // m: tolerance for paths on the ground
    for (double t = 0.0; t <= duration; t += std::max(1.0, 1e-4 * duration)) {
        const double h = path.at(t).position.h;
        if (h < ground - allowed)
            throw input_error(
                fmt::format("leads {:.1f} m below the ground after {:.0f} s", ground - h, t),
                {.file = {}, .line = 0, .column = 0, .key = "trajectory"},
                fmt::format("stay above {:g} m, or give the height of the ground: trajectory.ground_height_m", ground));
    }
}

NavState nav_state(const Kinematics& k, Time time) { return {time, k.position, k.v_eb_n, math::quaternion_from_rpy(k.rpy)}; }

}  // namespace schuler::sim
