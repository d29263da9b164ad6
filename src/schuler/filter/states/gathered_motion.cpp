#include "schuler/filter/states/gathered_motion.h"

#include "schuler/math/rotation.h"

#include <array>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::skew;
using math::Triple;

namespace {

constexpr int p = Layout::position, v = Layout::velocity, a = Layout::attitude;

/// A scale factor or misalignment: its contribution to the rate about `axis` is itself times the rate about `of`.
struct Gain {
    int axis, of;
};
constexpr std::array<Gain, 9> gains_of_axes{{{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 0}, {1, 2}, {2, 0}, {2, 1}}};

/// The first of them that a layout has: scale factors come before misalignments.
std::size_t first_gain(const Layout& layout) { return layout.gyro_scale >= 0 ? 0 : 3; }

/// Copies a block of A into the rows of the transition.
template <class Block>
void put(estim::Transition& phi, int row, int column, const Block& block) {
    for (Eigen::Index i = 0; i < 3; ++i)
        for (Eigen::Index j = 0; j < block.cols(); ++j) phi.rows(column + j, row + i) = block(i, j);
}

}  // namespace

GatheredMotion::GatheredMotion(const Layout& layout) {
    const Eigen::Index gains = (layout.gyro_scale >= 0 ? 3 : 0) + (layout.gyro_misalignment >= 0 ? 6 : 0);
    gain_turn = gain_velocity_by_gyro = gain_position_by_gyro = gain_velocity_by_accel = gain_position_by_accel =
        Columns::Zero(3, gains);
}

void GatheredMotion::reset() {
    time = distance = gyro_variance = accel_variance = 0.0;
    force.setZero();
    force_twice.setZero();
    acceleration.setZero();
    rotation.setZero();
    turn.setZero();
    turn_twice.setZero();
    velocity_by_gyro.setZero();
    position_by_gyro.setZero();
    if (gain_turn.cols() == 0) return;
    gain_turn.setZero();
    gain_velocity_by_gyro.setZero();
    gain_position_by_gyro.setZero();
    gain_velocity_by_accel.setZero();
    gain_position_by_accel.setZero();
}

void GatheredMotion::add(const Layout& layout, double dt, const Matrix3d& C, const Vector3d& df, const Vector3d& w_b,
                         const Vector3d& f_b, double gyro_psd, double accel_psd) {
    const double half = 0.5 * dt;
    const Triple dforce(df);
    for (int i = 0; i < 3; ++i) {
        const Triple dturn = dt * math::column(C, i), before = math::column(turn, i);
        const Triple dv = dforce.cross(before + 0.5 * dturn);
        math::add_to(position_by_gyro, dt * math::column(velocity_by_gyro, i) + half * dv, i);
        math::add_to(velocity_by_gyro, dv, i);
        math::add_to(turn_twice, dt * before + half * dturn, i);
        math::add_to(turn, dturn, i);
    }
    math::add_to(force_twice, dt * Triple(force) + half * dforce);
    math::add_to(force, dforce);
    time += dt;
    gyro_variance += gyro_psd * dt;
    accel_variance += accel_psd * dt;
    if (gain_turn.cols() == 0) return;
    const std::size_t first = first_gain(layout);
    for (Eigen::Index i = 0; i < gain_turn.cols(); ++i) {
        const Gain& g = gains_of_axes[first + static_cast<std::size_t>(i)];
        const Triple axis = dt * math::column(C, g.axis), gyro = w_b(g.of) * axis, accel = -f_b(g.of) * axis;
        const Triple dv = dforce.cross(math::column(gain_turn, i) + 0.5 * gyro);
        math::add_to(gain_position_by_gyro, dt * math::column(gain_velocity_by_gyro, i) + half * dv, i);
        math::add_to(gain_velocity_by_gyro, dv, i);
        math::add_to(gain_turn, gyro, i);
        math::add_to(gain_position_by_accel, dt * math::column(gain_velocity_by_accel, i) + half * accel, i);
        math::add_to(gain_velocity_by_accel, accel, i);
    }
}

