// Calibration from the log: what the readings show is found, what they do not show stays, and what would harm is refused. Axes of the
// magnetometer in all orders and signs.
#include "ahrs/simulated_motion.h"
#include "support/perturbation.h"

#include "schuler/ahrs/calibration.h"
#include "schuler/ahrs/constant_magnet.h"
#include "schuler/ahrs/magnetometer_axes.h"
#include "schuler/ahrs/magnetometer_clock.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace testing;

struct CalibrationLog {
    std::vector<ImuSample> imu;
    std::vector<MagSample> mag;
};

/// A sensor that is turned about all axes, its magnetometer wrong by a matrix and a hard iron.
CalibrationLog turned(const Matrix3d& distortion, const Vector3d& iron, std::uint64_t seed, double duration = 120.0,
                      double reach = 1.0) {
    Motion m;
    m.gravity = 9.81;
    math::Random noise(seed, "turned");
    CalibrationLog l;
    const auto attitude = [&](double t) {
        return math::quaternion_from_rpy(
            {reach * 2.5 * std::sin(0.9 * t), reach * 1.2 * std::sin(0.55 * t + 0.4), reach * 2.8 * std::sin(0.31 * t + 1.0)});
    };
    const Vector3d field_n(m.horizontal, 0.0, m.vertical);
    for (double t = m.dt; t < duration; t += m.dt) {
        const Eigen::Quaterniond q = attitude(t), before = attitude(t - m.dt);
        const Vector3d rate = math::rotation_vector_from_quaternion(before.conjugate() * q) / m.dt;
        const Vector3d force = q.conjugate() * Vector3d(0.0, 0.0, -m.gravity), field = q.conjugate() * field_n;
        l.imu.push_back({Time::from_seconds(t), rate + 2e-3 * noise.normal3(), force + 0.05 * noise.normal3()});
        l.mag.push_back({Time::from_seconds(t), distortion * field + iron + m.field_std * noise.normal3()});
    }
    return l;
}

/// At rest in some attitudes, a few seconds each; the accelerometer wrong by a matrix and a bias.
CalibrationLog rested(int attitudes, const Matrix3d& distortion, const Vector3d& bias) {
    math::Random noise(3, "rested");
    CalibrationLog l;
    double t = 0.0;
    for (int a = 0; a < attitudes; ++a) {
        const Vector3d down = noise.normal3().normalized();
        for (int i = 0; i < 400; ++i, t += 0.01)
            l.imu.push_back(
                {Time::from_seconds(t), 1e-4 * noise.normal3(), distortion * (-9.81 * down) + bias + 0.02 * noise.normal3()});
        for (int i = 0; i < 100; ++i, t += 0.01)
            l.imu.push_back({Time::from_seconds(t), noise.normal3(), 9.81 * noise.normal3()});
    }
    return l;
}

Matrix3d some_distortion(double size) {
    Matrix3d d;
    d << 1.0, 0.5, -0.2, 0.5, -0.8, 0.3, -0.2, 0.3, 0.4;
    return Matrix3d::Identity() + size * d;
}

SCHULER_JACOBIAN(size_error, "ahrs.size_error") {
    EllipsoidFit fit;
    fit.offset = Vector3d(0.1, -0.2, 0.3);
    fit.gain = some_distortion(0.1);
    fit.size = 1.0;
    const Vector3d measured(0.7, -0.9, 0.4);
    schuler::test::LinearModel m;
    m.where = "off the centre";
    m.analytic = size_error(fit, measured).H;
    m.output = [=](const Eigen::VectorXd& dx) {
        EllipsoidFit f = fit;
        f.offset += dx.head<3>();
        Matrix3d d;
        d << dx(3), dx(6), dx(7), dx(6), dx(4), dx(8), dx(7), dx(8), dx(5);
        f.gain += d;
        return Eigen::VectorXd::Constant(1, size_error(f, measured).error).eval();
    };
    m.step = Eigen::VectorXd::Constant(ellipsoid_parameters, 1e-3);
    m.tolerance = schuler::test::tolerance_of(m.analytic, 1e-8, Eigen::VectorXd::Constant(1, 1e-9), m.step.cwiseInverse() * 1e-3);
    return {m};
}

