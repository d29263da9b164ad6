// Fixed-interval smoothing over a forward walk: replays a stretch from its checkpoint, writes down what happened, and steps back
// over it with the adjoint recursion. Memory is one stretch plus one filter per stretch, whatever the length of the log.
#pragma once

#include "schuler/fusion/forward_pass.h"
#include "schuler/fusion/outputs.h"

#include <Eigen/StdVector>

#include <vector>

namespace schuler::fusion {

/// What happened in one stretch, in order.
template <class Frame, int N>
class Tape : public PassObserver<Frame, N> {
public:
    enum class Kind : std::uint8_t { Step, Scalar, Output, Outage };
    struct Point {                       ///< a state to be smoothed and reported
        InertialFilter<Frame, N> filter;
        Time time;
        OutageEpoch outage;              ///< of an Outage point
        LocalMeasurement measurement;    ///< of an Outage point
    };

    void clear() {
        order_.clear();
        steps_.clear();
        scalars_.clear();
        points_.clear();
    }
    void step(const estim::Transition<N>& phi) override {
        order_.push_back(Kind::Step);
        steps_.push_back(phi);
    }
    void scalar(const estim::ScalarUpdate<N>& u) override {
        order_.push_back(Kind::Scalar);
        scalars_.push_back(u);
    }
    void output(const InertialFilter<Frame, N>& filter, Time time) override {
        order_.push_back(Kind::Output);
        points_.push_back({filter, time, OutageEpoch{}, LocalMeasurement{}});
    }
    void outage_epoch(const InertialFilter<Frame, N>& filter, const Event& event, const LocalMeasurement& m, const AidRecord&) override {
        order_.push_back(Kind::Outage);
        OutageEpoch epoch;
        epoch.outage = event.outage;
        epoch.time = event.stamp;
        epoch.end = event.outage_end;
        points_.push_back({filter, filter.time(), epoch, m});
    }

    /// Steps back over the tape; `report(Kind, point, smoothed nav, smoothed covariance, smoothed error)` for each point.
    template <class Report>
    void rewind(const InertialModel<N>& model, estim::Adjoint<N>& adjoint, Report&& report) const;

private:
    std::vector<Kind> order_;
    std::vector<estim::Transition<N>> steps_;
    std::vector<estim::ScalarUpdate<N>> scalars_;
    std::vector<Point> points_;
};

template <class Frame, int N>
template <class Report>
void Tape<Frame, N>::rewind(const InertialModel<N>& model, estim::Adjoint<N>& adjoint, Report&& report) const {
    std::size_t step = steps_.size(), scalar = scalars_.size(), point = points_.size();
    for (std::size_t i = order_.size(); i-- > 0;) {
        switch (order_[i]) {
            case Kind::Step: {
                const estim::Transition<N>& phi = steps_[--step];
                adjoint.lambda = phi.transpose_times(adjoint.lambda);
                estim::propagate_adjoint<N>(adjoint.Lambda, phi, model.sparsity);
                break;
            }
            case Kind::Scalar: adjoint.undo(scalars_[--scalar]); break;
            case Kind::Output:
            case Kind::Outage: report(order_[i], points_[--point], adjoint); break;
        }
    }
}

/// The smoothed counterpart of a filter state: nominal corrected by -P lambda, covariance P - P Lambda P.
template <class Frame, int N>
void smooth_in_place(const InertialModel<N>& model, InertialFilter<Frame, N>& filter, const estim::Adjoint<N>& adjoint,
                     bool whole_covariance) {
    using Matrix = Eigen::Matrix<double, N, N>;
    const Eigen::Matrix<double, N, 1> dx = -(filter.P * adjoint.lambda);
    if (whole_covariance) {
        Matrix LP;
        LP.noalias() = adjoint.Lambda * filter.P;
        const Matrix P = filter.P;
        filter.P.noalias() -= P * LP;
    } else {
        Eigen::Matrix<double, N, 9> LP;
        LP.noalias() = adjoint.Lambda * filter.P.template leftCols<9>();
        const Matrix9 part = filter.P.template topRows<9>() * LP;
        filter.P.template topLeftCorner<9, 9>() -= part;
    }
    filter.apply(model, dx);
}

}  // namespace schuler::fusion
