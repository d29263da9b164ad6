// A magnetic disturbance must not tilt the horizon: math.md 3.5, the same noise with and without the disturbance.
#include "ahrs/simulated_motion.h"

#include "schuler/ahrs/dcm_filter.h"
#include "schuler/ahrs/mekf.h"
#include "schuler/ahrs/quaternion_filter.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace schuler::ahrs {
namespace {

using Eigen::Vector3d;
using namespace testing;

struct Change {
    double tilt = 0.0, heading = 0.0;  ///< largest difference between the two runs, deg
};

template <class Filter>
std::vector<Vector3d> attitudes(const std::vector<Instant>& data, double dt, Filter filter) {
    std::vector<Vector3d> out;
    for (const Instant& s : data) {
        if constexpr (std::is_same_v<Filter, Mekf>) {
            filter.step(dt, s.gyro, s.accel);
            filter.magnetometer(s.field);
        } else {
            filter.propagate(dt, s.gyro);
            filter.accelerometer(s.accel);
            filter.magnetometer(s.field);
        }
        if constexpr (std::is_same_v<Filter, DcmFilter>) {
            out.push_back(math::rpy_from_dcm(filter.C_nb()));
        } else {
            out.push_back(math::rpy_from_quaternion(filter.q_nb()));
        }
    }
    return out;
}

template <class Filter>
Change change(const Filter& filter, bool moving, const Vector3d& bias) {
    Motion m;
    m.duration = 180.0;
    m.moving = moving;
    m.gyro_bias = bias;
    const auto clean = attitudes(simulated(m, 5), m.dt, filter);
    m.disturbed_from = 60.0;
    m.disturbed_to = 120.0;
    const auto disturbed = attitudes(simulated(m, 5), m.dt, filter);
    Change c;
    for (std::size_t i = 0; i < clean.size(); ++i) {
        const Vector3d d = disturbed[i] - clean[i];
        c.tilt = std::max({c.tilt, std::abs(math::wrap_pi(d.x())) / units::deg, std::abs(d.y()) / units::deg});
        c.heading = std::max(c.heading, std::abs(math::wrap_pi(d.z())) / units::deg);
    }
    return c;
}

/// Noises of math.md 3.5: measurement covariances a hundred times those of the sensors.
VectorFilterSettings paper_settings(Separation separation) {
    VectorFilterSettings s;
    s.gyro_noise = 0.01 * units::deg;
    s.accel_std = 0.5;
    s.field_std = 2e-6;
    s.horizontal_field = 18964e-9;
    s.vertical_field = 46962e-9;
    s.separation = separation;
    return s;
}

const Vector3d bias = Vector3d(0.02, -0.03, 0.02) * units::deg_per_s;

class Separation_ : public ::testing::TestWithParam<bool> {};

TEST_P(Separation_, DirectionCosinesDoNotFeelTheField) {
    const Change c = change(DcmFilter(paper_settings(Separation::Projected)), GetParam(), bias);
    EXPECT_LT(c.tilt, 1e-9);
    EXPECT_GT(c.heading, 10.0) << "the disturbance must have reached the heading";
}

TEST_P(Separation_, QuaternionWithProjectedGainBarelyDoes) {
    const Change c = change(QuaternionFilter(paper_settings(Separation::Projected)), GetParam(), bias);
    EXPECT_LT(c.tilt, 1e-3);
    EXPECT_GT(c.heading, 10.0);
}

TEST_P(Separation_, QuaternionAsPrintedLeavesTenthsOfADegree) {
    const Change c = change(QuaternionFilter(paper_settings(Separation::Printed)), GetParam(), bias);
    EXPECT_GT(c.tilt, 0.05);
    EXPECT_LT(c.tilt, 1.5);
}

TEST_P(Separation_, TheUnseparatedFilterTilts) {
    const Change c = change(QuaternionFilter(paper_settings(Separation::None)), GetParam(), bias);
    EXPECT_GT(c.tilt, 1.5);
}

TEST_P(Separation_, MekfTiltIsTheSameToTheLastBit) {
    // roll and pitch come out of a product with the heading: compare the level attitude itself
    Motion m;
    m.moving = GetParam();
    m.gyro_bias = bias;
    Mekf clean{MekfSettings{}}, disturbed{MekfSettings{}};
    const auto a = simulated(m, 5);
    m.disturbed_from = 30.0;
    m.disturbed_to = 90.0;
    const auto b = simulated(m, 5);
    double heading = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        clean.step(m.dt, a[i].gyro, a[i].accel);
        clean.magnetometer(a[i].field);
        disturbed.step(m.dt, b[i].gyro, b[i].accel);
        disturbed.magnetometer(b[i].field);
        ASSERT_EQ(clean.tilt().q_wb().coeffs(), disturbed.tilt().q_wb().coeffs());
        heading = std::max(heading, std::abs(clean.heading().heading() - disturbed.heading().heading()));
    }
    EXPECT_GT(heading, 0.001 * units::deg) << "the disturbance must have reached the heading";
    EXPECT_LT(heading, 5.0 * units::deg) << "a turn of the field by 20 deg for 60 s is to be rejected";
    EXPECT_LT(change(Mekf(MekfSettings{}), GetParam(), bias).tilt, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Ahrs, Separation_, ::testing::Bool(), [](const auto& p) { return p.param ? "moving" : "still"; });

}  // namespace
}  // namespace schuler::ahrs
