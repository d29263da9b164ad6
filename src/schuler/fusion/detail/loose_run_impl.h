// run_pass for one frame; instantiated once per frame so that compile times stay bearable.
#pragma once

#include "schuler/fusion/correction_period.h"
#include "schuler/fusion/loose_run.h"
#include "schuler/fusion/outputs.h"
#include "schuler/fusion/smoother.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>

namespace schuler::fusion {

template <class Frame>
Result run_pass_in(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                   const PassOptions& options);
template <class Frame>
StartEstimate smooth_start_in(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                              std::size_t last_increment);

inline constexpr double sensor_row_spacing = 1.0;   // s

/// Collects what a pass reports.
template <class Frame, int N>
struct Collector : PassObserver<Frame, N> {
    Collector(const InertialModel<N>& model_, Result& result_, bool outputs_, bool states_, Time start)
        : model(model_), result(result_), outputs(outputs_), states(states_), next_sensor(start) {}

    void output(const InertialFilter<Frame, N>& f, Time time) override {
        if (!outputs) return;
        Matrix9 P = f.P.template topLeftCorner<9, 9>();
        if constexpr (!Frame::errors_are_geographic) {
            const Matrix9 T = f.to_local_level(model);
            P = (T * P * T.transpose()).eval();
        }
        const NavState nav = Frame::geographic(model.earth, f.estimated(model));
        result.forward.rows.push_back(solution_row(nav, P));
        if (time >= next_sensor) {
            while (next_sensor <= time) next_sensor = next_sensor + Duration::from_seconds(sensor_row_spacing);
            const Eigen::Matrix<double, N, 1> parameters = f.estimated_parameters();
            if (states) result.forward.states.push_back(state_row<N>(model.layout, nav, parameters, f.P, P));
            result.forward.sensor_errors.push_back(sensor_error_row<N>(time, model.layout, parameters, f.P.diagonal()));
        }
    }
    void outage_epoch(const InertialFilter<Frame, N>&, const Event& event, const LocalMeasurement&,
                      const AidRecord& r) override {
        result.forward.outage_epochs.push_back({event.outage, event.stamp, event.outage_end, r.innovation, r.sigma});
    }
    void aid(const AidRecord& r) override {
        result.aids.push_back(r);
        if (r.kind != AidKind::GnssPosition || !(r.sigma.x() > 0.0)) return;   // a height of another age is no epoch of its own
        ++result.counters.gnss_epochs;
        ++(r.status == AidStatus::Accepted   ? result.counters.gnss_accepted
           : r.status == AidStatus::Withheld ? result.counters.gnss_withheld
                                             : result.counters.gnss_rejected);
    }
    void alert(const Alert& a) override { result.alerts.push_back(a); }

