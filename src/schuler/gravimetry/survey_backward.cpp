#include "schuler/gravimetry/detail/survey_backward.h"
#include "schuler/filter/update/reversed.h"
#include "schuler/ins/state_error.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <utility>

namespace schuler::gravimetry::detail {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using filter::InertialModel;
using filter::Layout;

constexpr double opening = 10.0;  ///< times the forward filter's last sigmas: a weight of one hundredth

/// Information that both filters have about the states before any measurement; zero for position, velocity and attitude.
MatrixXd common_information(const Layout& layout, const estim::StateMatrix& P) {
    std::vector<int> known;
    for (int i = Layout::navigation; i < layout.size; ++i)
        if (P(i, i) > 0.0) known.push_back(i);
    MatrixXd J = MatrixXd::Zero(layout.size, layout.size);
    // Scaled, as the variances differ by 16 orders of magnitude.
    const Eigen::VectorXd scale = P.diagonal()(known).cwiseSqrt();
    const MatrixXd correlation =
        scale.cwiseInverse().asDiagonal() * MatrixXd(P(known, known)) * scale.cwiseInverse().asDiagonal();
    const MatrixXd inverse = correlation.ldlt().solve(MatrixXd::Identity(scale.size(), scale.size()));
    J(known, known) = scale.cwiseInverse().asDiagonal() * inverse * scale.cwiseInverse().asDiagonal();
    return J;
}

/// Epochs and their rows, in the time of the log.
class BackwardEpochs : public filter::PassObserver<SurveyFrame> {
public:
    BackwardEpochs(const InertialModel& model, SurveyResult& result, std::vector<DisturbanceRows>& rows)
        : model_(model), result_(result), rows_(rows), signs_(filter::signs_in_reversed_time(model.layout)) {}
    void instant(const SurveyFilterRun& run, std::size_t) override {
        SurveyEpoch e = survey_epoch(model_, run.filter, run.covariance(model_), 0);
        e.time = e.nav.time = filter::reversed(e.time);
        e.nav.v_eb_e = -e.nav.v_eb_e;
        e.gyro_bias = -e.gyro_bias;
        result_.backward.push_back(e);
        rows_.emplace_back(disturbance_rows(model_, run.filter) * signs_.asDiagonal());
    }

private:
    const InertialModel& model_;
    SurveyResult& result_;
    std::vector<DisturbanceRows>& rows_;
    estim::StateVector signs_;
};

/// With e_f = P_f (J x - ...) and e_b alike, where J x is what the common prior, of mean zero, contributes: E[e_f e_b'] = P_f J P_b.
SurveySeparation separation_of(const SurveyEpoch& forward, const SurveyEpoch& backward, const DisturbanceRows& rows_forward,
                               const DisturbanceRows& rows_backward, const MatrixXd& J) {
    const Vector3d sum = forward.sigma_disturbance_n.cwiseAbs2() + backward.sigma_disturbance_n.cwiseAbs2();
    const Vector3d shared = (rows_forward * J).cwiseProduct(rows_backward).rowwise().sum();
    constexpr double least = 1e-4;  // of the sum: J is that of the start, the priors of random states drift a little
    return {forward.time, forward.disturbance_n - backward.disturbance_n, (sum - 2.0 * shared).cwiseMax(least * sum).cwiseSqrt()};
}

filter::Start start_at(const InertialModel& model, const SurveyEpoch& last, const filter::Start& start) {
    filter::Start out = start;
    out.nav = ins::to_geographic(model.earth, last.nav);
    out.nav.time = filter::reversed(last.time);
    out.nav.v_eb_n = -out.nav.v_eb_n;
    out.std_position = opening * last.sigma_position_n;
    out.std_velocity = opening * last.sigma_velocity_n;
    const Matrix3d J = math::rpy_error_from_phi(math::rpy_from_quaternion(out.nav.q_nb));
    out.std_rpy = opening * (J.cwiseAbs2() * last.sigma_attitude_n.cwiseAbs2()).cwiseSqrt();
    out.gyro_bias = -start.gyro_bias;
    out.position_rate.setZero();
    out.velocity_rate.setZero();
    out.heading_rate = 0.0;
    out.increment = 0;
    return out;
}

}  // namespace

void run_backward(const filter::RunData& data, const filter::Settings& settings, const filter::Start& start,
                  const SurveyOptions& options, const std::vector<DisturbanceRows>& rows, SurveyResult& result) {
    const std::vector<ImuIncrement>& imu = data.imu.increments;
    const SurveyEpoch& last = result.forward.back();
    const auto after = std::ranges::upper_bound(imu, last.time, {}, &ImuIncrement::time);
    const auto end = static_cast<std::size_t>(after - imu.begin());
    if (end <= start.increment + 1) return;
    const filter::Settings back = filter::reversed(settings);
    filter::ReversedData whole = filter::reversed(data, start.increment, end - 1);
    for (const SurveyEpoch& e : result.forward) whole.data.instants.push_back(filter::reversed(e.time));
    std::ranges::reverse(whole.data.instants);
    SurveyOptions reversed;
    for (const Time step : options.steps) reversed.steps.push_back(filter::reversed(step));
    std::ranges::reverse(reversed.steps);

    const InertialModel model = make_model(back, make_layout(back, *whole.recording));
    const filter::Pass<SurveyFrame> pass(model, whole.data, back, filter::Rivalry::Contest);
    SurveyFilterRun run = begin_survey(model, whole.data, back, start_at(model, last, start));
    const MatrixXd J = common_information(model.layout, run.filter.P);
    std::vector<DisturbanceRows> backward_rows;
    BackwardEpochs epochs(model, result, backward_rows);
    run_along(pass, whole.data, back, model, run, reversed, false, epochs);
    std::ranges::reverse(result.backward);
    std::ranges::reverse(backward_rows);
    // Both in order of time, the backward ones among the forward ones.
    std::size_t k = 0;
    for (std::size_t i = 0; i < result.backward.size(); ++i) {
        while (k < result.forward.size() && result.forward[k].time < result.backward[i].time) ++k;
        if (k == result.forward.size()) break;
        if (result.forward[k].time == result.backward[i].time)
            result.separation.push_back(separation_of(result.forward[k], result.backward[i], rows[k], backward_rows[i], J));
    }
}

}  // namespace schuler::gravimetry::detail
