// Hard iron of a magnetometer: what it does to the heading, and whether the filter knows it once the body has turned.
#include "fusion/car_drive.h"

#include "schuler/filter/measurement/environment.h"
#include "schuler/filter/states/model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>
#include <variant>

namespace schuler::fusion {
namespace {

using namespace testing;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double level = 2e-5, down = 4e-5;  // T, the Earth's field
constexpr double declination = 0.1, white = 0.02;
constexpr double disturbance = 0.02, disturbance_time = 10.0;  // rad, s: of the heading

Vector3d earth_field() { return {level * std::cos(declination), level * std::sin(declination), down}; }

// Without tilt the levelled field turns by the classical B sin + C cos of the magnetic heading, up to the square of the deviation.
TEST(HardIron, DeviatesAsTheCoefficientsBAndC) {
    filter::Estimate e;
    e.parameters.setZero(16);
    for (const double size : {0.1, 0.01, 0.001}) {
        const Vector3d iron = size * Vector3d(0.8, -0.6, 0.5);
        for (double heading = 0.0; heading < 6.3; heading += 0.3) {
            e.C_nb = math::dcm_from_rpy({0.0, 0.0, heading});
            const Vector3d field_b = e.C_nb.transpose() * earth_field() + level * iron;
            const double turned = magnetic_azimuth(e, field_b, declination, 1.0).innovation(0), magnetic = heading - declination;
            EXPECT_NEAR(turned, iron.x() * std::sin(magnetic) + iron.y() * std::cos(magnetic), size * size) << heading;
        }
    }
}

// With its states at the truth nothing is left, however large the iron and the tilt are.
TEST(HardIron, IsTakenInFullAtAnyTilt) {
    filter::Estimate e;
    e.layout.mag_bias = e.layout.add("mag_heading_offset", "rad", 1);
    e.layout.hard_iron = e.layout.add("mag_hard_iron", "1", 3);
    e.parameters.setZero(20);
    const Vector3d iron(0.4, -0.3, 0.5);
    e.parameters.segment<3>(e.layout.hard_iron) = iron;
    for (double heading = 0.0; heading < 6.3; heading += 0.3) {
        e.C_nb = math::dcm_from_rpy({0.7, -0.4, heading});
        const Vector3d field_b = e.C_nb.transpose() * earth_field() + level * iron;
        EXPECT_NEAR(magnetic_azimuth(e, field_b, declination, 1.0).innovation(0), 0.0, 1e-12);
    }
    // A body's field that cancels the Earth's leaves no direction.
    e.C_nb.setIdentity();
    e.parameters.segment<3>(e.layout.hard_iron) = Vector3d(-std::cos(declination), -std::sin(declination), 0.0);
    EXPECT_EQ(magnetic_azimuth(e, earth_field(), declination, 1.0).dof, 0);
}

/// An aircraft in circles whose fixes are poor: the heading is the magnetometer's.
struct Circling {
    Recording recording;
    Settings settings;
    Vector3d iron;  ///< parts of the Earth's horizontal field
};

/// `soft_std`: of each coefficient of the body's soft iron, which the filter does not know.
Circling circling(std::uint64_t seed, double iron_std, double soft_std = 0.0) {
    sim::Scenario s = flight_in_curves(seed, 0.0);
    s.duration = 180.0;
    auto& path = std::get<sim::FigureEightPath>(s.path);
    path.length = 400.0;
    path.width = 200.0;
    path.period = 60.0;
    s.imu.errors = mems();
    s.gnss.rate = 1.0;
    s.gnss.white_position = Vector3d(3.0, 3.0, 5.0);
    s.gnss.white_velocity = Vector3d(0.5, 0.5, 0.8);
    Circling c{sim::simulate(s).recording, settings_of(s), {}};
    math::Random random(seed, "iron");
    c.iron = iron_std * random.normal3();
    Matrix3d soft = Matrix3d::Identity();
    for (Eigen::Index i = 0; soft_std > 0.0 && i < 9; ++i) soft(i) += soft_std * random.normal();
    double turned = disturbance * random.normal();
    Time before = c.recording.reference.front().time;
    for (const ReferenceSample& t : c.recording.reference) {
        const double kept = std::exp(-(t.time - before).seconds() / disturbance_time);
        turned = kept * turned + std::sqrt(1.0 - kept * kept) * disturbance * random.normal();
        before = t.time;
        const Vector3d field_n = math::dcm_from_rpy({0.0, 0.0, turned}) * earth_field();
        const Vector3d field_b = math::dcm_from_rpy(t.rpy).transpose() * field_n;
        c.recording.mag.push_back({t.time, soft * field_b + level * (c.iron + white * random.normal3())});
    }
    Settings& f = c.settings;
    f.vehicle = VehicleKind::Air;
    f.gnss.estimate_std = f.gnss.estimate_latency = false;
    f.mag = {.declination = declination,
             .heading_std = white,
             .bias_std = std::hypot(0.02, iron_std),
             .bias_walk = 1e-4,
             .deviation_std = iron_std,
             .disturbance_std = disturbance};
    give_start(f, c.recording, seed);
    return c;
}

TEST(HardIron, IsKnownOnceTheBodyHasTurned) {
    constexpr double iron_std = 0.15;
    constexpr int runs = 12;
    double heading_nees = 0.0, iron_nees = 0.0, epochs = 0.0;
    for (std::uint64_t seed = 1; seed <= runs; ++seed) {
        const Circling c = circling(seed, iron_std);
        const Result r = fuse(c.recording, c.settings);
        const auto states = std::ranges::find(r.states, std::string_view("mag_hard_iron"), &filter::LayoutBlock::name);
        ASSERT_NE(states, r.states.end());
        const auto first = static_cast<std::size_t>(states->offset - filter::Layout::navigation);
        for (std::size_t i = 0; i < 3; ++i) {
            const double sigma = r.forward.parameters.back().std[first + i];
            const double error = r.forward.parameters.back().value[first + i] - c.iron(static_cast<Eigen::Index>(i));
            EXPECT_LT(std::abs(error), 3.0 * sigma + 0.005) << "seed " << seed << ", axis " << i;
            EXPECT_LT(sigma, (i < 2 ? 0.1 : 0.9) * iron_std);  // the vertical one shows in banks alone
            iron_nees += error * error / (sigma * sigma) / (3.0 * runs);
        }
        for (const analysis::ErrorRow& e : errors(c.settings, r.forward.rows, c.recording)) {
            if (e.time.seconds() < 1030.0) continue;
            heading_nees += e.rpy.z() * e.rpy.z() / (e.std_rpy.z() * e.std_rpy.z());
            epochs += 1.0;
        }
    }
    EXPECT_GT(iron_nees, 0.5);
    EXPECT_LT(iron_nees, 1.6);
    EXPECT_GT(heading_nees / epochs, 0.4);
    EXPECT_LT(heading_nees / epochs, 1.8);
}

// What the model of the field does not know must not tilt the solution: the tilt's error is noise, as large as the dip makes it.
TEST(HardIron, IsNotTakenForATilt) {
    constexpr double tilt = 0.01;
    filter::Estimate e;
    e.layout.mag_bias = e.layout.add("mag_heading_offset", "rad", 1);
    e.layout.hard_iron = e.layout.add("mag_hard_iron", "1", 3);
    e.parameters.setZero(20);
    e.tilt_covariance = tilt * tilt * Eigen::Matrix2d::Identity();
    e.C_nb = math::dcm_from_rpy({0.0, 0.0, 0.7});
    Settings s;
    s.mag = {.declination = declination, .heading_std = white};
    const filter::Measurement m = measurement_of(e, MagSample{{}, e.C_nb.transpose() * earth_field()}, s);
    ASSERT_EQ(m.dof, 1);
    EXPECT_EQ(m.rows[0].head.segment<2>(filter::Layout::attitude).norm(), 0.0);
    EXPECT_NEAR(std::abs(m.rows[0].head(filter::Layout::attitude + 2)), 1.0, 1e-12);
    const double dip = down / level;
    EXPECT_NEAR(m.variance(0), white * white + dip * dip * tilt * tilt, 1e-12);
    s.mag.deviation_std = 0.01;  // calibrated: its field shows the tilt too
    const filter::Measurement whole = measurement_of(e, MagSample{{}, e.C_nb.transpose() * earth_field()}, s);
    EXPECT_NEAR(whole.rows[0].head.segment<2>(filter::Layout::attitude).norm(), dip, 1e-12);
    EXPECT_EQ(whole.variance(0), white * white);
    s.mag.disturbance_std = 0.1;  // soft iron or motors were not
    EXPECT_EQ(measurement_of(e, MagSample{{}, e.C_nb.transpose() * earth_field()}, s).variance(0), m.variance(0));
}

// Soft iron has no states of its own. It is not constant while the body turns, nor another in each sample.
TEST(HardIron, OtherDistortionsAreInTheSigmas) {
    constexpr double iron_std = 0.15, soft_std = 0.04;
    constexpr int runs = 6;
    const auto beyond = [&](double assumed) {
        double epochs = 0.0, tilts = 0.0, headings = 0.0;
        for (std::uint64_t seed = 1; seed <= runs; ++seed) {
            Circling c = circling(seed, iron_std, soft_std);
            c.settings.mag.disturbance_std = assumed;
            const Result r = fuse(c.recording, c.settings);
            for (const analysis::ErrorRow& e : errors(c.settings, r.forward.rows, c.recording)) {
                epochs += 1.0;
                if ((e.rpy.head<2>().array().abs() > 3.0 * e.std_rpy.head<2>().array()).any()) tilts += 1.0;
                if (std::abs(e.rpy.z()) > 3.0 * e.std_rpy.z()) headings += 1.0;
            }
        }
        return Eigen::Vector2d(tilts / epochs, headings / epochs);
    };
    // with the dip of 63 degrees, coefficients of 0.04 turn the field by 0.04 sqrt(1 + 4) and more
    const Eigen::Vector2d with = beyond(0.1), without = beyond(0.0);
    EXPECT_LT(with.maxCoeff(), 0.01) << with.transpose();
    EXPECT_GT(without.y(), 0.05) << "headings without the state";
}

// What is given is used: trials of the noise fit the numbers of the magnetometer that are not.
TEST(HardIron, NumbersThatAreGivenAreNotFitted) {
    Circling c = circling(1, 0.15);
    c.settings.imu.estimate_noise = true;
    const auto fitted = [&] {
        const Result r = fuse(c.recording, c.settings);
        int count = 0;
        for (const TunedSetting& t : r.findings.tuned) count += std::string_view(t.key).starts_with("mag.") ? 1 : 0;
        return std::pair(count, r.findings.in_force->mag);
    };
    EXPECT_EQ(fitted().first, 4);
    filter::MagSettings& mag = c.settings.mag;
    mag.heading_std = 0.06;
    mag.fit_heading_std = mag.fit_bias_walk = mag.fit_deviation = mag.fit_disturbance = false;
    const auto [count, used] = fitted();
    EXPECT_EQ(count, 0);
    EXPECT_NEAR(used.heading_std, mag.heading_std, 1e-6);
    EXPECT_NEAR(used.deviation_std, mag.deviation_std, 1e-6);
    EXPECT_NEAR(used.disturbance_std, mag.disturbance_std, 1e-6);
}

/// A heading set by the magnetometer has its errors: its next sample tells nothing but noise until the body turns.
TEST(HardIron, IsThatOfAHeadingSetByTheMagnetometer) {
    filter::Sensors sensors;
    sensors.mag = true;
    Settings s;
    s.mag = {.declination = declination, .heading_std = white, .bias_std = 0.2, .deviation_std = 0.15};
    const filter::InertialModel model = make_model(s, filter::layout_with(s, sensors));
    filter::Start start;
    start.nav.position = {0.8, 0.2, 500.0};
    start.std_position = start.std_velocity = Vector3d::Ones();
    start.std_rpy = Vector3d(0.0, 0.0, s.mag.first_std());
    start.std_gyro_bias = start.std_accel_bias = Vector3d::Constant(1e-3);
    start.heading_of_mag = true;
    const auto sigma_of_sample = [&](double turned) {
        start.nav.q_nb = math::quaternion_from_rpy({0.0, 0.0, 0.7});
        filter::FilterRun<filter::GeographicFrame> run;
        set_out(run, model, s, start, not_given);
        NavState nav = run.filter.nav;
        nav.q_nb = math::quaternion_from_rpy({0.0, 0.0, 0.7 + turned});
        run.filter.set_nav(nav);
        const filter::Estimate e = run.filter.estimate(model);
        const filter::Measurement m = magnetic_azimuth(e, e.C_nb.transpose() * earth_field(), declination, white * white);
        return std::sqrt(run.filter.innovation_covariance(run.filter.to_own(model, m))(0, 0));
    };
    EXPECT_NEAR(sigma_of_sample(0.0), white, 0.3 * white);
    EXPECT_GT(sigma_of_sample(std::numbers::pi), 0.25) << "the other way round the iron shows twice";
}

// No state without a sigma, and none without a magnetometer.
TEST(HardIron, HasStatesOnlyWhereItMayBe) {
    Settings s;
    filter::Sensors sensors;
    EXPECT_LT(filter::layout_with(s, sensors).hard_iron, 0);
    sensors.mag = true;
    const filter::Layout with = filter::layout_with(s, sensors);
    EXPECT_GT(with.hard_iron, 0);
    s.mag.deviation_std = 0.0;
    EXPECT_LT(filter::layout_with(s, sensors).hard_iron, 0);
    EXPECT_EQ(filter::layout_with(s, sensors).size, with.size - 4);  // nor what is taken for a part of it
    s.mag.disturbance_std = 0.05;
    EXPECT_EQ(filter::layout_with(s, sensors).size, with.size - 3);
    s.mag.use = false;
    EXPECT_LT(filter::layout_with(s, sensors).mag_bias, 0);
}

}  // namespace
}  // namespace schuler::fusion
