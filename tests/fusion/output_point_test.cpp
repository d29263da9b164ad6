// The solution at a point of the user's choice and at instants of his own.
#include "fusion/car_drive.h"

#include "schuler/filter/outputs.h"
#include "schuler/ins/state_error.h"

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <cmath>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

const Vector3d arm(1.5, -0.4, 0.8);

Drive drive(double output_rate) {
    Drive d;
    d.scenario = town_drive(21, 1.0, 100.0);
    d.recording = sim::simulate(d.scenario).recording;
    d.settings = settings_of(d.scenario);
    give_start(d.settings, d.recording, 21);
    d.settings.output_rate = output_rate;
    d.settings.smooth = true;
    return d;
}

TEST(OutputPoint, LiesAtTheEndOfTheLeverArmAndMovesWithIt) {
    Drive d = drive(0.0);
    d.settings.output_lever_arm_b = arm;
    const Result r = fuse(d.recording, d.settings);
    for (const Trajectory* t : {&r.forward, &r.smoothed}) {
        ASSERT_EQ(t->point.size(), t->rows.size());
        for (std::size_t i = 0; i < t->rows.size(); i += 50) {
            const SolutionRow &imu = t->rows[i], &point = t->point[i];
            EXPECT_EQ(imu.time, point.time);
            const Vector3d moved = earth::ned_difference(d.settings.earth, point.position, imu.position);
            EXPECT_LT((moved - math::dcm_from_rpy(imu.rpy) * arm).norm(), 1e-5);
        }
    }
    // smoothed positions of the point have its velocity, in turns as well
    double fastest_turn = 0.0;
    for (std::size_t i = 100; i + 101 < r.smoothed.point.size(); i += 37) {
        const SolutionRow &a = r.smoothed.point[i], &b = r.smoothed.point[i + 1];
        const double dt = (b.time - a.time).seconds();
        const Vector3d mean = earth::ned_difference(d.settings.earth, b.position, a.position) / dt;
        const double about = math::wrap_pi(b.rpy.z() - a.rpy.z()) / dt;
        fastest_turn = std::max(fastest_turn, std::abs(about));
        EXPECT_LT((mean - 0.5 * (a.v_eb_n + b.v_eb_n)).norm(), 0.03) << a.time.seconds();
    }
    EXPECT_GT(fastest_turn, 0.08);  // 0.12 m/s at this arm
}

// A covariance asked for at every epoch ends the spans that transitions are gathered over. The acceleration that a late fix is judged with
// must not depend on them, with an engine that shakes.
TEST(OutputPoint, StatesDoNotDependOnWhatIsAskedFor) {
    sim::Scenario scenario = town_drive(21, 1.0, 100.0);
    shake(scenario);
    scenario.gnss.position_latency = scenario.gnss.velocity_latency = 0.15;
    const Recording recording = sim::simulate(scenario).recording;
    Settings f = settings_of(scenario);
    give_start(f, recording, 21);
    f.gnss.latency = 0.1;
    f.gnss.latency_std = 0.05;
    f.output_rate = 1.0;
    const Result seldom = fuse(recording, f);
    f.output_rate = 0.0;
    f.covariance_rows = true;
    const Result always = fuse(recording, f);
    std::size_t i = 0, compared = 0;
    for (const SolutionRow& a : seldom.forward.rows) {
        while (i < always.forward.rows.size() && always.forward.rows[i].time < a.time) ++i;
        ASSERT_LT(i, always.forward.rows.size());
        const SolutionRow& b = always.forward.rows[i];
        if (b.time != a.time) continue;
        ++compared;
        EXPECT_LT(earth::ned_difference(f.earth, a.position, b.position).cwiseQuotient(a.std_position).cwiseAbs().maxCoeff(),
                  0.01)
            << compared;
        EXPECT_LT((a.v_eb_n - b.v_eb_n).cwiseQuotient(a.std_velocity).cwiseAbs().maxCoeff(), 0.01) << compared;
        EXPECT_LT(std::abs(math::wrap_pi(a.rpy.z() - b.rpy.z())) / a.std_rpy.z(), 0.01) << compared;
    }
    EXPECT_GT(compared, 90u);
    // ... and may be had more seldom than the rows
    f.covariance_rate = 2.0;
    const std::vector<filter::CovarianceRow> few = fuse(recording, f).forward.covariances;
    EXPECT_EQ(always.forward.covariances.size(), always.forward.rows.size());
    EXPECT_NEAR(static_cast<double>(few.size()), 200.0, 2.0);
    for (std::size_t k = 1; k < few.size(); ++k) EXPECT_NEAR((few[k].time - few[k - 1].time).seconds(), 0.5, 0.011);
}

