#include "schuler/fusion/receiver_filter.h"

#include "schuler/earth/earth.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/filter/outputs.h"
#include "schuler/fusion/tuning/trial.h"
#include "schuler/gnss/sampled_ranges.h"
#include "schuler/gnss/single_point.h"

#include <algorithm>
#include <cmath>

namespace schuler::fusion {

using Eigen::Vector3d;

namespace {

Settings of_receiver(const Settings& settings) {
    Settings s = trial_settings(settings);
    s.imu.errors = {};
    s.coupling = settings.coupling;  // determines which ranges are used
    s.imu.gyro_vibration = s.imu.accel_vibration = std::nullopt;
    s.imu.errors.accel_noise = settings.ranging.receiver_acceleration;
    s.gnss.lever_arm_b.setZero();
    s.ranging.protection.use = false;
    s.constraints = {};
    s.constraints.gate_probability = settings.constraints.gate_probability;
    s.constraints.recovery_time = settings.constraints.recovery_time;
    return s;
}

}  // namespace

ReceiverFilter::ReceiverFilter(const Settings& settings, const RangingLog& log)
    : log_(log),
      settings_(of_receiver(settings)),
      model_(make_model(settings_, make_layout(settings_, {}))),
      test_(settings_.constraints.gate_probability, settings_.constraints.recovery_time),
      update_(model_, settings_.ranging, settings_.gnss.lever_arm_b, test_) {}

bool ReceiverFilter::start(const RangeEpoch& epoch, std::span<const RangeSample> samples) {
    const gnss::BroadcastSource nobody{gnss::Navigation{}};
    gnss::SinglePointSettings settings;
    settings.ranges = settings_.ranging.corrections;
    gnss::SinglePoint solver(nobody, settings_.ranging.ionosphere, settings);
    RangingLog now{log_.sources, {{epoch.time, 0, samples.size()}}, {samples.begin(), samples.end()}, {}, log_.to_gps};
    const gnss::SinglePointSolution s = solver.solve(gnss::satellite_ranges(now, now.epochs.front()), epoch.time);
    if (s.status != gnss::SinglePointStatus::Solved) return false;
    const earth::Earth& earth = model_.earth;
    NavState nav;
    nav.time = epoch.time;
    nav.position = earth::geodetic_from_ecef(earth.ellipsoid, s.position);
    const Eigen::Matrix3d C_ne = earth::C_en(nav.position.lat, nav.position.lon).transpose();
    const bool moving = s.velocity.allFinite();
    nav.v_eb_n = moving ? Vector3d(C_ne * s.velocity) : Vector3d(Vector3d::Zero());
    nav.q_nb.setIdentity();
    // wide: this epoch's ranges are used once more, and the solution does not include their slow errors
    constexpr double roomy = 100.0, least_position = 100.0, least_velocity = 1.0, unknown_velocity = 300.0;
    InertialFilter<GeographicFrame>& f = filter_.emplace(model_);
    tracking_.slots = {};
    f.set_nav(nav);
    start_ranging(f, model_.layout, settings_.ranging.errors);
    f.P.topLeftCorner<3, 3>() = roomy * C_ne * s.covariance * C_ne.transpose();
    f.P.diagonal().head<3>().array() += least_position * least_position;
    f.P.diagonal()
        .segment<3>(Layout::velocity)
        .setConstant(moving ? least_velocity * least_velocity * roomy : unknown_velocity * unknown_velocity);
    last_determined_ = epoch.time;
    const double clock = *std::ranges::find_if(s.clock, [](double x) { return std::isfinite(x); });
    const int clock_state = model_.layout.clock;
    f.parameters(clock_state) = clock;
    f.P(clock_state, clock_state) = std::max(f.P(clock_state, clock_state), least_position * least_position * roomy);
    if (std::isfinite(s.drift)) f.parameters(model_.layout.drift) = s.drift;
    return true;
}

/// Level axes that rotate with the local level, and the specific force of unaccelerated motion over the Earth.
void ReceiverFilter::coast_to(Time time) {
    // short steps for the rotation of the axes
    constexpr double longest = 0.01;  // s
    InertialFilter<GeographicFrame>& f = *filter_;
    for (double left = (time - f.time()).seconds(); left > 1e-9; left = (time - f.time()).seconds()) {
        const NavState& nav = f.nav;
        const earth::EarthTerms terms = earth::terms_at(model_.earth, nav.position, nav.v_eb_n);
        const double dt = std::min(left, longest);
        const Eigen::Matrix3d C_bn = nav.q_nb.toRotationMatrix().transpose();
        const Vector3d f_n = (2.0 * terms.w_ie_n + terms.w_en_n).cross(nav.v_eb_n) - terms.g_n;
        const Time next = left <= longest ? time : nav.time + Duration::from_seconds(dt);
        if (f.gathered.is_full(dt)) propagate_covariance();
        f.propagate(model_, {next, dt, C_bn * (terms.w_ie_n + terms.w_en_n) * dt, C_bn * f_n * dt}, {});
    }
    propagate_covariance();
}

void ReceiverFilter::propagate_covariance() {
    estim::Transition phi;
    (void)filter_->propagate_covariance(model_, phi);
}

bool ReceiverFilter::process(const RangeEpoch& epoch, std::span<const RangeSample> samples) {
    constexpr int least = 4;           // pseudoranges that determine a position and a clock
    constexpr double patience = 10.0;  // s with fewer, longer than a turning vehicle moves without acceleration
    if (!filter_ && !start(epoch, samples)) return false;
    coast_to(epoch.time);
    (void)update_(*filter_, tracking_, log_, samples, nullptr);
    const auto used = std::ranges::count_if(tracking_.work.all(), [](const RangeScalar& r) { return r.use && !r.is_rate; });
    determined_ = used >= least;
    if (determined_) last_determined_ = epoch.time;
    if (filter_->P.diagonal().allFinite() && (epoch.time - last_determined_).seconds() <= patience) return true;
    filter_.reset();
    return false;
}

SolutionRow ReceiverFilter::row() const {
    SolutionRow r = solution_row(filter_->nav, filter_->local_covariance(model_));
    r.rpy = r.std_rpy = not_given3();
    return r;
}

Eigen::Matrix3d ReceiverFilter::position_covariance() const { return filter_->P.topLeftCorner<3, 3>(); }

}  // namespace schuler::fusion
