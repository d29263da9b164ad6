#include "schuler/gravimetry/detail/survey_pass.h"

#include <algorithm>

namespace schuler::gravimetry::detail {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Frame = SurveyFrame;
using Filter = SurveyFilter;
using FilterRun = SurveyFilterRun;
using filter::InertialModel;
using filter::Layout;
using filter::Matrix9;

namespace {

Matrix3d to_local_level(const InertialModel& model, const NavStateEcef& nav) {
    return model.disturbance.from_local_level(Frame::C_en(model.earth, nav)).transpose();
}

/// Of the disturbance, the sum of both parts, in the axes of its model: covariance with every state, and of the columns of such rows.
DisturbanceRows rows_of_sum(const Layout& L, const estim::StateMatrix& P) {
    DisturbanceRows rows = P.block(L.gravity_constant, 0, 3, L.size);
    if (L.gravity_random >= 0) rows += P.block(L.gravity_random, 0, 3, L.size);
    return rows;
}
Matrix3d columns_of_sum(const Layout& L, const DisturbanceRows& rows) {
    Matrix3d columns = rows.middleCols<3>(L.gravity_constant);
    if (L.gravity_random >= 0) columns += rows.middleCols<3>(L.gravity_random);
    return columns;
}

/// The clone becomes the disturbance as estimated now, with all its correlations.
void keep_before(const Layout& L, Filter& f) {
    const int to = L.gravity_before;
    const DisturbanceRows rows = rows_of_sum(L, f.P);
    f.P.block(to, 0, 3, L.size) = rows;
    f.P.block(0, to, L.size, 3) = rows.transpose();
    f.P.block<3, 3>(to, to) = columns_of_sum(L, rows);
    f.parameters.segment<3>(to) = filter::disturbance_of(L, f.parameters);
    f.error.segment<3>(to) = filter::disturbance_of(L, f.error);
}

void open_systematic_part(const filter::Settings& settings, const InertialModel& model, FilterRun& run) {
    Filter& f = run.filter;
    if (model.layout.gravity_before >= 0) keep_before(model.layout, f);
    filter::open_disturbance(settings.disturbance, model.layout, Frame::C_en(model.earth, f.nav), f.P);
    if (!run.rival.empty()) open_systematic_part(settings, model, run.rival.front().run);
}

}  // namespace

SurveyEpoch survey_epoch(const InertialModel& model, const Filter& f, const Matrix9& P_n, std::size_t fix) {
    const Layout& L = model.layout;
    const estim::StateVector parameters = f.estimated_parameters();
    const auto sigma = [](const auto& variances) { return Vector3d(variances.cwiseMax(0.0).cwiseSqrt()); };
    SurveyEpoch e;
    e.nav = f.estimated(model);
    e.time = e.nav.time;
    e.fix = fix;
    const Matrix3d to_ned = to_local_level(model, e.nav);
    const auto turned = [&](const Matrix3d& block) { return sigma((to_ned * block * to_ned.transpose()).diagonal()); };
    const auto block = [&f](int i, int j) { return Matrix3d(f.P.block<3, 3>(i, j)); };
    const int r = L.gravity_random;
    const DisturbanceRows rows = rows_of_sum(L, f.P);
    const Matrix3d own = columns_of_sum(L, rows);
    e.disturbance_n = to_ned * filter::disturbance_of(L, parameters);
    e.sigma_disturbance_n = turned(own);
    if (const int b = L.gravity_before; b >= 0) {
        e.change_n = e.disturbance_n - to_ned * parameters.segment<3>(b);
        const Matrix3d common = rows.middleCols<3>(b);
        e.sigma_change_n = turned(own + block(b, b) - common - common.transpose());
    }
    e.sigma_random_n = r < 0 ? Vector3d(Vector3d::Zero()) : turned(block(r, r));
    e.sigma_position_n = sigma(P_n.diagonal().segment<3>(Layout::position));
    e.sigma_velocity_n = sigma(P_n.diagonal().segment<3>(Layout::velocity));
    e.sigma_attitude_n = sigma(P_n.diagonal().segment<3>(Layout::attitude));
    e.accel_bias = parameters.segment<3>(Layout::accel_bias);
    e.gyro_bias = parameters.segment<3>(Layout::gyro_bias);
    e.sigma_accel_bias = sigma(f.P.diagonal().segment<3>(Layout::accel_bias));
    e.sigma_gyro_bias = sigma(f.P.diagonal().segment<3>(Layout::gyro_bias));
    return e;
}

DisturbanceRows disturbance_rows(const InertialModel& model, const Filter& f) {
    return to_local_level(model, f.estimated(model)) * rows_of_sum(model.layout, f.P);
}

FilterRun begin_survey(const InertialModel& model, const filter::RunData& data, const filter::Settings& settings,
                       const filter::Start& start) {
    FilterRun run = filter::first_step<Frame>(model, data, settings, start);
    run.next_output = Time{INT64_MAX};
    while (run.event < data.events.size() && data.events[run.event].valid <= start.nav.time) ++run.event;
    return run;
}

std::vector<FilterRun> run_along(const filter::Pass<Frame>& pass, const filter::RunData& data, const filter::Settings& settings,
                                 const InertialModel& model, FilterRun& run, const SurveyOptions& options, bool keep,
                                 filter::PassObserver<Frame>& observer) {
    const std::vector<ImuIncrement>& imu = data.imu.increments;
    std::vector<FilterRun> checkpoints;
    std::size_t step = 0;
    while (run.increment < imu.size()) {
        pass.propagate_covariance(run, observer);
        for (; step < options.steps.size() && options.steps[step] <= imu[run.increment].time; ++step)
            open_systematic_part(settings, model, run);
        if (keep) {
            checkpoints.push_back(run);
            checkpoints.back().rival.clear();
        }
        std::size_t end = std::min(imu.size(), run.increment + options.stretch);
        if (step < options.steps.size()) {
            const auto next = std::ranges::lower_bound(imu, options.steps[step], {}, &ImuIncrement::time);
            end = std::min(end, static_cast<std::size_t>(next - imu.begin()));
        }
        pass.advance(run, end - 1, observer);
        if (options.progress) options.progress(static_cast<double>(end) / static_cast<double>(imu.size()) * (keep ? 0.4 : 1.0));
    }
    return checkpoints;
}

}  // namespace schuler::gravimetry::detail