    const InertialModel<N>& model;
    Result& result;
    bool outputs, states;
    Time next_sensor;
};

/// Filter at the start: sigmas in human coordinates mapped to the error states.
template <class Frame, int N>
Walk<Frame, N> first_step(const InertialModel<N>& model, const RunData& data, const Settings& settings, const Start& start) {
    Walk<Frame, N> walk;
    InertialFilter<Frame, N>& f = walk.filter;
    f.set_nav(Frame::from_geographic(model.earth, start.nav));
    f.previous = start.previous;
    const Layout& L = model.layout;
    f.parameters.template segment<3>(Layout::gyro_bias) = start.gyro_bias;
    f.parameters.template segment<3>(Layout::accel_bias) = start.accel_bias;

    Matrix9 P = Matrix9::Zero();
    P.diagonal().segment<3>(Layout::position) = start.std_position.cwiseAbs2();
    P.diagonal().segment<3>(Layout::velocity) = start.std_velocity.cwiseAbs2();
    const Eigen::Matrix3d J = math::rpy_error_from_phi(math::rpy_from_quaternion(start.nav.q_nb)).inverse();
    P.block<3, 3>(Layout::attitude, Layout::attitude) = J * start.std_rpy.cwiseAbs2().asDiagonal() * J.transpose();
    Matrix9 T = Matrix9::Identity();   // local level to the filter's own errors
    if constexpr (!Frame::errors_are_geographic) T = f.to_local_level(model).inverse();
    f.P.template topLeftCorner<9, 9>() = T * P * T.transpose();
    // A state of its own whose error has the covariance `shared` with the component `state` of the local level.
    const auto tie = [&](int own, int state, double shared) {
        f.P.template block<9, 1>(0, own) = shared * T.col(state);
        f.P.template block<1, 9>(own, 0) = shared * T.col(state).transpose();
    };
    const auto set = [&f](int offset, const Eigen::Vector3d& sigma) {
        if (offset >= 0) f.P.diagonal().template segment<3>(offset) = sigma.cwiseAbs2();
    };
    const sensor::ImuErrorModel& imu = settings.imu.errors;
    set(Layout::gyro_bias, start.std_gyro_bias);
    set(Layout::accel_bias, start.std_accel_bias);
    set(L.gyro_scale, Eigen::Vector3d::Constant(imu.gyro_scale));
    set(L.accel_scale, Eigen::Vector3d::Constant(imu.accel_scale));
    if (L.gyro_misalignment >= 0) {
        f.P.diagonal().template segment<6>(L.gyro_misalignment).setConstant(imu.gyro_misalignment * imu.gyro_misalignment);
        f.P.diagonal().template segment<6>(L.accel_misalignment).setConstant(imu.accel_misalignment * imu.accel_misalignment);
    }
    if (L.mounting >= 0 && settings.aids.nonholonomic) {   // otherwise known only once wheels are recognised
        f.P.diagonal().template segment<2>(L.mounting).setConstant(start.std_mounting * start.std_mounting);
        f.P(L.axle, L.axle) = 1.5 * 1.5;
    }
    if (L.lever_arm >= 0) {
        f.parameters.template segment<3>(L.lever_arm) = settings.gnss.lever_arm_b;
        set(L.lever_arm, Eigen::Vector3d::Constant(1.0));
    }
    if (L.baro_bias >= 0) {
        const double height_variance = P(Layout::position + 2, Layout::position + 2), prior = settings.baro.bias_std;
        f.P(L.baro_bias, L.baro_bias) = prior * prior;
        const auto first = std::find_if(data.recording->baro.begin(), data.recording->baro.end(),
                                        [&](const BaroSample& s) { return s.time >= start.nav.time; });
        const double offset = first == data.recording->baro.end() ? 0.0 : first->height - start.nav.position.h;
        // A first sample that contradicts the stated bias speaks instead of it; its bias errs with the height it was taken from.
        if (offset * offset > 9.0 * (prior * prior + height_variance)) {
            f.parameters(L.baro_bias) = offset;
            f.P(L.baro_bias, L.baro_bias) = height_variance + settings.baro.std * settings.baro.std;
            tie(L.baro_bias, Layout::position + 2, height_variance);
        }
    }
    if (L.mag_bias >= 0) f.P(L.mag_bias, L.mag_bias) = settings.mag.bias_std * settings.mag.bias_std;
    const auto set_slow = [&](int offset, int state, const Eigen::Vector3d& sigma, const Eigen::Vector3d& of_fix) {
        set(offset, sigma);
        // The start has the error of the fix in it, of which the state, zero, knows nothing yet: their errors are opposite.
        for (int i = 0; offset >= 0 && i < 3; ++i)
            if (of_fix(i) > 0.0) tie(offset + i, state + i, -std::min(sigma(i) * sigma(i), P(state + i, state + i)));
    };
    set_slow(L.gnss_position, Layout::position, settings.gnss.errors.correlated_position, start.position_of_fix);
    set_slow(L.gnss_velocity, Layout::velocity, settings.gnss.errors.correlated_velocity, start.velocity_of_fix);

    const InertialErrorBounds bounds =
        three_sigma(start.std_rpy.head<2>().maxCoeff(), start.std_gyro_bias.maxCoeff(), start.std_accel_bias.maxCoeff());
    walk.feedback_period =
        Duration::from_seconds(settings.feedback_period.value_or(correction_period(bounds, settings.feedback_attitude)));
    walk.next_feedback = start.nav.time + walk.feedback_period;

    if (settings.integrity.use && settings.integrity.window > 0.0) walk.shadows.resize(2);
    walk.increment = start.increment;
    walk.next_output = start.nav.time;
    walk.next_constraint = start.nav.time;
    return walk;
}

template <int N>
InertialModel<N> make_model(const Settings& settings, const Layout& layout) {
    InertialModel<N> model(settings.earth, layout, settings.imu.errors);
    const auto set = [&model](int offset, int count, StateProcess process) {
        for (int i = 0; offset >= 0 && i < count; ++i) model.process[static_cast<std::size_t>(offset + i)] = process;
    };
    set(layout.baro_bias, 1, {0.0, settings.baro.bias_walk * settings.baro.bias_walk});
    set(layout.mag_bias, 1, {0.0, settings.mag.bias_walk * settings.mag.bias_walk});
    model.gnss = settings.gnss.errors;
    model.loop = settings.loop;
    for (int i = 0; i < 3; ++i) {
        const auto slow = [](double sigma, double time) { return StateProcess{1.0 / time, 2.0 * sigma * sigma / time}; };
        const sensor::GnssErrorModel& g = model.gnss;
        if (layout.gnss_position >= 0)
            set(layout.gnss_position + i, 1, slow(g.correlated_position(i), g.correlated_time));
        if (layout.gnss_velocity >= 0)
            set(layout.gnss_velocity + i, 1, slow(g.correlated_velocity(i), g.correlated_velocity_time));
    }
    const auto bound = [&model](int offset, double sigma) { model.floor.template segment<3>(offset).setConstant(sigma * sigma); };
    bound(Layout::position, settings.aids.floor_position);
    bound(Layout::velocity, settings.aids.floor_velocity);
    bound(Layout::attitude, settings.aids.floor_attitude);
    bound(Layout::gyro_bias, settings.aids.floor_gyro_bias);
    bound(Layout::accel_bias, settings.aids.floor_accel_bias);
    return model;
}

/// One stretch of the smoother: this many increments are replayed at once.
inline constexpr std::size_t stretch = 512;

template <class Frame, int N>
Result run_sized(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                 const PassOptions& options) {
    const InertialModel<N> model = make_model<N>(settings, layout);
    const ForwardPass<Frame, N> pass(model, data, settings);
    Walk<Frame, N> walk = first_step<Frame, N>(model, data, settings, start);
    Result result;
    const std::size_t end = std::min(options.last_increment, data.imu.increments.size() - 1);
    std::optional<SolutionRow> first_row, last_row;
    const auto hand_over = [&] {
        auto& rows = result.forward.rows;
        if (rows.empty()) return;
        if (!first_row) first_row = rows.front();
        last_row = rows.back();
        options.rows(rows);
        rows.clear();
    };
    if (options.outputs && !options.rows && end >= walk.increment) {
        const auto n = static_cast<double>(end - walk.increment + 1);
        const double rows = settings.output_rate > 0.0 ? n * data.imu.median_dt * settings.output_rate : n;
        result.forward.rows.reserve(static_cast<std::size_t>(std::min(rows * 1.1 + 16.0, n + 16.0)));
    }
    Collector<Frame, N> collector(model, result, options.outputs, settings.state_rows, walk.filter.time());
    std::vector<Walk<Frame, N>> checkpoints;

    const auto begin = std::chrono::steady_clock::now();
    for (std::size_t done = 0; walk.increment <= end; ++done) {
        if (options.smooth) checkpoints.push_back(walk);
        pass.advance(walk, std::min(end, walk.increment + stretch - 1), collector);
        if (options.rows) hand_over();
        if (options.progress && done % 16 == 0)
            options.progress(static_cast<double>(walk.increment) / static_cast<double>(end + 1) * (options.smooth ? 0.3 : 1.0));
    }
    if (first_row) result.forward.rows = {*first_row, *last_row};
    result.filter_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (!options.smooth) return result;

    estim::Adjoint<N> adjoint;
    Tape<Frame, N> tape;
    std::size_t last = end;
    Time next_sensor{INT64_MAX};
    using Kind = typename Tape<Frame, N>::Kind;
    for (std::size_t k = checkpoints.size(); k-- > 0;) {
        tape.clear();
        Walk<Frame, N> replay = checkpoints[k];
        const std::size_t first = replay.increment;
        pass.advance(replay, last, tape);
        tape.rewind(model, adjoint, [&](Kind kind, const typename Tape<Frame, N>::Point& point, const estim::Adjoint<N>& a) {
            InertialFilter<Frame, N> f = point.filter;
            const bool sensors = kind == Kind::Outage || point.time <= next_sensor;
            smooth_in_place(model, f, a, sensors);
            if (kind == Kind::Output) {
                const Matrix9 T = f.to_local_level(model);
                const Matrix9 P = T * f.P.template topLeftCorner<9, 9>() * T.transpose();
                result.smoothed.rows.push_back(solution_row(Frame::geographic(model.earth, f.estimated(model)), P));
                if (sensors) {
                    next_sensor = point.time - Duration::from_seconds(sensor_row_spacing);
                    result.smoothed.sensor_errors.push_back(
                        sensor_error_row<N>(point.time, layout, f.estimated_parameters(), f.P.diagonal()));
                }
                return;
            }
            // An outage epoch: the same measurement against the smoothed state, to first order in the correction.
            const Measurement<N> m = to_filter(model, point.filter, point.measurement);
            const Eigen::Matrix<double, N, 1> dx = -(point.filter.P * a.lambda);
            OutageEpoch epoch = point.outage;
            epoch.error = m.innovation - m.rows.transpose() * dx;
            const Eigen::Matrix3d S = m.rows.transpose() * f.P * m.rows;
            epoch.sigma = (S.diagonal() + m.variance).cwiseMax(0.0).cwiseSqrt();
            result.smoothed.outage_epochs.push_back(epoch);
        });
        if (first == 0) break;
        last = first - 1;
        if (options.progress && k % 16 == 0)
            options.progress(1.0 - 0.7 * static_cast<double>(k) / static_cast<double>(checkpoints.size()));
    }
    std::reverse(result.smoothed.rows.begin(), result.smoothed.rows.end());
    std::reverse(result.smoothed.sensor_errors.begin(), result.smoothed.sensor_errors.end());
    std::reverse(result.smoothed.outage_epochs.begin(), result.smoothed.outage_epochs.end());
    return result;
}

template <class Frame>
Result run_pass_in(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                   const PassOptions& options) {
    if (layout.size <= 16) return run_sized<Frame, 16>(data, settings, layout, start, options);
    if (layout.size <= 24) return run_sized<Frame, 24>(data, settings, layout, start, options);
    return run_sized<Frame, 44>(data, settings, layout, start, options);
}

/// Log-likelihood of the accepted and rejected GNSS innovations; far ones count as far, not infinitely far.
template <class Frame, int N>
struct StartTape : Tape<Frame, N> {
    void aid(const AidRecord& r) override {
        if (r.kind != AidKind::GnssPosition && r.kind != AidKind::GnssVelocity) return;
        if (r.status == AidStatus::Withheld) return;
        double log_sigma = 0.0;
        for (int i = 0; i < 3; ++i)
            if (r.sigma(i) > 0.0) log_sigma += std::log(r.sigma(i));
        log_likelihood -= 0.5 * std::min(r.nis, 50.0) + log_sigma;
    }
    double log_likelihood = 0.0;
};

template <class Frame, int N>
StartEstimate smooth_start_sized(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                                 std::size_t last_increment) {
    const InertialModel<N> model = make_model<N>(settings, layout);
    const ForwardPass<Frame, N> pass(model, data, settings);
    Walk<Frame, N> walk = first_step<Frame, N>(model, data, settings, start);
    InertialFilter<Frame, N> first = walk.filter;
    walk.next_output = Time{INT64_MAX};
    std::vector<Walk<Frame, N>> checkpoints;
    StartEstimate estimate;
    StartTape<Frame, N> tape;
    estim::Adjoint<N> adjoint;
    const std::size_t end = std::min(last_increment, data.imu.increments.size() - 1);
    while (walk.increment <= end) {
        checkpoints.push_back(walk);
        tape.clear();
        pass.advance(walk, std::min(end, walk.increment + stretch - 1), tape);
    }
    estimate.log_likelihood = tape.log_likelihood;
    std::size_t last = end;
    for (std::size_t k = checkpoints.size(); k-- > 0;) {
        tape.clear();
        Walk<Frame, N> replay = checkpoints[k];
        const std::size_t begin = replay.increment;
        pass.advance(replay, last, tape);
        tape.rewind(model, adjoint, [](auto, const auto&, const auto&) {});
        last = begin - 1;
    }
    smooth_in_place(model, first, adjoint, true);
    const Matrix9 T = first.to_local_level(model);
    estimate.nav = Frame::geographic(model.earth, first.nav);
    estimate.std_rpy = solution_row(estimate.nav, T * first.P.template topLeftCorner<9, 9>() * T.transpose()).std_rpy;
    estimate.gyro_bias = first.parameters.template segment<3>(Layout::gyro_bias);
    estimate.accel_bias = first.parameters.template segment<3>(Layout::accel_bias);
    return estimate;
}

template <class Frame>
StartEstimate smooth_start_in(const RunData& data, const Settings& settings, const Layout& layout, const Start& start,
                              std::size_t last_increment) {
    if (layout.size <= 16) return smooth_start_sized<Frame, 16>(data, settings, layout, start, last_increment);
    if (layout.size <= 24) return smooth_start_sized<Frame, 24>(data, settings, layout, start, last_increment);
    return smooth_start_sized<Frame, 44>(data, settings, layout, start, last_increment);
}

}  // namespace schuler::fusion
