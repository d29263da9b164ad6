// The loop closed before the first filter: increments by inverse kinematics, mechanized, against the path.
#include "sim/paths.h"

#include "schuler/ins/increments.h"
#include "schuler/ins/step.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/inverse_imu.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace schuler::sim {
namespace {

using Eigen::Vector3d;
using testing::deg;

struct Closure {
    double horizontal = 0.0, vertical = 0.0, tilt = 0.0;  ///< largest at whole seconds, m, m, rad
};

void worsen(Closure& worst, const earth::Earth& earth, const NavState& state, const Kinematics& truth) {
    const Vector3d dr = earth::ned_difference(earth, state.position, truth.position);
    const Eigen::Quaterniond turn = state.q_nb * math::quaternion_from_rpy(truth.rpy).conjugate();
    worst.horizontal = std::max(worst.horizontal, dr.head<2>().norm());
    worst.vertical = std::max(worst.vertical, std::abs(dr.z()));
    worst.tilt = std::max(worst.tilt, math::rotation_vector_from_quaternion(turn).norm());
}

struct Both {
    Closure geographic, ecef;
};

Both close_loop(const PathSettings& settings, double rate, double duration, const earth::Earth& earth) {
    const auto path = make_path(settings, earth.ellipsoid);
    NavState n = nav_state(path->at(0.0), Time{});
    NavStateEcef e = ins::to_ecef(earth, n);
    ImuIncrement previous{Time{}, 0.0, Vector3d::Zero(), Vector3d::Zero()};
    Both worst;
    const auto steps = static_cast<long>(duration * rate);
    for (long k = 1; k <= steps; ++k) {
        const double from = static_cast<double>(k - 1) / rate, to = static_cast<double>(k) / rate;
        const ExactIncrement exact = exact_increment(earth, *path, from, to);
        const ImuIncrement raw{Time::from_seconds(to), to - from, exact.dtheta, exact.dv};
        const ins::CompensatedIncrement step = ins::compensate(previous, raw);
        previous = raw;
        n = ins::step_n(earth, n, step);
        e = ins::step_e(earth, e, step);
        if (k % static_cast<long>(rate) != 0) continue;
        const Kinematics truth = path->at(to);
        worsen(worst.geographic, earth, n, truth);
        worsen(worst.ecef, earth, ins::to_geographic(earth, e), truth);
    }
    return worst;
}

void expect_within(const Both& worst, double horizontal, double vertical, double tilt) {
    for (const Closure& c : {worst.geographic, worst.ecef}) {
        EXPECT_LT(c.horizontal, horizontal);
        EXPECT_LT(c.vertical, vertical);
        EXPECT_LT(c.tilt, tilt);
    }
}

TEST(Closure, HourAtRest) {
    const StaticPath rest{{48.0 * deg, 11.0 * deg, 500.0}, {0.05, -0.03, 2.0}};
    expect_within(close_loop(rest, 50.0, 3600.0, {}), 1e-3, 1e-3, 1e-6 * deg);
}

TEST(Closure, HourOnAGreatCircle) {
    const GreatCirclePath circle{{30.0 * deg, 10.0 * deg, 9000.0}, 40.0 * deg, 230.0};
    expect_within(close_loop(circle, 50.0, 3600.0, {}), 1e-3, 1e-3, 1e-6 * deg);
}

// The bounds asked for dynamic paths are 0.1 m and 3 m; these guard what is reached (4e-5 m and 9e-4 m; 3 mm and 1 mm).
TEST(Closure, HourOfPaperAFlight) { expect_within(close_loop(PaperAPath{}, 100.0, 3600.0, {}), 1e-3, 0.02, 1e-7 * deg); }

TEST(Closure, HourOfTownDrive) {
    const RoutePath drive = town_route({50.4 * deg, 30.5 * deg, 150.0}, 3500.0, 11);
    expect_within(close_loop(drive, 200.0, 3600.0, {}), 0.02, 0.02, 1e-6 * deg);
}

// Every other kind of path for as long as it is described; the rates are those of the instruments used on them.
TEST(Closure, MotionsOfEveryKind) {
    for (const testing::NamedPath& p : testing::all_paths()) {
        if (p.name == "static" || p.name == "great_circle" || p.name == "paper_a" || p.name.ends_with("route")) continue;
        SCOPED_TRACE(p.name);
        expect_within(close_loop(p.settings, 100.0, 280.0, {}), 0.02, 0.02, 2e-6 * deg);
    }
}

// What remains is the mechanization's, not the simulator's: it falls at the order of the algorithm when the rate doubles,
// position by its second-order step, attitude by the third order of the coning correction.
TEST(Closure, ErrorFallsAtTheOrderOfTheAlgorithm) {
    const Both slow = close_loop(PaperAPath{}, 10.0, 600.0, {});
    const Both fast = close_loop(PaperAPath{}, 20.0, 600.0, {});
    EXPECT_NEAR(fast.geographic.horizontal / slow.geographic.horizontal, 0.25, 0.02);
    EXPECT_NEAR(fast.ecef.horizontal / slow.ecef.horizontal, 0.25, 0.02);
    const RoutePath route = testing::example_route();
    const Both rough = close_loop(route, 25.0, 100.0, {}), fine = close_loop(route, 50.0, 100.0, {});
    EXPECT_LT(fine.geographic.tilt, 0.14 * rough.geographic.tilt);
    EXPECT_LT(fine.ecef.tilt, 0.14 * rough.ecef.tilt);
}

}  // namespace
}  // namespace schuler::sim
