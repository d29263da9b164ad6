#include "sim/paths.h"

#include "schuler/core/error.h"
#include "schuler/math/chi_square.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/imu_errors.h"
#include "schuler/sim/inverse_imu.h"
#include "schuler/sim/simulate.h"

#include <gtest/gtest.h>

#include <functional>

namespace schuler::sim {
namespace {

using Eigen::Vector3d;
using testing::deg;

/// sum_of_squares of `count` standard normal numbers is what chance allows (two-sided, 1 in 10 000 of failing).
void expect_chi_square(double sum_of_squares, double count) {
    EXPECT_GT(sum_of_squares, math::chi_square_quantile(5e-5, count));
    EXPECT_LT(sum_of_squares, math::chi_square_quantile(1.0 - 5e-5, count));
}

Scenario at_rest(double duration) {
    Scenario s;
    s.duration = duration;
    s.path = StaticPath{{45.0 * deg, 20.0 * deg, 100.0}, Vector3d::Zero()};
    s.imu.rate = 50.0;
    return s;
}

bool same(const std::vector<ImuSample>& a, const std::vector<ImuSample>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const ImuSample& x, const ImuSample& y) {
        return x.time == y.time && x.gyro == y.gyro && x.accel == y.accel;
    });
}

bool same(const std::vector<GnssFix>& a, const std::vector<GnssFix>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const GnssFix& x, const GnssFix& y) {
        return x.time == y.time && x.position.lat == y.position.lat && x.position.lon == y.position.lon &&
               x.position.h == y.position.h && x.velocity_n == y.velocity_n;
    });
}

TEST(ImuErrors, WhiteNoiseHasTheStatedRandomWalk) {
    Scenario s = at_rest(400.0);
    const SimulatedData exact = simulate(s);
    s.imu.errors.gyro_noise = 0.1 * units::deg_per_sqrt_hour;
    s.imu.errors.accel_noise = 0.02 * units::m_s_per_sqrt_hour;
    const SimulatedData noisy = simulate(s);
    double gyro = 0.0, accel = 0.0, neighbours = 0.0;
    Vector3d before = Vector3d::Zero(), angle = Vector3d::Zero();
    const double sigma = s.imu.errors.gyro_noise * std::sqrt(0.02);
    for (std::size_t k = 0; k < exact.recording.imu.size(); ++k) {
        const Vector3d dg = noisy.recording.imu[k].gyro - exact.recording.imu[k].gyro;
        const Vector3d da = noisy.recording.imu[k].accel - exact.recording.imu[k].accel;
        gyro += (dg / sigma).squaredNorm();
        accel += (da / (s.imu.errors.accel_noise * std::sqrt(0.02))).squaredNorm();
        neighbours += dg.dot(before) / (sigma * sigma);
        before = dg;
        angle += dg;
    }
    const auto count = static_cast<double>(3 * exact.recording.imu.size());
    EXPECT_EQ(exact.recording.imu.size(), 20000u);
    expect_chi_square(gyro, count);
    expect_chi_square(accel, count);
    EXPECT_LT(std::abs(neighbours) / std::sqrt(count), 4.0);
    // The angle walks: 0.1 deg/sqrt(h) over 400 s.
    expect_chi_square((angle / (0.1 * deg * std::sqrt(400.0 / 3600.0))).squaredNorm(), 3.0);
}

TEST(ImuErrors, InRunBiasIsAStationaryGaussMarkovProcess) {
    sensor::ImuErrorModel model;
    model.gyro_bias = 3e-5;
    model.gyro_bias_time = 20.0;
    const int runs = 400;
    double start = 0.0, end = 0.0, shared = 0.0;
    for (std::uint64_t seed = 0; seed < runs; ++seed) {
        SensorTriad gyro = gyro_triad(model, seed);
        const Vector3d b0 = gyro.bias() / model.gyro_bias;
        Vector3d angle = Vector3d::Zero();
        for (int k = 0; k < 100; ++k) angle += gyro.measure(Vector3d::Zero(), 0.1);
        const Vector3d b1 = gyro.bias() / model.gyro_bias;
        start += b0.squaredNorm();
        end += b1.squaredNorm();
        // Given the start, the end has mean b0 exp(-t/T) and variance 1 - exp(-2t/T).
        const double kept = std::exp(-10.0 / 20.0);
        shared += (b1 - kept * b0).squaredNorm() / (1.0 - kept * kept);
        ASSERT_LT(angle.norm(), 10.0 * 6.0 * model.gyro_bias);
    }
    for (const double sum : {start, end, shared}) expect_chi_square(sum, 3.0 * runs);
}

