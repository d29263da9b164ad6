#include "schuler/filter/states/inertial_filter.h"

#include "schuler/filter/states/gain_noise.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using math::Triple;

InertialModel::InertialModel(const earth::Earth& earth_, const Layout& layout_, const sensor::ImuErrorModel& imu)
    : earth(earth_),
      layout(layout_),
      gyro_psd(imu.gyro_noise * imu.gyro_noise),
      accel_psd(imu.accel_noise * imu.accel_noise),
      floor(StateVector::Zero(estim::padded(layout_.size))) {
    const auto set = [&](int offset, double sigma, double time, double walk, bool constant_part) {
        // With a turn-on part the sum does not return to zero: it is modelled as a random walk with the same driving noise.
        set_process(offset, 3, {constant_part ? 0.0 : 1.0 / time, 2.0 * sigma * sigma / time + walk * walk});
    };
    // Flicker is modelled in the filter as in-run bias with the magnitude of its Allan floor.
    constexpr double allan_floor = 0.664;
    set(Layout::gyro_bias, std::hypot(imu.gyro_bias, allan_floor * imu.gyro_flicker), imu.gyro_bias_time, imu.gyro_rate_walk,
        imu.gyro_turn_on_bias > 0.0 || imu.gyro_rate_walk > 0.0);
    set(Layout::accel_bias, std::hypot(imu.accel_bias, allan_floor * imu.accel_flicker), imu.accel_bias_time, imu.accel_rate_walk,
        imu.accel_turn_on_bias > 0.0 || imu.accel_rate_walk > 0.0);
}

void InertialModel::set_process(int offset, int count, StateProcess process_) {
    for (int i = 0; offset >= 0 && i < count; ++i) process[static_cast<std::size_t>(offset + i)] = process_;
}

template <class Frame>
InertialFilter<Frame>::InertialFilter(const InertialModel& model)
    : gathered(model.layout), used(estim::padded(model.layout.without_slots())) {
    const int n = estim::padded(model.layout.size);
    P = StateMatrix::Zero(n, n);
    parameters = error = cached_q = StateVector::Zero(n);
    cached_diagonal = StateVector::Ones(n);
}

template <class Frame>
void InertialFilter<Frame>::set_nav(const typename Frame::State& state) {
    nav = state;
    C = Frame::attitude(nav).toRotationMatrix();
}

namespace {

/// I + S + M of a triad.
Matrix3d gain(const Vector3d& scale, const Eigen::Matrix<double, 6, 1>& m) {
    Matrix3d G;
    G << 1.0 + scale.x(), m(0), m(1), m(2), 1.0 + scale.y(), m(3), m(4), m(5), 1.0 + scale.z();
    return G;
}

BiasNoise bias_noise(const InertialModel& model) {
    return {model.process[Layout::gyro_bias].psd, model.process[Layout::accel_bias].psd};
}

}  // namespace

template <class Frame>
ImuIncrement InertialFilter<Frame>::corrected(const InertialModel& model, const ImuIncrement& raw) const {
    const Layout& L = model.layout;
    const auto parameter = [&](int offset) { return Triple(parameters.segment<3>(offset)); };
    ImuIncrement c{raw.time, raw.dt, (Triple(raw.dtheta) - raw.dt * parameter(Layout::gyro_bias)).vector(),
                   (Triple(raw.dv) - raw.dt * parameter(Layout::accel_bias)).vector()};
    if (L.gyro_misalignment >= 0) {
        const auto scale = [&](int offset) -> Vector3d {
            return offset < 0 ? Vector3d(Vector3d::Zero()) : Vector3d(parameters.segment<3>(offset));
        };
        c.dtheta = gain(scale(L.gyro_scale), parameters.segment<6>(L.gyro_misalignment)).inverse() * c.dtheta;
        c.dv = gain(scale(L.accel_scale), parameters.segment<6>(L.accel_misalignment)).inverse() * c.dv;
    } else if (L.gyro_scale >= 0) {
        for (int i = 0; i < 3; ++i) {
            c.dtheta(i) /= 1.0 + parameters(L.gyro_scale + i);
            c.dv(i) /= 1.0 + parameters(L.accel_scale + i);
        }
    }
    return c;
}

