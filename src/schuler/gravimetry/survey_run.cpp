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

SurveyEpoch epoch_of(const SurveySettings& settings, const SurveyState& state, const Reported& P, const FixStep& step) {
    const Geodetic place = earth::geodetic_from_ecef(settings.earth.ellipsoid, state.nav.position);
    const Matrix3d C_ne = earth::C_en(place.lat, place.lon).transpose();
    const Matrix3d to_ned = settings.disturbance.from_local_level(C_ne.transpose()).transpose();   // of the disturbance
    const auto turned = [](const Matrix3d& C, const Matrix3d& block) {
        return Vector3d((C * block * C.transpose()).diagonal().cwiseMax(0.0).cwiseSqrt());
    };
    const auto sigma = [&](const Matrix3d& block) { return turned(C_ne, block); };
    const auto block = [&P](int i, int j) { return Matrix3d(P.block<3, 3>(i, j)); };
    const auto sigma_b = [&block](int i) { return Vector3d(block(i, i).diagonal().cwiseMax(0.0).cwiseSqrt()); };
    constexpr int s = kept_first, r = kept_first + 3;   // systematic and random part
    return {state.nav.time,
            state.nav,
            to_ned * state.disturbance(),
            turned(to_ned, block(s, s) + block(r, r) + block(s, r) + block(r, s)),
            turned(to_ned, block(r, r)),
            sigma(block(attitude, attitude)),
            sigma(block(velocity, velocity)),
            sigma(block(position, position)),
            state.parameters.segment<3>(accel_bias),
            state.parameters.segment<3>(gyro_bias),
            sigma_b(accel_bias),
            sigma_b(gyro_bias),
            C_ne * step.f_e,
            step.nis(),
            static_cast<int>(step.used)};
}

/// What the way back needs of a fix.
struct Kept {
    FixStep step;
    SurveyState state;
    Columns P;
};

std::vector<SurveyEpoch> smoothed(const SurveySettings& settings, const std::vector<Kept>& kept) {
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
                epoch_of(settings, corrected(here.state, whole), reported_block(here.P) - here.P.transpose() * LP, here.step));
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
    auto velocity_fix = input.velocities.begin();
    auto heading = input.headings.begin();
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
        const auto take_due = [&](auto& next, const auto& all) {
            for (; next != all.end() && due(*next); ++next) {
                if (late(*next) > half) continue;
                const FixStep taken = filter.take(*next);
                if (smooth) kept.push_back({taken, filter.state(), {}});
            }
        };
        take_due(height, input.heights);
        take_due(velocity_fix, input.velocities);
        take_due(heading, input.headings);
        for (; fix != input.fixes.end() && due(*fix); ++fix) {
            if (late(*fix) > half) continue;   // before the first increment
            AntennaFix now = *fix;
            if (std::isfinite(now.sigma_velocity_n.sum())) now.position += late(*fix) * now.velocity;
            const FixStep taken = filter.take(now);
            const Columns P = reported_columns(filter.P());
            result.forward.push_back(epoch_of(settings, filter.state(), reported_block(P), taken));
            if (smooth) kept.push_back({taken, filter.state(), P});
        }
    }
    if (result.forward.empty())
        throw input_error("no satellite fix lies within the IMU log", {}, "check the time stamps of both");
    if (smooth) result.smoothed = smoothed(settings, kept);
    return result;
}

}  // namespace schuler::gravimetry
