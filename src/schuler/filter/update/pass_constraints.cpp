// Constraints of the motion: standing still, rolling on wheels; instantiated for both frames.

#include "schuler/filter/update/pass.h"

#include "schuler/filter/measurement/constraint.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

template <class Frame>
void Pass<Frame>::stand_still(Walk<Frame>& walk, Observer& observer) const {
    const Time now = walk.filter.time();
    const AidSettings& aids = settings_.aids;
    for (; walk.still < data_.still.windows.size() && data_.still.windows[walk.still].end <= now; ++walk.still) {
        const StillWindow& w = data_.still.windows[walk.still];
        if (!aids.zero_velocity || (now - w.end).seconds() > 0.1) continue;
        walk.last_still = now;
        propagate_covariance(walk, observer);
        const AidRecord velocity =
            try_update(walk, AidKind::ZeroVelocity, zero_velocity(walk.filter.estimate(model_), aids.zero_velocity_std), now,
                       false, observer);
        if (walk.diverged) return;
        observer.aid(velocity);
        if (velocity.status != AidStatus::Accepted) continue;
        const double variance = model_.gyro_psd / w.length + aids.zero_rate_std * aids.zero_rate_std;
        const AidRecord rate = try_update(walk, AidKind::ZeroRate,
                                          zero_rate(walk.filter.estimate(model_), w.mean_rate_b, variance), now, false, observer);
        if (walk.diverged) return;
        observer.aid(rate);
    }
}

template <class Frame>
void Pass<Frame>::constrain(Walk<Frame>& walk, Observer& observer) const {
    stand_still(walk, observer);
    if (walk.diverged) return;
    const Time now = walk.filter.time();
    const AidSettings& aids = settings_.aids;
    const bool imposed = aids.nonholonomic || walk.wheels.verdict == WheelEvidence::Verdict::Wheels;
    const bool open = aids.nonholonomic_auto && walk.wheels.verdict == WheelEvidence::Verdict::Open;
    if (!(imposed || open) || now < walk.next_constraint) return;
    walk.next_constraint = now + Duration::from_seconds(1.0 / aids.constraint_rate);
    if ((now - walk.last_still).seconds() < 0.3) return;
    propagate_covariance(walk, observer);
    const Estimate e = walk.filter.estimate(model_);
    if (!imposed) {
        observe_wheels(walk, e);
        return;
    }
    const double speed = e.nav.v_eb_n.norm();
    const double turn = std::abs(e.w_ib_b.z());
    // Tyres slip in proportion to the sideways acceleration, speed times turn rate. What was seen to scatter, scatters.
    double lateral = aids.nonholonomic_std_lateral + 0.02 * speed * turn, vertical = aids.nonholonomic_std_vertical;
    if (!aids.nonholonomic) {
        lateral = 0.03 + 2.0 * walk.wheels.std_side() * speed;
        vertical = 0.03 + 2.0 * walk.wheels.std_down() * speed;
    }
    const AidRecord record = try_update(walk, AidKind::Nonholonomic, nonholonomic(e, lateral, vertical), now, false, observer);
    if (!walk.diverged) observer.aid(record);
}

template <class Frame>
void Pass<Frame>::observe_wheels(Walk<Frame>& walk, const Estimate& e) const {
    InertialFilter<Frame>& f = walk.filter;
    const int mounting = model_.layout.mounting;
    const double along = data_.backward ? -1.0 : 1.0;  // wheels roll forward in the time of the log
    const Eigen::Vector3d v_b = along * (e.C_nb.transpose() * e.nav.v_eb_n);
    const bool good = f.P.diagonal().template segment<3>(Layout::velocity).maxCoeff() < 0.05 &&
                      f.P.diagonal().template segment<3>(Layout::attitude).maxCoeff() < 4e-4;
    if (v_b.x() < 3.0 || !good) return;
    walk.wheels.add(v_b, along * e.w_ib_b.z(), 1.0 / settings_.aids.constraint_rate);
    if (walk.wheels.verdict != WheelEvidence::Verdict::Wheels) return;
    f.parameters(mounting) = -std::atan(walk.wheels.mean_down);
    f.parameters(mounting + 1) = std::atan(walk.wheels.mean_side);
    f.P.diagonal().template segment<2>(mounting).setConstant(2.5e-5);
    f.P(model_.layout.axle, model_.layout.axle) = 1.5 * 1.5;
}

#define SCHULER_INSTANTIATE(Frame)                                         \
    template void Pass<Frame>::stand_still(Walk<Frame>&, Observer&) const; \
    template void Pass<Frame>::constrain(Walk<Frame>&, Observer&) const;   \
    template void Pass<Frame>::observe_wheels(Walk<Frame>&, const Estimate&) const;
SCHULER_INSTANTIATE(GeographicFrame)
SCHULER_INSTANTIATE(EarthFixedFrame)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::filter
