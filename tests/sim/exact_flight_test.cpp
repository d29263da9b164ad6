// A simulation with the error-free part made beforehand is the simulation, to the last bit, whatever the path.
#include "schuler/sim/exact_flight.h"

#include "sim/paths.h"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <vector>

namespace schuler::sim {
namespace {

using testing::deg;

const Geodetic start{48.0 * deg, 11.0 * deg, 600.0};

Scenario flight(PathSettings path) {
    Scenario s;
    s.duration = 40.0;
    s.path = std::move(path);
    s.imu.rate = 50.0;
    s.imu.errors = sensor::imu_grade("mems");
    s.baro.rate = 2.0;
    s.reference_rate = 7.0;
    return s;
}

std::vector<PathSettings> all_kinds() {
    RecordedPath recorded;
    for (int i = 0; i < 60; ++i)
        recorded.points.push_back(
            {1.0 * i, {start.lat + 1e-6 * i * i, start.lon + 2e-5 * i, start.h}, Eigen::Vector3d(0.01 * i, 0.0, 0.4)});
    return {StaticPath{start, {0.1, 0.2, 0.3}},
            GreatCirclePath{start, 0.4, 150.0},
            PaperAPath{},
            town_route(start, 40.0, 3),
            FigureEightPath{start},
            ShipPath{start},
            TablePath{start, Eigen::Vector3d::Zero(), {TableMove{{0.3, 0.2, 0.1}, 8.0, 1.0}}},
            recorded};
}

bool same(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return std::memcmp(a.data(), b.data(), 3 * sizeof(double)) == 0; }

void expect_same(const SimulatedData& a, const SimulatedData& b) {
    const auto &x = a.recording, &y = b.recording;
    ASSERT_EQ(x.imu.size(), y.imu.size());
    for (std::size_t i = 0; i < x.imu.size(); ++i)
        ASSERT_TRUE(x.imu[i].time == y.imu[i].time && same(x.imu[i].gyro, y.imu[i].gyro) && same(x.imu[i].accel, y.imu[i].accel))
            << i;
    ASSERT_EQ(x.reference.size(), y.reference.size());
    for (std::size_t i = 0; i < x.reference.size(); ++i)
        ASSERT_TRUE(x.reference[i].time == y.reference[i].time && same(x.reference[i].velocity_n, y.reference[i].velocity_n) &&
                    same(x.reference[i].rpy, y.reference[i].rpy) && x.reference[i].position.lat == y.reference[i].position.lat &&
                    x.reference[i].position.lon == y.reference[i].position.lon)
            << i;
    ASSERT_EQ(x.gnss.size(), y.gnss.size());
    for (std::size_t i = 0; i < x.gnss.size(); ++i) ASSERT_TRUE(same(x.gnss[i].velocity_n, y.gnss[i].velocity_n)) << i;
    ASSERT_EQ(a.sensor_truth.size(), b.sensor_truth.size());
    for (std::size_t i = 0; i < a.sensor_truth.size(); ++i)
        ASSERT_TRUE(same(a.sensor_truth[i].disturbance_n, b.sensor_truth[i].disturbance_n)) << i;
}

TEST(ExactFlight, SimulationWithItIsTheSimulation) {
    for (const PathSettings& path : all_kinds()) {
        SCOPED_TRACE(path.index());
        Scenario s = flight(path);
        const auto flown = exact_flight(s);
        ASSERT_NE(flown, nullptr);
        EXPECT_TRUE(flown->is_of(s));
        s.seed = 77;  // and whatever else is no part of the flight
        s.imu.errors = sensor::imu_grade("tactical");
        s.gnss.rate = 5.0;
        EXPECT_TRUE(flown->is_of(s));
        expect_same(simulate(s, flown.get()), simulate(s));
        expect_same(simulate(s, nullptr), simulate(s));
    }
}

TEST(ExactFlight, DisturbedGravityIsAddedToIt) {
    Scenario s = flight(ShipPath{start});
    const auto flown = exact_flight(s);
    s.anomaly.emplace_back().size_n = {1e-4, 2e-4, -3e-4};
    expect_same(simulate(s, flown.get()), simulate(s));
}

TEST(ExactFlight, AnotherFlightIsNotUsed) {
    const std::vector<PathSettings> kinds = all_kinds();
    for (const PathSettings& path : kinds) {
        SCOPED_TRACE(path.index());
        const Scenario s = flight(path);
        const auto flown = exact_flight(s);
        std::vector<std::function<void(Scenario&)>> changes{
            [](Scenario& o) { o.duration = 41.0; },
            [](Scenario& o) { o.imu.rate = 25.0; },
            [](Scenario& o) { o.reference_rate = 5.0; },
            [](Scenario& o) { o.earth.ellipsoid = earth::pz90; },
            [](Scenario& o) { o.earth.gravity = earth::GravityModel::Grs80; },
            [&](Scenario& o) { o.path = kinds[(path.index() + 1) % kinds.size()]; }};
        for (const auto& change : changes) {
            Scenario other = s;
            change(other);
            EXPECT_FALSE(flown->is_of(other));
            expect_same(simulate(other, flown.get()), simulate(other));
        }
    }
}

/// Every number of a path's settings counts.
template <class Path>
void expect_told_apart(const Path& path, const std::vector<std::function<void(Path&)>>& changes) {
    const auto flown = exact_flight(flight(path));
    ASSERT_NE(flown, nullptr);
    for (std::size_t i = 0; i < changes.size(); ++i) {
        Path other = path;
        changes[i](other);
        EXPECT_FALSE(flown->is_of(flight(other))) << "change " << i;
    }
}

TEST(ExactFlight, EverySettingOfAPathIsCompared) {
    expect_told_apart<PaperAPath>(PaperAPath{},
                                  {[](auto& p) { p.start.h += 1.0; }, [](auto& p) { p.lat.amplitude *= 2.0; },
                                   [](auto& p) { p.lon.rate *= 2.0; }, [](auto& p) { p.height.period += 1.0; },
                                   [](auto& p) { p.height.phase += 0.1; }, [](auto& p) { p.roll_per_accel += 0.1; }});
    expect_told_apart<StaticPath>(StaticPath{start, Eigen::Vector3d::Zero()}, {[](auto& p) { p.rpy.z() = 1.0; }});
    expect_told_apart<GreatCirclePath>(GreatCirclePath{start, 0.4, 150.0},
                                       {[](auto& p) { p.heading += 0.1; }, [](auto& p) { p.speed += 1.0; }});
    expect_told_apart<FigureEightPath>(FigureEightPath{start},
                                       {[](auto& p) { p.heading += 0.1; }, [](auto& p) { p.length += 1.0; },
                                        [](auto& p) { p.width += 1.0; }, [](auto& p) { p.height_amplitude += 1.0; },
                                        [](auto& p) { p.period += 1.0; }, [](auto& p) { p.roll_per_lateral_accel += 0.1; }});
    expect_told_apart<ShipPath>(ShipPath{start}, {[](auto& p) { p.heading += 0.1; }, [](auto& p) { p.speed += 1.0; },
                                                  [](auto& p) { p.roll.phase += 1.0; }, [](auto& p) { p.pitch.amplitude += 0.1; },
                                                  [](auto& p) { p.yaw.period += 1.0; }, [](auto& p) { p.heave.phase += 1.0; }});
    expect_told_apart<RoutePath>(
        town_route(start, 40.0, 3),
        {[](auto& p) { p.waypoints.back().north += 1.0; }, [](auto& p) { p.waypoints.back().east += 1.0; },
         [](auto& p) { p.waypoints.back().up += 1.0; }, [](auto& p) { p.waypoints.back().speed += 1.0; },
         [](auto& p) { p.waypoints.back().stop += 1.0; }, [](auto& p) { p.waypoints.pop_back(); },
         [](auto& p) { p.standstill += 1.0; }, [](auto& p) { p.corner_radius += 1.0; }, [](auto& p) { p.lateral_accel += 1.0; },
         [](auto& p) { p.longitudinal_accel += 1.0; }, [](auto& p) { p.roll_per_lateral_accel += 0.1; },
         [](auto& p) { p.pitch_per_accel += 0.1; }, [](auto& p) { p.vibration.frequency += 1.0; },
         [](auto& p) { p.vibration.angle += 0.01; }, [](auto& p) { p.vibration.accel += 0.1; },
         [](auto& p) { p.knot_spacing += 1.0; }, [](auto& p) { p.start_speed += 1.0; },
         [](auto& p) { p.drape = Drape{[](double, double) { return 0.0; }}; }});
}

TEST(ExactFlight, NoneWhereItIsTooLargeOrNotValid) {
    Scenario s = flight(StaticPath{start});
    s.duration = 1e6;
    EXPECT_EQ(exact_flight(s), nullptr);
    for (const double none : {0.0, -1.0, std::nan("")}) {
        s.duration = none;
        EXPECT_EQ(exact_flight(s), nullptr);
    }
    s = flight(StaticPath{{2.0, 0.0, 0.0}});
    EXPECT_EQ(exact_flight(s), nullptr);
}

}  // namespace
}  // namespace schuler::sim