template <class Frame>
void InertialFilter<Frame>::propagate(const InertialModel& model, const ImuIncrement& raw, const BridgeNoise& bridge) {
    const double dt = raw.dt;
    const ImuIncrement inc = corrected(model, raw);
    ins::CompensatedIncrement motion = ins::compensate(previous, inc);
    const Matrix3d C0 = C;
    const Vector3d velocity0 = Frame::velocity(nav);
    // dv is resolved in the body axes at the start of the step
    const Vector3d df = math::product(C0, Triple(motion.dv)).vector();
    if (model.layout.gravity_constant >= 0) {
        follow_disturbance(model, 0.5 * dt);  // at mid-step
        motion.dv += felt_disturbance(model, dt);
        set_nav(Frame::step(model.earth, nav, motion));
        follow_disturbance(model, 0.5 * dt);
    } else {
        set_nav(Frame::step(model.earth, nav, motion));
    }
    const double by_dt = 1.0 / dt;
    const Triple rate = by_dt * Triple(inc.dtheta);
    w_ib_b = rate.vector();
    if (previous.dt > 0.0) {
        const Triple acceleration = (2.0 / (dt + previous.dt)) * (rate - (1.0 / previous.dt) * Triple(previous.dtheta));
        w_ib_b = (rate + 0.5 * dt * acceleration).vector();
        if (model.eccentric()) {
            recent_rate.add(rate.vector(), acceleration.vector(), dt);
            if (model.late()) mean_rate.add(rate, dt, latency_width(recent_rate.frequency(model.gyro_psd, dt)));
        }
    }
    if (model.late()) {
        const Vector3d force_now = (by_dt * Triple(df)).vector();
        if (previous.dt > 0.0) force_change.add(force_now, (2.0 / (dt + previous.dt)) * (force_now - last_force), dt);
        last_force = force_now;
    }
    previous = inc;
    recent_force.add(by_dt * Triple(df), dt,
                     model.late() ? latency_width(force_change.frequency(model.accel_psd, dt)) : force_width);
    double gyro_psd = model.gyro_psd + bridge.gyro_psd, accel_psd = model.accel_psd + bridge.accel_psd;
    if (model.gyro_gain > 0.0 || model.accel_gain > 0.0) {
        const BridgeNoise more = gain_noise(model, raw);
        gyro_psd += more.gyro_psd;
        accel_psd += more.accel_psd;
    }
    if (model.gyro_g > 0.0) {
        sustained_force.add((by_dt * Triple(inc.dv)).vector(), dt);
        gyro_psd += model.gyro_g * model.gyro_g * sustained_force.gathered_square();
    }
    const Vector3d effective = bridge.standing ? vertical_part(model, df, dt) : df;
    gathered.add(model.layout, dt, 0.5 * (C0 + C), effective, rate.vector(), (by_dt * Triple(inc.dv)).vector(), gyro_psd,
                 accel_psd);
    math::add_to(gathered.acceleration, Triple(Frame::velocity(nav)) - Triple(velocity0) - (Triple(df) - Triple(effective)));
    if (model.eccentric()) gathered.rotation += C - C0;
}

template <class Frame>
Vector3d InertialFilter<Frame>::vertical_part(const InertialModel& model, const Vector3d& df, double dt) const {
    constexpr double calm = 0.2;  // m/s^2: more than noise, known bias and known level cause for a body at rest
    const Vector3d down = down_axis(model), vertical = down.dot(df) * down;
    const double horizontal = (df - vertical).norm() / dt;
    if (horizontal < calm) return vertical;
    // If not yet known, they may cause more: three sigma of their sum.
    constexpr int a = Layout::attitude, b = Layout::accel_bias;
    const Matrix3d F = math::skew(vertical / dt), cross = F * covariance_of(a, b) * C.transpose();
    const Matrix3d M =
        F * covariance_of(a, a) * F.transpose() + C * covariance_of(b, b) * C.transpose() - cross - cross.transpose();
    return horizontal * horizontal < 9.0 * (M.trace() - down.dot(M * down)) ? vertical : df;
}

template <class Frame>
Matrix3d InertialFilter<Frame>::disturbance_axes(const InertialModel& model) const {
    const bool local = model.disturbance.axes == DisturbanceAxes::LocalLevel;
    if (local == Frame::errors_are_geographic) return Matrix3d::Identity();
    const Matrix3d C_en = Frame::C_en(model.earth, nav);
    return local ? C_en : Matrix3d(C_en.transpose());
}