TEST(ImuErrors, ConstantsOfARunAreDrawnAsStated) {
    sensor::ImuErrorModel model;
    model.accel_turn_on_bias = 0.02;
    model.accel_scale = 3e-4;
    model.accel_misalignment = 5e-4;
    const int runs = 400;
    double bias = 0.0, scale = 0.0, misalignment = 0.0;
    for (std::uint64_t seed = 0; seed < runs; ++seed) {
        SensorTriad accel = accel_triad(model, seed);
        const Eigen::Matrix3d error = accel.gain() - Eigen::Matrix3d::Identity();
        bias += (accel.bias() / 0.02).squaredNorm();
        scale += (error.diagonal() / 3e-4).squaredNorm();
        misalignment += (error.squaredNorm() - error.diagonal().squaredNorm()) / 25e-8;
        const Vector3d exact(0.1, -0.2, 0.3);
        const Vector3d expected = exact + error * exact + 0.5 * accel.bias();
        ASSERT_LT((accel.measure(exact, 0.5) - expected).norm(), 1e-15);
    }
    expect_chi_square(bias, 3.0 * runs);
    expect_chi_square(scale, 3.0 * runs);
    expect_chi_square(misalignment, 6.0 * runs);
}

TEST(ImuErrors, QuantizationLosesNothing) {
    sensor::ImuErrorModel model;
    model.gyro_quantum = 1e-5;
    SensorTriad gyro = gyro_triad(model, 1);
    Vector3d in = Vector3d::Zero(), out = Vector3d::Zero();
    for (int k = 0; k < 1000; ++k) {
        const Vector3d exact(3.3e-6, -1.7e-5 * std::sin(0.1 * k), 2.1e-7);
        const Vector3d measured = gyro.measure(exact, 0.01);
        in += exact;
        out += measured;
        ASSERT_LT((in - out).cwiseAbs().maxCoeff(), 0.5001e-5);
        ASSERT_NEAR(std::remainder(measured.x(), 1e-5), 0.0, 1e-18);
    }
    EXPECT_GT(out.x(), 3e-3);
}

TEST(Simulate, ExactImuIsTheIntegralOfThePath) {
    Scenario s;
    s.path = testing::example_route();
    s.duration = 60.0;
    s.imu.rate = 10.0;
    const SimulatedData increments = simulate(s);
    s.imu.kind = ImuKind::Rates;
    s.imu.mounting = Vector3d(0.02, -0.1, 3.0);
    const SimulatedData rates = simulate(s);
    const auto path = make_path(s.path, earth::wgs84);
    const Eigen::Matrix3d C_sb = testing::body_axes(s.imu.mounting).transpose();
    for (std::size_t k = 300; k < 600; k += 7) {
        // Simpson's rule on a grid of its own.
        Vector3d angle = Vector3d::Zero(), velocity = Vector3d::Zero();
        const int n = 64;
        const double from = 0.1 * static_cast<double>(k), h = 0.1 / n;
        for (int j = 0; j <= n; ++j) {
            const double weight = h / 3.0 * (j == 0 || j == n ? 1.0 : (j % 2 == 1 ? 4.0 : 2.0));
            const InertialInput input = inertial_input(s.earth, path->at(from + h * j));
            angle += weight * input.w_ib_b;
            velocity += weight * input.f_b;
        }
        const ImuSample& sample = increments.recording.imu[k];
        EXPECT_EQ(sample.time, Time::from_seconds(from + 0.1));
        EXPECT_LT((sample.gyro - angle).norm(), 1e-8);
        EXPECT_LT((sample.accel - velocity).norm(), 2e-7);
        EXPECT_LT((0.1 * rates.recording.imu[k].gyro - C_sb * sample.gyro).norm(), 1e-14);
        EXPECT_LT((0.1 * rates.recording.imu[k].accel - C_sb * sample.accel).norm(), 1e-14);
    }
}

