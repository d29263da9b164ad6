#include "schuler/filter/states/disturbance.h"

#include "schuler/core/fail.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::RowVector3d;
using Eigen::Vector3d;

Matrix3d DisturbanceChain::dynamics() const {
    const double k = rate;
    Matrix3d F = Matrix3d::Zero();
    if (order > 1) F(0, 1) = 1.0;
    if (order > 2) F(1, 2) = 1.0;
    if (!random) return F;
    if (order == 1) F(0, 0) = -k;
    if (order == 2) F.row(1) << -k * k, -2.0 * k, 0.0;
    if (order == 3) F.row(2) << -k * k * k, -3.0 * k * k, -3.0 * k;
    return F;
}

Matrix3d DisturbanceChain::growth(double distance) const {
    // All poles are at -rate: the remainder of the dynamics is nilpotent.
    Matrix3d present = Matrix3d::Zero();
    present.diagonal().head(order).setOnes();
    const Matrix3d X = distance * (dynamics() + rate * present);
    const Matrix3d series = Matrix3d::Identity() + X + 0.5 * X * X;
    return random ? Matrix3d(std::exp(-rate * distance) * present * series + (Matrix3d::Identity() - present)) : series;
}

double DisturbanceChain::psd() const {
    const double k = rate;
    return !random ? 0.0 : order == 1 ? 2.0 * k : order == 2 ? 4.0 * k * k * k : 16.0 / 3.0 * std::pow(k, 5);
}

DisturbanceChain DisturbanceModel::random_part() const {
    return {true, kind == DisturbanceKind::SecondOrder ? 2 : kind == DisturbanceKind::ThirdOrder ? 3 : 1, 1.0 / length};
}

void DisturbanceModel::check() const {
    if (!(sigma_n.array() >= 0.0).all() || !sigma_n.allFinite())
        fail(
            input_error("sigmas of the disturbance must be numbers >= 0", {{}, 0, 0, "sigma_mgal"}, "give three sigmas in mGal"));
    const bool chained = kind == DisturbanceKind::SecondOrder || kind == DisturbanceKind::ThirdOrder;
    if (kind != DisturbanceKind::Constant && (!(length > 0.0) || (chained && !std::isfinite(length))))
        fail(input_error("the correlation length of the disturbance must be positive", {{}, 0, 0, "length_m"},
                         "give metres along the track, for example 5000"));
}

Matrix3d DisturbanceModel::stationary() const {
    Matrix3d S = Matrix3d::Zero();
    if (!has_random_part()) return S;
    const double k2 = 1.0 / (length * length);
    S(0, 0) = 1.0;
    if (kind == DisturbanceKind::SecondOrder) S(1, 1) = k2;
    if (kind == DisturbanceKind::ThirdOrder) {
        S(1, 1) = k2 / 3.0;
        S(0, 2) = S(2, 0) = -k2 / 3.0;
        S(2, 2) = k2 * k2;
    }
    return S;
}

void add_disturbance(const DisturbanceModel& model, Layout& layout) {
    const bool by_time = model.by_time;
    layout.gravity_constant = layout.add("gravity_constant", "m/s^2", 3);
    if (!model.has_random_part()) return;
    layout.gravity_random = layout.add("gravity_random", "m/s^2", 3);
    const int order = std::max(model.degree() + 1, model.random_part().order);
    if (order > 1) layout.gravity_slope = layout.add("gravity_slope", by_time ? "m/s^3" : "1/s^2", 3);
    if (order > 2) layout.gravity_curvature = layout.add("gravity_curvature", by_time ? "m/s^4" : "1/(m s^2)", 3);
}