template <class Frame>
void InertialFilter<Frame>::follow_disturbance(const InertialModel& model, double dt) {
    // the track of the vehicle, which may differ from that of the nominal state
    const double distance = model.disturbance.pace(Frame::velocity(nav) - error.segment<3>(Layout::velocity)) * dt;
    advance_disturbance(model.disturbance, model.layout, distance, parameters);
    gathered.distance += distance;
}

template <class Frame>
Vector3d InertialFilter<Frame>::felt_disturbance(const InertialModel& model, double dt) const {
    return dt * (C.transpose() * (disturbance_axes(model) * disturbance_of(model.layout, parameters)));
}

template <class Frame>
Vector3d InertialFilter<Frame>::down_axis(const InertialModel& model) const {
    if constexpr (Frame::errors_are_geographic) return Vector3d::UnitZ();
    else return Frame::C_en(model.earth, nav).col(2);
}

template <class Frame>
Vector3d InertialFilter<Frame>::lever_arm(const InertialModel& model) const {
    const int state = model.layout.lever_arm;
    return state < 0 ? model.lever_arm_b : Vector3d(parameters.segment<3>(state) - error.segment<3>(state));
}

template <class Frame>
double InertialFilter<Frame>::rate_variance(const InertialModel& model) const {
    const double dt = previous.dt;
    if (!(dt > 0.0)) return 0.0;
    constexpr double extrapolated = 2.5;  // noise of one and a half intervals less half of the one before
    constexpr double averaged = 0.005;    // s: a receiver's velocity is a mean over some time, its stamp rounded
    const int latency = model.layout.gnss_velocity_latency >= 0 ? model.layout.gnss_velocity_latency : model.layout.gnss_latency;
    double late = averaged * averaged;
    if (latency >= 0) {
        // a latency that is estimated moves the stamp no more than an unknown one does
        const double estimate = parameters(latency) - error(latency);
        late += P(latency, latency) + estimate * estimate;
    }
    return extrapolated * model.gyro_psd / dt + recent_rate.total_change_square(late, model.gyro_psd, dt);
}

template <class Frame>
Vector3d InertialFilter<Frame>::force_change_square(const InertialModel& model, double time2) const {
    if (!(previous.dt > 0.0)) return Vector3d::Zero();
    const Vector3d change = force_change.change_square(time2, model.accel_psd, previous.dt);
    if constexpr (Frame::errors_are_geographic) return change;
    else return Frame::C_en(model.earth, nav).transpose().cwiseAbs2() * change;
}

template <class Frame>
double InertialFilter<Frame>::uncertain_rate(double rate_variance) const {
    constexpr double bound = 2.0;  // one sigma
    return bound * std::sqrt(covariance_of(Layout::gyro_bias, Layout::gyro_bias).trace() + 3.0 * rate_variance);
}

template <class Frame>
double InertialFilter<Frame>::heading_variance(const InertialModel& model) const {
    const Vector3d down = down_axis(model);
    return down.dot(covariance_of(Layout::attitude, Layout::attitude) * down);
}

template <class Frame>
HeadingForce InertialFilter<Frame>::force_for_heading(const InertialModel& model) const {
    const Vector3d down = down_axis(model);
    // of the velocity at the end of the interval, by that of velocity, level and accelerometer biases at its start
    constexpr int v = Layout::velocity, a = Layout::attitude, b = Layout::accel_bias;
    const Vector3d vertical = down.dot(gathered.force) * down;
    const Matrix3d by_level = math::skew(vertical), &by_bias = gathered.turn;
    const Matrix3d cross = covariance_of(v, a) * by_level.transpose() - covariance_of(v, b) * by_bias.transpose() -
                           by_level * covariance_of(a, b) * by_bias.transpose();
    const Matrix3d velocity = covariance_of(v, v) + by_level * covariance_of(a, a) * by_level.transpose() +
                              by_bias * covariance_of(b, b) * by_bias.transpose() + cross + cross.transpose();
    // less what the heading itself contributes: it is not what makes the acceleration uncertain
    const double heading = heading_variance(model);
    const Vector3d by_heading = (covariance_of(v, a) + by_level * covariance_of(a, a) - by_bias * covariance_of(b, a)) * down;
    const Matrix3d apart = heading > 0.0 ? Matrix3d(velocity - by_heading * by_heading.transpose() / heading) : velocity;
    return heading_force(gathered.acceleration, withheld, down, apart, std::max(0.0, heading));
}

