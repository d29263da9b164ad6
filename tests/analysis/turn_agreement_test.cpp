// Units and axes that a log's own motion gives away, on a coning motion in closed form.
#include "schuler/analysis/turn_agreement.h"

#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace schuler::analysis {
namespace {

using Eigen::Vector3d;

/// A minute of turning to and fro about all axes; the field is sampled every third time.
TurnAgreement agreement(double rate_factor, const Eigen::Matrix3d& C_field) {
    const auto q_nb = [](double t) {
        return math::quaternion_from_rpy({0.6 * std::sin(1.1 * t), 0.5 * std::sin(1.7 * t), 1.2 * std::sin(0.6 * t)});
    };
    constexpr double dt = 0.01;
    std::vector<ImuSample> imu;
    std::vector<Vector3d> field;
    std::vector<Time> times;
    for (int i = 1; i < 6000; ++i) {
        const Eigen::Quaterniond q = q_nb(i * dt);
        const Vector3d rate = math::rotation_vector_from_quaternion(q_nb((i - 1) * dt).conjugate() * q) / dt;
        imu.push_back({Time::from_seconds(i * dt), rate_factor * rate, q.conjugate() * Vector3d(0.0, 0.0, -9.81)});
        if (i % 3 != 0) continue;
        field.emplace_back(C_field * (q.conjugate() * Vector3d(19e-6, 0.0, 44e-6)));
        times.push_back(imu.back().time);
    }
    return turn_agreement(
        imu, field.size(), [&](std::size_t k) { return times[k]; }, [&](std::size_t k) { return field[k]; });
}

TEST(TurnAgreement, TellsUnitsAndAxes) {
    const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
    const TurnAgreement good = agreement(1.0, same);
    EXPECT_NEAR(good.factor, 1.0, 0.02);
    EXPECT_GT(good.correlation, 0.995);
    EXPECT_GT(good.turned, 1.0);
    EXPECT_NEAR(agreement(1.0 / units::deg, same).factor, units::deg, 0.02 * units::deg);
    const Eigen::Matrix3d flipped = Vector3d(1.0, -1.0, -1.0).asDiagonal();
    EXPECT_LT(agreement(1.0, flipped).correlation, 0.5) << "forward-left-up beside forward-right-down";
}

TEST(TurnAgreement, SaysNothingWithoutSamples) {
    const TurnAgreement none = turn_agreement({}, 0, {}, {});
    EXPECT_TRUE(std::isnan(none.factor));
    EXPECT_EQ(none.turned, 0.0);
}

}  // namespace
}  // namespace schuler::analysis
