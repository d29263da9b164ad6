#include "schuler/gravimetry/survey_run.h"

#include "schuler/core/error.h"
#include "schuler/filter/outputs.h"
#include "schuler/filter/update/tape.h"
#include "schuler/gravimetry/detail/survey_backward.h"
#include "schuler/gravimetry/detail/survey_pass.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Frame = detail::SurveyFrame;
using Filter = detail::SurveyFilter;
using FilterRun = detail::SurveyFilterRun;
using detail::survey_epoch;
using filter::Event;
using filter::InertialModel;
using filter::Layout;
using filter::Matrix9;
using filter::MeasurementKind;

namespace {

/// An epoch starts with the position of a fix that is not withheld; simultaneous measurements belong to it.
bool begins_epoch(const Event& event) {
    return event.kind == MeasurementKind::GnssPosition && (event.components & 3) == 3 && !event.withheld;
}

class ForwardEpochs : public filter::PassObserver<Frame> {
public:
    ForwardEpochs(const InertialModel& model, SurveyResult& result, bool covariances, bool rows_of_disturbance)
        : model_(model), result_(result), covariances_(covariances), rows_of_disturbance_(rows_of_disturbance) {}

    void propagated(const Filter& f, double time) override {
        // Corrected for the estimated errors of a nominal state without feedback.
        const Vector3d force = f.mean_force + f.error.segment<3>(Layout::attitude).cross(f.mean_force) +
                               f.C * f.error.segment<3>(Layout::accel_bias);
        force_ += time * force;
        elapsed_ += time;
    }
    void measurement(const filter::MeasurementRecord& record) override { result_.measurements.push_back(record); }
    void measured(const FilterRun& run, const Event& event, const filter::MeasurementRecord& record) override {
        std::vector<SurveyEpoch>& epochs = result_.forward;
        const bool begins = begins_epoch(event);
        if (!begins && (epochs.empty() || epochs.back().time != run.filter.time())) {
            if (!epochs.empty()) count(epochs.back(), record);  // a velocity older or younger than its position
            return;
        }
        SurveyEpoch e = survey_epoch(model_, run.filter, run.covariance(model_), begins ? event.index : epochs.back().fix);
        if (begins) {
            e.f_n =
                elapsed_ > 0.0 ? Vector3d(Frame::C_en(model_.earth, e.nav).transpose() * force_ / elapsed_) : Vector3d::Zero();
            force_.setZero();
            elapsed_ = 0.0;
            epochs.push_back(e);
        } else {
            e.f_n = epochs.back().f_n;
            e.nis = epochs.back().nis;
            e.measured = epochs.back().measured;
            epochs.back() = e;
        }
        count(epochs.back(), record);
        keep_states(run.filter, begins);
    }

    std::vector<detail::DisturbanceRows> rows;  ///< of the epochs

private:
    void keep_states(const Filter& f, bool begins) {
        const auto keep = [begins](auto& rows, auto row) {
            if (begins) rows.push_back(std::move(row));
            else rows.back() = std::move(row);
        };
        keep(result_.parameters, filter::parameter_row(f.time(), model_.layout, f.estimated_parameters(), f.P));
        if (covariances_) keep(result_.covariances, filter::covariance_row(f.time(), model_.layout, f.P));
        if (rows_of_disturbance_) keep(rows, detail::disturbance_rows(model_, f));
    }
    static void count(SurveyEpoch& e, const filter::MeasurementRecord& record) {
        const bool of_fix = filter::is_part_of_fix(record.kind);
        if (!of_fix || record.status != filter::MeasurementStatus::Accepted) return;
        e.nis += record.nis;
        e.measured += record.dof;
    }