template <class Frame>
void InertialFilter<Frame>::fill_transition(const InertialModel& model, const HeadingForce& force, const Corrections& after,
                                            estim::Transition& phi) const {
    gathered.fill(model.layout, phi);
    // What is withheld is a part of the acceleration: the force that balances gravity and the Coriolis acceleration is smooth.
    const Vector3d column = (force.effective - horizontal_part(gathered.acceleration, force.down)).cross(force.down);
    for (int i = 0; i < 3; ++i) {
        phi.rows.col(Layout::velocity + i).template segment<3>(Layout::attitude) += column(i) * force.down;
        phi.rows.col(Layout::position + i).template segment<3>(Layout::attitude) += 0.5 * gathered.time * column(i) * force.down;
    }
    if (model.eccentric()) withhold_lever_arm(model, force.down, after, phi);
    after.fill_late(model.layout, phi);
    if (model.layout.gravity_constant >= 0)
        fill_disturbance(model.disturbance, model.layout, gathered.time, gathered.distance, disturbance_axes(model), phi);
    gathered.add_earth(Frame::dynamics(model.earth, nav, Vector3d::Zero()), phi);
}

template <class Frame>
void InertialFilter<Frame>::withhold_lever_arm(const InertialModel& model, const Vector3d& down, const Corrections& after,
                                               estim::Transition& phi) const {
    constexpr int p = Layout::position;
    // The error of withholding a turn, heading times uncertain rate times arm, is small against that of the inertial velocity.
    const double angle = uncertain_rate(gathered.gyro_variance / (gathered.time * gathered.time)) * gathered.time;
    const Vector3d l_b = lever_arm(model), moved = horizontal_part(gathered.rotation * l_b, down);
    const double limit = heading_unknown(heading_variance(model)) * angle * l_b.norm();
    const Vector3d turned = down.cross(withheld_part(moved, limit));
    for (int i = 0; i < 3; ++i)
        phi.rows.col(p + i).template segment<3>(Layout::attitude) +=
            math::skew(after.antenna_moved).row(i).transpose() + turned(i) * down;
    const int own = model.layout.lever_arm;
    if (own < 0) return;
    const Matrix3d turn = C.transpose() * gathered.rotation;
    const Vector3d axes = 0.5 * Vector3d(turn(2, 1) - turn(1, 2), turn(0, 2) - turn(2, 0), turn(1, 0) - turn(0, 1));
    const Matrix3d of_arm = after.arm_turned - C * math::skew(axes - for_lever_arm(axes, angle));
    for (int i = 0; i < 3; ++i) phi.rows.col(p + i).template segment<3>(own) += of_arm.row(i).transpose();
}

template <class Frame>
bool InertialFilter<Frame>::propagate_covariance(const InertialModel& model, estim::Transition& phi) {
    const double T = gathered.time;
    if (!(T > 0.0)) return false;
    const Layout& L = model.layout;
    const Eigen::Index n = P.rows();
    if (T != cached_time) {
        cached_time = T;
        for (int i = 9; i < n; ++i) {
            const bool slot = L.source >= 0 && i >= L.source && i < L.source + Layout::slots;
            const StateProcess& s =
                slot ? slot_process[static_cast<std::size_t>(i - L.source)] : model.process[static_cast<std::size_t>(i)];
            const double m = s.decay * T;
            cached_diagonal(i) = m == 0.0 ? 1.0 : std::exp(-m);
            cached_q(i) = m == 0.0 ? s.psd * T : s.psd * -std::expm1(-2.0 * m) / (2.0 * s.decay);
        }
    }
    if (L.gnss_position >= 0 && model.gnss.correlated_distance > 0.0) {
        const double times = model.gnss.position_decay(Frame::ground_speed(nav)) * T;
        cached_diagonal.template segment<3>(L.gnss_position).setConstant(std::exp(-times));
        cached_q.template segment<3>(L.gnss_position) = -std::expm1(-2.0 * times) * model.gnss.correlated_position.cwiseAbs2();
    }
    phi.diagonal = cached_diagonal;
    const HeadingForce force = force_for_heading(model);
    const auto fill = [&](const Corrections& after) {
        fill_transition(model, force, after, phi);
        if (L.clock >= 0) phi.shears[static_cast<std::size_t>(phi.shear_count++)] = {L.clock, L.drift, T};
    };
    StateVector moved = error;  // all zero in the closed loop
    if (model.loop != Loop::Closed) {
        fill({});
        moved = phi.times(error);
    }
    fill(corrections);
    estim::propagate(P, phi, used);
    gathered.add_noise(bias_noise(model), P);
    estim::add(P.block<3, 3>(Layout::velocity, Layout::velocity), force.velocity_noise);
    withheld = force.withheld;
    corrections = {};
    estim::add(P.diagonal().head(used), cached_q.head(used));
    if (L.clock >= 0) {
        const double cross = 0.5 * model.drift_psd * T * T;
        P(L.clock, L.clock) += model.clock_psd * T + model.drift_psd * T * T * T / 3.0;
        P(L.drift, L.drift) += model.drift_psd * T;
        P(L.clock, L.drift) += cross;
        P(L.drift, L.clock) += cross;
        parameters(L.clock) += T * parameters(L.drift);
    }
    if (L.gravity_constant >= 0)
        add_disturbance_noise(model.disturbance, L, T, gathered.distance,
                              model.disturbance.from_local_level(Frame::C_en(model.earth, nav)), disturbance_axes(model), P);
    // the nominal values of the disturbance were propagated with the nominal state
    parameters.tail(n - 9).array() *= cached_diagonal.tail(n - 9).array();
    // the acceleration of the estimate, not that of the nominal state
    withheld.change -= horizontal_part((moved - error).segment<3>(Layout::velocity), force.down);
    error = moved;
    mean_force = gathered.force / T;
    gathered.reset();
    return true;
}

