// Collects the reported data of a pass into a result.
#pragma once

#include "schuler/earth/earth.h"
#include "schuler/filter/outputs.h"
#include "schuler/fusion/run_pass.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace schuler::fusion {

inline constexpr double sensor_row_spacing = 1.0;  // s

template <class Frame>
class PassCollector : public PassObserver<Frame> {
public:
    using Filter = InertialFilter<Frame>;

    PassCollector(const InertialModel& model, const Settings& settings, const PassOptions& options, Result& result, Time start,
                  double imu_interval)
        : model_(model),
          settings_(settings),
          options_(options),
          result_(result),
          next_sensor_(start),
          imu_interval_(imu_interval) {
        if (settings.ranging.protection.use) limits_ = ProtectionLimits(settings.ranging.protection);
    }

    [[nodiscard]] bool wants_all_states(Time time) const override {
        // The smoother replays the run and propagates at every output; what is withheld from an unknown heading depends on when (HeadingForce).
        return options_.smooth || (options_.outputs && (covariance_due(time) || time >= next_sensor_));
    }
    void output(const FilterRun<Frame>& run, Time time) override {
        if (!options_.outputs) return;
        const Filter& f = run.filter;
        const auto [nav, P] = reported(model_, f, run.undecided(model_));
        if (settings_.loop == Loop::Open)
            result_.open_attitude = std::max(result_.open_attitude, f.error.template segment<3>(Layout::attitude).norm());
        result_.forward.rows.push_back(solution_row(nav, P));
        if (!settings_.output_lever_arm_b.isZero(0.0)) result_.forward.point.push_back(at_point(f, run.covariance(model_)));
        if (covariance_due(time)) {
            result_.forward.covariances.push_back(covariance_row(time, model_.layout, f.P));
            covariance_slot_ = slot_of(time);
        }
        if (time < next_sensor_) return;
        while (next_sensor_ <= time) next_sensor_ = next_sensor_ + Duration::from_seconds(sensor_row_spacing);
        const StateVector parameters = f.estimated_parameters();
        if (settings_.state_rows) result_.forward.states.push_back(state_row(model_.layout, nav, parameters, f.P, P));
        result_.forward.sensor_errors.push_back(sensor_error_row(time, model_.layout, parameters, f.P.diagonal()));
        result_.forward.parameters.push_back(parameter_row(time, model_.layout, parameters, f.P));
        if (model_.layout.source < 0) return;
        for (const RangeTracking::Slot& slot : run.ranges.slots)
            result_.forward.parameters.back().sources.push_back(static_cast<std::int16_t>(slot.source));
    }
    void instant(const FilterRun<Frame>& run, std::size_t index) override {
        if (!options_.outputs) return;
        const bool elsewhere = !settings_.output_lever_arm_b.isZero(0.0);
        result_.forward.instants.push_back({index, elsewhere
                                                       ? at_point(run.filter, run.covariance(model_))
                                                       : solution_row(reported(model_, run.filter, run.undecided(model_)))});
    }
    void outage_epoch(const FilterRun<Frame>& run, const Event& event, const Measurement& m,
                      const MeasurementRecord& r) override {
        result_.forward.outage_epochs.push_back(
            {event.outage, event.stamp, event.outage_end, r.innovation, r.sigma, r.sigma_state,
             run.filter.sigma_apart(model_, run.filter.to_own(model_, m), run.undecided(model_))});
    }
    void measurement(const MeasurementRecord& r) override {
        result_.measurements.push_back(r);
        if (r.kind != MeasurementKind::GnssPosition || !(r.sigma.x() > 0.0))
            return;  // a height with its own age is not a separate epoch
        ++result_.counters.gnss_epochs;
        ++(r.status == MeasurementStatus::Accepted   ? result_.counters.gnss_accepted
           : r.status == MeasurementStatus::Withheld ? result_.counters.gnss_withheld
                                                     : result_.counters.gnss_rejected);
    }
    void alert(const Alert& a) override { result_.alerts.push_back(a); }
    void ranges(const FilterRun<Frame>& run, const RangeEpoch& epoch) override {
        const RangeEpochWork& work = run.ranges.work;
        ++result_.counters.gnss_epochs;
        // a faulty satellite is no faulty epoch
        const auto out = static_cast<std::size_t>(work.excluded);
        ++(work.withheld              ? result_.counters.gnss_withheld
           : 2 * out < work.count + 1 ? result_.counters.gnss_accepted
                                      : result_.counters.gnss_rejected);
        for (const RangeScalar& s : work.all()) result_.measurements.push_back(record_of(s, run.filter.time(), epoch.time));
        if (settings_.ranging.protection.use) protect(run, epoch);
        if (!options_.after_ranges) return;
        const NavState nav = run.filter.geographic(model_);
        const Eigen::Vector3d lever_n = nav.q_nb.toRotationMatrix() * settings_.gnss.lever_arm_b;
        options_.after_ranges(epoch, earth::moved_by_ned(model_.earth, nav.position, lever_n),
                              run.filter.local_covariance(model_).template topLeftCorner<3, 3>());
    }
    void carriers(const FilterRun<Frame>&, const RangeEpoch& epoch, const CarrierUse& use) override {
        result_.forward.carriers.push_back(
            {epoch.time, use.phases, use.slipped, use.whole, use.held, use.ratio, use.doubted > 0});
    }

private:
    /// Decimated as the rows of the solution (report::decimated).
    [[nodiscard]] std::int64_t slot_of(Time time) const {
        return period_number(time, Duration::from_seconds(1.0 / settings_.covariance_rate));
    }
    [[nodiscard]] bool covariance_due(Time time) const {
        return settings_.covariance_rows && (!(settings_.covariance_rate > 0.0) || slot_of(time) != covariance_slot_);
    }
    [[nodiscard]] SolutionRow at_point(const Filter& f, const Matrix9& P) const {
        return solution_row_at(model_, f, P, settings_.output_lever_arm_b, imu_interval_);
    }
    static MeasurementRecord record_of(const RangeScalar& s, Time time, Time stamp) {
        MeasurementRecord r;
        r.time = time;
        r.stamp = stamp;
        r.kind = s.is_rate ? MeasurementKind::RangeRate : MeasurementKind::Pseudorange;
        r.source = s.source;
        r.status = s.use ? MeasurementStatus::Accepted : MeasurementStatus::Rejected;
        r.dof = 1;
        r.sigma(0) = s.use ? std::sqrt(s.s) : std::sqrt(s.variance);
        r.innovation(0) = s.use ? s.sequential * r.sigma(0) : s.innovation;
        r.sigma_state(0) = std::sqrt(std::max(0.0, s.s - s.variance));
        r.nis = r.innovation(0) * r.innovation(0) / (r.sigma(0) * r.sigma(0));
        return r;
    }
    void protect(const FilterRun<Frame>& run, const RangeEpoch& epoch) {
        const RangeEpochWork& work = run.ranges.work;
        const Matrix9 T = run.filter.to_local_level(model_), P = run.covariance(model_);
        const ProtectionLevels l = run.ranges.watch.levels(limits_, P.template topLeftCorner<3, 3>(), T.template topRows<3>());
        const int used = static_cast<int>(std::ranges::count_if(work.all(), &RangeScalar::use));
        result_.forward.protection.push_back({epoch.time, l.horizontal, l.vertical, used, work.excluded, work.alarm});
    }

    const InertialModel& model_;
    const Settings& settings_;
    const PassOptions& options_;
    Result& result_;
    Time next_sensor_;
    std::int64_t covariance_slot_ = INT64_MIN;
    double imu_interval_;  // s
    ProtectionLimits limits_;
};

}  // namespace schuler::fusion