namespace {

/// The states of a chain's value, slope and curvature: the first components of their blocks.
using ChainStates = std::array<int, 3>;

/// Each chain of a model with its states.
template <class Each>
void each_chain(const DisturbanceModel& model, const Layout& layout, Each each) {
    each(model.systematic_part(), ChainStates{layout.gravity_constant, layout.gravity_slope, layout.gravity_curvature});
    if (model.has_random_part())
        each(model.random_part(), ChainStates{layout.gravity_random, layout.gravity_slope, layout.gravity_curvature});
}

/// Mean of the growth over the distance, by Simpson's rule: accurate to fourth order in distance over length.
Matrix3d mean_growth(const DisturbanceChain& chain, double distance) {
    return (Matrix3d::Identity() + 4.0 * chain.growth(0.5 * distance) + chain.growth(distance)) / 6.0;
}

/// The same with the weight for double integration, which decreases to zero at the end of the distance.
Matrix3d double_mean_growth(const DisturbanceChain& chain, double distance) {
    return (Matrix3d::Identity() + 2.0 * chain.growth(0.5 * distance)) / 3.0;
}

}  // namespace

Vector3d disturbance_of(const Layout& layout, const estim::StateVector& parameters) {
    Vector3d g = parameters.segment<3>(layout.gravity_constant);
    if (layout.gravity_random >= 0) g += parameters.segment<3>(layout.gravity_random);
    return g;
}

void advance_disturbance(const DisturbanceModel& model, const Layout& layout, double distance, estim::StateVector& parameters) {
    each_chain(model, layout, [&](const DisturbanceChain& chain, const ChainStates& at) {
        if (!chain.random && chain.order == 1) return;
        const Matrix3d M = chain.growth(distance);
        for (int axis = 0; axis < 3; ++axis) {
            Vector3d x = Vector3d::Zero();
            for (int i = 0; i < chain.order; ++i) x(i) = parameters(at[static_cast<std::size_t>(i)] + axis);
            x = (M * x).eval();
            for (int i = 0; i < chain.order; ++i) parameters(at[static_cast<std::size_t>(i)] + axis) = x(i);
        }
    });
}

void fill_disturbance(const DisturbanceModel& model, const Layout& layout, double time, double distance, const Matrix3d& to_frame,
                      estim::Transition& phi) {
    const auto shear = [&phi](int to, int from, double factor) {
        if (factor != 0.0) phi.shears[static_cast<std::size_t>(phi.shear_count++)] = {to, from, factor};
    };
    each_chain(model, layout, [&](const DisturbanceChain& chain, const ChainStates& at) {
        const auto state = [&at](int i) { return at[static_cast<std::size_t>(i)]; };
        // Growth = L U = D (D^-1 L D) U with triangles of unit diagonals: shears by U, shears by the other, D. No pivot is zero:
        // the leading minors of exp(F d) are exp(-n k d) times polynomials with positive coefficients.
        const Matrix3d M = chain.growth(distance);
        Matrix3d L = Matrix3d::Identity(), U = M;
        for (int c = 0; c < 3; ++c)
            for (int r = c + 1; r < 3; ++r) {
                L(r, c) = U(r, c) / U(c, c);
                U.row(r) -= L(r, c) * U.row(c);
            }
        const Vector3d D = U.diagonal();
        for (int axis = 0; axis < 3; ++axis) {
            for (int to = 0; to < chain.order; ++to)
                for (int from = to + 1; from < chain.order; ++from)
                    shear(state(to) + axis, state(from) + axis, U(to, from) / D(to));
            for (int to = chain.order - 1; to > 0; --to)
                for (int from = 0; from < to; ++from) shear(state(to) + axis, state(from) + axis, L(to, from) * D(from) / D(to));
        }
        // Velocity and position from the mean value over the interval, by the states after the shears: M^-1 D reverses these.
        const Matrix3d back = chain.growth(-distance) * D.asDiagonal();
        const RowVector3d velocity = time * mean_growth(chain, distance).row(0) * back;
        const RowVector3d position = 0.5 * time * time * double_mean_growth(chain, distance).row(0) * back;
        for (int i = 0; i < chain.order; ++i) {
            phi.diagonal.segment<3>(state(i)).setConstant(D(i));
            for (int axis = 0; axis < 3; ++axis) {
                phi.rows.block<1, 3>(state(i) + axis, Layout::velocity) = velocity(i) * to_frame.col(axis).transpose();
                phi.rows.block<1, 3>(state(i) + axis, Layout::position) = position(i) * to_frame.col(axis).transpose();
            }
        }
    });
}