void GatheredMotion::fill(const Layout& layout, estim::Transition& phi) const {
    phi.driven = estim::padded(layout.driven());
    phi.shear_count = 0;
    phi.rows.setZero();
    for (int i = 0; i < 9; ++i) phi.rows(i, i) = 1.0;
    put(phi, p, v, Matrix3d(time * Matrix3d::Identity()));
    put(phi, p, a, skew(force_twice));
    put(phi, v, a, skew(force));
    put(phi, a, Layout::gyro_bias, turn);
    put(phi, v, Layout::gyro_bias, velocity_by_gyro);
    put(phi, p, Layout::gyro_bias, position_by_gyro);
    put(phi, v, Layout::accel_bias, Matrix3d(-turn));
    put(phi, p, Layout::accel_bias, Matrix3d(-turn_twice));
    const auto gains = [&](int gyro, int accel, Eigen::Index first, Eigen::Index count) {
        put(phi, a, gyro, gain_turn.middleCols(first, count));
        put(phi, v, gyro, gain_velocity_by_gyro.middleCols(first, count));
        put(phi, p, gyro, gain_position_by_gyro.middleCols(first, count));
        put(phi, v, accel, gain_velocity_by_accel.middleCols(first, count));
        put(phi, p, accel, gain_position_by_accel.middleCols(first, count));
    };
    if (layout.gyro_scale >= 0) gains(layout.gyro_scale, layout.accel_scale, 0, 3);
    if (layout.gyro_misalignment >= 0)
        gains(layout.gyro_misalignment, layout.accel_misalignment, layout.gyro_scale >= 0 ? 3 : 0, 6);
}

void GatheredMotion::add_earth(const ins::ErrorDynamics& earth, estim::Transition& phi) const {
    // (I + F T/2) Phi (I + F T/2) without the product of the two small terms.
    const double h = 0.5 * time;
    Matrix9 F = ins::matrix(earth);
    F.block<3, 3>(p, v).setZero();  // the propagation of position by velocity is already in Phi
    // Phi F: the first nine columns of Phi are a unit matrix, T, and the skew matrices of the forces.
    Eigen::Matrix<double, 3, 9> by_p = F.topRows<3>(), by_v = F.middleRows<3>(v);
    const auto by_a = F.bottomRows<3>();
    by_p += time * by_v;
    by_p.noalias() += skew(force_twice).lazyProduct(by_a);
    by_v.noalias() += skew(force).lazyProduct(by_a);
    // F Phi, element by element: most of F is zero.
    const estim::Transition::Rows before = phi.rows;
    for (int k = 0; k < 9; ++k)
        for (int r = 0; r < 9; ++r)
            if (F(r, k) != 0.0) phi.rows.col(r).head(phi.driven) += (h * F(r, k)) * before.col(k).head(phi.driven);
    for (int i = 0; i < 3; ++i) {
        phi.rows.col(p + i).head<9>() += h * by_p.row(i).transpose();
        phi.rows.col(v + i).head<9>() += h * by_v.row(i).transpose();
        phi.rows.col(a + i).head<9>() += h * by_a.row(i).transpose();
    }
}

Matrix9 GatheredMotion::noise(const BiasNoise& biases) const {
    const double T = time, T2 = T * T;
    const double qg = gyro_variance, qa = accel_variance;  // times T
    const double wg = biases.gyro_bias_psd * T2, wa = biases.accel_bias_psd * T2;
    const Matrix3d f = skew(force / T), f2 = -f * f, I = Matrix3d::Identity();  // f2: f f^T
    Matrix9 Q = Matrix9::Zero();
    const auto off_diagonal = [&Q](int row, int column, const Matrix3d& block) {
        Q.block<3, 3>(row, column) = block;
        Q.block<3, 3>(column, row) = block.transpose();
    };
    Q.block<3, 3>(a, a).diagonal().setConstant(qg + wg * T / 3.0);
    Q.block<3, 3>(v, v) = (qa + wa * T / 3.0) * I + (qg * T2 / 3.0) * f2;
    Q.block<3, 3>(p, p) = (qa * T2 / 3.0) * I + (qg * T2 * T2 / 20.0) * f2;
    // cov(v, phi) = density times the integral of [integral of f from s to T x].
    off_diagonal(v, a, skew(Vector3d(force * qg - force_twice * (qg / T))));
    off_diagonal(p, v, (0.5 * qa * T) * I + (qg * T2 * T / 8.0) * f2);
    off_diagonal(p, a, (qg * T2 / 6.0) * f);
    return Q;
}

void GatheredMotion::add_noise(const BiasNoise& biases, estim::StateMatrix& P) const {
    const double T = time;
    estim::add(P.topLeftCorner<9, 9>(), noise(biases));
    const double wg = biases.gyro_bias_psd * T * T, wa = biases.accel_bias_psd * T * T;
    const Matrix3d f = skew(force / T), C = turn / T;
    const auto add = [&P](int row, int column, const Matrix3d& block) {
        estim::add(P.block<3, 3>(row, column), block);
        estim::add(P.block<3, 3>(column, row), block.transpose());
    };
    if (wg > 0.0) {
        add(a, Layout::gyro_bias, (0.5 * wg) * C);
        add(v, Layout::gyro_bias, (wg * T / 6.0) * f * C);
    }
    if (wa > 0.0) {
        add(v, Layout::accel_bias, (-0.5 * wa) * C);
        add(p, Layout::accel_bias, (-wa * T / 6.0) * C);
    }
}

}  // namespace schuler::filter
