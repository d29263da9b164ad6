// Motion constraints: standstill, rolling wheels; instantiated for both frames.

#include "schuler/filter/update/pass.h"

#include "schuler/filter/measurement/constraint.h"

#include <algorithm>
#include <cmath>

namespace schuler::filter {

template <class Frame>
void Pass<Frame>::stand_still(FilterRun<Frame>& run, Observer& observer) const {
    const Time now = run.filter.time();
    const ConstraintSettings& constraints = settings_.constraints;
    for (; run.still < data_.still.windows.size() && data_.still.windows[run.still].end <= now; ++run.still) {
        const StillWindow& w = data_.still.windows[run.still];
        if (!constraints.zero_velocity || (now - w.end).seconds() > 0.1) continue;
        run.last_still = now;
        propagate_covariance(run, observer);
        const MeasurementRecord velocity =
            try_update(run, MeasurementKind::ZeroVelocity,
                       zero_velocity(run.filter.estimate(model_), constraints.zero_velocity_std), now, false, observer);
        if (run.diverged) return;
        observer.measurement(velocity);
        if (velocity.status != MeasurementStatus::Accepted) continue;
        const double variance = model_.gyro_psd / w.length + constraints.zero_rate_std * constraints.zero_rate_std;
        const MeasurementRecord rate =
            try_update(run, MeasurementKind::ZeroRate, zero_rate(run.filter.estimate(model_), w.mean_rate_b, variance), now,
                       false, observer);
        if (run.diverged) return;
        observer.measurement(rate);
    }
}

template <class Frame>
void Pass<Frame>::constrain(FilterRun<Frame>& run, Observer& observer) const {
    stand_still(run, observer);
    if (run.diverged) return;
    const Time now = run.filter.time();
    const ConstraintSettings& constraints = settings_.constraints;
    const bool imposed = constraints.nonholonomic || run.wheels.verdict == WheelEvidence::Verdict::Wheels;
    const bool open = constraints.nonholonomic_auto && run.wheels.verdict == WheelEvidence::Verdict::Open;
    if (!(imposed || open) || now < run.next_constraint) return;
    run.next_constraint = now + Duration::from_seconds(1.0 / constraints.constraint_rate);
    if ((now - run.last_still).seconds() < 0.3) return;
    propagate_covariance(run, observer);
    const Estimate e = run.filter.estimate(model_);
    if (!imposed) {
        observe_wheels(run, e);
        return;
    }
    const double speed = e.nav.v_eb_n.norm();
    const double turn = std::abs(e.w_ib_b.z());
    // Tyres slip in proportion to the lateral acceleration, speed times turn rate. The observed scatter is included.
    double lateral = constraints.nonholonomic_std_lateral + 0.02 * speed * turn, vertical = constraints.nonholonomic_std_vertical;
    if (!constraints.nonholonomic) {
        lateral = 0.03 + 2.0 * run.wheels.std_side() * speed;
        vertical = 0.03 + 2.0 * run.wheels.std_down() * speed;
    }
    const MeasurementRecord record =
        try_update(run, MeasurementKind::Nonholonomic, nonholonomic(e, lateral, vertical), now, false, observer);
    if (!run.diverged) observer.measurement(record);
}

template <class Frame>
void Pass<Frame>::observe_wheels(FilterRun<Frame>& run, const Estimate& e) const {
    InertialFilter<Frame>& f = run.filter;
    const int mounting = model_.layout.mounting;
    const double along = data_.backward ? -1.0 : 1.0;  // wheels roll forward in the log's time direction
    const Eigen::Vector3d v_b = along * (e.C_nb.transpose() * e.nav.v_eb_n);
    const bool good = f.P.diagonal().template segment<3>(Layout::velocity).maxCoeff() < 0.05 &&
                      f.P.diagonal().template segment<3>(Layout::attitude).maxCoeff() < 4e-4;
    if (v_b.x() < 3.0 || !good) return;
    run.wheels.add(v_b, along * e.w_ib_b.z(), 1.0 / settings_.constraints.constraint_rate);
    if (run.wheels.verdict != WheelEvidence::Verdict::Wheels) return;
    f.parameters(mounting) = -std::atan(run.wheels.mean_down);
    f.parameters(mounting + 1) = std::atan(run.wheels.mean_side);
    f.P.diagonal().template segment<2>(mounting).setConstant(2.5e-5);
    f.P(model_.layout.axle, model_.layout.axle) = 1.5 * 1.5;
}

#define SCHULER_INSTANTIATE(Frame)                                              \
    template void Pass<Frame>::stand_still(FilterRun<Frame>&, Observer&) const; \
    template void Pass<Frame>::constrain(FilterRun<Frame>&, Observer&) const;   \
    template void Pass<Frame>::observe_wheels(FilterRun<Frame>&, const Estimate&) const;
SCHULER_INSTANTIATE(GeographicFrame)
SCHULER_INSTANTIATE(EarthFixedFrame)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::filter
