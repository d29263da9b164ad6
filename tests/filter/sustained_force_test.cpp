// A g-dependent gyro bias, which has no states: its noise grows in pulls, and not with vibration or with the constant force of gravity.
#include "fusion/car_drive.h"

#include "schuler/filter/states/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <variant>

namespace schuler::fusion {
namespace {

using namespace testing;
using Eigen::Vector3d;

constexpr double per_g = 0.1 * deg / units::g0;  // rad/s/(m/s^2), of a consumer unit

/// One sigma of the roll (rad) after `time` (s) without measurements, under `force` (body axes, m/s^2, of time).
double sigma_after(double time, double gyro_g, const std::function<Vector3d(double)>& force) {
    constexpr double dt = 0.005;
    Settings settings;
    settings.imu.errors.gyro_g = gyro_g;
    filter::InertialModel model = filter::make_model(settings, filter::make_layout(settings, {}));
    model.process = {};
    filter::InertialFilter<filter::GeographicFrame> f(model);
    NavState nav;
    nav.position = {0.9, 1.0, 100.0};
    f.set_nav(nav);
    estim::Transition phi;
    for (int k = 1; k <= std::lround(time / dt); ++k) {
        f.propagate(model, {Time::from_seconds(dt * k), dt, Vector3d::Zero(), dt * force(dt * k)}, {});
        if (k % 20 == 0) (void)f.propagate_covariance(model, phi);
    }
    return std::sqrt(f.P(6, 6));
}

const Vector3d rest{0.0, 0.0, -units::g0};

TEST(GDependentBias, GrowsInPullsOnly) {
    constexpr double pull = 30.0, from = 60.0, lasting = 5.0;  // m/s^2, s, s
    const auto steady = [](double) { return rest; };
    const auto pulled = [=](double t) { return t < from ? rest : Vector3d(rest - Vector3d(0.0, 0.0, pull)); };
    const auto shaken = [=](double t) {
        return Vector3d(rest + pull * Vector3d::UnitX() * std::sin(2.0 * std::numbers::pi * 40.0 * t));
    };
    const auto walked = [=](double t) {
        return Vector3d(rest + 3.0 * Vector3d::UnitX() * std::sin(2.0 * std::numbers::pi * 2.0 * t));
    };
    const double constant = per_g * pull * lasting;
    EXPECT_NEAR(sigma_after(from + lasting, per_g, pulled), constant, 0.12 * constant);
    EXPECT_LT(sigma_after(from + lasting, per_g, steady), 1e-3 * constant);
    EXPECT_LT(sigma_after(from + lasting, per_g, shaken), 0.1 * constant);
    EXPECT_LT(sigma_after(from + lasting, per_g, walked), 0.1 * constant);
    EXPECT_EQ(sigma_after(from + lasting, 0.0, pulled), 0.0);
    // A pull that lasts for minutes is a new constant force, which the estimated biases take over: less than a random walk.
    const double minute = sigma_after(from + 60.0, per_g, pulled), later = sigma_after(from + 300.0, per_g, pulled);
    EXPECT_LT(later * later - minute * minute, 0.2 * minute * minute);
}

/// Mean attitude NEES per component, over runs, of a flight in steep figures of eight whose gyros err by 0.1 deg/s/g.
double attitude_nees(double assumed) {
    double sum = 0.0, n = 0.0;
    for (const std::uint64_t seed : {21U, 22U, 23U, 24U}) {
        sim::Scenario s = flight_in_curves(seed, 0.0);
        auto& path = std::get<sim::FigureEightPath>(s.path);
        path.length = 500.0;
        path.width = 300.0;
        path.period = 40.0;
        s.imu.errors = mems();
        s.imu.errors.gyro_g = per_g;
        const Recording recording = sim::simulate(s).recording;
        Settings f = settings_of(s);
        f.vehicle = VehicleKind::Air;
        f.imu.errors.gyro_turn_on_bias = std::hypot(f.imu.errors.gyro_turn_on_bias, per_g * units::g0);
        f.imu.errors.gyro_g = assumed;
        give_start(f, recording, seed);
        for (const analysis::ErrorRow& e : errors(f, fuse(recording, f).forward.rows, recording)) {
            if (e.time < s.origin + Duration::from_seconds(60.0)) continue;
            sum += e.rpy.cwiseQuotient(e.std_rpy).squaredNorm() / 3.0;
            n += 1.0;
        }
    }
    return sum / n;
}

TEST(GDependentBias, IsInTheSigmasOfAFlightInSteepTurns) {
    const double told = attitude_nees(per_g), untold = attitude_nees(0.0);
    EXPECT_LT(told, 2.0);
    EXPECT_GT(told, 0.2);
    EXPECT_GT(untold, 5.0);  // what the flight is hard enough to show
}

}  // namespace
}  // namespace schuler::fusion
