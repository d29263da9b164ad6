// Where and how anybody may fly: poles, date line, below the sea and above the air, 8 km/s, upside down; absurd noise; a month of samples.
#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/filter/navigator.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"
#include "schuler/sensor/grades.h"
#include "schuler/sim/simulate.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

namespace schuler::filter {
namespace {

using Eigen::Vector3d;

struct ExtremeFlight {
    const char* name;
    Geodetic start;
    double speed, heading;           ///< m/s, rad; speed 0: at rest, with this attitude
    double roll = 0.0, pitch = 0.0;  ///< rad
    double looping = 0.0;            ///< rad/s about the right axis, of speed 0
};

using units::deg;

constexpr double duration = 120.0;  // s
const Time origin = Time::from_seconds(1000.0);

/// At rest, poles included: what the instruments feel follows from the Earth's rotation and gravity alone.
sim::SimulatedData at_rest(const ExtremeFlight& flight) {
    sim::SimulatedData data;
    data.imu_kind = ImuKind::Rates;
    const Vector3d rpy(flight.roll, flight.pitch, flight.heading), turning(0.0, flight.looping, 0.0);
    const Eigen::Matrix3d C_en = earth::C_en(flight.start.lat, flight.start.lon), first = math::dcm_from_rpy(rpy);
    const auto C_nb = [&](double t) -> Eigen::Matrix3d {
        return first * Eigen::AngleAxisd(flight.looping * t, Vector3d::UnitY()).toRotationMatrix();
    };
    const Vector3d gravity = earth::gravity_ecef({}, earth::ecef_from_geodetic(earth::wgs84, flight.start));
    const sensor::ImuErrorModel errors = sensor::imu_grade("tactical");
    math::Random random(5, "at rest");
    const auto noise = [&](double sigma) {
        const double x = random.normal(), y = random.normal(), z = random.normal();
        return Vector3d(sigma * x, sigma * y, sigma * z);
    };
    for (int k = 0; k <= 100 * static_cast<int>(duration); ++k) {
        const Time time = origin + Duration{k * std::int64_t{10'000'000}};
        if (k > 0) {
            const Eigen::Matrix3d C_be = (C_en * C_nb(0.01 * (k - 0.5))).transpose();  // in the middle of the interval
            const Vector3d rate = turning + C_be * Vector3d(0.0, 0.0, earth::wgs84.w_ie), force = -C_be * gravity;
            data.recording.imu.push_back(
                {time, rate + noise(10.0 * errors.gyro_noise), force + noise(10.0 * errors.accel_noise)});
        }
        if (k % 100 == 0) {
            GnssFix fix{.time = time, .position = flight.start};
            const Ecef at{earth::ecef_from_geodetic(earth::wgs84, flight.start).r + noise(1.5)};
            fix.position = earth::geodetic_from_ecef(earth::wgs84, at);
            fix.std_position.setConstant(1.5);
            data.recording.gnss.push_back(fix);
        }
        if (k % 10 == 0)
            data.recording.reference.push_back({time, flight.start, Vector3d::Zero(), math::rpy_from_dcm(C_nb(0.01 * k))});
    }
    return data;
}

sim::SimulatedData simulated(const ExtremeFlight& flight) {
    if (flight.speed == 0.0) return at_rest(flight);
    sim::Scenario scenario;
    scenario.seed = 11;
    scenario.duration = duration;
    scenario.origin = origin;
    scenario.path = sim::GreatCirclePath{flight.start, flight.heading, flight.speed};
    scenario.imu.rate = 100.0;
    scenario.imu.errors = sensor::imu_grade("tactical");
    scenario.gnss.rate = 1.0;
    return sim::simulate(scenario);
}

NavigatorSettings settings_for(const sim::SimulatedData& data, Mechanization mechanization, Vector3d error) {
    NavigatorSettings s;
    s.filter.vehicle = VehicleKind::Air;
    s.filter.mechanization = mechanization;
    s.filter.imu.kind = data.imu_kind;
    s.filter.imu.errors = sensor::imu_grade("tactical");
    s.filter.constraints.zero_velocity = false;
    s.imu_interval = 0.01;
    const ReferenceSample& truth = data.recording.reference.front();
    Start start;
    start.nav = {truth.time, truth.position, truth.velocity_n, math::quaternion_from_rpy(truth.rpy)};
    start.nav.q_nb = math::quaternion_from_rotation_vector(error) * start.nav.q_nb;
    start.std_position.setConstant(5.0);
    start.std_velocity.setConstant(0.3);
    start.std_rpy.setConstant(0.01);
    start.std_gyro_bias.setConstant(1e-5);
    start.std_accel_bias.setConstant(5e-3);
    s.start = start;
    return s;
}

/// What the navigator has at the end of the data.
NavigatorState flown(const sim::SimulatedData& data, const NavigatorSettings& settings) {
    NavigatorMade made = Navigator::make(settings);
    if (!made) throw std::runtime_error(made.key + ": " + made.reason);
    std::size_t k = 0;
    for (const ImuSample& imu : data.recording.imu) {
        for (; k < data.recording.gnss.size() && data.recording.gnss[k].time <= imu.time; ++k)
            (void)made.navigator->feed(data.recording.gnss[k]);
        (void)made.navigator->feed(imu);
    }
    const auto state = made.navigator->state();
    if (!state) {
        std::string events;
        while (const auto event = made.navigator->poll())
            events += " " + std::to_string(static_cast<int>(event->kind)) + "/" + std::to_string(static_cast<int>(event->phase)) +
                      "/" + std::to_string(static_cast<int>(event->status));
        throw std::runtime_error("does not navigate:" + events.substr(0, 300));
    }
    return *state;
}

/// Finite and positive definite, whatever the units of its states are: the correlations are decomposed.
void expect_definite(const NavigatorState& state) {
    ASSERT_TRUE(state.covariance.allFinite());
    ASSERT_GT(state.covariance.diagonal().minCoeff(), 0.0);
    const Eigen::VectorXd scale = state.covariance.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::MatrixXd correlations = scale.asDiagonal() * state.covariance * scale.asDiagonal();
    EXPECT_EQ(correlations.llt().info(), Eigen::Success);
    EXPECT_LE(correlations.cwiseAbs().maxCoeff(), 1.0 + 1e-9);
}

TEST(Extremes, ConsistentWhereverItFlies) {
    constexpr double pi = std::numbers::pi;
    const std::vector<ExtremeFlight> flights{
        {"100 m from the pole", {89.999 * deg, 10.0 * deg, 2800.0}, 0.0, 1.0},
        {"near the pole", {88.9 * deg, 20.0 * deg, 10e3}, 250.0, 1.6},
        {"south pole", {-89.95 * deg, 170.0 * deg, 3000.0}, 0.0, 2.0},
        {"date line", {10.0 * deg, 179.999 * deg, 9e3}, 250.0, 0.5 * pi},
        {"equator, date line, west", {0.0, -179.999 * deg, 100.0}, 30.0, 1.5 * pi},
        {"below the sea", {31.5 * deg, 35.5 * deg, -1000.0}, 20.0, 3.0},
        {"orbit", {-30.0 * deg, 60.0 * deg, 100e3}, 8000.0, 0.8},
        {"nose up", {50.0 * deg, 30.0 * deg, 200.0}, 0.0, 0.3, 0.0, 0.5 * pi},
        {"nose down", {50.0 * deg, 30.0 * deg, 200.0}, 0.0, 0.3, 0.2, -0.5 * pi},
        {"over the equator", {-0.12 * deg, 20.0 * deg, 9e3}, 250.0, 0.2},    // after 54 s
        {"loops", {45.0 * deg, 8.0 * deg, 500.0}, 0.0, 0.7, 0.0, 0.0, 0.5},  // nose up and down twenty times
        {"loops, banked", {-35.0 * deg, 18.0 * deg, 500.0}, 0.0, 4.0, 1e-3, 0.0, -0.3},
        {"upside down", {-20.0 * deg, 130.0 * deg, 50.0}, 0.0, 5.0, pi, 0.1},
    };
    const Vector3d error(0.003, -0.004, 0.008);
    for (const ExtremeFlight& flight : flights) {
        const sim::SimulatedData data = simulated(flight);
        const ReferenceSample& truth = data.recording.reference.back();
        for (const Mechanization mechanization : {Mechanization::Geographic, Mechanization::Ecef}) {
            if (mechanization == Mechanization::Geographic && std::abs(flight.start.lat) > 89.0 * deg) continue;
            SCOPED_TRACE(std::string(flight.name) + (mechanization == Mechanization::Ecef ? ", Earth-fixed" : ", geographic"));
            const NavigatorState state = flown(data, settings_for(data, mechanization, error));
            ASSERT_EQ(state.covariance.llt().info(), Eigen::Success);
            ASSERT_LT(std::abs((state.nav.time - truth.time).seconds()), 1e-6);
            Eigen::Matrix<double, 9, 1> e;
            // Near a pole north turns with the position: all is compared in Earth-fixed axes.
            const Eigen::Matrix3d C_en = earth::C_en(truth.position.lat, truth.position.lon);
            const Eigen::Matrix3d estimated = earth::C_en(state.nav.position.lat, state.nav.position.lon);
            e.head<3>() = C_en.transpose() * (earth::ecef_from_geodetic(earth::wgs84, state.nav.position).r -
                                              earth::ecef_from_geodetic(earth::wgs84, truth.position).r);
            e.segment<3>(3) = C_en.transpose() * estimated * state.nav.v_eb_n - truth.velocity_n;
            const Eigen::Quaterniond turn(estimated * state.nav.q_nb * (C_en * math::dcm_from_rpy(truth.rpy)).transpose());
            e.segment<3>(6) = C_en.transpose() * math::rotation_vector_from_quaternion(turn);
            for (int i = 0; i < 9; i += 3) {
                const double sigma = std::sqrt(state.covariance(i, i) + state.covariance(i + 1, i + 1));
                EXPECT_LT(e.segment<2>(i).norm(), 5.0 * sigma) << "horizontal, from " << i;
                EXPECT_LT(std::abs(e(i + 2)), 5.0 * std::sqrt(state.covariance(i + 2, i + 2))) << "component " << i + 2;
            }
            EXPECT_LT(state.covariance.diagonal().head<3>().sum(), 3.0 * 9.0);
        }
    }
}

TEST(Extremes, AbsurdNoiseLeavesTheCovariancePositive) {
    const sim::SimulatedData data = simulated({"rest", {50.0 * deg, 30.0 * deg, 200.0}, 0.0, 0.3});
    constexpr double tiny = std::numeric_limits<double>::denorm_min(), huge = 1e300;
    int navigated = 0, refused = 0, waiting = 0;
    for (const double std_of_fixes : {0.0, tiny, 1e-160, 1e-9, 1e9, 1e160, huge}) {
        for (const double std_of_start : {0.0, tiny, 1e-9, 1e6, 1e160}) {
            SCOPED_TRACE(std::to_string(std_of_fixes) + " of the fixes, " + std::to_string(std_of_start) + " of the start");
            NavigatorSettings settings = settings_for(data, Mechanization::Geographic, Vector3d::Zero());
            settings.start->std_position.setConstant(std_of_start);
            settings.start->std_velocity.setConstant(std_of_start);
            settings.start->std_gyro_bias.setZero();
            NavigatorMade made = Navigator::make(settings);
            if (!made) {
                EXPECT_FALSE(made.reason.empty());
                ++refused;
                continue;
            }
            std::size_t k = 0;
            for (std::size_t i = 0; i < 2000; ++i) {
                for (; k < 20 && data.recording.gnss[k].time <= data.recording.imu[i].time; ++k) {
                    GnssFix fix = data.recording.gnss[k];
                    fix.std_position.setConstant(std_of_fixes);
                    (void)made.navigator->feed(fix);
                }
                (void)made.navigator->feed(data.recording.imu[i]);
            }
            const auto state = made.navigator->state();
            if (!state) {  // began anew and waits: that is told by an event
                ++waiting;
                continue;
            }
            ++navigated;
            expect_definite(*state);
            EXPECT_LT(earth::ned_difference({}, state->nav.position, data.recording.reference.front().position).norm(), 100.0);
        }
    }
    std::printf("%d navigated, %d began anew, %d were refused\n", navigated, waiting, refused);
    EXPECT_EQ(navigated + waiting + refused, 7 * 5);
    EXPECT_GE(navigated, 20) << "little was judged";
}

/// An IMU without any noise, biases known exactly: nothing is added to the covariance, and fixes for two minutes make it small.
TEST(Extremes, AnImuWithoutNoise) {
    const sim::SimulatedData data = simulated({"rest", {50.0 * deg, 30.0 * deg, 200.0}, 0.0, 0.3});
    int judged = 0;
    for (const Mechanization mechanization : {Mechanization::Geographic, Mechanization::Ecef}) {
        for (const double std_of_biases : {0.0, 1e-5}) {
            SCOPED_TRACE(std::to_string(std_of_biases) +
                         (mechanization == Mechanization::Ecef ? ", Earth-fixed" : ", geographic"));
            NavigatorSettings settings = settings_for(data, mechanization, Vector3d::Zero());
            settings.filter.imu.errors = sensor::ImuErrorModel{};
            settings.start->std_gyro_bias.setConstant(std_of_biases);
            settings.start->std_accel_bias.setConstant(std_of_biases);
            NavigatorMade made = Navigator::make(settings);
            if (!made) {
                EXPECT_FALSE(made.reason.empty());
                continue;
            }
            const NavigatorState state = flown(data, settings);
            ++judged;
            expect_definite(state);
            EXPECT_LT(earth::ned_difference({}, state.nav.position, data.recording.reference.front().position).norm(), 20.0);
        }
    }
    EXPECT_GE(judged, 2);
}

/// A month at rest by ten samples and a fix a second: 26 million steps, 2.6 million fixes.
TEST(Extremes, AMonthWithoutEnd) {
    if (std::getenv("SCHULER_LONG_TESTS") == nullptr)
        GTEST_SKIP() << "takes more than a minute: set SCHULER_LONG_TESTS, or run scripts/trust month";
    NavigatorSettings settings;
    settings.filter.imu.errors = sensor::imu_grade("tactical");
    settings.imu_interval = 0.1;
    Start start;
    start.nav.position = {50.0 * deg, 30.0 * deg, 200.0};
    start.std_position.setConstant(5.0);
    start.std_velocity.setConstant(0.3);
    start.std_rpy.setConstant(0.01);
    start.std_gyro_bias.setConstant(1e-5);
    start.std_accel_bias.setConstant(5e-3);
    settings.start = start;
    NavigatorMade made = Navigator::make(settings);
    ASSERT_TRUE(made) << made.reason;
    const earth::EarthTerms terms = earth::terms_at({}, start.nav.position, Vector3d::Zero());
    const std::int64_t samples = 30LL * 86400 * 10;
    for (std::int64_t i = 1; i <= samples; ++i) {
        const Time time{i * 100'000'000};
        const double wave = std::sin(0.37 * static_cast<double>(i));  // noise without a generator: no two samples alike
        if (i % 10 == 0) {
            GnssFix fix{.time = time, .position = start.nav.position};
            fix.position.lat += 1e-7 * std::sin(1.7 * static_cast<double>(i));
            fix.position.h += 3.0 * wave;
            fix.std_position.setConstant(3.0);
            (void)made.navigator->feed(fix);
        }
        (void)made.navigator->feed(ImuSample{time, terms.w_ie_n + Vector3d::Constant(1e-5 * wave),
                                             Vector3d(0.003 * wave, -0.002 * wave, 0.0) - terms.g_n});
        if (i % 864'000 == 0) {  // each day
            const auto state = made.navigator->state();
            ASSERT_TRUE(state) << i / 864'000 << " days";
            ASSERT_EQ(state->covariance.llt().info(), Eigen::Success) << i / 864'000 << " days";
            ASSERT_LT(earth::ned_difference({}, state->nav.position, start.nav.position).norm(),
                      5.0 * std::sqrt(state->covariance.diagonal().head<3>().sum()))
                << i / 864'000 << " days";
        }
    }
}

}  // namespace
}  // namespace schuler::filter