Scenario full() {
    Scenario s;
    s.seed = 42;
    s.origin = Time::from_gps(2374, 1000.0);
    s.path = testing::example_route();
    s.duration = 120.0;
    s.imu.errors = sensor::imu_grade("mems");
    s.gnss.rate = 5.0;
    s.gnss.lever_arm_b = {1.0, 0.2, -1.5};
    s.gnss.errors.correlated_position = {2.0, 2.0, 3.0};
    s.baro = {10.0, 0.4, 3.0, 0.05};
    return s;
}

TEST(Simulate, SameSeedSameNumbersAndChannelsDoNotDisturbEachOther) {
    const SimulatedData first = simulate(full());
    const SimulatedData again = simulate(full());
    EXPECT_TRUE(same(first.recording.imu, again.recording.imu));
    EXPECT_TRUE(same(first.recording.gnss, again.recording.gnss));

    Scenario other = full();
    other.seed = 43;
    EXPECT_FALSE(same(first.recording.imu, simulate(other).recording.imu));

    Scenario quiet = full();
    quiet.baro.rate = 0.0;
    quiet.imu.errors.gyro_noise = 0.0;
    const SimulatedData without = simulate(quiet);
    EXPECT_TRUE(without.recording.baro.empty());
    EXPECT_TRUE(same(first.recording.gnss, without.recording.gnss));
    EXPECT_EQ(first.recording.imu[777].accel, without.recording.imu[777].accel);
    EXPECT_NE(first.recording.imu[777].gyro, without.recording.imu[777].gyro);
}

TEST(Simulate, OutagesWithholdEpochsStrictlyInsideAndLeaveTheOthers) {
    Scenario s = full();
    const SimulatedData all = simulate(s);
    s.outages = {{20.0, 10.0, Channel::Gnss}, {50.0, 1.0, Channel::Baro}};
    const SimulatedData some = simulate(s);
    std::vector<GnssFix> expected;
    for (const GnssFix& fix : all.recording.gnss) {
        const double t = (fix.time - s.origin).seconds();
        if (!(t > 20.0 && t < 30.0)) expected.push_back(fix);
    }
    EXPECT_EQ(all.recording.gnss.size(), 601u);
    EXPECT_EQ(expected.size(), 601u - 49u);
    EXPECT_TRUE(same(some.recording.gnss, expected));
    EXPECT_EQ(some.recording.baro.size(), all.recording.baro.size() - 9u);
    EXPECT_TRUE(same(some.recording.imu, all.recording.imu));
}

TEST(Simulate, GnssErrorsAreAsStated) {
    Scenario s = at_rest(3000.0);
    s.imu.rate = 1.0;
    s.gnss.white_position = {0.5, 1.0, 2.0};
    s.gnss.errors.correlated_position = {3.0, 3.0, 6.0};
    s.gnss.errors.correlated_time = 100.0;
    s.gnss.white_velocity = {0.03, 0.04, 0.05};
    const SimulatedData data = simulate(s);
    const Vector3d truth = testing::ecef(std::get<StaticPath>(s.path).start);
    const Eigen::Matrix3d axes = testing::level_axes(std::get<StaticPath>(s.path).start);
    // Against the one before: e1 - a e0 is white with variance w^2 (1 + a^2) + c^2 (1 - a^2) and a known neighbour correlation;
    // differences of pairs two epochs apart are independent.
    const double a = std::exp(-0.01);
    double position = 0.0, velocity = 0.0;
    Vector3d mean_square = Vector3d::Zero();
    double pairs = 0.0;
    const auto error = [&](std::size_t k) {
        return Vector3d(axes.transpose() * (testing::ecef(data.recording.gnss[k].position) - truth));
    };
    const Vector3d w2 = s.gnss.white_position.cwiseAbs2(), c2 = s.gnss.errors.correlated_position.cwiseAbs2();
    for (std::size_t k = 0; k + 1 < data.recording.gnss.size(); k += 2) {
        const Vector3d step = error(k + 1) - a * error(k);
        position += step.cwiseAbs2().cwiseQuotient((1.0 + a * a) * w2 + (1.0 - a * a) * c2).sum();
        velocity += data.recording.gnss[k].velocity_n.cwiseQuotient(s.gnss.white_velocity).squaredNorm();
        mean_square += error(k).cwiseAbs2();
        pairs += 1.0;
    }
    expect_chi_square(position, 3.0 * pairs);
    expect_chi_square(velocity, 3.0 * pairs);
    // The whole variance, with about 3000 s / (2 x 100 s) x 2 independent values of the slow part an axis.
    const Vector3d ratio = (mean_square / pairs).cwiseQuotient(w2 + c2);
    EXPECT_GT(ratio.minCoeff(), 0.3);
    EXPECT_LT(ratio.maxCoeff(), 2.5);
    EXPECT_LT((data.recording.gnss[5].std_position - (w2 + c2).cwiseSqrt()).norm(), 1e-14);
}

