#include "schuler/gravimetry/survey_run.h"

#include "schuler/core/error.h"
#include "schuler/estim/dense.h"
#include "schuler/gravimetry/survey_filter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace schuler::gravimetry {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// States that are reported: position, velocity, attitude, sensor errors, systematic and random part of the disturbance.
constexpr int kept_first = gnss_position, reported = kept_first + 6;
using Columns = Eigen::Matrix<double, max_states, reported>;
using Reported = Eigen::Matrix<double, reported, reported>;

Columns reported_columns(const StateMatrix& M) {
    Columns out;
    out << M.leftCols<kept_first>(), M.middleCols<6>(systematic);
    return out;
}
Reported reported_block(const Columns& columns) {
    Reported out;
    out << columns.topRows<kept_first>(), columns.middleRows<6>(systematic);
    return out;
}

SurveyEpoch epoch_of(const earth::Earth& earth, const SurveyState& state, const Reported& P, const Vector3d& f_e) {
    const Geodetic place = earth::geodetic_from_ecef(earth.ellipsoid, state.nav.position);
    const Matrix3d C_ne = earth::C_en(place.lat, place.lon).transpose();
    const auto sigma = [&](const Matrix3d& block) {
        return Vector3d((C_ne * block * C_ne.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt());
    };
    const auto block = [&P](int i, int j) { return Matrix3d(P.block<3, 3>(i, j)); };
    const auto sigma_b = [&block](int i) { return Vector3d(block(i, i).diagonal().cwiseMax(0.0).cwiseSqrt()); };
    constexpr int s = kept_first, r = kept_first + 3;   // systematic and random part
    return {state.nav.time,
            state.nav,
            C_ne * state.disturbance_e(),
            sigma(block(s, s) + block(r, r) + block(s, r) + block(r, s)),
            sigma(block(r, r)),
            sigma(block(attitude, attitude)),
            sigma(block(velocity, velocity)),
            sigma(block(position, position)),
            state.parameters.segment<3>(accel_bias),
            state.parameters.segment<3>(gyro_bias),
            sigma_b(accel_bias),
            sigma_b(gyro_bias),
            C_ne * f_e};
}

/// What the way back needs of a fix.
struct Kept {
    FixStep step;
    SurveyState state;
    Columns P;
};

std::vector<SurveyEpoch> smoothed(const earth::Earth& earth, const std::vector<Kept>& kept) {
    std::vector<SurveyEpoch> out;
    estim::Adjoint<max_states> adjoint;
    for (std::size_t k = kept.size(); k-- > 0;) {
        const Kept& here = kept[k];
        if (here.step.satellites) {
            const Eigen::Matrix<double, reported, 1> dx = -here.P.transpose().lazyProduct(adjoint.lambda);
            Columns LP;
            LP.noalias() = adjoint.Lambda * here.P;
            StateVector whole = StateVector::Zero();
            whole.head<kept_first>() = dx.head<kept_first>();
            whole.segment<6>(systematic) = dx.tail<6>();
            out.push_back(
                epoch_of(earth, corrected(here.state, whole), reported_block(here.P) - here.P.transpose() * LP, here.step.f_e));
        }
        for (std::size_t i = here.step.used; i-- > 0;) adjoint.undo(here.step.updates[i]);
        adjoint.lambda = here.step.Phi.transpose().lazyProduct(adjoint.lambda).eval();
        estim::propagate_adjoint<max_states>(adjoint.Lambda, here.step.Phi);
    }
    std::ranges::reverse(out);
    return out;
}

}  // namespace

SurveyResult run_survey(const SurveySettings& settings, const SurveyInput& input, bool smooth) {
    SurveyFilter filter(settings, input.start);
    SurveyResult result;
    std::vector<Kept> kept;
    auto fix = input.fixes.begin();
    auto height = input.heights.begin();
    auto step = input.steps.begin();
    for (const ImuIncrement& increment : input.imu) {
        const double gap = (increment.time - filter.state().nav.time).seconds() - increment.dt;
        if (!(increment.dt > 0.0) || std::abs(gap) > 0.5 * increment.dt)
            throw input_error(fmt::format("the increment at {:.3f} s does not follow the one before", increment.time.seconds()),
                              {}, "gravimetry needs an IMU log without gaps");
        if (step != input.steps.end() && *step <= increment.time) {
            filter.open_disturbance();
            ++step;
        }
        filter.advance(increment);
        const double half = 0.5 * increment.dt;
        const auto due = [&](const auto& measured) { return (measured.time - increment.time).seconds() < half; };
        const auto late = [&](const auto& measured) { return (increment.time - measured.time).seconds(); };
        for (; height != input.heights.end() && due(*height); ++height) {
            if (late(*height) > half) continue;
            const FixStep taken = filter.take(*height);
            if (smooth) kept.push_back({taken, filter.state(), {}});
        }
        for (; fix != input.fixes.end() && due(*fix); ++fix) {
            if (late(*fix) > half) continue;   // before the first increment
            AntennaFix now = *fix;
            if (std::isfinite(now.sigma_velocity_n.sum())) now.position += late(*fix) * now.velocity;
            const FixStep taken = filter.take(now);
            const Columns P = reported_columns(filter.P());
            result.forward.push_back(epoch_of(settings.earth, filter.state(), reported_block(P), taken.f_e));
            if (smooth) kept.push_back({taken, filter.state(), P});
        }
    }
    if (result.forward.empty())
        throw input_error("no satellite fix lies within the IMU log", {}, "check the time stamps of both");
    if (smooth) result.smoothed = smoothed(settings.earth, kept);
    return result;
}

}  // namespace schuler::gravimetry
