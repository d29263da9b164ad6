// The disturbance of gravity as states: its processes against their correlation functions, spans against their parts, and what the
// covariance's staged propagation makes of them against dense matrices.
#include "schuler/filter/states/disturbance.h"

#include "schuler/core/error.h"
#include "schuler/earth/earth.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace schuler::filter {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using estim::StateMatrix;
using estim::StateVector;

constexpr DisturbanceKind kinds[] = {DisturbanceKind::Constant,          DisturbanceKind::FirstOrder,
                                     DisturbanceKind::RampAndFirstOrder, DisturbanceKind::QuadraticAndFirstOrder,
                                     DisturbanceKind::SecondOrder,       DisturbanceKind::ThirdOrder};
const Matrix3d C_en = earth::C_en(0.9, 0.4);

DisturbanceModel model_of(DisturbanceKind kind, DisturbanceAxes axes = DisturbanceAxes::LocalLevel) {
    return {kind, 5000.0, Vector3d(2e-4, 3e-4, 5e-4), false, axes};
}
Layout layout_of(const DisturbanceModel& model) {
    Layout layout;
    add_disturbance(model, layout);
    return layout;
}

/// Phi of a span in which nothing but the disturbance happens.
estim::Transition span(const DisturbanceModel& model, const Layout& layout, double time, double distance) {
    estim::Transition phi;
    phi.driven = estim::padded(layout.driven());
    phi.diagonal = StateVector::Ones(estim::padded(layout.size));
    for (int i = 0; i < 9; ++i) phi.rows(i, i) = 1.0;
    fill_disturbance(model, layout, time, distance, model.to_earth_fixed(C_en), phi);
    return phi;
}
MatrixXd dense(const estim::Transition& phi) {
    const Eigen::Index n = phi.diagonal.size();
    MatrixXd M(n, n);
    for (Eigen::Index i = 0; i < n; ++i) M.col(i) = phi.times(StateVector::Unit(n, i));
    return M;
}

TEST(Disturbance, ProcessesStayInTheirStationaryStateAndForgetAsTheyShould) {
    for (const DisturbanceKind kind : {DisturbanceKind::FirstOrder, DisturbanceKind::SecondOrder, DisturbanceKind::ThirdOrder}) {
        const DisturbanceModel model =
            model_of(kind, kind == DisturbanceKind::SecondOrder ? DisturbanceAxes::EarthFixed : DisturbanceAxes::LocalLevel);
        const Layout layout = layout_of(model);
        StateMatrix P = StateMatrix::Zero(estim::padded(layout.size), estim::padded(layout.size));
        start_disturbance({.estimate = true, .model = model, .prior_n = Vector3d::Zero()}, layout, C_en, P);
        const StateMatrix before = P;
        MatrixXd way = MatrixXd::Identity(P.rows(), P.cols());
        double distance = 0.0;
        for (int second = 0; second < 200; ++second) {  // a hundred at 20 m/s and a hundred at 60
            const double d = second < 100 ? 20.0 : 60.0;
            const estim::Transition phi = span(model, layout, 1.0, d);
            estim::propagate(P, phi, static_cast<int>(P.rows()));
            add_disturbance_noise(model, layout, 1.0, d, model.from_local_level(C_en), model.to_earth_fixed(C_en), P);
            way = dense(phi) * way;
            distance += d;
        }
        const int first = layout.gravity_random, n = layout.size - first;
        const MatrixXd scale = before.diagonal().segment(first, n).cwiseSqrt().asDiagonal().inverse();
        EXPECT_LT((scale * (P - before).block(first, first, n, n) * scale).norm(), 1e-9) << static_cast<int>(kind);
        const double x = distance / model.length;
        const double correlation = std::exp(-x) * (kind == DisturbanceKind::FirstOrder    ? 1.0
                                                   : kind == DisturbanceKind::SecondOrder ? 1.0 + x
                                                                                          : 1.0 + x + x * x / 3.0);
        const Matrix3d sigma2 = before.block<3, 3>(first, first), kept = (way * before).block<3, 3>(first, first);
        EXPECT_LT((kept - correlation * sigma2).norm(), 1e-12 * sigma2.norm()) << static_cast<int>(kind);
    }
}

