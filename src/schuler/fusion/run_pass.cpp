#include "schuler/fusion/run_pass.h"

#include "schuler/core/error.h"
#include "schuler/filter/outputs.h"
#include "schuler/filter/update/tape.h"
#include "schuler/fusion/pass_collector.h"
#include "schuler/fusion/tuning/trial.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

namespace schuler::fusion {

namespace {

using estim::StateAdjoint;

/// One segment of the smoother: number of increments replayed at once.
constexpr std::size_t stretch = 512;

/// Data passed from the filter to a receiver after `last`, which followed `before`: their means give the force at the end of the
/// last and its rate of change.
template <class Frame>
ReceiverAiding aiding_of(const InertialModel& model, const FilterRun<Frame>& run, const Settings& settings,
                         const ImuIncrement& before, const ImuIncrement& last) {
    const InertialFilter<Frame>& f = run.filter;
    const Layout& L = model.layout;
    const Estimate e = f.estimate(model);
    const Eigen::Vector3d mean = last.dv / last.dt, change = (mean - before.dv / before.dt) / (0.5 * (last.dt + before.dt));
    const Eigen::Vector3d f_b = mean + 0.5 * last.dt * change - e.parameters.template segment<3>(Layout::accel_bias);
    ReceiverAiding g;
    g.time = f.time();
    g.antenna = antenna_motion(model.earth, e.nav, f_b, e.w_ib_b, settings.gnss.lever_arm_b);
    g.C_en = earth::C_en(e.nav.position.lat, e.nav.position.lon);
    g.jerk_e = g.C_en * (e.C_nb * (change + e.w_ib_b.cross(f_b)));
    g.P = f.local_covariance(model).template topLeftCorner<6, 6>();
    g.drift = e.parameters(L.drift);
    g.clock = e.parameters(L.clock);
    g.std_clock = std::sqrt(std::max(0.0, f.P(L.clock, L.clock)));
    g.std_drift = std::sqrt(std::max(0.0, f.P(L.drift, L.drift)));
    return g;
}

/// Passes the rows of a result to the sink as they are formed; keeps the first and the last.
class HandOver {
public:
    HandOver(std::vector<SolutionRow>& rows, const RowSink& sink) : rows_(rows), sink_(sink) {}
    void now() {
        if (!sink_ || rows_.empty()) return;
        if (!first_) first_ = rows_.front();
        last_ = rows_.back();
        sink_(rows_);
        rows_.clear();
    }
    void end() {
        if (first_) rows_ = {*first_, *last_};
    }

private:
    std::vector<SolutionRow>& rows_;
    const RowSink& sink_;
    std::optional<SolutionRow> first_, last_;
};

/// The backward pass over the checkpoints of a run.
template <class Frame>
void smooth_back(const Pass<Frame>& pass, const InertialModel& model, const Settings& settings, double imu_interval,
                 const std::vector<FilterRun<Frame>>& checkpoints, std::size_t end, std::size_t block, const Progress& progress,
                 const Trajectory& forward, Trajectory& out) {
    Tape<Frame> tape(model);
    Time next_sensor{INT64_MAX};
    auto covariance = forward.covariances.rbegin();  // next time in backward order that has a full one
    using Kind = typename Tape<Frame>::Kind;
    const auto report = [&](Kind kind, const typename Tape<Frame>::Point& point, const StateAdjoint& a) {
        InertialFilter<Frame> f = point.filter;
        const bool sensors = kind == Kind::Outage || point.time <= next_sensor;
        const bool full = kind == Kind::Output && covariance != forward.covariances.rend() && covariance->time == point.time;
        smooth_in_place(model, f, a, sensors || full || model.at_antenna);
        const auto at_point = [&] {
            if (settings.output_lever_arm_b.isZero(0.0)) return solution_row(reported(model, f, point.undecided));
            return solution_row_at(model, f, reported_covariance(model, f, point.undecided), settings.output_lever_arm_b,
                                   imu_interval);
        };
        if (kind == Kind::Instant) {
            out.instants.push_back({point.index, at_point()});
            return;
        }
        if (kind == Kind::Output) {
            out.rows.push_back(solution_row(reported(model, f, point.undecided)));
            if (!settings.output_lever_arm_b.isZero(0.0)) out.point.push_back(at_point());
            if (full) {
                out.covariances.push_back(covariance_row(point.time, model.layout, f.P));
                ++covariance;
            }
            if (!sensors) return;
            next_sensor = point.time - Duration::from_seconds(sensor_row_spacing);
            const StateVector parameters = f.estimated_parameters();
            out.sensor_errors.push_back(sensor_error_row(point.time, model.layout, parameters, f.P.diagonal()));
            out.parameters.push_back(parameter_row(point.time, model.layout, parameters, f.P));
            return;
        }
        // An outage epoch: the same measurement compared with the smoothed state, to first order in the correction.
        const Measurement m = point.filter.to_own(model, point.measurement);
        const StateVector dx = -(point.filter.P * a.lambda);
        OutageEpoch epoch = point.outage;
        epoch.error = m.innovation;
        for (int i = 0; i < m.dof; ++i) epoch.error(i) -= m.rows[static_cast<std::size_t>(i)].dot(dx);
        epoch.sigma.setZero();
        epoch.sigma.head(m.dof) = f.innovation_covariance(m).diagonal().head(m.dof).cwiseMax(0.0).cwiseSqrt();
        epoch.sigma_state.setZero();
        for (int i = 0; i < m.dof; ++i)
            epoch.sigma_state(i) = std::sqrt(std::max(0.0, epoch.sigma(i) * epoch.sigma(i) - m.variance(i)));
        epoch.sigma_apart = f.sigma_apart(model, m, point.undecided);
        out.outage_epochs.push_back(epoch);
    };
    rewind_checkpoints(pass, model, checkpoints, end, block, tape, progress, report);
    std::ranges::reverse(out.rows);
    std::ranges::reverse(out.point);
    std::ranges::reverse(out.instants);
    std::ranges::reverse(out.sensor_errors);
    std::ranges::reverse(out.parameters);
    std::ranges::reverse(out.covariances);
    std::ranges::reverse(out.outage_epochs);
}

bool is_refused_fix(const MeasurementRecord& r) { return is_part_of_fix(r.kind) && r.status == MeasurementStatus::Rejected; }

/// Propagates the covariance when the tape does.
template <class Frame>
struct Rehearsal : PassObserver<Frame> {
    [[nodiscard]] bool wants_all_states(Time) const override { return true; }
    void measurement(const MeasurementRecord& r) override { refused += is_refused_fix(r) ? 1 : 0; }
    std::ptrdiff_t refused = 0;
};

template <class Frame>
struct Rehearsed {
    std::vector<FilterRun<Frame>> checkpoints;
    std::ptrdiff_t refused = 0;  ///< parts of fixes
};

/// Repeats the run with the hypotheses that were finally accepted.
template <class Frame>
Rehearsed<Frame> rehearse(const Pass<Frame>& pass, FilterRun<Frame> run, std::size_t end) {
    Rehearsed<Frame> out;
    Rehearsal<Frame> observer;
    while (run.increment <= end) {
        pass.propagate_covariance(run, observer);
        out.checkpoints.push_back(run);
        pass.advance(run, std::min(end, run.increment + stretch - 1), observer);
    }
    out.refused = observer.refused;
    return out;
}

/// The openings after a long time without an accepted fix are spread over that time: an increase of the covariance at its end is a
/// barrier for the smoother, which would correct nothing of the error before it. Empty if there are none.
std::vector<Opening> spread_over_gaps(const std::vector<Opening>& openings, const RunData& data) {
    constexpr double shortest = 3.0, step = 1.0;  // s
    constexpr int most = 30;                      // of one error
    std::vector<Opening> out;
    bool any = false;
    for (const Opening& o : openings) {
        if (o.span < shortest) {
            out.push_back(o);
            continue;
        }
        any = true;
        const int parts = std::min(most, static_cast<int>(o.span / step));
        const Time end = data.imu.increments[o.increment].time;
        Opening one = o;
        one.part = 1.0 / parts;
        for (int k = parts; k > 0; --k) {
            one.increment = increment_at(data, end - Duration::from_seconds(o.span * k / parts));
            out.push_back(one);
        }
    }
    return any ? out : std::vector<Opening>{};
}

/// The checkpoints with such openings; empty if the filter diverges with them, or rejects more parts of fixes than `most`.
template <class Frame>
std::vector<FilterRun<Frame>> rehearse_spread(const Pass<Frame>& pass, const FilterRun<Frame>& first, std::size_t end,
                                              std::ptrdiff_t most) {
    try {
        Rehearsed<Frame> rehearsed = rehearse(pass, first, end);
        if (rehearsed.refused <= most) return std::move(rehearsed.checkpoints);
    } catch (const Error&) {  // diverged; with the openings of the contest it did not
    }
    return {};
}

template <class Frame>
Result run_in(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options) {
    const InertialModel model = make_model(settings, make_layout(settings, *data.recording));
    const Pass<Frame> pass(model, data, settings, options.rivalry);
    FilterRun<Frame> run = first_step<Frame>(model, data, settings, start);
    Result result;
    result.states.assign(model.layout.blocks().begin(), model.layout.blocks().end());
    const std::size_t end = std::min(options.last_increment, data.imu.increments.size() - 1);
    HandOver hand_over(result.forward.rows, options.rows);
    if (options.outputs && !options.rows && end >= run.increment) {
        const auto n = static_cast<double>(end - run.increment + 1);
        const double rows = settings.output_rate > 0.0 ? n * data.imu.median_dt * settings.output_rate : n;
        result.forward.rows.reserve(static_cast<std::size_t>(std::min(rows * 1.1 + 16.0, n + 16.0)));
    }
    result.measurements.reserve(data.events.size() +
                                (uses_ranges(settings.coupling) ? 2 * data.recording->ranges.samples.size() : 0));
    PassCollector<Frame> collector(model, settings, options, result, run.filter.time(), data.imu.median_dt);
    std::vector<FilterRun<Frame>> checkpoints;
    const auto begin = std::chrono::steady_clock::now();
    const std::size_t block = options.receiver ? 1 : stretch;
    for (std::size_t done = 0; run.increment <= end; ++done) {
        if (options.smooth && done % (stretch / block) == 0) {
            pass.propagate_covariance(run, collector);
            checkpoints.push_back(run);
            checkpoints.back().rival.clear();
        }
        const std::size_t last = std::min(end, run.increment + block - 1);
        if (options.receiver) {
            const auto back = [&](std::size_t n) -> const ImuIncrement& { return data.imu.increments[last - std::min(last, n)]; };
            pass.propagate_covariance(run,
                                      collector);  // sigmas that do not grow without reception would predict the wrong place
            options.receiver(aiding_of(model, run, settings, back(2), back(1)), back(0).time);
        }
        pass.advance(run, last, collector);
        hand_over.now();
        if (options.progress && done % (block > 1 ? 16 : stretch) == 0)
            options.progress(static_cast<double>(run.increment) / static_cast<double>(end + 1) * (options.smooth ? 0.3 : 1.0));
    }
    hand_over.end();
    result.filter_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (options.smooth) {
        std::vector<Opening> openings = run.openings;
        if (run.sides_changed > 0) {
            const auto pass_with = [&](const std::vector<Opening>& o) {
                return Pass<Frame>(model, data, settings, Rivalry::Decided, o);
            };
            const FilterRun<Frame> first = first_step<Frame>(model, data, settings, start);
            checkpoints.clear();
            if (std::vector<Opening> spread = spread_over_gaps(openings, data); !spread.empty()) {
                checkpoints =
                    rehearse_spread(pass_with(spread), first, end, std::ranges::count_if(result.measurements, is_refused_fix));
                if (!checkpoints.empty()) openings = std::move(spread);
            }
            if (checkpoints.empty()) checkpoints = rehearse(pass_with(openings), first, end).checkpoints;
        }
        const Pass<Frame> decided(model, data, settings, Rivalry::Decided, std::move(openings));
        smooth_back(decided, model, settings, data.imu.median_dt, checkpoints, end, block, options.progress, result.forward,
                    result.smoothed);
    }
    return result;
}

/// Log-likelihood of the accepted and rejected GNSS innovations, with a limited contribution of outliers.
template <class Frame>
struct StartTape : Tape<Frame> {
    using Tape<Frame>::Tape;
    void measurement(const MeasurementRecord& r) override {
        if (r.kind != MeasurementKind::GnssPosition && r.kind != MeasurementKind::GnssVelocity) return;
        if (r.status == MeasurementStatus::Withheld) return;
        double log_sigma = 0.0;
        for (int i = 0; i < 3; ++i)
            if (r.sigma(i) > 0.0) log_sigma += std::log(r.sigma(i));
        log_likelihood -= 0.5 * std::min(r.nis, 50.0) + log_sigma;
    }
    double log_likelihood = 0.0;
};

}  // namespace

Result run_pass(const RunData& data, const Settings& settings, const Start& start, const PassOptions& options) {
    if (uses_ranges(settings.coupling) && data.recording->ranges.empty() && !options.receiver)
        throw input_error("there are no pseudoranges", {.file = {}, .key = "filter.scheme"},
                          "give raw measurements ([gnss] observations or [stations] file), or choose --scheme loose");
    return settings.mechanization == Mechanization::Ecef ? run_in<EarthFixedFrame>(data, settings, start, options)
                                                         : run_in<GeographicFrame>(data, settings, start, options);
}

StartEstimate smooth_start(const RunData& data, const Settings& settings, const Start& start, std::size_t last_increment) {
    using Frame = GeographicFrame;
    const InertialModel model = make_model(settings, make_layout(settings, *data.recording));
    // A filter that finally accepts the fixes it refused no longer has the heading of its start, and its likelihood is not that of it.
    const Pass<Frame> pass(model, data, settings, Rivalry::Decided);
    FilterRun<Frame> run = first_step<Frame>(model, data, settings, start);
    InertialFilter<Frame> first = run.filter;
    run.next_output = Time{INT64_MAX};
    StartTape<Frame> tape(model);  // a start is short: one segment
    pass.advance(run, std::min(last_increment, data.imu.increments.size() - 1), tape);
    StateAdjoint adjoint(estim::padded(model.layout.size));
    tape.rewind(adjoint, [](auto, const auto&, const auto&) {});
    smooth_in_place(model, first, adjoint, true);
    StartEstimate estimate;
    estimate.log_likelihood = tape.log_likelihood;
    estimate.nav = first.geographic(model);
    estimate.std_rpy = solution_row(estimate.nav, first.local_covariance(model)).std_rpy;
    estimate.gyro_bias = first.parameters.segment<3>(Layout::gyro_bias);
    estimate.accel_bias = first.parameters.segment<3>(Layout::accel_bias);
    return estimate;
}

}  // namespace schuler::fusion
