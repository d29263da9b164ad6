// Motions in closed form: a figure of eight, a ship in waves, a turntable.
#include "schuler/core/error.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/detail/require.h"
#include "schuler/sim/path_kinds.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace schuler::sim {

namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;

using detail::require;

bool positive(double x) { return std::isfinite(x) && x > 0.0; }

/// Lemniscate of Gerono, its long axis along the heading, entered at the crossing.
class FigureEight final : public TruthPath {
public:
    FigureEight(const FigureEightPath& s, const earth::Ellipsoid& ellipsoid)
        : s_(s), ellipsoid_(ellipsoid), chart_(ellipsoid, s.start) {
        require(positive(s.length), "trajectory.length_m", "is not a length", "give metres");
        require(positive(s.width), "trajectory.width_m", "is not a width", "give metres");
        require(positive(s.period), "trajectory.period_s", "is not a period", "give the seconds of one figure");
        require(std::isfinite(s.heading + s.height_amplitude + s.roll_per_lateral_accel), "trajectory",
                "a setting is not a number", "give numbers");
    }
    Kinematics at(double t) const override {
        const SinCos<3> angle = sincos(two_pi / s_.period * Jet<3>::variable(t));
        const Jet<3> along = 0.5 * s_.length * angle.sin, across = s_.width * angle.sin * angle.cos;
        const double c = std::cos(s_.heading), s = std::sin(s_.heading);
        const GeodeticJet<3> p = chart_.at<3>(c * along - s * across, s * along + c * across, s_.height_amplitude * angle.sin);
        return moving_along(ellipsoid_, p, s_.roll_per_lateral_accel);
    }

private:
    FigureEightPath s_;
    earth::Ellipsoid ellipsoid_;
    LocalChart chart_;
};

class Ship final : public TruthPath {
public:
    Ship(const ShipPath& s, const earth::Ellipsoid& ellipsoid) : s_(s), ellipsoid_(ellipsoid), chart_(ellipsoid, s.start) {
        require(std::isfinite(s.heading), "trajectory.heading_deg", "is not a number", "give degrees");
        require(std::isfinite(s.speed) && s.speed >= 0.0, "trajectory.speed_m_s", "is not a speed", "give metres a second");
        for (const Wave* w : {&s.roll, &s.pitch, &s.yaw, &s.heave}) {
            require(positive(w->period), "trajectory.waves", "a wave has no positive period", "give seconds");
            require(std::isfinite(w->amplitude + w->phase), "trajectory.waves", "a wave is not a number",
                    "give amplitude and phase");
        }
    }
    Kinematics at(double t) const override {
        const Jet<3> sailed = s_.speed * Jet<3>::variable(t);
        const GeodeticJet<3> p =
            chart_.at<3>(std::cos(s_.heading) * sailed, std::sin(s_.heading) * sailed, swing<3>(s_.heave, t));
        const VelocityJet<2> v = velocity(ellipsoid_, p);
        return kinematics({p.lat.to<1>(), p.lon.to<1>(), p.h.to<1>()}, {v.north.to<1>(), v.east.to<1>(), v.up.to<1>()},
                          {swing<1>(s_.roll, t), swing<1>(s_.pitch, t), s_.heading + swing<1>(s_.yaw, t)});
    }

private:
    template <int N>
    static Jet<N> swing(const Wave& w, double t) {
        return w.amplitude * sincos(two_pi / w.period * Jet<N>::variable(t) + w.phase).sin;
    }
    ShipPath s_;
    earth::Ellipsoid ellipsoid_;
    LocalChart chart_;
};