TEST(Simulate, LateFixesTellWhereTheAntennaWas) {
    Scenario s = full();
    s.gnss.white_position.setZero();
    s.gnss.white_velocity.setZero();
    s.gnss.errors.correlated_position.setZero();
    const SimulatedData prompt = simulate(s);
    s.gnss.position_latency = 0.4;
    s.gnss.velocity_latency = 0.2;
    const SimulatedData late = simulate(s);
    ASSERT_EQ(late.recording.gnss.size() + 2, prompt.recording.gnss.size());  // none from before the flight
    for (std::size_t k = 2; k < prompt.recording.gnss.size(); ++k) {
        EXPECT_EQ(late.recording.gnss[k - 2].time, prompt.recording.gnss[k].time);
        const Vector3d apart =
            testing::ecef(late.recording.gnss[k - 2].position) - testing::ecef(prompt.recording.gnss[k - 2].position);
        ASSERT_LT(apart.norm(), 1e-8);
        ASSERT_LT((late.recording.gnss[k - 2].velocity_n - prompt.recording.gnss[k - 1].velocity_n).norm(), 1e-9);
    }
}

TEST(Simulate, BaroBiasWalks) {
    Scenario s = at_rest(100.0);
    s.imu.rate = 1.0;
    s.gnss.rate = 0.0;
    s.baro = {10.0, 0.0, 0.0, 0.2};
    double first = 0.0, walked = 0.0;
    const int runs = 200;
    for (std::uint64_t seed = 0; seed < runs; ++seed) {
        s.seed = seed;
        s.baro.bias = 4.0;
        const SimulatedData data = simulate(s);
        const double start = data.recording.baro.front().height - 100.0, end = data.recording.baro.back().height - 100.0;
        first += start * start / 16.0;
        walked += (end - start) * (end - start) / 4.0;  // 0.2 m/sqrt(s) over 100 s
    }
    expect_chi_square(first, runs);
    expect_chi_square(walked, runs);
}

TEST(Simulate, TruthIsThePathAndTheSensorErrorsOfTheMoment) {
    Scenario s = full();
    const SimulatedData data = simulate(s);
    ASSERT_EQ(data.recording.reference.size(), 1201u);
    ASSERT_EQ(data.sensor_truth.size(), 1201u);
    const auto path = make_path(s.path, earth::wgs84);
    const ReferenceSample& r = data.recording.reference[437];
    EXPECT_EQ(r.time, s.origin + Duration::from_seconds(43.7));
    EXPECT_EQ(r.position.lat, path->at(43.7).position.lat);
    EXPECT_EQ(r.rpy, path->at(43.7).rpy);
    EXPECT_FALSE(data.recording.reference[100].movement);
    EXPECT_TRUE(r.movement);
    // The mean of what a gyro at rest says too much is its bias there (20 s of 100 Hz).
    Vector3d mean = Vector3d::Zero();
    const Vector3d exact = inertial_input(s.earth, path->at(0.0)).w_ib_b;
    for (std::size_t k = 0; k < 1900; ++k) mean += (data.recording.imu[k].gyro / 0.01 - exact) / 1900.0;
    const double sigma = s.imu.errors.gyro_noise / std::sqrt(19.0) + 0.3 * s.imu.errors.gyro_bias;
    EXPECT_LT((mean - data.sensor_truth[95].gyro_bias).cwiseAbs().maxCoeff(), 4.0 * sigma);
    EXPECT_GT(data.sensor_truth[95].gyro_bias.norm(), 8.0 * sigma);
}

