// Rates between two carrier phases: the change of a range between the antenna positions at two epochs. The first position is a clone
// of the states at that time, so that exactly the information about the displacement between the two is used [RoumeliotisBurdick2002].
#include "schuler/filter/update/range_update.h"

#include <cmath>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

/// Acceleration of a satellite relative to the Earth, m/s^2, to 1e-3.
Vector3d orbital_acceleration(const earth::Ellipsoid& e, const Vector3d& r, const Vector3d& v) {
    const Vector3d w(0.0, 0.0, e.w_ie);
    return -e.gm / std::pow(r.norm(), 3) * r - 2.0 * w.cross(v) - w.cross(w.cross(r));
}

}  // namespace

template <class Frame>
bool RangeUpdate<Frame>::spans_phases(const InertialFilter<Frame>& f, const RangeTracking& tracking, const RangeSample& m) const {
    constexpr double rounding = 1e-6;  // s
    return !backward_ && model_.layout.antenna >= 0 && tracking.cloned &&
           std::abs((f.time() - *tracking.cloned).seconds() - m.phase_span) < rounding;
}

template <class Frame>
const RangeTracking::Phase* RangeUpdate<Frame>::phase_of(InertialFilter<Frame>& f, RangeTracking& tracking, const RangeSample& m,
                                                         RangeListener* listener) const {
    const Layout& L = model_.layout;
    if (L.phase < 0 || !(m.phase_std > 0.0)) return nullptr;
    constexpr double tolerance = 1e-3;  // s
    const auto carriers = std::span(tracking.phases).first(static_cast<std::size_t>(L.phases));
    auto found = std::ranges::find(carriers, static_cast<int>(m.source), &RangeTracking::Phase::source);
    if (found == carriers.end())  // older than one interval: no longer in use
        found = std::ranges::find_if(carriers, [&](const RangeTracking::Phase& p) {
            return p.source < 0 || (f.time() - p.last).seconds() > m.phase_span + tolerance;
        });
    if (found == carriers.end()) return nullptr;
    RangeTracking::Phase& p = *found;
    if (p.source == m.source && p.last == f.time()) return &p;  // relinearised
    const bool goes_on =
        m.phase_goes_on && p.source == m.source && std::abs((f.time() - p.last).seconds() - m.phase_span) < tolerance;
    const int first = L.phase + 2 * static_cast<int>(found - carriers.begin());
    const Ecef unknown{Vector3d::Constant(RangeSample::none)};
    p = {m.source, f.time(), goes_on ? p.begin : first, goes_on ? p.end : first + 1, m.tx, goes_on ? p.tx_end : unknown};
    const double variance = m.phase_std * m.phase_std;
    renew(f, tracking, p.end, variance, listener);
    if (!goes_on) renew(f, tracking, p.begin, variance, listener);
    return &p;
}

template <class Frame>
typename RangeUpdate<Frame>::PhaseRate RangeUpdate<Frame>::phase_rate(const InertialFilter<Frame>& f, const AntennaEstimate& a,
                                                                      const RangeRows& now, const RangeSample& m,
                                                                      const RangeTracking::Phase* phase,
                                                                      const StateVector& dx) const {
    const double span = m.phase_span;
    Ecef from;
    if (phase != nullptr && phase->tx_begin.r.allFinite()) {
        from = phase->tx_begin;
    } else {
        // accurate to a micrometre over an interval of 0.2 s, to a tenth of a millimetre over a second; a transmitter that recedes sent
        // the two phases closer together than they arrived
        const double sent = span * (1.0 - now.rate / gnss::speed_of_light);
        const Vector3d acceleration = orbital_acceleration(model_.earth.ellipsoid, m.tx.r, m.tx_velocity);
        from.r = m.tx.r - sent * m.tx_velocity + 0.5 * sent * sent * acceleration;
    }
    const int clone = model_.layout.antenna;
    AntennaEstimate begin = a;  // current axes
    begin.r_e = f.parameters.template segment<3>(clone) - f.error.template segment<3>(clone) - dx.segment<3>(clone);
    const RangeRows then = range_rows(begin, from, m.tx_velocity);
    const Vector3d u_e = a.C_en * then.u_n;
    return {(now.range - then.range) / span, now.range_by_position / span, now.range_by_attitude / span,
            now.range_by_lever_arm / span, -u_e / span};
}

template <class Frame>
void RangeUpdate<Frame>::clone_antenna(InertialFilter<Frame>& f, RangeTracking& tracking, RangeListener* listener) const {
    const Layout& L = model_.layout;
    if (L.antenna < 0) return;
    const AntennaEstimate a = antenna(f, StateVector::Zero(f.P.rows()), 1.0);
    const Matrix9 from_local = local_rows(f.geographic(model_));
    std::array<estim::Row, 3> rows;
    for (int k = 0; k < 3; ++k) {
        estim::Row& row = rows[static_cast<std::size_t>(k)];
        const Vector3d u_n = a.C_en.row(k).transpose();
        row.head << u_n, Vector3d::Zero(), u_n.cross(a.l_n);
        row.head = (from_local * row.head).eval();
        if (L.lever_arm >= 0) row.add3(L.lever_arm, a.C_nb.transpose() * u_n);
    }
    f.clone(L.antenna, rows, a.r_e);
    tracking.watch.clone(L.antenna, rows, f.used);
    if (listener != nullptr) listener->cloned(L.antenna, rows);
    tracking.cloned = f.time();
    tracking.cloned_velocity = a.v_e;
}

template bool RangeUpdate<GeographicFrame>::spans_phases(const InertialFilter<GeographicFrame>&, const RangeTracking&,
                                                         const RangeSample&) const;
template bool RangeUpdate<EarthFixedFrame>::spans_phases(const InertialFilter<EarthFixedFrame>&, const RangeTracking&,
                                                         const RangeSample&) const;
template const RangeTracking::Phase* RangeUpdate<GeographicFrame>::phase_of(InertialFilter<GeographicFrame>&, RangeTracking&,
                                                                            const RangeSample&, RangeListener*) const;
template const RangeTracking::Phase* RangeUpdate<EarthFixedFrame>::phase_of(InertialFilter<EarthFixedFrame>&, RangeTracking&,
                                                                            const RangeSample&, RangeListener*) const;
template RangeUpdate<GeographicFrame>::PhaseRate RangeUpdate<GeographicFrame>::phase_rate(const InertialFilter<GeographicFrame>&,
                                                                                          const AntennaEstimate&,
                                                                                          const RangeRows&, const RangeSample&,
                                                                                          const RangeTracking::Phase*,
                                                                                          const StateVector&) const;
template RangeUpdate<EarthFixedFrame>::PhaseRate RangeUpdate<EarthFixedFrame>::phase_rate(const InertialFilter<EarthFixedFrame>&,
                                                                                          const AntennaEstimate&,
                                                                                          const RangeRows&, const RangeSample&,
                                                                                          const RangeTracking::Phase*,
                                                                                          const StateVector&) const;
template void RangeUpdate<GeographicFrame>::clone_antenna(InertialFilter<GeographicFrame>&, RangeTracking&, RangeListener*) const;
template void RangeUpdate<EarthFixedFrame>::clone_antenna(InertialFilter<EarthFixedFrame>&, RangeTracking&, RangeListener*) const;

}  // namespace schuler::filter