template <class Frame>
Measurement InertialFilter<Frame>::to_own(const InertialModel& model, const Measurement& local) const {
    Measurement m = local;
    if constexpr (!Frame::errors_are_geographic) {
        const Matrix9 T = to_local_level(model).transpose();
        for (int i = 0; i < m.dof; ++i) {
            estim::Row& row = m.rows[static_cast<std::size_t>(i)];
            row.head = (T * row.head).eval();
        }
    }
    return m;
}

template <class Frame>
Matrix3d InertialFilter<Frame>::innovation_covariance(const Measurement& m) const {
    Matrix3d S = Matrix3d::Identity();
    for (int i = 0; i < m.dof; ++i) {
        const StateVector ph = m.rows[static_cast<std::size_t>(i)].times(P, used);
        for (int j = 0; j <= i; ++j) S(i, j) = S(j, i) = m.rows[static_cast<std::size_t>(j)].dot(ph);
        S(i, i) += m.variance(i);
    }
    return S;
}

template <class Frame>
Eigen::Vector3d InertialFilter<Frame>::sigma_apart(const InertialModel& model, const Measurement& m,
                                                   const Matrix9& undecided) const {
    const int slow = model.layout.gnss_position;
    Vector3d sigma = Vector3d::Zero();
    for (int i = 0; i < m.dof; ++i) {
        estim::Row row = m.rows[static_cast<std::size_t>(i)];
        for (std::size_t k = 0; k < static_cast<std::size_t>(row.count); ++k)
            if (slow >= 0 && row.index[k] >= slow && row.index[k] < slow + 3) row.value[k] = 0.0;
        const double of_fix = slow >= 0 ? model.gnss.correlated_position(i) : 0.0;
        sigma(i) = std::sqrt(std::max(0.0, row.dot(row.times(P, used))) + undecided(i, i) + m.variance(i) + of_fix * of_fix);
    }
    return sigma;
}

template <class Frame>
void InertialFilter<Frame>::apply(const InertialModel& model, const StateVector& dx) {
    withheld.correct(-horizontal_part(dx.segment<3>(Layout::velocity), down_axis(model)));
    corrections.add_late(model.layout, dx);
    const auto attitude = [&] { return Matrix3d(math::dcm_from_rotation_vector(error.segment<3>(Layout::attitude)) * C); };
    const Matrix3d before = model.eccentric() ? attitude() : Matrix3d::Zero();
    if (model.eccentric()) corrections.antenna_moved += before * lever_arm(model);
    if (model.loop == Loop::Closed) {
        set_nav(Frame::corrected(model.earth, nav, dx.head<9>()));
        parameters.tail(dx.size() - 9) -= dx.tail(dx.size() - 9);
    } else {
        error += dx;
    }
    if (!model.eccentric()) return;
    corrections.antenna_moved -= attitude() * lever_arm(model);
    if (model.layout.lever_arm >= 0) corrections.arm_turned += before - attitude();
}