TEST(Disturbance, ALongSpanIsTheProductOfItsParts) {
    // Value, slope, curvature exactly; velocity and position, and the noise, to the order of the quadrature.
    for (const DisturbanceKind kind : kinds) {
        DisturbanceModel model = model_of(kind, DisturbanceAxes::EarthFixed);
        model.length = 2000.0;  // an eightieth of it in the span
        const Layout layout = layout_of(model);
        const int n = estim::padded(layout.size);
        constexpr int parts = 64;
        const double time = 0.5, distance = 25.0;
        MatrixXd product = MatrixXd::Identity(n, n), flight = MatrixXd::Identity(n, n);
        StateMatrix sum = StateMatrix::Zero(n, n), whole = sum;
        for (int i = 0; i < parts; ++i) {
            flight.setIdentity();
            flight.block<3, 3>(Layout::position, Layout::velocity) = time / parts * Matrix3d::Identity();
            MatrixXd one = dense(span(model, layout, time / parts, distance / parts));
            product = (one * flight * product).eval();
            sum = (one * flight * sum * flight.transpose() * one.transpose()).eval();
            add_disturbance_noise(model, layout, time / parts, distance / parts, model.from_local_level(C_en),
                                  Matrix3d::Identity(), sum);
        }
        MatrixXd expected = dense(span(model, layout, time, distance));
        expected.block<3, 3>(Layout::position, Layout::velocity) += time * Matrix3d::Identity();
        add_disturbance_noise(model, layout, time, distance, model.from_local_level(C_en), Matrix3d::Identity(), whole);
        const int first = layout.gravity_constant, states = layout.size - first;
        EXPECT_LT((product - expected).bottomRightCorner(n - first, n - first).norm(), 1e-14 * distance * distance)
            << static_cast<int>(kind);
        for (int state = first; state < layout.size; ++state)
            for (int row = 0; row < 6; ++row)
                EXPECT_NEAR(product(row, state), expected(row, state),
                            2e-3 * expected.col(state).segment<3>(row / 3 * 3).norm() + 1e-18)
                    << static_cast<int>(kind) << " " << row << " " << state;
        if (!model.has_random_part()) continue;
        for (const int r : {Layout::velocity, layout.gravity_random}) {
            const Matrix3d a = sum.block<3, 3>(r, layout.gravity_random), b = whole.block<3, 3>(r, layout.gravity_random);
            EXPECT_LT((a - b).norm(), 0.02 * b.norm()) << static_cast<int>(kind) << " " << r;
        }
        EXPECT_GT(states, 3);
    }
}

TEST(Disturbance, NominalValuesFollowTheTransition) {
    math::Random random(3, "disturbance");
    for (const DisturbanceKind kind : kinds) {
        const DisturbanceModel model = model_of(kind);
        const Layout layout = layout_of(model);
        StateVector x = StateVector::Zero(estim::padded(layout.size));
        for (int i = layout.gravity_constant; i < layout.size; ++i) x(i) = random.normal();
        const StateVector expected = span(model, layout, 1.0, 60.0).times(x);
        advance_disturbance(model, layout, 60.0, x);
        EXPECT_LT((x - expected).tail(x.size() - layout.gravity_constant).norm(), 1e-12 * x.norm()) << static_cast<int>(kind);
    }
    // A parabola at the place that is reached.
    const DisturbanceModel model = model_of(DisturbanceKind::QuadraticAndFirstOrder);
    const Layout layout = layout_of(model);
    StateVector x = StateVector::Zero(estim::padded(layout.size));
    const double value = 3e-4, slope = -2e-8, curvature = 5e-12, d = 800.0;
    x(layout.gravity_constant + 2) = value;
    x(layout.gravity_slope + 2) = slope;
    x(layout.gravity_curvature + 2) = curvature;
    advance_disturbance(model, layout, d, x);
    EXPECT_NEAR(disturbance_of(layout, x).z(), value + d * slope + 0.5 * d * d * curvature, 1e-15);
    EXPECT_NEAR(x(layout.gravity_slope + 2), slope + d * curvature, 1e-18);
}

TEST(Disturbance, TheStagedPropagationIsThatOfDenseMatrices) {
    // Shears reach driven states here: covariance, its leading corner, and the adjoint.
    math::Random random(4, "staged");
    for (const DisturbanceKind kind : kinds) {
        DisturbanceModel model = model_of(kind);
        model.length = 30.0;
        const Layout layout = layout_of(model);
        const int n = estim::padded(layout.size);
        const estim::Transition phi = span(model, layout, 0.5, 20.0);
        const MatrixXd M = dense(phi);
        StateMatrix P(n, n);
        for (int i = 0; i < n; ++i)
            for (int j = 0; j < n; ++j) P(i, j) = random.normal();
        P = (P * P.transpose()).eval();
        const MatrixXd forward = M * P * M.transpose(), back = M.transpose() * P * M;
        EXPECT_LT((estim::propagated_corner(P, phi) - forward.topLeftCorner<9, 9>()).norm(), 1e-12 * forward.norm());
        StateMatrix F = P, L = P;
        estim::propagate(F, phi, n);
        estim::propagate_adjoint(L, phi, n);
        EXPECT_LT((F - forward).norm(), 1e-12 * forward.norm()) << static_cast<int>(kind);
        EXPECT_LT((L - back).norm(), 1e-12 * back.norm()) << static_cast<int>(kind);
    }
}

TEST(Disturbance, UnusableModelsAreRefused) {
    const double infinite = std::numeric_limits<double>::infinity();
    EXPECT_THROW((DisturbanceModel{DisturbanceKind::FirstOrder, 0.0, Vector3d::Ones()}.check()), Error);
    EXPECT_THROW((DisturbanceModel{DisturbanceKind::SecondOrder, infinite, Vector3d::Ones()}.check()), Error);
    EXPECT_THROW((DisturbanceModel{DisturbanceKind::FirstOrder, 10.0, Vector3d(1.0, -1.0, 1.0)}.check()), Error);
    EXPECT_NO_THROW((DisturbanceModel{DisturbanceKind::FirstOrder, infinite, Vector3d::Ones()}.check()));
}

}  // namespace
}  // namespace schuler::filter