// Sigmas: the map of the errors by numerical differences of the point's position and velocity.
TEST(OutputPoint, SigmasHaveTheShareOfAttitudeAndRate) {
    filter::Estimate e;
    e.nav.position = {50.0 * deg, 30.0 * deg, 150.0};
    e.nav.v_eb_n = {12.0, -7.0, 0.5};
    e.nav.q_nb = math::quaternion_from_rpy({0.1, -0.2, 2.0});
    e.C_nb = e.nav.q_nb.toRotationMatrix();
    e.w_ib_b = {0.1, -0.3, 0.6};
    math::Random random(5, "test.point");
    filter::Matrix9 A;
    for (int i = 0; i < 81; ++i) A(i) = random.normal();
    const Vector3d scale(1.0, 0.1, 0.02);
    for (int i = 0; i < 9; ++i) A.row(i) *= scale(i / 3);
    const filter::Matrix9 P = A * A.transpose();
    const Vector3d rate_variance(1e-4, 2e-4, 3e-4);
    const SolutionRow row = solution_row_at(e, P, arm, rate_variance);
    constexpr double step = 1e-4;
    Eigen::Matrix<double, 6, 12> J;
    for (int i = 0; i < 12; ++i) {
        SolutionRow side[2];
        for (int k = 0; k < 2; ++k) {
            filter::Estimate moved = e;
            const double by = k == 0 ? step : -step;
            if (i < 9) moved.nav = ins::corrected(e.earth, e.nav, -by * filter::Vector9::Unit(i));  // an estimate with this error
            else moved.w_ib_b(i - 9) += by;
            moved.C_nb = moved.nav.q_nb.toRotationMatrix();
            side[k] = solution_row_at(moved, P, arm, rate_variance);
        }
        J.col(i).head<3>() = earth::ned_difference(e.earth, side[0].position, side[1].position) / (2.0 * step);
        J.col(i).tail<3>() = (side[0].v_eb_n - side[1].v_eb_n) / (2.0 * step);
    }
    Eigen::Matrix<double, 12, 12> all = Eigen::Matrix<double, 12, 12>::Zero();
    all.topLeftCorner<9, 9>() = P;
    all.bottomRightCorner<3, 3>() = rate_variance.asDiagonal();
    const Eigen::Matrix<double, 6, 1> sigma = (J * all * J.transpose()).diagonal().cwiseSqrt();
    EXPECT_LT((row.std_position - sigma.head<3>()).norm(), 1e-4 * sigma.head<3>().norm());
    EXPECT_LT((row.std_velocity - sigma.tail<3>()).norm(), 1e-4 * sigma.tail<3>().norm());
}