template <class Frame>
estim::Transition InertialFilter<Frame>::feed_back(const InertialModel& model) {
    estim::Transition turn;
    turn.diagonal = StateVector::Ones(P.rows());
    for (int i = 0; i < 9; ++i) turn.rows(i, i) = 1.0;
    turn.rows.block<3, 3>(Layout::attitude, Layout::attitude) -=
        0.5 * math::skew(error.segment<3>(Layout::attitude));  // transposed
    set_nav(Frame::corrected(model.earth, nav, error.head<9>()));
    parameters.tail(error.size() - 9) -= error.tail(error.size() - 9);
    error.setZero();
    estim::propagate(P, turn, used);
    return turn;
}

template <class Frame>
void InertialFilter<Frame>::renew(int state, double variance) {
    used = std::max(used, estim::padded(state + 1));
    P.row(state).setZero();
    P.col(state).setZero();
    P(state, state) = variance;
    parameters(state) = 0.0;
    error(state) = 0.0;
}

template <class Frame>
void InertialFilter<Frame>::clone(int first, const std::array<estim::Row, 3>& rows, const Vector3d& value) {
    for (int k = 0; k < 3; ++k) renew(first + k, 0.0);
    estim::clone(P, rows, first, used);
    parameters.segment<3>(first) = value;
}

template <class Frame>
typename Frame::State InertialFilter<Frame>::estimated(const InertialModel& model) const {
    if (model.loop == Loop::Closed) return nav;
    return Frame::corrected(model.earth, nav, error.head<9>());
}

template <class Frame>
StateVector InertialFilter<Frame>::estimated_parameters() const {
    StateVector estimate = parameters;
    estimate.tail(error.size() - 9) -= error.tail(error.size() - 9);
    return estimate;
}

template <class Frame>
Estimate InertialFilter<Frame>::estimate(const InertialModel& model) const {
    const bool fed_back = model.loop == Loop::Closed;
    Estimate e;
    e.earth = model.earth;
    e.layout = model.layout;
    e.nav = geographic(model);
    if (Frame::errors_are_geographic && fed_back) e.C_nb = C;
    else e.C_nb = e.nav.q_nb.toRotationMatrix();
    e.w_ib_b = w_ib_b;
    if (model.eccentric()) {
        e.rate_variance = rate_variance(model);
        e.uncertain_rate = uncertain_rate(e.rate_variance);
        e.angular_acceleration = mean_rate.derivative();
    }
    e.heading_unknown = heading_unknown(heading_variance(model));
    Matrix3d to_level = Matrix3d::Identity();
    if constexpr (!Frame::errors_are_geographic) to_level = earth::C_en(e.nav.position.lat, e.nav.position.lon).transpose();
    if (const int a = Layout::attitude; model.layout.mag_bias >= 0)
        e.tilt_covariance = (to_level * covariance_of(a, a) * to_level.transpose()).template topLeftCorner<2, 2>();
    e.a_n = earth::terms_at(model.earth, e.nav.position, e.nav.v_eb_n).g_n + to_level * recent_force.mean();
    if (!fed_back) e.w_ib_b += error.segment<3>(Layout::gyro_bias);
    e.parameters = estimated_parameters();
    return e;
}

template <class Frame>
Matrix9 InertialFilter<Frame>::to_local_level(const InertialModel& model) const {
    if constexpr (Frame::errors_are_geographic) return Matrix9::Identity();
    else return ins::geographic_from_ecef_errors(model.earth, geographic(model));
}

template <class Frame>
Matrix9 InertialFilter<Frame>::local_covariance(const InertialModel& model) const {
    Matrix9 P9 = estim::as_double(P.topLeftCorner<9, 9>());
    if (gathered.time > 0.0) {
        estim::Transition phi;
        if (model.layout.gravity_constant >= 0) phi.diagonal = StateVector::Ones(P.rows());
        const HeadingForce force = force_for_heading(model);
        fill_transition(model, force, corrections, phi);
        P9 = estim::propagated_corner(P, phi) + gathered.noise(bias_noise(model));
        P9.block<3, 3>(Layout::velocity, Layout::velocity) += force.velocity_noise;
    }
    if constexpr (Frame::errors_are_geographic) return P9;
    const Matrix9 T = to_local_level(model);
    return T * P9 * T.transpose();
}

template struct InertialFilter<GeographicFrame>;
template struct InertialFilter<EarthFixedFrame>;

}  // namespace schuler::filter