TEST(AhrsCalibration, EllipsoidIsUndoneAndItsCovarianceIsTrue) {
    math::Random random(6, "calibration");
    const Matrix3d distortion = some_distortion(0.08);
    const Vector3d iron(12e-6, -7e-6, 20e-6);
    EllipsoidPrior prior{.offset_std = 50e-6, .gain_std = 0.1, .noise = 1e-7};
    double nees = 0.0;
    constexpr int runs = 30;
    for (int run = 0; run < runs; ++run) {
        std::vector<Vector3d> readings;
        for (int i = 0; i < 500; ++i)
            readings.push_back(distortion * (48e-6 * random.normal3().normalized()) + iron + 1e-7 * random.normal3());
        readings[5] = Vector3d(9e-5, 9e-5, 9e-5);
        const auto fit = fit_ellipsoid(readings, 48e-6, prior);
        ASSERT_TRUE(fit.has_value());
        EXPECT_LT((fit->offset - iron).norm(), 5e-8);
        EXPECT_LT((fit->gain - distortion.inverse()).norm(), 3e-3);
        const Vector3d e = fit->offset - iron;
        nees += e.dot(fit->covariance.topLeftCorner<3, 3>().inverse() * e) / runs;
    }
    // three degrees of freedom; 90 together: 2.2 to 3.9 of 99 in a hundred. The noise across the distorted field is some 8 % more or less
    EXPECT_GT(nees, 2.0);
    EXPECT_LT(nees, 4.2);
}

TEST(AhrsCalibration, WhatTheReadingsDoNotShowStaysAtThePrior) {
    // a cap of 20 deg: the size along it is seen, the rest is not
    math::Random random(7, "cap");
    EllipsoidPrior prior{.offset_std = 20e-6, .gain_std = 0.05, .noise = 2e-7};
    std::vector<Vector3d> readings;
    for (int i = 0; i < 2000; ++i)
        readings.push_back(48e-6 * (Vector3d::UnitZ() + 0.2 * random.normal3()).normalized() + 2e-7 * random.normal3());
    const auto fit = fit_ellipsoid(readings, 48e-6, prior);
    ASSERT_TRUE(fit.has_value());
    EXPECT_LT((fit->gain - Matrix3d::Identity()).cwiseAbs().maxCoeff(), 3.0 * prior.gain_std);
    EXPECT_GT(fit->offset_std(), 1e-6) << "and it says that it does not know";
}

TEST(AhrsJudge, AMagnetometerIsMendedWhereItNeedsItAndShowsIt) {
    const Vector3d iron(9e-6, -6e-6, 8e-6);
    const CalibrationLog bad = turned(some_distortion(0.03), iron, 1);
    const JudgedCalibration judged = judge_magnetometer(bad.imu, bad.mag, 0.0);
    ASSERT_TRUE(judged.fit.has_value()) << judged.reason;
    EXPECT_LT((judged.fit->offset - iron).norm(), 0.5e-6);

    const CalibrationLog good = turned(Matrix3d::Identity(), Vector3d::Zero(), 2);
    EXPECT_FALSE(judge_magnetometer(good.imu, good.mag, 0.0).fit.has_value()) << "there is nothing to mend";
    const CalibrationLog little = turned(some_distortion(0.03), iron, 3, 120.0, 0.03);
    const JudgedCalibration refused = judge_magnetometer(little.imu, little.mag, 0.0);
    EXPECT_FALSE(refused.fit.has_value()) << "a few degrees of turning do not show it";
    EXPECT_NE(refused.reason.find("held-out"), std::string::npos) << refused.reason;
}

// as much hard iron as the field itself, with which the raw readings are twice as large
class AhrsJudgeOfStillReadings : public ::testing::TestWithParam<std::pair<double, double>> {};

TEST_P(AhrsJudgeOfStillReadings, AreOfNoiseAlone) {
    const auto [gain, iron] = GetParam();
    CalibrationLog weak = turned(gain * some_distortion(0.03), iron * Vector3d(9e-6, -6e-6, 8e-6), 9);
    // a still minute at its end, in which noise is all that the calibration can make worse
    math::Random noise(9, "still");
    const Vector3d field = weak.mag.back().field_b, force = weak.imu.back().accel;
    for (double t = 120.0; t < 180.0; t += 0.01) {
        weak.imu.push_back({Time::from_seconds(t), 2e-3 * noise.normal3(), force + 0.05 * noise.normal3()});
        weak.mag.push_back({Time::from_seconds(t), field + 200e-9 * noise.normal3()});
    }
    const JudgedCalibration judged = judge_magnetometer(weak.imu, weak.mag, Vector3d(18964e-9, 0.0, 46962e-9).norm());
    ASSERT_TRUE(judged.fit.has_value()) << judged.reason;
    EXPECT_NEAR(judged.fit->gain.trace() / 3.0, 1.0 / gain, 0.05);
}
INSTANTIATE_TEST_SUITE_P(WeakOrMagnetic, AhrsJudgeOfStillReadings, ::testing::Values(std::pair(0.8, 1.0), std::pair(1.0, 5.0)));

