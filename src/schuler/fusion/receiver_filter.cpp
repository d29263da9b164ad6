#include "schuler/fusion/receiver_filter.h"

#include "schuler/earth/earth.h"
#include "schuler/earth/ellipsoid.h"
#include "schuler/fusion/outputs.h"
#include "schuler/gnss/sampled_ranges.h"
#include "schuler/gnss/single_point.h"

#include <algorithm>
#include <cmath>

namespace schuler::fusion {

using Eigen::Vector3d;
using L = TightLayout;

namespace {

Settings of_receiver(const Settings& settings) {
    Settings s = settings;
    s.imu.errors = {};
    s.imu.errors.accel_noise = settings.ranging.receiver_acceleration;
    s.gnss.lever_arm_b.setZero();
    s.ranging.protection.use = false;
    return s;
}

}  // namespace

ReceiverFilter::ReceiverFilter(const Settings& settings, const RangingLog& log)
    : log_(log),
      model_(make_tight_model(of_receiver(settings), false)),
      test_(settings.aids.gate_probability, settings.aids.recovery_time) {}

bool ReceiverFilter::start(const RangeEpoch& epoch, std::span<const RangeSample> samples) {
    const gnss::BroadcastSource nobody{gnss::Navigation{}};
    gnss::SinglePointSettings settings;
    settings.ranges = model_.ranging.corrections;
    gnss::SinglePoint solver(nobody, model_.ranging.klobuchar, settings);
    RangingLog now{log_.sources, {{epoch.time, 0, samples.size()}}, {samples.begin(), samples.end()}};
    const gnss::SinglePointSolution s = solver.solve(gnss::satellite_ranges(now, now.epochs.front()), epoch.time);
    if (s.status != gnss::SinglePointStatus::Solved) return false;
    const earth::Earth& earth = model_.inertial.earth;
    NavState nav;
    nav.time = epoch.time;
    nav.position = earth::geodetic_from_ecef(earth.ellipsoid, s.position);
    const Eigen::Matrix3d C_ne = earth::C_en(nav.position.lat, nav.position.lon).transpose();
    const bool moving = s.velocity.allFinite();
    nav.v_eb_n = moving ? Vector3d(C_ne * s.velocity) : Vector3d(Vector3d::Zero());
    nav.q_nb.setIdentity();
    // roomy: this epoch's ranges are used once more, and the solution knows nothing of their slow errors
    constexpr double roomy = 100.0, least_position = 100.0, least_velocity = 1.0, unknown_velocity = 300.0;
    Eigen::Matrix<double, L::inertial, L::inertial> P = Eigen::Matrix<double, L::inertial, L::inertial>::Zero();
    P.topLeftCorner<3, 3>() = roomy * C_ne * s.covariance * C_ne.transpose();
    P.diagonal().head<3>().array() += least_position * least_position;
    P.diagonal()
        .segment<3>(Layout::velocity)
        .setConstant(moving ? least_velocity * least_velocity * roomy : unknown_velocity * unknown_velocity);
    TightFilter<GeographicFrame>& f = filter_.emplace();
    f.inertial.set_nav(nav);
    f.start(model_, P);
    last_determined_ = epoch.time;
    const double clock = *std::ranges::find_if(s.clock, [](double x) { return std::isfinite(x); });
    f.parameters(L::clock) = clock;
    f.P(L::clock, L::clock) = std::max(f.P(L::clock, L::clock), least_position * least_position * roomy);
    if (std::isfinite(s.drift)) f.parameters(L::drift) = s.drift;
    return true;
}

/// Level axes that turn with the local level, and the specific force of unaccelerated motion over the Earth.
void ReceiverFilter::coast_to(Time time) {
    // the noise of a step enters the velocity at its end: short steps, or the position would not learn from the velocity what it
    // is owed in a turn
    constexpr double longest = 0.01;  // s
    TightFilter<GeographicFrame>& f = *filter_;
    for (double left = (time - f.time()).seconds(); left > 1e-9; left = (time - f.time()).seconds()) {
        const NavState& nav = f.inertial.nav;
        const earth::EarthTerms terms = earth::terms_at(model_.inertial.earth, nav.position, nav.v_eb_n);
        const double dt = std::min(left, longest);
        const Eigen::Matrix3d C_bn = nav.q_nb.toRotationMatrix().transpose();
        const Vector3d f_n = (2.0 * terms.w_ie_n + terms.w_en_n).cross(nav.v_eb_n) - terms.g_n;
        const Time next = left <= longest ? time : nav.time + Duration::from_seconds(dt);
        f.propagate(model_, {next, dt, C_bn * (terms.w_ie_n + terms.w_en_n) * dt, C_bn * f_n * dt}, {});
    }
    f.bring_up(model_);
}

bool ReceiverFilter::meet(const RangeEpoch& epoch, std::span<const RangeSample> samples) {
    constexpr int least = 4;  // pseudoranges that determine a position and a clock
    constexpr double patience = 10.0;  // s with fewer, which a vehicle that turns does not spend in unaccelerated motion
    if (!filter_ && !start(epoch, samples)) return false;
    coast_to(epoch.time);
    (void)update_with_ranges(model_, test_, *filter_, log_, samples, work_);
    const auto used = std::ranges::count_if(work_.all(), [](const RangeScalar& r) { return r.use && !r.is_rate; });
    determined_ = used >= least;
    if (determined_) last_determined_ = epoch.time;
    if (filter_->P.diagonal().allFinite() && (epoch.time - last_determined_).seconds() <= patience) return true;
    filter_.reset();
    return false;
}

SolutionRow ReceiverFilter::row() const {
    SolutionRow r = solution_row(filter_->inertial.nav, filter_->local_covariance(model_));
    r.rpy = r.std_rpy = not_given3();
    return r;
}

Eigen::Matrix3d ReceiverFilter::position_covariance() const { return filter_->P.topLeftCorner<3, 3>(); }

}  // namespace schuler::fusion
