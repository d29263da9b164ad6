#include "schuler/study/covariance/range_errors.h"

#include "schuler/filter/states/model.h"

namespace schuler::study {

RangeErrors::RangeErrors(const filter::Layout& layout, const Filter& filter)
    : first_(layout.clock), S_(filter::StateMatrix::Zero(filter.P.rows(), filter.P.cols())) {
    const Eigen::Index n = S_.rows() - first_;
    S_.bottomRightCorner(n, n) = filter.P.bottomRightCorner(n, n);
}

void RangeErrors::step(const filter::InertialModel& model, const Filter& filter, const estim::Transition& phi, double span) {
    estim::propagate(S_, phi, static_cast<int>(S_.rows()));
    const filter::Layout& L = model.layout;
    const Eigen::Index n = S_.rows() - first_;
    S_.diagonal().tail(n) += filter.cached_q.tail(n);
    const double drift = model.drift_psd * span;
    S_(L.clock, L.clock) += model.clock_psd * span + drift * span * span / 3.0;
    S_(L.drift, L.drift) += drift;
    S_(L.clock, L.drift) += 0.5 * drift * span;
    S_(L.drift, L.clock) = S_(L.clock, L.drift);
}

void RangeErrors::renewed(int state, double variance) {
    S_.row(state).setZero();
    S_.col(state).setZero();
    if (state >= first_) S_(state, state) = variance;
}

void RangeErrors::correct(const estim::RowUpdate& u, bool of_range) {
    // (I - k h) S (I - k h)^T + k r k^T, with r = s (1 - h k)
    const filter::StateVector Sh = u.h.times(S_, static_cast<int>(S_.rows()));
    const double seen = u.h.dot(Sh) + (of_range ? u.s * (1.0 - u.h.dot(u.k)) : 0.0);
    S_ += -u.k * Sh.transpose() - Sh * u.k.transpose() + seen * u.k * u.k.transpose();
}

}  // namespace schuler::study
