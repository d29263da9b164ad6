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

/// Steps back over a stretch; epochs are appended, the last one first.
void rewind(const SurveySettings& settings, const std::vector<Kept>& tape, estim::Adjoint<max_states>& adjoint,
            std::vector<SurveyEpoch>& out) {
    for (std::size_t k = tape.size(); k-- > 0;) {
        const Kept& here = tape[k];
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
}

/// The filter and the next of everything. Copying it is saving the run.
struct Walk {
    SurveyFilter filter;
    std::size_t increment = 0, fix = 0, height = 0, velocity = 0, heading = 0, step = 0;

    /// Advances by one increment and takes what is due at its end; `taken(FixStep)` is called for each.
    template <class Taken>
    void advance(const SurveyInput& input, Taken&& taken) {
        const ImuIncrement& now = input.imu[increment++];
        const double gap = (now.time - filter.reference().nav.time).seconds() - now.dt;
        if (!(now.dt > 0.0) || std::abs(gap) > 0.5 * now.dt)
            throw input_error(fmt::format("the increment at {:.3f} s does not follow the one before", now.time.seconds()), {},
                              "gravimetry needs an IMU log without gaps");
        if (step < input.steps.size() && input.steps[step] <= now.time) {
            filter.open_disturbance();
            ++step;
        }
        filter.advance(now);
        const double half = 0.5 * now.dt;
        const auto each_due = [&](std::size_t& next, const auto& all, auto take) {
            for (; next < all.size() && (all[next].time - now.time).seconds() < half; ++next) {
                const double late = (now.time - all[next].time).seconds();
                if (late <= half) taken(take(all[next], late));   // the others lie before the first increment
            }
        };
        const auto as_it_is = [&](const auto& measured, double) { return filter.take(measured); };
        each_due(height, input.heights, as_it_is);
        each_due(velocity, input.velocities, as_it_is);
        each_due(heading, input.headings, as_it_is);
        each_due(fix, input.fixes, [&](AntennaFix moved, double late) {
            if (std::isfinite(moved.sigma_velocity_n.sum())) moved.position += late * moved.velocity;
            return filter.take(moved);
        });
    }
    [[nodiscard]] Kept kept(const FixStep& taken) const {
        return {taken, filter.estimate(), taken.satellites ? reported_columns(filter.P()) : Columns::Zero()};
    }
};

}  // namespace

SurveyResult run_survey(const SurveySettings& settings, const SurveyInput& input, bool smooth, std::size_t stretch) {
    Walk walk{SurveyFilter(settings, input.start)};
    SurveyResult result;
    std::vector<Walk> checkpoints;
    std::vector<Kept> tape;
    while (walk.increment < input.imu.size()) {
        if (smooth && (checkpoints.empty() || tape.size() >= stretch)) {
            checkpoints.push_back(walk);
            tape.clear();
        }
        walk.advance(input, [&](const FixStep& taken) {
            const Kept here = walk.kept(taken);
            if (taken.satellites) result.forward.push_back(epoch_of(settings, here.state, reported_block(here.P), taken));
            if (smooth) tape.push_back(here);
        });
    }
    if (result.forward.empty())
        throw input_error("no satellite fix lies within the IMU log", {}, "check the time stamps of both");
    estim::Adjoint<max_states> adjoint;
    std::size_t end = input.imu.size();
    for (std::size_t k = checkpoints.size(); k-- > 0;) {
        Walk& replay = checkpoints[k];
        const std::size_t first = replay.increment;
        if (k + 1 < checkpoints.size()) {   // the last stretch is on the tape already
            tape.clear();
            while (replay.increment < end)
                replay.advance(input, [&](const FixStep& taken) { tape.push_back(replay.kept(taken)); });
        }
        rewind(settings, tape, adjoint, result.smoothed);
        end = first;
    }
    std::ranges::reverse(result.smoothed);
    return result;
}

}  // namespace schuler::gravimetry
