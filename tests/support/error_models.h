// The register of filters' error dynamics. A frame policy as filter/frame.h has them (State, step, attitude, dynamics, corrected)
// is judged by three oracles that do not know it: paper C's closed solution, differences of its own mechanization, and the
// simulator. house.error_models fails for a filter that is not registered here.
#pragma once

#include "schuler/ins/state_error.h"
#include "schuler/math/rotation.h"
#include "schuler/sim/inverse_imu.h"
#include "schuler/theory/equator.h"
#include "support/draws.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <unsupported/Eigen/MatrixFunctions>

#include <random>

namespace schuler::test {

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Eigen::Vector3d;

inline Vector3d attitude_error(const Eigen::Quaterniond& estimate, const Eigen::Quaterniond& truth) {
    return -math::rotation_vector_from_quaternion(estimate * truth.conjugate());
}
inline Vector9 error_between(const earth::Earth& earth, const NavState& estimate, const NavState& truth) {
    Vector9 dx;
    // clang-format off
    dx << -earth::ned_difference(earth, truth.position, estimate.position), estimate.v_eb_n - truth.v_eb_n,
        attitude_error(estimate.q_nb, truth.q_nb);
    // clang-format on
    return dx;
}
inline Vector9 error_between(const earth::Earth&, const NavStateEcef& estimate, const NavStateEcef& truth) {
    Vector9 dx;
    dx << estimate.position.r - truth.position.r, estimate.v_eb_e - truth.v_eb_e, attitude_error(estimate.q_eb, truth.q_eb);
    return dx;
}

/// Sizes of errors that belong together: R, sqrt(g R), 1 rad.
inline Vector9 natural_scale() {
    Vector9 s;
    s << Vector3d::Constant(6.4e6), Vector3d::Constant(7900.0), Vector3d::Ones();
    return s;
}
constexpr double natural_rate = 1.24e-3;  // rad/s

template <class Frame>
Matrix9 dynamics_at(const earth::Earth& earth, const NavState& state, const Vector3d& f_b) {
    const typename Frame::State s = Frame::from_geographic(earth, state);
    return ins::matrix(Frame::dynamics(earth, s, Frame::attitude(s) * f_b));
}

/// Errors of paper C as errors of the filter: inertial attitude right, the computed local level off by the position error. In the
/// Earth-fixed frame the map turns with the longitude.
template <class Frame>
Eigen::Matrix<double, 9, 6> from_equator_errors(const theory::EquatorFlight& flight, double longitude) {
    using namespace theory;
    const double R = flight.constants().R;
    Eigen::Matrix<double, 9, 6> T = Eigen::Matrix<double, 9, 6>::Zero();
    T(0, lat) = T(1, lon) = R;
    T(2, height) = -1.0;
    T(3, vn) = T(4, ve) = 1.0;
    T(5, vh) = -1.0;
    T(6, lon) = 1.0;
    T(7, lat) = -1.0;
    if (Frame::errors_are_geographic) return T;
    const Eigen::Matrix3d C_en = earth::C_en(0.0, longitude);
    Eigen::Matrix<double, 9, 6> T_e = Eigen::Matrix<double, 9, 6>::Zero();
    T_e.topRows<3>() = C_en * T.topRows<3>();
    T_e.middleRows<3>(3) = C_en * (T.middleRows<3>(3) - math::skew({0.0, flight.speed(), 0.0}) * T.bottomRows<3>());
    return T_e;
}

/// (a) On the equator of a spherical Earth: F T - dT/dt = T A, and so exp(F t) T = T P(t).
template <class Frame>
void expect_closed_solution() {
    earth::Earth sphere{earth::paper_c, earth::GravityModel::PaperC};
    sphere.ellipsoid.f = 0.0;
    for (const auto& [v, h, longitude] :
         {std::tuple{600.0, 10000.0, 0.7}, std::tuple{10.0, 0.0, -2.0}, std::tuple{-465.0, 3000.0, 0.1}}) {
        const theory::EquatorFlight flight(v, h);
        NavState state;
        state.position = {0.0, longitude, h};
        state.v_eb_n = {0.0, v, 0.0};
        state.q_nb = math::quaternion_from_rpy({0.3, -0.2, 2.0});
        const Vector3d f_b = state.q_nb.conjugate() * Vector3d(0.0, 0.0, -flight.constants().a_h);
        Matrix9 F = dynamics_at<Frame>(sphere, state, f_b);
        if (!Frame::errors_are_geographic) {  // seen from axes that turn with the longitude
            const Eigen::Matrix3d turn = math::skew({0.0, 0.0, v / flight.constants().R});
            for (int block = 0; block < 9; block += 3) F.block<3, 3>(block, block) -= turn;
        }
        const Eigen::Matrix<double, 9, 6> T = from_equator_errors<Frame>(flight, longitude);
        const Eigen::Matrix<double, 9, 6> FT = F * T, TA = T * flight.dynamics();
        const Eigen::Matrix<double, 9, 6> size = F.cwiseAbs() * T.cwiseAbs() + T.cwiseAbs() * flight.dynamics().cwiseAbs();
        const Vector9 scale = natural_scale();
        const theory::Vector6 column = (theory::Vector6() << 7900.0, 7900.0, 7900.0, 6.4e6, 1.0, 1.0).finished();
        const Eigen::Matrix<double, 9, 6> rounding = 1e-13 * natural_rate * scale * column.cwiseInverse().transpose();
        EXPECT_LE((FT - TA).cwiseAbs().cwiseQuotient(1e-8 * size + rounding).maxCoeff(), 1.0) << v << "\n" << FT - TA;

        const Matrix9 scaled = scale.cwiseInverse().asDiagonal() * F * scale.asDiagonal();
        for (const double t : {600.0, 3600.0}) {
            const Matrix9 power = (scaled * t).exp();
            const Eigen::Matrix<double, 9, 6> grown = scale.asDiagonal() * power * scale.cwiseInverse().asDiagonal() * T;
            const Eigen::Matrix<double, 9, 6> closed = T * flight.transition(t);
            const Eigen::Matrix<double, 9, 6> misfit = scale.cwiseInverse().asDiagonal() * (grown - closed);
            const Eigen::Matrix<double, 9, 6> whole = scale.cwiseInverse().asDiagonal() * closed;
            for (int j = 0; j < 6; ++j)
                EXPECT_LE(misfit.col(j).cwiseAbs().maxCoeff(), 1e-8 * whole.col(j).cwiseAbs().maxCoeff())
                    << v << ", " << t << ", " << j;
        }
    }
}

/// (b) F is the derivative of the mechanization at random states: differences in time to the sixth order around the instant, in
/// the error to the fourth.
template <class Frame>
void expect_derivative_of_mechanization() {
    std::mt19937_64 generator(77);
    std::uniform_real_distribution<double> unit(-1.0, 1.0);
    const auto vector = [&](double size) { return Vector3d(size * draw3(unit, generator)); };
    for (int point = 0; point < 40; ++point) {
        earth::Earth earth;
        earth.gravity = point % 2 == 0 ? earth::GravityModel::KfGins : earth::GravityModel::PaperC;
        NavState state;
        state.position = {std::asin(0.98 * unit(generator)), 0.4 * unit(generator), 6000.0 + 6000.0 * unit(generator)};
        state.v_eb_n = vector(250.0);
        state.q_nb = math::quaternion_from_rotation_vector(vector(1.8));
        const Vector3d f_b = state.q_nb.conjugate() * (Vector3d(0.0, 0.0, -9.8) + vector(5.0)), w_b = vector(0.01);
        const auto increment = [&](double dt) {
            const Vector3d theta = dt * w_b, dv = dt * f_b;
            return ins::CompensatedIncrement{Time{}, dt, theta, dv + 0.5 * theta.cross(dv) + theta.cross(theta.cross(dv)) / 6.0};
        };
        const typename Frame::State truth = Frame::from_geographic(earth, state);
        const auto growth = [&](const Vector9& dx) {
            const typename Frame::State start = Frame::corrected(earth, truth, -dx);
            const auto slope = [&](double dt) {
                const Vector9 after =
                    error_between(earth, Frame::step(earth, start, increment(dt)), Frame::step(earth, truth, increment(dt)));
                const Vector9 before =
                    error_between(earth, Frame::step(earth, start, increment(-dt)), Frame::step(earth, truth, increment(-dt)));
                return Vector9((after - before) / (2.0 * dt));
            };
            const Vector9 r1 = slope(1.6), r2 = slope(0.8), r3 = slope(0.4);
            return Vector9((16.0 * (4.0 * r3 - r2) - (4.0 * r2 - r1)) / 45.0);
        };
        const Vector9 scale = natural_scale();
        const Matrix9 F = dynamics_at<Frame>(earth, state, f_b);
        for (int j = 0; j < 9; ++j) {
            const double size = scale(j) * (j < 3 ? 1e-3 : 2e-3);
            const auto difference = [&](double h) {
                const Vector9 dx = h * Vector9::Unit(j);
                return Vector9((growth(dx) - growth(-dx)) / (2.0 * h));
            };
            const Vector9 column = (4.0 * difference(size) - difference(2.0 * size)) / 3.0;
            for (int i = 0; i < 9; ++i)
                EXPECT_LE(std::abs(column(i) - F(i, j)), 1e-8 * std::abs(F(i, j)) + 1e-9 * natural_rate * scale(i) / scale(j))
                    << "point " << point << ", latitude " << state.position.lat << ": (" << i << ", " << j << ") is " << F(i, j)
                    << ", by differences " << column(i);
        }
    }
}

/// (c) Simulated perfect sensors: the difference of a right and a perturbed start, against dx/dt = F dx along the true path.
template <class Frame>
void expect_growth_in_simulation() {
    const earth::Earth earth;
    const Geodetic start{50.0 * units::deg, 0.5, 3000.0};
    for (const sim::PathSettings& settings :
         {sim::PathSettings(sim::PaperAPath{}), sim::PathSettings(sim::GreatCirclePath{start, 1.0, 240.0})}) {
        const std::unique_ptr<const sim::TruthPath> path = sim::make_path(settings, earth.ellipsoid);
        const auto state_at = [&](double t) { return sim::nav_state(path->at(t), Time::from_seconds(t)); };
        const auto F_at = [&](double t) {
            return dynamics_at<Frame>(earth, state_at(t), sim::inertial_input(earth, path->at(t)).f_b);
        };
        Vector9 dx;
        dx << 0.5, -0.8, 0.3, 0.002, -0.003, 0.001, 1e-6, -2e-6, 3e-6;
        typename Frame::State right = Frame::from_geographic(earth, state_at(0.0)), wrong = Frame::corrected(earth, right, -dx);
        const double dt = 0.05, duration = 900.0;
        const int steps_a_second = 20;
        ImuIncrement previous{Time{}, 0.0, Vector3d::Zero(), Vector3d::Zero()};
        for (int second = 0; second < static_cast<int>(duration); ++second) {
            for (int i = 0; i < steps_a_second; ++i) {
                const double from = second + dt * i;
                const sim::ExactIncrement felt = sim::exact_increment(earth, *path, from, from + dt);
                const ImuIncrement raw{Time::from_seconds(from + dt), dt, felt.dtheta, felt.dv};
                const ins::CompensatedIncrement increment = ins::compensate(previous, raw);
                right = Frame::step(earth, right, increment);
                wrong = Frame::step(earth, wrong, increment);
                previous = raw;
            }
            const Matrix9 first = F_at(second), middle = F_at(second + 0.5), last = F_at(second + 1.0);
            const Vector9 k1 = first * dx, k2 = middle * (dx + 0.5 * k1), k3 = middle * (dx + 0.5 * k2), k4 = last * (dx + k3);
            dx += (k1 + 2.0 * (k2 + k3) + k4) / 6.0;
        }
        const Vector9 true_growth = error_between(earth, wrong, right);
        for (int block = 0; block < 9; block += 3)
            EXPECT_LT((true_growth - dx).segment<3>(block).norm(), 1e-5 * dx.segment<3>(block).norm())
                << "path " << settings.index() << "\n"
                << true_growth.transpose() << "\n"
                << dx.transpose();
    }
}

/// Names of the frame policies and of the functions of their F: "filter.GeographicFrame.error_n" registers both.
#define SCHULER_ERROR_MODEL(ID, NAME, FRAME)                                                                                    \
    TEST(ErrorModelOf##ID, IsThatOfTheClosedSolution) { ::schuler::test::expect_closed_solution<FRAME>(); }                     \
    TEST(ErrorModelOf##ID, IsTheDerivativeOfTheMechanization) { ::schuler::test::expect_derivative_of_mechanization<FRAME>(); } \
    TEST(ErrorModelOf##ID, IsTheGrowthInSimulation) { ::schuler::test::expect_growth_in_simulation<FRAME>(); }

}  // namespace schuler::test
