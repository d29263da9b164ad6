// Do the filters say truly how good they are? Normalised error of the small rotation over 100 seeds against chi-square bounds.
#include "ahrs/simulated_motion.h"

#include "schuler/ahrs/dcm_filter.h"
#include "schuler/ahrs/mekf.h"
#include "schuler/ahrs/quaternion_filter.h"
#include "schuler/ahrs/run.h"
#include "schuler/math/chi_square.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>

#include <cmath>
#include <utility>

namespace schuler::ahrs {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using namespace testing;

constexpr int seeds = 100;

/// phi of C_est = (I - [phi x]) C_true.
Vector3d phi_of(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth) {
    return -math::rotation_vector_from_quaternion(estimate * truth.conjugate());
}

struct Nees {
    double all = 0.0, heading = 0.0, tilt = 0.0;  ///< means over seeds of the last instant
};

void add(Nees& n, const Vector3d& phi, const Matrix3d& P) {
    n.all += phi.dot(P.ldlt().solve(phi)) / seeds;
    n.heading += phi.z() * phi.z() / P(2, 2) / seeds;
    n.tilt += phi.head<2>().dot(P.topLeftCorner<2, 2>().inverse() * phi.head<2>()) / seeds;
}

void expect_consistent(const Nees& n) {
    for (const auto& [value, dof] : {std::pair{n.all, 3}, {n.heading, 1}, {n.tilt, 2}}) {
        EXPECT_GT(value, math::chi_square_quantile(0.0005, dof * seeds) / seeds) << dof;
        EXPECT_LT(value, math::chi_square_quantile(0.9995, dof * seeds) / seeds) << dof;
    }
}

VectorFilterSettings matched(const Motion& m, Separation separation) {
    VectorFilterSettings s;
    s.gyro_noise = m.gyro_std * std::sqrt(m.dt);
    s.accel_std = m.accel_std;
    s.field_std = m.field_std;
    s.horizontal_field = m.horizontal;
    s.vertical_field = m.vertical;
    s.separation = separation;
    return s;
}

template <class Filter>
Nees of_vector_filter(const Motion& m, Separation separation) {
    Nees n;
    for (int seed = 1; seed <= seeds; ++seed) {
        Filter filter(matched(m, separation));
        const auto data = simulated(m, static_cast<std::uint64_t>(seed));
        for (const Instant& s : data) {
            filter.propagate(m.dt, s.gyro);
            filter.accelerometer(s.accel);
            filter.magnetometer(s.field);
        }
        Eigen::Quaterniond q;
        if constexpr (std::is_same_v<Filter, DcmFilter>) {
            q = Eigen::Quaterniond(filter.C_nb());
        } else {
            q = filter.q_nb();
        }
        add(n, phi_of(q, data.back().q_nb), filter.covariance_phi());
    }
    return n;
}

template <class Filter>
void expect_consistent_vector_filter() {
    Motion m;
    m.duration = 20.0;
    const Nees n = of_vector_filter<Filter>(m, Separation::Projected);
    SCOPED_TRACE(fmt::format("{:.2f} {:.2f} {:.2f}", n.all, n.heading, n.tilt));
    expect_consistent(n);
}

TEST(AhrsConsistency, DirectionCosinesWithoutGyroBias) { expect_consistent_vector_filter<DcmFilter>(); }

TEST(AhrsConsistency, QuaternionWithoutGyroBias) { expect_consistent_vector_filter<QuaternionFilter>(); }

/// With rooms that add this much (T) to the field, for good.
Nees of_mekf(double place_std, int logs, double duration) {
    Nees n;
    for (int seed = 1; seed <= logs; ++seed) {
        math::Random truth(static_cast<std::uint64_t>(seed), "truth");
        Motion m;
        m.duration = duration;
        MekfSettings s;
        if (place_std > 0.0)
            s.heading.hard_iron_std = 1e-7;  // where a magnet may be, the first reading tells little of the field
        s.tilt.bias_std = 0.1 * units::deg_per_s;
        m.gyro_bias = s.tilt.bias_std * truth.normal3();
        m.accel_bias = s.tilt.accel_bias_std * truth.normal3();
        m.sway_std = s.tilt.velocity_std;
        m.sway_time = s.tilt.velocity_time;
        m.hard_iron = s.heading.hard_iron_std * truth.normal3();
        s.tilt.gyro_noise = m.gyro_std * std::sqrt(m.dt);
        s.tilt.turn_noise = s.heading.turn_noise = 0.0;
        s.tilt.bias_walk = 1e-7;
        s.tilt.force_noise = m.accel_std * std::sqrt(m.dt);
        s.heading.walk = 0.0;
        s.heading.hard_iron_walk = 1e-11;
        s.heading.field_walk = 1e-11;
        m.place = place_std * truth.normal3().head<2>();
        if (place_std > 0.0) {  // where it rests, a room adds something else than where it moves
            m.rest = 0.0;
            m.sway_std = 0.0;
        }
        s.heading.place_std = std::max(place_std, 1e-9);
        s.heading.place_time = 1e6;
        s.heading.field_noise = 1e-6;
        m.field_std = s.heading.field_noise;
        s.heading.field_time = 0.5 * m.dt;
        s.heading.delay_std = 1e-6;
        s.heading.delay_walk = 1e-9;
        s.heading.gyro_matrix_std = s.heading.soft_iron_std = 1e-7;
        Mekf filter(s);
        const auto data = simulated(m, static_cast<std::uint64_t>(seed));
        for (const Instant& i : data) {
            filter.step(m.dt, i.gyro, i.accel);
            filter.magnetometer(i.field);
        }
        add(n, phi_of(filter.q_nb(), data.back().q_nb), filter.covariance_phi());
    }
    return n;
}

TEST(AhrsConsistency, MekfWithBiasSwayAndHardIronSlow) {
    const Nees n = of_mekf(0.0, seeds, 60.0);
    SCOPED_TRACE(fmt::format("{:.2f} {:.2f} {:.2f}", n.all, n.heading, n.tilt));
    expect_consistent(n);
}

TEST(AhrsConsistency, AFieldSeenAgainAndAgainInOneRoomIsKnownNoBetterForThat) {
    constexpr int logs = 100;
    const double heading = of_mekf(2e-6, logs, 20.0).heading * seeds / logs;
    EXPECT_GT(heading, math::chi_square_quantile(0.0005, logs) / logs);
    EXPECT_LT(heading, math::chi_square_quantile(0.9995, logs) / logs);
}

/// A hand that moves to and fro without much turning: what an accelerometer bias tilts is not seen, and must be in the sigma, online
/// and smoothed.
TEST(AhrsConsistency, AnAccelerometerBiasThatNothingShowsIsInTheSigmaOfTheTilt) {
    constexpr int logs = 60;
    for (const bool offline : {false, true}) {
        for (const double swing : {0.1, 1.0}) {
            double nees = 0.0;
            for (int seed = 1; seed <= logs; ++seed) {
                math::Random truth(static_cast<std::uint64_t>(seed), "truth");
                RunSettings s;
                s.offline = offline;
                s.mekf.six_axis = true;
                Motion m;
                m.duration = 20.0;
                m.swing = swing;
                m.accel_bias = s.mekf.tilt.accel_bias_std * truth.normal3();
                m.sway_std = s.mekf.tilt.velocity_std;
                m.sway_time = s.mekf.tilt.velocity_time;
                s.mekf.tilt.gyro_noise = m.gyro_std * std::sqrt(m.dt);
                s.mekf.tilt.turn_noise = 0.0;
                s.mekf.tilt.bias_std = 1e-3 * units::deg_per_s;
                s.mekf.tilt.force_noise = m.accel_std * std::sqrt(m.dt);
                std::vector<ImuSample> imu;
                const auto data = simulated(m, static_cast<std::uint64_t>(seed));
                for (const Instant& i : data) imu.push_back({Time::from_seconds(i.time), i.gyro, i.accel});
                const AttitudeRow row = run(imu, {}, {}, s).rows[imu.size() / 2];
                const auto at = std::ranges::find(imu, row.time, &ImuSample::time) - imu.begin();
                const Vector3d up = (row.q_nb * data[static_cast<std::size_t>(at)].q_nb.conjugate()).toRotationMatrix().col(2);
                nees += (std::pow(up.x() / row.std_phi.y(), 2) + std::pow(up.y() / row.std_phi.x(), 2)) / logs;
            }
            EXPECT_GT(nees, 2.0 * math::chi_square_quantile(0.0005, logs) / logs) << offline << swing;
            EXPECT_LT(nees, 2.0 * math::chi_square_quantile(0.9995, logs) / logs) << offline << swing;
        }
    }
}

/// The share of the accelerometer bias in the sigma is what such a bias does to the attitude, found by adding one to the log.
TEST(AhrsConsistency, TheShareOfTheAccelerometerBiasIsWhatOneDoes) {
    Motion m;
    m.duration = 20.0;
    m.gyro_std = m.accel_std = 0.0;
    m.rest = 0.0;  // readings without noise that do not change would be those of a frozen instrument
    const auto data = simulated(m, 1);
    for (const bool offline : {false, true}) {
        const auto rows_with = [&](double std, const Vector3d& bias) {
            RunSettings s;
            s.offline = offline;
            s.mekf.six_axis = true;
            s.mekf.tilt.accel_bias_std = std;
            std::vector<ImuSample> imu;
            for (const Instant& i : data) imu.push_back({Time::from_seconds(i.time), i.gyro, i.accel + bias});
            return run(imu, {}, {}, s).rows;
        };
        constexpr double std = 0.5, small = 1e-3;
        const auto none = rows_with(1e-9, Vector3d::Zero()), with = rows_with(std, Vector3d::Zero());
        const std::array biased{rows_with(1e-9, small * Vector3d::UnitX()), rows_with(1e-9, small * Vector3d::UnitY()),
                                rows_with(1e-9, small * Vector3d::UnitZ())};
        for (const std::size_t at : {std::size_t{600}, std::size_t{900}, std::size_t{1300}}) {
            Vector3d share = Vector3d::Zero();
            for (const auto& rows : biased) {
                const Vector3d change = math::rotation_vector_from_quaternion(rows[at].q_nb * none[at].q_nb.conjugate());
                share += (change * (std / small)).cwiseAbs2();
            }
            const Vector3d published = with[at].std_phi.cwiseAbs2() - none[at].std_phi.cwiseAbs2();
            for (int i = 0; i < 2; ++i) EXPECT_NEAR(std::sqrt(published(i)), std::sqrt(share(i)), 0.02 * std::sqrt(share(i)));
        }
    }
}

}  // namespace
}  // namespace schuler::ahrs