/// At a fixed position, rotated by successive moves: each starts and stops smoothly with constant rate in between.
class Table final : public TruthPath {
public:
    explicit Table(const TablePath& s) : s_(s) {
        require(!s.moves.empty(), "trajectory.moves", "no moves", "use type = \"static\" for a body at rest");
        double pitch = s.rpy.y();
        double begin = s.standstill;
        for (std::size_t i = 0; i < s.moves.size(); ++i) {
            const TableMove& m = s.moves[i];
            const std::string key = fmt::format("trajectory.moves[{}]", i);
            require(m.turn.allFinite() && positive(m.duration) && std::isfinite(m.dwell) && m.dwell >= 0.0, key,
                    "needs finite turns, a positive duration and a dwell", "give degrees and seconds");
            pitch += m.turn.y();
            require(std::abs(pitch) < 1.5533, key, "pitches the table within a degree of 90 deg",
                    "turn it about another axis first");
            begins_.push_back(begin);
            begin += m.duration + m.dwell;
        }
    }
    Kinematics at(double t) const override {
        std::array<Jet<1>, 3> angle{s_.rpy.x(), s_.rpy.y(), s_.rpy.z()};
        for (std::size_t i = 0; i < s_.moves.size() && begins_[i] < t; ++i) {
            const Jet<1> part = done(s_.moves[i].duration, t - begins_[i]);
            for (std::size_t k = 0; k < 3; ++k) angle[k] += s_.moves[i].turn[static_cast<Eigen::Index>(k)] * part;
        }
        return kinematics({s_.start.lat, s_.start.lon, s_.start.h}, {0.0, 0.0, 0.0}, {angle[0], angle[1], angle[2]});
    }

private:
    /// Fraction of a move completed after `since` of its `duration` seconds.
    static Jet<1> done(double duration, double since) {
        if (since >= duration) return 1.0;
        const double ramp = std::min(1.0, 0.5 * duration), whole = duration - ramp;
        // Speed 10 x^3 - 15 x^4 + 6 x^5 of the full speed over the ramp, x from 0 to 1: twice differentiable at its ends.
        const auto ramped = [ramp](const Jet<1>& x) { return ramp * (x * x * x * x * (2.5 + x * (x - 3.0))); };
        const Jet<1> now = Jet<1>::variable(since);
        if (since < ramp) return (1.0 / whole) * ramped((1.0 / ramp) * now);
        if (since > duration - ramp) return 1.0 - (1.0 / whole) * ramped((1.0 / ramp) * (duration - now));
        return (1.0 / whole) * (now - 0.5 * ramp);
    }
    TablePath s_;
    std::vector<double> begins_;
};

}  // namespace

LocalChart::LocalChart(const earth::Ellipsoid& ellipsoid, const Geodetic& start) : origin(start) {
    const MetricJet<0> m = metric<0>(ellipsoid, start.lat, start.h);
    lat_per_m = 1.0 / m.north.value();
    lon_per_m = 1.0 / m.east.value();
}

Kinematics moving_along(const earth::Ellipsoid& ellipsoid, const GeodeticJet<3>& p, double roll_per_lateral_accel) {
    const VelocityJet<2> v = velocity(ellipsoid, p);
    const Jet<2> level = sqrt(v.north * v.north + v.east * v.east), course = atan2(v.east, v.north);
    const AttitudeJet attitude{roll_per_lateral_accel * (level.to<1>() * derivative(course)), atan2(v.up, level).to<1>(),
                               course.to<1>()};
    return kinematics({p.lat.to<1>(), p.lon.to<1>(), p.h.to<1>()}, {v.north.to<1>(), v.east.to<1>(), v.up.to<1>()}, attitude);
}

std::unique_ptr<const TruthPath> make_motion(const FigureEightPath& s, const earth::Ellipsoid& ellipsoid) {
    return std::make_unique<FigureEight>(s, ellipsoid);
}
std::unique_ptr<const TruthPath> make_motion(const ShipPath& s, const earth::Ellipsoid& ellipsoid) {
    return std::make_unique<Ship>(s, ellipsoid);
}
std::unique_ptr<const TruthPath> make_motion(const TablePath& s, const earth::Ellipsoid&) { return std::make_unique<Table>(s); }

}  // namespace schuler::sim
