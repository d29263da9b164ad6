// A run at its start: nominal state and initial covariance.
#include "schuler/filter/measurement/environment.h"
#include "schuler/filter/states/model.h"
#include "schuler/filter/update/correction_period.h"
#include "schuler/math/rotation.h"

#include <Eigen/LU>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace schuler::filter {

using Eigen::Vector3d;

template <class Frame>
void start_ranging(InertialFilter<Frame>& filter, const Layout& L, const sensor::RangingErrorModel& e) {
    filter.P(L.clock, L.clock) = e.clock.bias * e.clock.bias;
    filter.P(L.drift, L.drift) = e.clock.drift * e.clock.drift;
    filter.P(L.network, L.network) = e.network * e.network;
    filter.P.diagonal().template segment<3>(L.intersystem).setConstant(e.intersystem * e.intersystem);
}

namespace {

/// Sets the initial covariance of a run in its filter, block by block.
template <class Frame>
class StartCovariance {
public:
    StartCovariance(InertialFilter<Frame>& filter, const InertialModel& model, const Start& start)
        : f_(filter), L_(model.layout) {
        P_n_.diagonal().segment<3>(Layout::position) = start.std_position.cwiseAbs2();
        P_n_.diagonal().segment<3>(Layout::velocity) = start.std_velocity.cwiseAbs2();
        const Eigen::Matrix3d J = math::rpy_error_from_phi(math::rpy_from_quaternion(start.nav.q_nb)).inverse();
        P_n_.block<3, 3>(Layout::attitude, Layout::attitude) = J * start.std_rpy.cwiseAbs2().asDiagonal() * J.transpose();
        if constexpr (!Frame::errors_are_geographic) {
            Eigen::Matrix<double, 9, 9> to_local_level = f_.to_local_level(model);
            // Near a pole a heading refers to the meridian of the stated position, not to that of the true position.
            if (std::cos(start.nav.position.lat) < 0.01) to_local_level.template block<6, 3>(3, 0).setZero();
            T_ = to_local_level.inverse();
        }
        f_.P.template topLeftCorner<9, 9>() = Matrix9(T_ * P_n_ * T_.transpose()).cast<estim::CovarianceScalar>();
    }

    /// The latency errors of the fixes have a covariance (s^2), and cause errors of the start in proportion to its `rates` (local
    /// level, one column per latency): z = x - rate * latency. own: the states of these latency errors, -1 if there are none.
    /// Other correlations of the start are unaffected.
    void latencies(const std::array<int, 2>& own, const Eigen::Matrix2d& covariance, const Eigen::Matrix<double, 9, 2>& rates) {
        const Eigen::Matrix<double, 9, 2> errors = T_ * rates, shared = errors * covariance;
        estim::add(f_.P.template topLeftCorner<9, 9>(), shared * errors.transpose());
        for (int i = 0; i < 2; ++i) {
            if (own[i] < 0) continue;
            f_.P.template block<9, 1>(0, own[i]) = shared.col(i).template cast<estim::CovarianceScalar>();
            f_.P.template block<1, 9>(own[i], 0) = shared.col(i).transpose().template cast<estim::CovarianceScalar>();
            for (int k = 0; k < 2; ++k)
                if (own[k] >= 0) f_.P(own[i], own[k]) = static_cast<estim::CovarianceScalar>(covariance(i, k));
        }
    }

    /// Adds a white error of this sigma to a navigation state of the local level.
    void loosen(int state, double sigma) {
        estim::add(f_.P.template topLeftCorner<9, 9>(), sigma * sigma * T_.col(state) * T_.col(state).transpose());
    }

    /// The position so far is that of the antenna: the unit's is that less the lever arm, with the errors of both. l_n: lever arm, m.
    void leave_antenna(const Vector3d& l_n, const Eigen::Matrix3d& C_nb) {
        const Eigen::Matrix<double, 9, 3> by_position = T_.template leftCols<3>();
        const Matrix9 to_local_level = T_.inverse();
        const Eigen::Matrix<double, 3, 9> attitude = to_local_level.template bottomRows<3>();
        const Eigen::Index n = f_.P.rows();
        Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, estim::max_states> of_arm =
            math::skew(l_n) * attitude * estim::as_double(f_.P.topRows(9));
        if (L_.lever_arm >= 0) of_arm += C_nb * estim::as_double(f_.P.middleRows(L_.lever_arm, 3));
        Eigen::Matrix3d both = of_arm.leftCols(9) * attitude.transpose() * math::skew(l_n).transpose();
        if (L_.lever_arm >= 0) both += of_arm.middleCols(L_.lever_arm, 3) * C_nb.transpose();
        const Eigen::Matrix<double, 9, Eigen::Dynamic, 0, 9, estim::max_states> change = by_position * of_arm;
        estim::subtract(f_.P.topRows(9), change.leftCols(n));
        estim::subtract(f_.P.leftCols(9), change.transpose());
        estim::add(f_.P.template topLeftCorner<9, 9>(), by_position * both * by_position.transpose());
    }