// Two-sample variance of averages over T of the rate of an axis, against [IEEE952]: white N^2/T, flicker (2 ln 2 / pi) B^2, walk K^2 T/3.
double allan_variance(const std::vector<ImuSample>& imu, std::size_t averaged, double rate) {
    double sum = 0.0, n = 0.0;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
        double before = 0.0;
        for (std::size_t k = 0; (k + 1) * averaged <= imu.size(); ++k) {
            double mean = 0.0;
            for (std::size_t i = k * averaged; i < (k + 1) * averaged; ++i)
                mean += imu[i].gyro[axis] * rate / static_cast<double>(averaged);
            if (k > 0) {
                sum += 0.5 * (mean - before) * (mean - before);
                n += 1.0;
            }
            before = mean;
        }
    }
    return sum / n;
}

TEST(Simulate, FlickerAndRateWalkHaveTheirAllanVariance) {
    Scenario s = at_rest(20000.0);
    s.imu.rate = 2.0;
    s.gnss.rate = 0.0;
    s.imu.errors = {};
    s.imu.errors.gyro_flicker = 1e-6;
    const auto flicker = simulate(s).recording.imu;
    for (const std::size_t averaged : {20U, 100U, 400U})
        EXPECT_NEAR(allan_variance(flicker, averaged, 2.0) / (0.664 * 0.664 * 1e-12), 1.0, averaged < 200 ? 0.12 : 0.25)
            << averaged;
    s.imu.errors.gyro_flicker = 0.0;
    s.imu.errors.gyro_rate_walk = 1e-8;
    const auto walk = simulate(s).recording.imu;
    EXPECT_NEAR(allan_variance(walk, 200, 2.0) / (1e-16 * 100.0 / 3.0), 1.0, 0.25);
}

TEST(Simulate, TemperatureForceAndRangeActAsStated) {
    Scenario s = at_rest(60.0);
    s.imu.errors = {};
    s.imu.warm_up = 20.0;
    s.imu.warm_up_time = 10.0;
    s.imu.errors.gyro_temperature = 1e-6;
    s.imu.errors.accel_range = 5.0;  // below gravity
    SimulatedData warm = simulate(s);
    // The bias follows the temperature: the same coefficient at two times.
    const Vector3d early = warm.sensor_truth[100].gyro_bias, late = warm.sensor_truth[500].gyro_bias;
    EXPECT_GT(late.norm(), 1e-6);
    EXPECT_LT((early / -std::expm1(-1.0) - late / -std::expm1(-5.0)).norm(), 1e-6 * late.norm());
    double most = 0.0;
    for (const ImuSample& sample : warm.recording.imu) most = std::max(most, sample.accel.cwiseAbs().maxCoeff());
    EXPECT_NEAR(most, 5.0 / s.imu.rate, 1e-12);

    double square = 0.0;  // drift of gyros by gravity alone: nine coefficients, three of them feel it
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        Scenario g = at_rest(1.0);
        g.seed = seed;
        g.imu.errors = {};
        g.gnss.rate = 0.0;
        const Vector3d exact = simulate(g).recording.imu.back().gyro;
        g.imu.errors.gyro_g = 1e-6;
        square += ((simulate(g).recording.imu.back().gyro - exact) * g.imu.rate / 9.8 / 1e-6).squaredNorm();
    }
    expect_chi_square(square, 900.0);
}

TEST(Simulate, FaultsAreInTheLogAndNowhereElse) {
    Scenario s = full();
    const SimulatedData healthy = simulate(s);
    s.faults = {{Channel::Gnss, FaultKind::Ramp, 20.0, 10.0, 0.5, {3.0, 4.0, 0.0}},
                {Channel::Gnss, FaultKind::Dropout, 50.0, 2.0, 0.0, Vector3d::UnitX()},
                {Channel::Gnss, FaultKind::Freeze, 60.0, 2.0, 0.0, Vector3d::UnitX()},
                {Channel::Baro, FaultKind::Step, 30.0, 1e9, 7.0, Vector3d::UnitX()},
                {Channel::Imu, FaultKind::Gyro, 70.0, 1.0, 1e-3, Vector3d::UnitZ()}};
    const SimulatedData ill = simulate(s);
    EXPECT_EQ(healthy.recording.gnss.size(), ill.recording.gnss.size() + 10);
    std::size_t i = 0;
    for (const GnssFix& fix : healthy.recording.gnss) {
        const double t = (fix.time - s.origin).seconds();
        if (t >= 50.0 && t < 52.0) continue;
        const GnssFix& other = ill.recording.gnss[i++];
        ASSERT_EQ(other.time, fix.time);
        const Vector3d apart =
            testing::level_axes(fix.position).transpose() * (testing::ecef(other.position) - testing::ecef(fix.position));
        if (t >= 20.0 && t < 30.0) ASSERT_LT((apart - 0.5 * (t - 20.0) * Vector3d(0.6, 0.8, 0.0)).norm(), 1e-5) << t;
        else if (t >= 60.0 && t < 62.0) ASSERT_EQ(other.position.lat, ill.recording.gnss[i - 2].position.lat);
        else ASSERT_EQ(apart.norm(), 0.0) << t;
    }
    EXPECT_NEAR(ill.recording.baro.back().height - healthy.recording.baro.back().height, 7.0, 1e-9);
    EXPECT_EQ(ill.recording.baro.front().height, healthy.recording.baro.front().height);
    EXPECT_NEAR((ill.recording.imu[7050].gyro - healthy.recording.imu[7050].gyro).z(), 1e-5, 1e-12);
    EXPECT_EQ(ill.recording.imu[6900].gyro, healthy.recording.imu[6900].gyro);
}

