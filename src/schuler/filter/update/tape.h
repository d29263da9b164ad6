// Fixed-interval smoothing of a forward run: replays a segment from its checkpoint, records it, and steps back over it with the
// adjoint recursion. Memory is one segment plus one filter per segment, for any length of the log.
#pragma once

#include "schuler/filter/update/pass.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace schuler::filter {

/// Record of one segment, in order.
template <class Frame>
class Tape : public PassObserver<Frame> {
public:
    enum class Kind : std::uint8_t { Step, Scalar, Renewed, Cloned, Output, Instant, Outage };
    struct Point {  ///< a state to be smoothed and reported
        InertialFilter<Frame> filter;
        Time time;
        OutageEpoch outage;       ///< of an Outage point
        Measurement measurement;  ///< of an Outage point, rows in local-level errors
        Matrix9 undecided;        ///< FilterRun::undecided
        std::size_t index = 0;    ///< of an Instant point
    };

    explicit Tape(const InertialModel& model) : model_(model) {}

    [[nodiscard]] bool records() const override { return true; }
    void clear() {
        order_.clear();
        steps_.clear();
        scalars_.clear();
        renewed_.clear();
        cloned_.clear();
        points_.clear();
    }
    void step(const estim::Transition& phi) override {
        order_.push_back(Kind::Step);
        steps_.push_back(phi);
    }
    void scalar(const estim::RowUpdate& u) override {
        order_.push_back(Kind::Scalar);
        scalars_.push_back(u);
    }
    void renewed(int state) override {
        order_.push_back(Kind::Renewed);
        renewed_.push_back(state);
    }
    void cloned(int first, const std::array<estim::Row, 3>& rows) override {
        order_.push_back(Kind::Cloned);
        cloned_.push_back({first, rows});
    }
    void output(const FilterRun<Frame>& run, Time time) override {
        order_.push_back(Kind::Output);
        points_.push_back({run.filter, time, OutageEpoch{}, Measurement{}, run.undecided(model_)});
    }
    void instant(const FilterRun<Frame>& run, std::size_t index) override {
        order_.push_back(Kind::Instant);
        points_.push_back({run.filter, run.filter.time(), OutageEpoch{}, Measurement{}, run.undecided(model_), index});
    }
    void outage_epoch(const FilterRun<Frame>& run, const Event& event, const Measurement& m, const MeasurementRecord&) override {
        order_.push_back(Kind::Outage);
        OutageEpoch epoch;
        epoch.outage = event.outage;
        epoch.time = event.stamp;
        epoch.end = event.outage_end;
        points_.push_back({run.filter, run.filter.time(), epoch, m, run.undecided(model_)});
    }

    /// Steps back over the tape; `report(Kind, point, adjoint)` for each point.
    template <class Report>
    void rewind(estim::StateAdjoint& adjoint, Report&& report) const {
        const auto size = static_cast<int>(adjoint.lambda.size());
        std::size_t step = steps_.size(), scalar = scalars_.size(), renewed = renewed_.size(), cloned = cloned_.size(),
                    point = points_.size();
        for (std::size_t i = order_.size(); i-- > 0;) {
            switch (order_[i]) {
                case Kind::Step: {
                    const estim::Transition& phi = steps_[--step];
                    adjoint.lambda = phi.transpose_times(adjoint.lambda);
                    estim::propagate_adjoint(adjoint.Lambda, phi, size);
                    break;
                }
                case Kind::Scalar: adjoint.undo(scalars_[--scalar], size); break;
                case Kind::Renewed: adjoint.forget(renewed_[--renewed]); break;
                case Kind::Cloned:
                    --cloned;
                    adjoint.undo_clone(cloned_[cloned].second, cloned_[cloned].first);
                    break;
                case Kind::Output:
                case Kind::Instant:
                case Kind::Outage: report(order_[i], points_[--point], adjoint); break;
            }
        }
    }

private:
    const InertialModel& model_;
    std::vector<Kind> order_;
    std::vector<estim::Transition> steps_;
    std::vector<estim::RowUpdate> scalars_;
    std::vector<int> renewed_;
    std::vector<std::pair<int, std::array<estim::Row, 3>>> cloned_;
    std::vector<Point> points_;
};

/// The smoothed counterpart of a filter state: nominal corrected by -P lambda, covariance P - P Lambda P (only its first nine
/// states if `whole_covariance` is not requested).
template <class Frame>
void smooth_in_place(const InertialModel& model, InertialFilter<Frame>& filter, const estim::StateAdjoint& adjoint,
                     bool whole_covariance) {
    const StateVector dx = -(filter.P * adjoint.lambda);
    if (whole_covariance) {
        const StateMatrix LP = adjoint.Lambda * filter.P, P = filter.P;
        filter.P.noalias() -= P * LP;
    } else {
        const Eigen::Matrix<double, Eigen::Dynamic, 9, 0, estim::max_states, 9> LP =
            adjoint.Lambda * filter.P.template leftCols<9>();
        const Matrix9 part = filter.P.template topRows<9>() * LP;
        filter.P.template topLeftCorner<9, 9>() -= part;
    }
    filter.apply(model, dx);
}

/// Backward pass over the checkpoints of a run whose last increment was `end`: each segment is replayed onto the tape and
/// rewound; `report(Kind, point, adjoint)` for each of its points, the last one first. The covariance of a checkpoint is at its
/// own time. `block`: number of increments after which the run propagated its covariance even without a request.
template <class Frame, class Report>
void rewind_checkpoints(const Pass<Frame>& pass, const InertialModel& model, const std::vector<FilterRun<Frame>>& checkpoints,
                        std::size_t end, std::size_t block, Tape<Frame>& tape, const std::function<void(double)>& progress,
                        Report&& report) {
    estim::StateAdjoint adjoint(estim::padded(model.layout.size));
    std::size_t last = end;
    for (std::size_t k = checkpoints.size(); k-- > 0;) {
        tape.clear();
        FilterRun<Frame> replay = checkpoints[k];
        const std::size_t first = replay.increment;
        while (replay.increment <= last) {
            pass.advance(replay, std::min(last, replay.increment + block - 1), tape);
            pass.propagate_covariance(replay, tape);
        }
        tape.rewind(adjoint, report);
        if (first == 0) break;
        last = first - 1;
        if (progress && k % 16 == 0) progress(1.0 - 0.7 * static_cast<double>(k) / static_cast<double>(checkpoints.size()));
    }
}

}  // namespace schuler::filter