TEST(AhrsJudge, AMagnetThatComesAndGoesIsNoCalibration) {
    CalibrationLog l = turned(Matrix3d::Identity(), Vector3d::Zero(), 4);
    for (MagSample& s : l.mag) {
        if (std::fmod(s.time.seconds(), 40.0) > 20.0) s.field_b += Vector3d(4e-6, 8e-6, -5e-6);
    }
    const JudgedCalibration judged = judge_magnetometer(l.imu, l.mag, 0.0);
    if (!judged.fit) return;
    // a compromise is tolerable: nothing beyond the disturbance itself
    EXPECT_LT(judged.fit->offset.norm(), 11e-6);
}

TEST(AhrsJudge, AnAccelerometerNeedsAttitudes) {
    const Vector3d bias(0.15, -0.1, 0.08);
    const CalibrationLog few = rested(3, some_distortion(0.004), bias);
    const JudgedCalibration refused = judge_accelerometer(few.imu, 9.81);
    EXPECT_FALSE(refused.fit.has_value());
    EXPECT_NE(refused.reason.find("attitudes"), std::string::npos) << refused.reason;
    const CalibrationLog many = rested(20, some_distortion(0.004), bias);
    const JudgedCalibration judged = judge_accelerometer(many.imu, 9.81);
    ASSERT_TRUE(judged.fit.has_value()) << judged.reason;
    EXPECT_LT((judged.fit->offset - bias).norm(), 0.02);
    const CalibrationLog right = rested(20, Matrix3d::Identity(), Vector3d::Zero());
    EXPECT_FALSE(judge_accelerometer(right.imu, 9.81).fit.has_value()) << "there is nothing to mend";
}

/// Readings of a magnetometer whose axes are such that C_bs of the readings is the field in b.
CalibrationLog mounted(const CalibrationLog& l, const Matrix3d& C_bs) {
    CalibrationLog out = l;
    for (MagSample& s : out.mag) s.field_b = (C_bs.transpose() * s.field_b).eval();
    return out;
}