    const InertialModel& model_;
    SurveyResult& result_;
    bool covariances_, rows_of_disturbance_;
    Vector3d force_ = Vector3d::Zero();  // integral since the last epoch, m/s
    double elapsed_ = 0.0;
};

/// The same epochs as points of the backward pass.
class SurveyTape : public filter::Tape<Frame> {
public:
    using filter::Tape<Frame>::Tape;
    void output(const FilterRun&, Time) override {}
    void outage_epoch(const FilterRun&, const Event&, const filter::Measurement&, const filter::MeasurementRecord&) override {}
    void measured(const FilterRun& run, const Event& event, const filter::MeasurementRecord&) override {
        const Time now = run.filter.time();
        if (begins_epoch(event)) epoch_ = now;
        if (epoch_ == now) Tape::output(run, now);
    }

private:
    Time epoch_{INT64_MIN};
};

}  // namespace

filter::Settings gravity27(filter::Settings s, const filter::DisturbanceSettings& disturbance) {
    s.disturbance = disturbance;
    s.disturbance.estimate = true;
    s.coupling = filter::Coupling::Loose;
    s.loose_kind = filter::LooseKind::Standard;
    s.mechanization = filter::Mechanization::Ecef;
    s.integrity.use = s.constraints.zero_velocity = s.constraints.nonholonomic = s.constraints.nonholonomic_auto = false;
    s.baro.use = s.mag.use = s.odometer.use = s.gnss.consider_errors = false;
    return s;
}

SurveyResult run_survey(const filter::RunData& data, const filter::Settings& settings, const filter::Start& start,
                        const SurveyOptions& options) {
    settings.disturbance.model.check();
    const InertialModel model = make_model(settings, make_layout(settings, *data.recording));
    const filter::Pass<Frame> pass(model, data, settings, filter::Rivalry::Contest);
    SurveyResult result;
    FilterRun run = detail::begin_survey(model, data, settings, start);
    result.states.assign(model.layout.blocks().begin(), model.layout.blocks().end());
    ForwardEpochs epochs(model, result, settings.covariance_rows, options.backward);
    std::vector<FilterRun> checkpoints = detail::run_along(pass, data, settings, model, run, options, options.smooth, epochs);
    if (result.forward.empty())
        throw input_error("no satellite fix lies within the IMU log", {}, "check the time stamps of both");
    if (options.backward) detail::run_backward(data, settings, start, options, epochs.rows, result);
    if (!options.smooth) return result;
    const filter::Pass<Frame> decided(model, data, settings, filter::Rivalry::Decided, run.openings);
    if (run.sides_changed > 0) {  // repeated with the hypotheses that were finally accepted
        filter::PassObserver<Frame> nobody;
        FilterRun right = detail::begin_survey(model, data, settings, start);
        checkpoints = detail::run_along(decided, data, settings, model, right, options, true, nobody);
    }
    SurveyTape tape(model);
    Time last{INT64_MAX};
    filter::rewind_checkpoints(
        decided, model, checkpoints, data.imu.increments.size() - 1, data.imu.increments.size(), tape, options.progress,
        [&](auto, const SurveyTape::Point& point, const estim::StateAdjoint& adjoint) {
            if (point.time >= last) return;  // of the same epoch: the last of them is used
            last = point.time;
            Filter f = point.filter;
            smooth_in_place(model, f, adjoint, true);
            result.smoothed.push_back(survey_epoch(model, f, filter::reported_covariance(model, f, point.undecided), 0));
            result.smoothed_parameters.push_back(filter::parameter_row(point.time, model.layout, f.estimated_parameters(), f.P));
            if (settings.covariance_rows)
                result.smoothed_covariances.push_back(filter::covariance_row(point.time, model.layout, f.P));
        });
    std::ranges::reverse(result.smoothed);
    std::ranges::reverse(result.smoothed_parameters);
    std::ranges::reverse(result.smoothed_covariances);
    for (std::size_t i = 0; i < result.smoothed.size(); ++i) {
        const SurveyEpoch& f = result.forward[i];
        SurveyEpoch& s = result.smoothed[i];
        s.f_n = f.f_n;
        s.nis = f.nis;
        s.measured = f.measured;
        s.fix = f.fix;
    }
    return result;
}

}  // namespace schuler::gravimetry