    /// Variance of a navigation state, local level.
    [[nodiscard]] double variance(int state) const { return P_n_(state, state); }

    template <int Size>
    void set(int offset, const Eigen::Matrix<double, Size, 1>& sigma) {
        if (offset >= 0)
            f_.P.diagonal().template segment<Size>(offset) = sigma.cwiseAbs2().template cast<estim::CovarianceScalar>();
    }
    void set(int offset, int count, double sigma) {
        if (offset >= 0) f_.P.diagonal().segment(offset, count).setConstant(sigma * sigma);
    }
    /// A state whose error has the covariance `shared` with the component `state` of the local level.
    void tie(int own, int state, double shared) {
        f_.P.template block<9, 1>(0, own) = (shared * T_.col(state)).template cast<estim::CovarianceScalar>();
        f_.P.template block<1, 9>(own, 0) = (shared * T_.col(state)).transpose().template cast<estim::CovarianceScalar>();
    }
    /// A receiver's slow error: a start from a fix contains that error, which the state, initially zero, does not include: their
    /// errors are opposite.
    void slow_error(int offset, int state, const Vector3d& sigma, const Vector3d& of_fix) {
        set<3>(offset, sigma);
        for (int i = 0; offset >= 0 && i < 3; ++i)
            if (of_fix(i) > 0.0) tie(offset + i, state + i, -std::min(sigma(i) * sigma(i), variance(state + i)));
    }
    /// Constant error of an instrument that measures heading; a start from it contains the error with the opposite sign, and an
    /// attitude error about the vertical is the opposite of a heading error.
    void shown_heading(int own, double sigma, bool started_by_it) {
        constexpr int state = Layout::attitude + 2;
        set(own, 1, sigma);
        if (own >= 0 && started_by_it) tie(own, state, std::min(sigma * sigma, variance(state)));
    }
    /// Likewise of a magnetometer, whose heading has three lasting errors: its offset, the body's hard iron, and what changes with currents.
    void magnetic_heading(const MagSettings& mag, const Start& start) {
        constexpr int state = Layout::attitude + 2;
        set(L_.mag_bias, 1, mag.offset_std());
        set(L_.hard_iron, 3, mag.deviation_std);
        set(L_.mag_disturbance, 1, mag.used_disturbance());
        if (!start.heading_of_mag || L_.mag_bias < 0) return;
        const Eigen::RowVector3d by_iron =
            deviation_by_iron(start.nav.q_nb.toRotationMatrix(), mag.used_declination(), Vector3d::Zero());
        const double offset = mag.offset_std() * mag.offset_std();
        const double iron = L_.hard_iron < 0 ? 0.0 : mag.deviation_std * mag.deviation_std;
        const double disturbance = L_.mag_disturbance < 0 ? 0.0 : std::pow(mag.used_disturbance(), 2);
        const double all = offset + iron * by_iron.squaredNorm() + disturbance;
        const double share = all > 0.0 ? std::min(1.0, variance(state) / all) : 0.0;
        tie(L_.mag_bias, state, share * offset);
        if (L_.mag_disturbance >= 0) tie(L_.mag_disturbance, state, share * disturbance);
        for (int i = 0; L_.hard_iron >= 0 && i < 3; ++i) tie(L_.hard_iron + i, state, -share * iron * by_iron(i));
    }
    /// A first barometric height that contradicts the stated bias takes precedence; the bias then has the error of the height used, and
    /// thus its correlations with all states set before.
    void baro(double first_height, const BaroSettings& settings, const NavState& nav) {
        const int own = L_.baro_bias;
        if (own < 0) return;
        const Eigen::Matrix<double, 1, 9> local_height = Matrix9(T_.inverse()).row(Layout::position + 2);
        const Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, estim::max_states> shared =
            local_height * estim::as_double(f_.P.topRows(9));
        const double height_variance = local_height.dot(shared.head(9)), prior = settings.bias_std;
        f_.P(own, own) = prior * prior;
        const double offset = first_height - nav.position.h;
        if (!(offset * offset > 9.0 * (prior * prior + height_variance))) return;
        f_.parameters(own) = offset;
        f_.P.row(own) = shared.template cast<estim::CovarianceScalar>();
        f_.P.col(own) = f_.P.row(own).transpose();
        f_.P(own, own) = height_variance + settings.std * settings.std;
    }

private:
    InertialFilter<Frame>& f_;
    const Layout& L_;
    Matrix9 P_n_ = Matrix9::Zero(), T_ = Matrix9::Identity();  // T: local level to the filter's own errors
};

/// Specific force at the start, in the filter's axes: for the acceleration shown by fixes, or else none.
template <class Frame>
Vector3d start_force(const InertialModel& model, const Start& start) {
    const Geodetic& at = start.nav.position;
    const Vector3d force_n = start.velocity_rate - earth::terms_at(model.earth, at, start.nav.v_eb_n).g_n;
    return Frame::errors_are_geographic ? force_n : Vector3d(earth::C_en(at.lat, at.lon) * force_n);
}

/// A start from fixes has their latency: the corresponding errors of position and velocity are known once the latency is. (An
/// attitude error about the vertical is the opposite of a heading error.)
template <class Frame>
void start_latencies(StartCovariance<Frame>& P, const GnssSettings& gnss, const Layout& L, const Start& start) {
    // Receivers usually give both for one instant; the fixes show that they differ little, but not their common latency.
    constexpr double alike = 0.9;
    Eigen::Matrix<double, 9, 2> rates = Eigen::Matrix<double, 9, 2>::Zero();
    rates.col(0).segment<3>(Layout::position) = start.position_rate;
    const bool shared = L.gnss_velocity_latency < 0 && !gnss.velocity_latency;  // one latency for both
    auto of_velocity = rates.col(shared ? 0 : 1);
    of_velocity.segment<3>(Layout::velocity) = start.velocity_rate;
    of_velocity(Layout::attitude + 2) = -start.heading_rate;
    const double position = gnss.latency_std, velocity = gnss.velocity_latency_std, both = alike * position * velocity;
    Eigen::Matrix2d covariance;
    covariance << position * position, both, both, velocity * velocity;
    P.latencies({L.gnss_latency, L.gnss_velocity_latency}, covariance, rates);
}

}  // namespace