TEST(Simulate, PressuresAreThoseOfTheDay) {
    Scenario s = at_rest(10.0);
    s.baro = {.rate = 1.0, .white = 0.0, .pressure = true, .sea_level_pressure = 99000.0, .temperature_offset = 20.0};
    const SimulatedData data = simulate(s);
    const double h = std::get<StaticPath>(s.path).start.h;
    // Near the ground p = p0 (1 - g h / (R T)) within 1e-4 of its change.
    const double expected = 99000.0 * std::exp(-9.80665 * h / (287.05287 * (308.15 - 0.00325 * h)));
    EXPECT_NEAR(data.recording.baro[3].pressure, expected, 0.1);
    EXPECT_TRUE(std::isnan(data.recording.baro[3].height));
    EXPECT_GT(data.baro_truth[3].bias, 150.0);  // 23 hPa below the standard
}

TEST(Simulate, MagneticFieldIsThatOfThePlaceAndTheIron) {
    Scenario s = at_rest(10.0);
    s.mag = {1.0, 50e-6, 0.1, 1.1, 0.0, 0.0, 0.0};
    const auto clean = simulate(s).recording.mag;
    ASSERT_EQ(clean.size(), 11u);
    const Vector3d field = testing::body_axes(std::get<StaticPath>(s.path).rpy) * clean[4].field_b;
    EXPECT_NEAR(std::atan2(field.y(), field.x()), 0.1, 1e-12);
    EXPECT_NEAR(std::atan2(field.z(), field.head<2>().norm()), 1.1, 1e-12);
    EXPECT_NEAR(field.norm(), 50e-6, 1e-18);
    double square = 0.0;
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
        s.seed = seed;
        s.mag.hard_iron = 3e-6;
        square += ((simulate(s).recording.mag[4].field_b - clean[4].field_b) / 3e-6).squaredNorm();
    }
    expect_chi_square(square, 900.0);
}

TEST(Simulate, UnusableSettingsAreNamed) {
    const auto key_of = [](const std::function<void(Scenario&)>& spoil) {
        Scenario s = full();
        s.duration = 1.0;
        spoil(s);
        try {
            (void)simulate(s);
        } catch (const Error& error) {
            EXPECT_EQ(error.kind(), ErrorKind::Input);
            return error.place().key;
        }
        return std::string("accepted");
    };
    EXPECT_EQ(key_of([](Scenario&) {}), "accepted");
    EXPECT_EQ(key_of([](Scenario& s) { s.duration = -1.0; }), "duration_s");
    EXPECT_EQ(key_of([](Scenario& s) { s.imu.rate = 0.0; }), "imu.rate_hz");
    EXPECT_EQ(key_of([](Scenario& s) { s.imu.errors.gyro_noise = std::nan(""); }), "imu");
    EXPECT_EQ(key_of([](Scenario& s) { s.gnss.lever_arm_b.x() = 1e6; }), "gnss.lever_arm_m");
    EXPECT_EQ(key_of([](Scenario& s) { s.baro.white = -1.0; }), "baro");
    EXPECT_EQ(key_of([](Scenario& s) { s.reference_rate = 0.0; }), "reference_rate_hz");
    EXPECT_EQ(key_of([](Scenario& s) { s.outages = {{1.0, -1.0, Channel::Gnss}}; }), "outage");
}

}  // namespace
}  // namespace schuler::sim