TEST(AhrsAxes, AllOrdersAndSignsAreRecognised) {
    const CalibrationLog l = turned(Matrix3d::Identity(), Vector3d(5e-6, -8e-6, 6e-6), 5, 60.0);
    std::array<int, 3> order{0, 1, 2};
    int recognised = 0;
    do {
        for (int signs = 0; signs < 8; ++signs) {
            Matrix3d C = Matrix3d::Zero();
            for (int i = 0; i < 3; ++i) C(i, order[static_cast<std::size_t>(i)]) = (signs >> i & 1) != 0 ? -1.0 : 1.0;
            const CalibrationLog m = mounted(l, C);
            const MagnetometerAxes found = recognise_axes(m.imu, m.mag, 40e-6);
            EXPECT_EQ(found.C_bs, C) << axes_text(C) << " taken for " << axes_text(found.C_bs);
            EXPECT_EQ(found.swapped, !C.isIdentity());
            recognised += found.C_bs == C ? 1 : 0;
        }
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_EQ(recognised, 48);
}

TEST(AhrsAxes, NothingIsTurnedWithoutEvidence) {
    const Matrix3d C = (Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
    const CalibrationLog still = mounted(turned(Matrix3d::Identity(), Vector3d::Zero(), 6, 60.0, 1e-3), C);
    EXPECT_FALSE(recognise_axes(still.imu, still.mag).swapped);
    const CalibrationLog right = turned(some_distortion(0.05), Vector3d(20e-6, 10e-6, -15e-6), 7, 60.0);
    EXPECT_FALSE(recognise_axes(right.imu, right.mag).swapped) << "irons are not axes";
    // about the vertical only: x and y can be told, but not what z does
    CalibrationLog yaw = right;
    for (std::size_t i = 0; i < yaw.imu.size(); ++i) {
        const double t = yaw.imu[i].time.seconds();
        yaw.imu[i].gyro = Vector3d(0.0, 0.0, 0.5);
        yaw.mag[i].field_b = C.transpose() * Vector3d(19e-6 * std::cos(0.5 * t), -19e-6 * std::sin(0.5 * t), 46e-6);
    }
    EXPECT_FALSE(recognise_axes(yaw.imu, yaw.mag).swapped);
    EXPECT_FALSE(recognise_axes({}, {}).swapped);
    EXPECT_EQ(axes_text(C), "x = y, y = x, z = -z");
}

TEST(AhrsClock, ALateOrEarlyMagnetometerIsFoundAndNothingElse) {
    const CalibrationLog l = turned(some_distortion(0.03), Vector3d(15e-6, -8e-6, 6e-6), 5, 60.0);
    const Matrix3d C = (Matrix3d() << 0, 1, 0, 1, 0, 0, 0, 0, -1).finished();
    for (const double delay : {-0.45, -0.1, 0.05, 0.2, 0.37}) {
        CalibrationLog late = l;
        for (MagSample& s : late.mag) s.time = s.time + Duration::from_seconds(delay);
        EXPECT_NEAR(find_delay(late.imu, late.mag).delay, delay, 0.01);
        // axes that are not known yet do not hide it
        const CalibrationLog turned_round = mounted(late, C);
        EXPECT_NEAR(find_delay(turned_round.imu, turned_round.mag).delay, delay, 0.01);
    }
    EXPECT_EQ(find_delay(l.imu, l.mag).delay, 0.0);
    const CalibrationLog slow = turned(Matrix3d::Identity(), Vector3d::Zero(), 6, 60.0, 1e-3);
    EXPECT_EQ(find_delay(slow.imu, slow.mag).delay, 0.0);
    EXPECT_EQ(find_delay({}, {}).delay, 0.0);
}

TEST(AhrsClock, ASteadySwingDoesNotTellOnePeriodFromTheNext) {
    for (const double period : {0.5, 0.6, 0.7, 0.8}) {
        CalibrationLog swing = turned(Matrix3d::Identity(), Vector3d::Zero(), 6, 60.0);
        const double rate = 2.0 * std::numbers::pi / period;
        for (std::size_t i = 0; i < swing.imu.size(); ++i) {
            const double t = swing.imu[i].time.seconds(), seen = 0.4 * std::sin(rate * (t - 0.15));
            swing.imu[i].gyro = Vector3d(0.0, 0.0, 0.4 * rate * std::cos(rate * t));
            swing.mag[i].field_b = Vector3d(19e-6 * std::cos(seen), -19e-6 * std::sin(seen), 46e-6);
        }
        const MagnetometerClock clock = find_delay(swing.imu, swing.mag);
        EXPECT_LT(clock.as_given, 0.9) << "that it is wrong shows";
        EXPECT_EQ(clock.delay, 0.0) << "0.15 s late, or early by the rest of the period of " << period;
    }
}

TEST(AhrsMagnet, OneThatStaysIsFoundAndOneThatComesAndGoesIsNot) {
    const Vector3d iron(60e-6, -30e-6, 40e-6);
    const CalibrationLog l = turned(some_distortion(0.03), iron, 5, 120.0);
    const auto found = find_constant_magnet(l.imu, l.mag);
    ASSERT_TRUE(found.has_value());
    EXPECT_LT((found->field_b - iron).norm(), std::max(2e-6, 3.0 * found->std));
    EXPECT_LT(found->std, 4e-6);
    const CalibrationLog none = turned(some_distortion(0.03), Vector3d::Zero(), 5, 120.0);
    EXPECT_FALSE(find_constant_magnet(none.imu, none.mag).has_value());
    for (const std::size_t sixths : {1, 2, 3, 4, 5}) {  // on the sensor at the end
        CalibrationLog late = none;
        for (std::size_t i = late.mag.size() - late.mag.size() * sixths / 6; i < late.mag.size(); ++i)
            late.mag[i].field_b += Vector3d(0.0, 30e-6, 0.0);
        EXPECT_FALSE(find_constant_magnet(late.imu, late.mag).has_value()) << sixths;
    }
    EXPECT_FALSE(find_constant_magnet({}, {}).has_value());
}

TEST(AhrsAxes, SouthOfTheEquatorTheFieldPointsUp) {
    CalibrationLog l = turned(Matrix3d::Identity(), Vector3d::Zero(), 8, 60.0);
    for (MagSample& s : l.mag) s.field_b = -s.field_b;
    const MagnetometerAxes unknown = recognise_axes(l.imu, l.mag);
    EXPECT_FALSE(unknown.swapped) << "all three turned round turn with the gyro as well: left as they are";
    EXPECT_FALSE(recognise_axes(l.imu, l.mag, -40e-6).swapped);
    EXPECT_TRUE(recognise_axes(l.imu, l.mag, 40e-6).C_bs.isApprox(-Matrix3d::Identity()));
}

}  // namespace
}  // namespace schuler::ahrs
