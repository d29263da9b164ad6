#include "schuler/fusion/inertial_filter.h"

#include <Eigen/LU>

#include <cmath>

namespace schuler::fusion {

using Eigen::Matrix3d;
using Eigen::Vector3d;

template <int N>
InertialModel<N>::InertialModel(const earth::Earth& earth_, const Layout& layout_, const sensor::ImuErrorModel& imu)
    : earth(earth_), layout(layout_), gyro_psd(imu.gyro_noise * imu.gyro_noise), accel_psd(imu.accel_noise * imu.accel_noise) {
    const auto set = [&](int offset, double sigma, double time, double walk, bool constant_part) {
        if (offset < 0) return;
        for (int i = 0; i < 3; ++i) {
            // With a turn-on part the sum does not return to zero: a random walk of the same driving noise describes it.
            process[static_cast<std::size_t>(offset + i)] = {constant_part ? 0.0 : 1.0 / time, 2.0 * sigma * sigma / time + walk * walk};
        }
    };
    // Flicker is told to the filter as in-run bias of the size of its Allan floor.
    constexpr double allan_floor = 0.664;
    set(Layout::gyro_bias, std::hypot(imu.gyro_bias, allan_floor * imu.gyro_flicker), imu.gyro_bias_time, imu.gyro_rate_walk,
        imu.gyro_turn_on_bias > 0.0 || imu.gyro_rate_walk > 0.0);
    set(Layout::accel_bias, std::hypot(imu.accel_bias, allan_floor * imu.accel_flicker), imu.accel_bias_time, imu.accel_rate_walk,
        imu.accel_turn_on_bias > 0.0 || imu.accel_rate_walk > 0.0);

    sparsity.add(0, Layout::position, 6);
    sparsity.add(1, Layout::position, 9);
    sparsity.add(1, Layout::accel_bias, 3);
    sparsity.add(2, Layout::position, 9);
    sparsity.add(2, Layout::gyro_bias, 3);
    if (layout.gyro_scale >= 0) sparsity.add(2, layout.gyro_scale, 3);
    if (layout.accel_scale >= 0) sparsity.add(1, layout.accel_scale, 3);
    if (layout.gyro_misalignment >= 0) {
        sparsity.add(2, layout.gyro_misalignment, 6);
        sparsity.add(1, layout.accel_misalignment, 6);
    }
}

template <class Frame, int N>
void InertialFilter<Frame, N>::set_nav(const typename Frame::State& state) {
    nav = state;
    C = Frame::attitude(nav).toRotationMatrix();
}

namespace {

/// What misaligned axes measure of w: the matrix whose product with the six misalignments is M w.
Eigen::Matrix<double, 3, 6> cross_axis(const Vector3d& w) {
    Eigen::Matrix<double, 3, 6> X = Eigen::Matrix<double, 3, 6>::Zero();
    X.row(0).segment<2>(0) << w.y(), w.z();
    X.row(1).segment<2>(2) << w.x(), w.z();
    X.row(2).segment<2>(4) << w.x(), w.y();
    return X;
}

/// I + S + M of a triad.
Matrix3d gain(const Vector3d& scale, const Eigen::Matrix<double, 6, 1>& m) {
    Matrix3d G;
    G << 1.0 + scale.x(), m(0), m(1), m(2), 1.0 + scale.y(), m(3), m(4), m(5), 1.0 + scale.z();
    return G;
}

}  // namespace

template <class Frame, int N>
ImuIncrement InertialFilter<Frame, N>::corrected(const InertialModel<N>& model, const ImuIncrement& raw) const {
    ImuIncrement c = raw;
    c.dtheta -= parameters.template segment<3>(Layout::gyro_bias) * raw.dt;
    c.dv -= parameters.template segment<3>(Layout::accel_bias) * raw.dt;
    const Layout& L = model.layout;
    if (L.gyro_misalignment >= 0) {
        const auto scale = [&](int offset) -> Vector3d {
            return offset < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(parameters.template segment<3>(offset));
        };
        c.dtheta = gain(scale(L.gyro_scale), parameters.template segment<6>(L.gyro_misalignment)).inverse() * c.dtheta;
        c.dv = gain(scale(L.accel_scale), parameters.template segment<6>(L.accel_misalignment)).inverse() * c.dv;
    } else if (L.gyro_scale >= 0) {
        c.dtheta = c.dtheta.cwiseQuotient(Vector3d::Ones() + parameters.template segment<3>(L.gyro_scale));
        c.dv = c.dv.cwiseQuotient(Vector3d::Ones() + parameters.template segment<3>(L.accel_scale));
    }
    return c;
}

template <class Frame, int N>
void InertialFilter<Frame, N>::propagate(const InertialModel<N>& model, const ImuIncrement& raw, const BridgeNoise& bridge,
                                         estim::Transition<N>& phi) {
    const Layout& L = model.layout;
    const double dt = raw.dt;
    const ImuIncrement inc = corrected(model, raw);
    const ins::CompensatedIncrement motion = ins::compensate(previous, inc);
    const Vector3d f = C * (motion.dv / dt);   // dv is resolved in the body axes of the start of the step
    const ins::ErrorDynamics F = Frame::dynamics(model.earth, nav, f);
    const Matrix3d C0 = C;
    set_nav(Frame::step(model.earth, nav, motion));
    previous = inc;
    w_ib_b = inc.dtheta / dt;
    const Matrix3d Cdt = (0.5 * dt) * (C0 + C);

    auto& A = phi.rows;
    const auto put = [&A](int row, int column, const Matrix3d& block) {
        for (int i = 0; i < 3; ++i) A.col(row + i).template segment<3>(column) = block.row(i).transpose();
    };
    const Matrix3d I = Matrix3d::Identity();
    constexpr int p = Layout::position, v = Layout::velocity, a = Layout::attitude;
    put(p, p, I + dt * F.pp);
    put(p, v, dt * F.pv);
    put(v, p, dt * F.vp);
    put(v, v, I + dt * F.vv);
    put(v, a, dt * F.va);
    put(a, p, dt * F.ap);
    put(a, v, dt * F.av);
    put(a, a, I + dt * F.aa);
    put(a, Layout::gyro_bias, Cdt);
    put(v, Layout::accel_bias, -Cdt);
    if (L.gyro_scale >= 0) {
        put(a, L.gyro_scale, Cdt * w_ib_b.asDiagonal());
        put(v, L.accel_scale, -Cdt * (inc.dv / dt).asDiagonal());
    }
    if (L.gyro_misalignment >= 0) {
        const Eigen::Matrix<double, 3, 6> W = Cdt * cross_axis(w_ib_b), V = -Cdt * cross_axis(inc.dv / dt);
        for (int i = 0; i < 3; ++i) {
            A.col(a + i).template segment<6>(L.gyro_misalignment) = W.row(i).transpose();
            A.col(v + i).template segment<6>(L.accel_misalignment) = V.row(i).transpose();
        }
    }
    if (dt != cached_dt) {
        cached_dt = dt;
        for (int i = 9; i < N; ++i) {
            const StateProcess& s = model.process[static_cast<std::size_t>(i)];
            const double m = s.decay * dt;
            cached_diagonal(i) = m == 0.0 ? 1.0 : std::exp(-m);
            cached_q(i) = m == 0.0 ? s.psd * dt : s.psd * -std::expm1(-2.0 * m) / (2.0 * s.decay);
        }
    }
    if (L.gnss_position >= 0 && model.gnss.correlated_distance > 0.0) {
        const double times = model.gnss.position_decay(Frame::ground_speed(nav)) * dt;
        cached_diagonal.template segment<3>(L.gnss_position).setConstant(std::exp(-times));
        cached_q.template segment<3>(L.gnss_position) = -std::expm1(-2.0 * times) * model.gnss.correlated_position.cwiseAbs2();
    }
    phi.diagonal = cached_diagonal;
    cached_q.template segment<3>(v).setConstant((model.accel_psd + bridge.accel_psd) * dt);
    cached_q.template segment<3>(a).setConstant((model.gyro_psd + bridge.gyro_psd) * dt);
    estim::propagate<N>(P, phi, model.sparsity, cached_q);
    parameters.template tail<N - 9>() = parameters.template tail<N - 9>().cwiseProduct(phi.diagonal.template tail<N - 9>());
    if (model.loop != Loop::Closed) error = phi.times(error);
}

template <class Frame, int N>
Matrix3d InertialFilter<Frame, N>::innovation_covariance(const Measurement<N>& m) const {
    Eigen::Matrix<double, N, 3> PH;
    PH.noalias() = P * m.rows;
    Matrix3d S = m.rows.transpose() * PH;
    S.diagonal() += m.variance;
    return S;
}

template <class Frame, int N>
void InertialFilter<Frame, N>::apply(const InertialModel<N>& model, const Vector& dx) {
    if (model.loop != Loop::Closed) {
        error += dx;
        return;
    }
    set_nav(Frame::corrected(model.earth, nav, dx.template head<9>()));
    parameters.template tail<N - 9>() -= dx.template tail<N - 9>();
}

template <class Frame, int N>
void InertialFilter<Frame, N>::feed_back(const InertialModel<N>& model) {
    set_nav(Frame::corrected(model.earth, nav, error.template head<9>()));
    parameters.template tail<N - 9>() -= error.template tail<N - 9>();
    error.setZero();
}

template <class Frame, int N>
typename Frame::State InertialFilter<Frame, N>::estimated(const InertialModel<N>& model) const {
    if (model.loop == Loop::Closed) return nav;
    return Frame::corrected(model.earth, nav, error.template head<9>());
}

template <class Frame, int N>
typename InertialFilter<Frame, N>::Vector InertialFilter<Frame, N>::estimated_parameters() const {
    Vector estimate = parameters;
    estimate.template tail<N - 9>() -= error.template tail<N - 9>();
    return estimate;
}

template <class Frame, int N>
Matrix9 InertialFilter<Frame, N>::to_local_level(const InertialModel<N>& model) const {
    if constexpr (Frame::errors_are_geographic)
        return Matrix9::Identity();
    else
        return ins::geographic_from_ecef_errors(model.earth, Frame::geographic(model.earth, estimated(model)));
}

template struct InertialModel<16>;
template struct InertialModel<24>;
template struct InertialModel<44>;
template struct InertialFilter<GeographicFrame, 16>;
template struct InertialFilter<GeographicFrame, 24>;
template struct InertialFilter<GeographicFrame, 44>;
template struct InertialFilter<EarthFixedFrame, 16>;
template struct InertialFilter<EarthFixedFrame, 24>;
template struct InertialFilter<EarthFixedFrame, 44>;

}  // namespace schuler::fusion