void add_disturbance_noise(const DisturbanceModel& model, const Layout& layout, double time, double distance,
                           const Matrix3d& from_local_level, const Matrix3d& to_frame, estim::StateMatrix& P) {
    if (!model.has_random_part() || !(distance > 0.0)) return;
    const DisturbanceChain chain = model.random_part();
    const std::array<int, 3> at{layout.gravity_random, layout.gravity_slope, layout.gravity_curvature};
    const Matrix3d sigma2 = from_local_level * model.sigma_n.cwiseAbs2().asDiagonal() * from_local_level.transpose();
    // Three-point Gauss rule over the time of the noise input; (value, slope, curvature, integral of the value over time).
    const double h = std::sqrt(0.6);
    Eigen::Matrix4d Q = Eigen::Matrix4d::Zero();
    for (const auto& [node, weight] : {std::pair{-h, 5.0 / 18.0}, std::pair{0.0, 8.0 / 18.0}, std::pair{h, 5.0 / 18.0}}) {
        const double rest = 0.5 * (1.0 + node) * distance;
        Eigen::Vector4d x;
        x.head<3>() = chain.growth(rest).col(chain.order - 1);
        x(3) = rest / distance * time * mean_growth(chain, rest)(0, chain.order - 1);
        Q += weight * chain.psd() * distance * x * x.transpose();
    }
    for (int r = 0; r < chain.order; ++r) {
        const int row = at[static_cast<std::size_t>(r)];
        for (int c = 0; c < chain.order; ++c) estim::add(P.block<3, 3>(row, at[static_cast<std::size_t>(c)]), Q(r, c) * sigma2);
        const Matrix3d shared = Q(3, r) * to_frame * sigma2;
        estim::add(P.block<3, 3>(Layout::velocity, row), shared);
        estim::add(P.block<3, 3>(row, Layout::velocity), shared.transpose());
    }
    const Matrix3d own = Q(3, 3) * to_frame * sigma2 * to_frame.transpose();
    estim::add(P.block<3, 3>(Layout::velocity, Layout::velocity), 0.5 * (own + own.transpose()));
}

void start_disturbance(const DisturbanceSettings& settings, const Layout& layout, const Matrix3d& C_en, estim::StateMatrix& P) {
    const DisturbanceModel& model = settings.model;
    open_disturbance(settings, layout, C_en, P);
    if (model.degree() > 0) P.diagonal().segment<3>(layout.gravity_slope).setConstant(settings.slope * settings.slope);
    if (model.degree() > 1)
        P.diagonal().segment<3>(layout.gravity_curvature).setConstant(settings.curvature * settings.curvature);
    if (!model.has_random_part()) return;
    const std::array<int, 3> at{layout.gravity_random, layout.gravity_slope, layout.gravity_curvature};
    const Matrix3d N = model.from_local_level(C_en), S = model.stationary();
    const Matrix3d sigma2 = N * model.sigma_n.cwiseAbs2().asDiagonal() * N.transpose();
    for (int r = 0; r < model.random_part().order; ++r)
        for (int c = 0; c < model.random_part().order; ++c)
            P.block<3, 3>(at[static_cast<std::size_t>(r)], at[static_cast<std::size_t>(c)]) =
                (S(r, c) * sigma2).cast<estim::CovarianceScalar>();
}

void open_disturbance(const DisturbanceSettings& settings, const Layout& layout, const Matrix3d& C_en, estim::StateMatrix& P) {
    const Matrix3d N = settings.model.from_local_level(C_en);
    estim::add(P.block<3, 3>(layout.gravity_constant, layout.gravity_constant),
               N * settings.prior_n.cwiseAbs2().asDiagonal() * N.transpose());
}

}  // namespace schuler::filter