template <class Frame>
void set_out(FilterRun<Frame>& run, const InertialModel& model, const Settings& settings, const Start& start,
             double baro_height) {
    const Layout& L = model.layout;
    std::vector<Shadow<Frame>> shadows = std::move(run.shadows);
    FaultWatch watch = std::move(run.ranges.watch);  // reuses its memory
    std::vector<Opening> openings = std::move(run.openings);
    AtMostOne<Rival<Frame>> rival = std::move(run.rival);
    shadows.clear();
    watch.clear();
    watch.left_out.clear();
    openings.clear();
    rival.clear();
    run = {};
    run.shadows = std::move(shadows);
    run.ranges.watch = std::move(watch);
    run.openings = std::move(openings);
    run.rival = std::move(rival);
    InertialFilter<Frame>& f = run.filter;
    f = InertialFilter<Frame>(model);
    NavState nav = start.nav;
    if (start.at_antenna) nav.position = earth::moved_by_ned(model.earth, nav.position, nav.q_nb * -model.lever_arm_b);
    f.set_nav(Frame::from_geographic(model.earth, nav));
    f.previous = start.previous;
    f.recent_force.reset(start_force<Frame>(model, start));
    f.parameters.template segment<3>(Layout::gyro_bias) = start.gyro_bias;
    f.parameters.template segment<3>(Layout::accel_bias) = start.accel_bias;

    StartCovariance<Frame> P(f, model, start);
    start_latencies(P, settings.gnss, L, start);
    const sensor::ImuErrorModel& imu = settings.imu.errors;
    P.template set<3>(Layout::gyro_bias, start.std_gyro_bias);
    P.template set<3>(Layout::accel_bias, start.std_accel_bias);
    P.set(L.gyro_scale, 3, imu.gyro_scale);
    P.set(L.accel_scale, 3, imu.accel_scale);
    P.set(L.gyro_misalignment, 6, imu.gyro_misalignment);
    P.set(L.accel_misalignment, 6, imu.accel_misalignment);
    if (settings.constraints.nonholonomic) {  // otherwise only once wheels are recognised
        P.set(L.mounting, 2, start.std_mounting);
        P.set(L.axle, 1, 1.5);
    }
    if (L.lever_arm >= 0) {
        f.parameters.template segment<3>(L.lever_arm) = settings.gnss.lever_arm_b;
        P.set(L.lever_arm, 3, settings.gnss.lever_arm_std);
    }
    P.magnetic_heading(settings.mag, start);
    P.set(L.odometer_scale, 1, settings.odometer.scale_std);
    P.shown_heading(L.heading_offset, settings.heading.offset_std, start.heading_of_sensor);
    P.set(L.gauge_level, L.gauges, settings.gauges.level_std);
    P.set(L.log_scale, 1, settings.log.scale_std);
    P.set(L.log_misalignment, 2, settings.log.misalignment_std);
    if (L.gravity_constant >= 0)
        start_disturbance(settings.disturbance, L, earth::C_en(start.nav.position.lat, start.nav.position.lon), f.P);
    P.slow_error(L.gnss_position, Layout::position, settings.gnss.errors.correlated_position, start.position_of_fix);
    P.slow_error(L.gnss_velocity, Layout::velocity, settings.gnss.errors.correlated_velocity, start.velocity_of_fix);
    if (L.clock >= 0) {
        start_ranging(f, L, settings.ranging.errors);
        // A fix contains the errors of the ranges, which will be used themselves: it only provides the point of linearisation.
        constexpr double roomy = 10.0;  // sigmas
        for (int i = 0; i < 3; ++i)
            if (start.position_of_fix(i) > 0.0) P.loosen(Layout::position + i, roomy * start.std_position(i));
    }
    P.baro(baro_height, settings.baro, nav);
    if (start.at_antenna && model.eccentric())
        P.leave_antenna(start.nav.q_nb * model.lever_arm_b, start.nav.q_nb.toRotationMatrix());
    run.ranges.watch.on = L.clock >= 0 && settings.ranging.protection.use;

    // An uncorrected gravity disturbance acts like an accelerometer error.
    const double gravity = settings.disturbance.estimate ? settings.disturbance.prior_n.head<2>().maxCoeff() : 0.0;
    const InertialErrorBounds bounds = three_sigma(start.std_rpy.head<2>().maxCoeff(), start.std_gyro_bias.maxCoeff(),
                                                   std::hypot(start.std_accel_bias.maxCoeff(), gravity));
    run.feedback_period =
        Duration::from_seconds(settings.feedback_period.value_or(correction_period(bounds, settings.feedback_attitude)));
    run.next_feedback = start.nav.time + run.feedback_period;
    if (settings.integrity.use && settings.coupling == Coupling::Separate) run.second_order = SecondOrder(f.P.rows());
    if (settings.integrity.use && settings.integrity.window > 0.0 && !uses_ranges(settings.coupling)) run.shadows.resize(2);
    run.undecided_heading = start.undecided_heading;
    run.increment = start.increment;
    run.next_output = start.nav.time;
    run.next_constraint = start.nav.time;
}

template <class Frame>
FilterRun<Frame> first_step(const InertialModel& model, const RunData& data, const Settings& settings, const Start& start) {
    const std::vector<BaroSample>& baro = data.recording->baro;
    const auto first = std::ranges::find_if(baro, [&](const BaroSample& s) { return s.time >= start.nav.time; });
    FilterRun<Frame> run;
    set_out(run, model, settings, start, first == baro.end() ? not_given : first->height);
    return run;
}

template void set_out(FilterRun<GeographicFrame>&, const InertialModel&, const Settings&, const Start&, double);
template void set_out(FilterRun<EarthFixedFrame>&, const InertialModel&, const Settings&, const Start&, double);

template FilterRun<GeographicFrame> first_step(const InertialModel&, const RunData&, const Settings&, const Start&);
template FilterRun<EarthFixedFrame> first_step(const InertialModel&, const RunData&, const Settings&, const Start&);
template void start_ranging(InertialFilter<GeographicFrame>&, const Layout&, const sensor::RangingErrorModel&);
template void start_ranging(InertialFilter<EarthFixedFrame>&, const Layout&, const sensor::RangingErrorModel&);

}  // namespace schuler::filter