TEST(Covariances, OfBothPassesBelongToTheRowsAndChangeNothing) {
    Drive d = drive(10.0);
    d.settings.output_at_antenna = false;
    const Result without = fuse(d.recording, d.settings);
    d.settings.covariance_rows = true;
    d.settings.covariance_rate = 2.0;
    const Result with = fuse(d.recording, d.settings);
    int size = 0;
    for (const LayoutBlock& block : with.states) size += block.size;
    ASSERT_EQ(with.smoothed.covariances.size(), with.forward.covariances.size());
    ASSERT_GT(with.forward.covariances.size(), 180u);
    double forward = 0.0, smoothed = 0.0;
    for (const auto& [t, plain] : {std::pair{&with.forward, &without.forward}, {&with.smoothed, &without.smoothed}}) {
        ASSERT_EQ(t->rows.size(), plain->rows.size());
        for (std::size_t i = 0; i < t->rows.size(); ++i)
            ASSERT_LT(earth::ned_difference(d.settings.earth, t->rows[i].position, plain->rows[i].position).norm(), 1e-6);
        auto row = t->rows.begin();
        for (std::size_t k = 0; k < t->covariances.size(); ++k) {
            const CovarianceRow& c = t->covariances[k];
            EXPECT_EQ(c.time, with.forward.covariances[k].time);
            const Eigen::Map<const Eigen::MatrixXd> P(c.covariance.data(), size, size);
            row = std::ranges::find(row, t->rows.end(), c.time, &SolutionRow::time);
            ASSERT_NE(row, t->rows.end());
            EXPECT_LT((P.diagonal().head<3>().cwiseSqrt() - row->std_position).norm(), 1e-9 * row->std_position.norm());
            EXPECT_LT((P.diagonal().segment<3>(3).cwiseSqrt() - row->std_velocity).norm(), 1e-9 * row->std_velocity.norm());
            const Eigen::VectorXd scale = P.diagonal().cwiseSqrt();
            const Eigen::MatrixXd correlation = scale.cwiseInverse().asDiagonal() * P * scale.cwiseInverse().asDiagonal();
            EXPECT_LT((correlation - correlation.transpose()).norm(), 1e-6);
            EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(correlation).eigenvalues().minCoeff(), -1e-9);
            (t == &with.forward ? forward : smoothed) += P.diagonal().segment<3>(Layout::gyro_bias).sum();
        }
        // those of the biases are the ones of the states, which have rows of their own
        const auto same = std::ranges::find(t->covariances, t->parameters.back().time, &CovarianceRow::time);
        if (same == t->covariances.end()) continue;
        for (int i = 9; i < size; ++i)
            EXPECT_NEAR(std::sqrt(same->covariance[static_cast<std::size_t>(i * (size + 1))]),
                        t->parameters.back().std[static_cast<std::size_t>(i - 9)], 1e-12);
    }
    EXPECT_LT(smoothed, forward);
}

TEST(OutputInstants, AreRowsAtTheirOwnTimesAndChangeNothing) {
    Drive d = drive(0.0);
    const Result without = fuse(d.recording, d.settings);
    const auto at = [](double s) { return Time{std::llround((1000.0 + s) * 1e9)}; };
    // before the log, at an epoch of the filter, between epochs, at a fix, just beside an epoch, behind the log
    d.settings.output_instants = {at(-5.0), at(20.0), at(33.3333), at(50.0), at(61.00003), at(61.00494), at(77.7777), at(150.0)};
    const Result with = fuse(d.recording, d.settings);
    ASSERT_EQ(with.forward.rows.size(), without.forward.rows.size());
    for (std::size_t i = 0; i < with.forward.rows.size(); i += 10)
        EXPECT_LT(earth::ned_difference(d.settings.earth, with.forward.rows[i].position, without.forward.rows[i].position).norm(),
                  1e-6);
    for (const auto& [t, plain] : {std::pair{&with.forward, &without.forward}, {&with.smoothed, &without.smoothed}}) {
        ASSERT_EQ(t->instants.size(), 6u);
        for (std::size_t k = 0; k < 6; ++k) {
            const InstantRow& r = t->instants[k];
            EXPECT_EQ(r.index, k + 1);
            const Time asked = d.settings.output_instants[r.index];
            EXPECT_LE(std::abs(r.row.time.ns - asked.ns), 1000);
            const auto expected = analysis::solution_at(d.settings.earth, plain->rows, asked, Duration::from_seconds(0.1));
            ASSERT_TRUE(expected);
            EXPECT_LT(earth::ned_difference(d.settings.earth, r.row.position, expected->position).norm(), 2e-4) << k;
            EXPECT_LT((r.row.v_eb_n - expected->v_eb_n).norm(), 0.01) << k;
            EXPECT_LT((r.row.std_position - expected->std_position).norm(), 0.01 * expected->std_position.norm()) << k;
        }
    }
    d.settings.smooth = false;
    d.settings.output_lever_arm_b = arm;
    d.settings.mechanization = Mechanization::Ecef;
    for (const InstantRow& r : fuse(d.recording, d.settings).forward.instants) {
        const Vector3d apart =
            earth::ned_difference(d.settings.earth, r.row.position, with.forward.instants[r.index - 1].row.position);
        EXPECT_LT((apart - math::dcm_from_rpy(r.row.rpy) * arm).norm(), 0.02) << r.index;
    }
}

}  // namespace
}  // namespace schuler::fusion
