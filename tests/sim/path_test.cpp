#include "sim/paths.h"

#include "schuler/core/error.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/inverse_imu.h"
#include "schuler/sim/receivers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

namespace schuler::sim {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using testing::deg;

const earth::Earth wgs;

class AnyPath : public ::testing::TestWithParam<testing::NamedPath> {
protected:
    std::unique_ptr<const TruthPath> path = make_path(GetParam().settings, earth::wgs84);
    std::vector<double> instants = {3.7, 21.3, 24.9, 30.13, 41.7, 55.55, 72.4, 88.8, 104.2, 133.3, 151.1, 180.9, 261.3};

    Vector3d inertial_position(double t) const {
        return testing::about_z(earth::wgs84.w_ie * t) * testing::ecef(path->at(t).position);
    }
    Matrix3d inertial_attitude(double t) const {
        const Kinematics k = path->at(t);
        return testing::about_z(earth::wgs84.w_ie * t) * testing::level_axes(k.position) * testing::body_axes(k.rpy);
    }
};

TEST_P(AnyPath, VelocityIsTheDerivativeOfTheEarthFixedPosition) {
    const double h = GetParam().step;
    for (const double t : instants) {
        const Kinematics k = path->at(t);
        const Vector3d v_e = testing::slope([&](double s) { return testing::ecef(path->at(s).position); }, t, h);
        EXPECT_LT((testing::level_axes(k.position) * k.v_eb_n - v_e).norm(), 1e-8 + h * GetParam().tolerance) << "t = " << t;
    }
}

// Newton's law in inertial space, with none of the local-level formulas: r'' = specific force + gravitation.
TEST_P(AnyPath, SpecificForceAndGravitationBendTheInertialPath) {
    for (const double t : instants) {
        const Kinematics k = path->at(t);
        const Vector3d accel = testing::bend([&](double s) { return inertial_position(s); }, t, GetParam().step);
        const Vector3d r_e = testing::ecef(k.position);
        const Vector3d w(0.0, 0.0, earth::wgs84.w_ie);
        const Vector3d gravitation_e = earth::gravity_ecef(wgs, Ecef{r_e}) + w.cross(w.cross(r_e));
        const Vector3d felt = inertial_attitude(t) * inertial_input(wgs, k).f_b;
        const Vector3d sum = felt + testing::about_z(earth::wgs84.w_ie * t) * gravitation_e;
        EXPECT_LT((accel - sum).norm(), GetParam().tolerance) << "t = " << t << " " << (accel - sum).transpose();
    }
}

TEST_P(AnyPath, GyrosFeelTheTurnOfTheInertialAttitude) {
    const double h = std::min(GetParam().step, 0.02);
    for (const double t : instants) {
        const Matrix3d C = inertial_attitude(t);
        const Matrix3d rate = testing::slope([&](double s) { return inertial_attitude(s); }, t, h);
        const Matrix3d W = C.transpose() * rate;
        const Vector3d w(W(2, 1), W(0, 2), W(1, 0));
        EXPECT_LT((inertial_input(wgs, path->at(t)).w_ib_b - w).norm(), 1e-12 / h + 1e-2 * GetParam().tolerance) << "t = " << t;
    }
}

TEST_P(AnyPath, AntennaVelocityIsTheDerivativeOfItsPosition) {
    const Vector3d lever(2.0, -0.7, -3.0);
    const double h = GetParam().step;
    for (const double t : instants) {
        const PointMotion point = point_motion(wgs, path->at(t), lever);
        const auto antenna = [&](double s) {
            const Kinematics k = path->at(s);
            return Vector3d(testing::ecef(k.position) + testing::level_axes(k.position) * (testing::body_axes(k.rpy) * lever));
        };
        EXPECT_LT((testing::ecef(point.position) - antenna(t)).norm(), 5e-9);
        const Vector3d v_e = testing::slope(antenna, t, h);
        EXPECT_LT((testing::level_axes(point.position) * point.v_n - v_e).norm(), 2e-8 + h * GetParam().tolerance) << "t = " << t;
    }
}

INSTANTIATE_TEST_SUITE_P(Kinds, AnyPath, ::testing::ValuesIn(testing::all_paths()),
                         [](const auto& instance) { return instance.param.name; });

// Numbers of an independent evaluation of paper A's (4.2.1) to (4.2.5) at 437 s.
TEST(PaperAFlight, ReproducesTheReferenceInstant) {
    const Kinematics k = make_path(PaperAPath{}, earth::wgs84)->at(437.0);
    EXPECT_NEAR(k.position.lat, 0.955968097235, 1e-12);
    EXPECT_NEAR(k.position.lon, 0.541078775598, 1e-12);
    EXPECT_NEAR(k.position.h, 5678.57786217, 1e-8);
    EXPECT_LT((k.v_eb_n - Vector3d(-36.2909257461, 147.621836301, 51.8754356198)).norm(), 1e-9);
    EXPECT_LT((k.dv_eb_n - Vector3d(2.77463962746, -1.11054229667e-05, 0.0744143894997)).norm(), 1e-11);
    EXPECT_NEAR(k.rpy.x(), -0.0569394805063, 1e-12);
    EXPECT_NEAR(k.rpy.y(), -0.328855938598, 1e-12);
    EXPECT_NEAR(k.rpy.z(), 1.81185315532, 1e-11);
    // Specific force without its gravity term, east north up.
    const earth::EarthTerms terms = earth::terms_at(wgs, k.position, k.v_eb_n);
    const Vector3d f_n = testing::body_axes(k.rpy) * inertial_input(wgs, k).f_b + terms.g_n;
    EXPECT_LT((f_n - Vector3d(2.79734492399, -6.27018566319e-05, 0.0904453486794)).norm(), 1e-9);
}

TEST(GreatCirclePath, KeepsItsPlaneHeightAndStartingSpeed) {
    const GreatCirclePath settings{{50.0 * deg, 179.9 * deg, 8000.0}, 70.0 * deg, 240.0};
    const auto path = make_path(settings, earth::wgs84);
    const Kinematics start = path->at(0.0);
    EXPECT_NEAR(start.v_eb_n.norm(), 240.0, 1e-9);
    EXPECT_NEAR(start.rpy.z(), 70.0 * deg, 1e-12);
    EXPECT_NEAR(start.position.lat, settings.start.lat, 1e-15);
    const auto up = [&](double t) { return Vector3d(-testing::level_axes(path->at(t).position).col(2)); };
    const Vector3d pole = up(0.0).cross(up(600.0)).normalized();
    for (const double t : {100.0, 1000.0, 3600.0, 7200.0}) {
        EXPECT_NEAR(up(t).dot(pole), 0.0, 1e-14);
        EXPECT_DOUBLE_EQ(path->at(t).position.h, 8000.0);
        EXPECT_NEAR(path->at(t).v_eb_n.norm(), 240.0, 1.5);  // the flattening
    }
    EXPECT_LT(path->at(100.0).position.lon, 0.0);  // beyond the date line
}

TEST(RoutePathDrive, KeepsItsPromises) {
    RoutePath route = testing::example_route();
    route.pitch_per_accel = 0.0;
    const auto path = make_path(route, earth::wgs84);
    const Vector3d origin = testing::ecef(route.start);
    const Matrix3d axes = testing::level_axes(route.start);
    const auto local = [&](double t) { return Vector3d(axes.transpose() * (testing::ecef(path->at(t).position) - origin)); };

    std::vector<double> closest(route.waypoints.size(), 1e9), rest(route.waypoints.size(), 0.0);
    double fastest = 0.0, hardest = 0.0;
    for (double t = 0.0; t < 300.0; t += 0.05) {
        const Kinematics k = path->at(t);
        const Vector3d here = local(t);
        const double speed = k.v_eb_n.norm();
        fastest = std::max(fastest, speed);
        hardest = std::max(hardest, k.dv_eb_n.head<2>().norm());
        for (std::size_t i = 0; i < route.waypoints.size(); ++i) {
            const double distance = std::hypot(here.x() - route.waypoints[i].north, here.y() - route.waypoints[i].east);
            closest[i] = std::min(closest[i], distance);
            if (speed == 0.0 && distance < 12.0) rest[i] += 0.05;
        }
        // The wheels do not slip and the vehicle does not jump: velocity along the x axis alone.
        const Vector3d v_b = testing::body_axes({0.0, k.rpy.y(), k.rpy.z()}).transpose() * k.v_eb_n;
        ASSERT_NEAR(v_b.y(), 0.0, 1e-9) << "t = " << t;
        ASSERT_NEAR(v_b.z(), 0.0, 1e-9) << "t = " << t;
        ASSERT_GE(v_b.x(), 0.0) << "t = " << t;
        if (t <= route.standstill) {
            ASSERT_EQ(speed, 0.0) << "t = " << t;
        }
    }
    for (std::size_t i = 0; i + 1 < route.waypoints.size(); ++i) EXPECT_LT(closest[i], 8.0) << "waypoint " << i;
    EXPECT_LT(closest.back(), 2.5);
    EXPECT_NEAR(rest[1], 12.0, 1.1);
    EXPECT_NEAR(rest[3], 20.0, 1.1);
    EXPECT_GT(rest[5], 50.0);
    EXPECT_EQ(rest[0] + rest[2] + rest[4], 0.0);
    EXPECT_GT(fastest, 14.0);
    EXPECT_LT(fastest, 16.01);
    EXPECT_GT(hardest, 1.4);
    EXPECT_LT(hardest, 2.8);  // both limits together are 2.5
}

TEST(RoutePathDrive, TownRouteLastsAboutAsLongAsAsked) {
    const RoutePath route = town_route({50.0 * deg, 30.0 * deg, 150.0}, 1800.0, 5);
    const auto path = make_path(route, earth::wgs84);
    double moving_until = 0.0;
    int stops = 0;
    for (double t = 0.0; t < 3600.0; t += 0.5) {
        const bool moves = path->at(t).v_eb_n.norm() > 0.0;
        if (moves && moving_until < t - 1.0) ++stops;
        if (moves) moving_until = t;
    }
    EXPECT_GT(moving_until, 1500.0);
    EXPECT_LT(moving_until, 2200.0);
    EXPECT_GT(stops, 5);
}

TEST(FlightPhases, DoWhatTheirNamesSay) {
    FlightPhase phase{{40.0 * deg, -3.0 * deg, 300.0}, 1.0, 120.0, 900.0, 20.0, 600.0};
    const auto takeoff = make_path(takeoff_route(phase), earth::wgs84);
    EXPECT_EQ(takeoff->at(19.0).v_eb_n.norm(), 0.0);
    EXPECT_NEAR(takeoff->at(620.0).position.h, 1200.0, 1.0);
    EXPECT_NEAR(takeoff->at(620.0).v_eb_n.norm(), 120.0, 1.0);
    EXPECT_NEAR(math::wrap_pi(takeoff->at(620.0).rpy.z() - 1.0), 45.0 * deg, 0.02);

    const auto holding = make_path(holding_route(phase), earth::wgs84);
    double turned = 0.0, bank = 0.0;
    for (double t = 0.0; t < 600.0; t += 0.5) {
        const Kinematics k = holding->at(t);
        ASSERT_NEAR(k.v_eb_n.norm(), 120.0, 0.5) << t;  // a chart of 20 km is true to 0.3 %
        ASSERT_NEAR(k.position.h, 300.0, 1e-6);
        turned += 0.5 * k.rpy_rate.z();
        bank = std::max(bank, k.rpy.x());
    }
    EXPECT_GT(turned, 3.5 * std::numbers::pi);  // right turns, four minutes a racetrack
    EXPECT_NEAR(std::tan(bank), 120.0 * 3.0 * deg / 9.81, 0.15);

    phase.start.h = 1200.0;
    const auto approach = make_path(approach_route(phase), earth::wgs84);
    EXPECT_NEAR(approach->at(0.0).v_eb_n.norm(), 120.0, 0.5);
    double steepest = 0.0;
    for (double t = 0.0; t < 900.0; t += 0.5) steepest = std::min(steepest, approach->at(t).rpy.y());
    EXPECT_NEAR(steepest, -3.0 * deg, 0.3 * deg);
    EXPECT_NEAR(approach->at(900.0).position.h, 300.0, 0.01);
    EXPECT_EQ(approach->at(900.0).v_eb_n.norm(), 0.0);
    EXPECT_THROW(require_above_ground(*approach, 900.0, 301.0), Error);
    EXPECT_NO_THROW(require_above_ground(*approach, 900.0, 300.0));
}

TEST(TablePathMoves, TurnsByWhatIsAskedAtAConstantRate) {
    TablePath table{{48.0 * deg, 11.0 * deg, 500.0}, {0.1, -0.2, 1.0}, {{{0.0, 0.0, 1.8}, 10.0, 5.0}}, 2.0};
    const auto path = make_path(table, earth::wgs84);
    EXPECT_EQ(path->at(1.9).rpy, table.rpy);
    EXPECT_NEAR(path->at(7.0).rpy_rate.z(), 1.8 / 9.0, 1e-14);  // a second each to speed up and slow down
    EXPECT_NEAR(path->at(7.0).rpy.z(), 1.0 + 0.9, 1e-14);
    EXPECT_NEAR(path->at(13.0).rpy.z(), 2.8, 1e-14);
    EXPECT_EQ(path->at(13.0).rpy_rate.norm(), 0.0);
}

TEST(RecordedFlight, StaysNearItsPointsAndFindsAnAttitude) {
    const auto all = testing::all_paths();
    const auto named = std::find_if(all.begin(), all.end(), [](const auto& p) { return p.name == "recorded"; });
    const auto& recorded = std::get<RecordedPath>(named->settings);
    const auto path = make_path(recorded, earth::wgs84);
    for (std::size_t k = 20; k + 20 < recorded.points.size(); k += 7) {
        const RecordedPoint& p = recorded.points[k];
        EXPECT_LT((testing::ecef(path->at(p.time).position) - testing::ecef(p.position)).norm(), 0.5);  // 1/4 a h^2
        const Kinematics kin = path->at(p.time);
        const Vector3d along = testing::body_axes(kin.rpy).transpose() * kin.v_eb_n;
        EXPECT_LT(along.tail<2>().norm(), 0.01 * along.x());
    }
}

TEST(RecordedFlight, BeginsAndEndsAtTheSpeedOfTheRecording) {
    RecordedPath recorded;
    recorded.spacing = 1.0;
    for (int k = 0; k <= 60; ++k) recorded.points.push_back({1.0 * k, {0.5 + 2e-5 * k, 1.0, 100.0 + k}, {0.0, 0.1, 0.2}});
    const auto path = make_path(recorded, earth::wgs84);
    const double speed = path->at(30.0).v_eb_n.x();
    EXPECT_GT(speed, 100.0);
    for (const double t : {0.0, 0.3, 59.7, 60.0}) {
        EXPECT_NEAR(path->at(t).v_eb_n.x(), speed, 0.01) << t;
        EXPECT_NEAR(path->at(t).v_eb_n.z(), -1.0, 1e-9) << t;
    }
}

TEST(Paths, UnusableSettingsAreNamed) {
    const auto key_of = [](const PathSettings& settings) {
        try {
            (void)make_path(settings, earth::wgs84);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::Input);
            return error.place().key;
        }
        return std::string("accepted");
    };
    RoutePath route = testing::example_route();
    route.waypoints[3] = {-105.0, 320.25, 0.0, 14.0, 0.0};  // straight on, 5 m further
    EXPECT_EQ(key_of(route), "trajectory.waypoints[3]");
    route = testing::example_route();
    route.waypoints[1] = {20.0, 0.0, 0.0, 14.0, 0.0};  // back where it came from
    EXPECT_EQ(key_of(route), "trajectory.waypoints[0]");
    route = testing::example_route();
    route.waypoints[4].speed = 0.0;
    EXPECT_EQ(key_of(route), "trajectory.waypoints[4]");
    EXPECT_EQ(key_of(RoutePath{}), "trajectory.waypoints");
    EXPECT_EQ(key_of(GreatCirclePath{{50.0 * deg, 0.0, 0.0}, 0.0, 100.0}), "trajectory.heading_deg");
    EXPECT_EQ(key_of(StaticPath{{90.0 * deg, 0.0, 0.0}, Vector3d::Zero()}), "trajectory.start.lat_deg");
    TablePath table{
        {48.0 * deg, 11.0 * deg, 500.0}, Vector3d::Zero(), {{{0.0, 1.0, 0.0}, 10.0, 0.0}, {{0.0, 0.6, 0.0}, 10.0, 0.0}}, 0.0};
    EXPECT_EQ(key_of(table), "trajectory.moves[1]");
    RecordedPath recorded{{{0.0, {0.9, 1.0, 0.0}, {}}, {20.0, {0.9, 1.0, 0.0}, {}}, {15.0, {0.9, 1.0, 0.0}, {}}}, 1.0, 0.1};
    EXPECT_EQ(key_of(recorded), "trajectory.file");
    ShipPath ship;
    ship.heave.period = 0.0;
    EXPECT_EQ(key_of(ship), "trajectory.waves");
    RoutePath flying = testing::example_route();
    flying.start_speed = 10.0;  // with its standstill
    EXPECT_EQ(key_of(flying), "trajectory.start_speed_m_s");
    PaperAPath flight;
    flight.lon.period = 0.0;
    EXPECT_EQ(key_of(flight), "trajectory.period_s");
}

// The shortest runway is as long as a leg has to be, whichever way it points.
TEST(FlightPhases, SlowTakeoffsLeaveInAnyDirection) {
    FlightPhase phase;
    phase.start = {0.9, -0.05, 900.0};
    phase.speed = 72.0;
    phase.height_change = 800.0;
    phase.duration = 300.0;
    for (int k = 0; k < 50; ++k) {
        phase.heading = 0.125 * k;
        EXPECT_NO_THROW((void)make_path(takeoff_route(phase), earth::wgs84)) << phase.heading;
    }
}

}  // namespace
}  // namespace schuler::sim
