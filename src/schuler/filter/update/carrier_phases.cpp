// Carrier phases relative to a base station: ambiguities as states, slips by the inertial prediction, integers told to the filter.
// The receiver's clock of the phases is reset at each epoch, which makes single differences equivalent to double differences.
#include "schuler/core/units.h"
#include "schuler/filter/update/range_update.h"
#include "schuler/gnss/satellite.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace schuler::filter {

using Eigen::Vector3d;
using gnss::speed_of_light;

namespace {

constexpr double unknown_ambiguity = 30.0;  // m, one sigma about that by which an arc's phase begins as its code
constexpr double carrier_clock = 10.0;      // m, of the phases' clock relative to that of the codes

using Ambiguity = RangeTracking::Ambiguity;

/// Carriers of one system whose ambiguities differ by whole cycles.
int group_of(const RangingLog& log, const CarrierSample& c) { return 8 * log.sources[c.source].name.front() + c.carrier; }

}  // namespace

template <class Frame>
void RangeUpdate<Frame>::begin_ambiguity(InertialFilter<Frame>& f, RangeTracking& tracking, int which, double more,
                                         RangeListener* listener) const {
    Ambiguity& a = tracking.ambiguities[static_cast<std::size_t>(which)];
    a.used.reset();
    a.trusted = a.held = false;
    a.integer = RangeSample::none;
    renew(f, tracking, model_.layout.ambiguity + which, unknown_ambiguity * unknown_ambiguity + more * more, listener);
}

template <class Frame>
int RangeUpdate<Frame>::ambiguity_of(InertialFilter<Frame>& f, RangeTracking& tracking, const CarrierSample& c,
                                     RangeListener* listener) const {
    const auto all = std::span(tracking.ambiguities).first(static_cast<std::size_t>(model_.layout.ambiguities));
    auto found = std::ranges::find_if(all, [&](const Ambiguity& a) { return a.source == c.source && a.carrier == c.carrier; });
    const bool known = found != all.end();
    if (!known) found = std::ranges::find(all, -1, &Ambiguity::source);
    if (found == all.end()) {  // the one longest unseen
        found = std::ranges::max_element(all, {}, [&](const Ambiguity& a) { return std::abs((f.time() - a.seen).seconds()); });
        if (found->seen == f.time()) return -1;
    }
    Ambiguity& a = *found;
    const int which = static_cast<int>(found - all.begin());
    if (!known || a.arc != c.arc) {
        a = {};
        a.source = c.source;
        a.carrier = c.carrier;
        a.arc = c.arc;
        begin_ambiguity(f, tracking, which, 0.0, listener);
    } else {
        // Reflections change a phase by its sigma within the correlation time: a wander of the ambiguity. Neighbouring epochs err alike,
        // so that their difference, a velocity, is known well and their mean no better than one of them.
        const double wander = settings_.phase_correlation > 0.0 ? 2.0 * c.variance / settings_.phase_correlation : 0.0;
        const int state = model_.layout.ambiguity + which;
        f.P(state, state) +=
            (settings_.ambiguity_walk * settings_.ambiguity_walk + wander) * std::abs((f.time() - a.seen).seconds());
    }
    a.seen = f.time();
    return which;
}

template <class Frame>
void RangeUpdate<Frame>::make_carriers(const InertialFilter<Frame>& f, RangeTracking& tracking, const RangingLog& log,
                                       const RangeEpoch& epoch, const std::array<int, RangeEpochWork::most>& assigned) const {
    const Layout& L = model_.layout;
    const AntennaEstimate a = antenna(f, StateVector::Zero(f.P.rows()), backward_ ? -1.0 : 1.0);
    const Matrix9 from_local = local_rows(f.geographic(model_));
    const auto nominal = [&](int i) { return f.parameters(i) - f.error(i); };
    RangeEpochWork& work = tracking.work;
    const auto samples = log.of(epoch);
    const auto carriers = log.carriers_of(epoch);
    work.count = 0;
    for (std::size_t k = 0; k < std::min(carriers.size(), RangeEpochWork::most); ++k) {
        const CarrierSample& c = carriers[k];
        const auto m = std::ranges::find(samples, c.source, &RangeSample::source);
        if (assigned[k] < 0 || m == samples.end()) continue;
        const Vector3d velocity = m->tx_velocity.allFinite() ? m->tx_velocity : Vector3d(Vector3d::Zero());
        const RangeRows now = range_rows(a, m->tx, velocity);
        const double clock = nominal(L.clock);
        const int state = L.ambiguity + assigned[k];
        RangeScalar& s = work.scalars[work.count++];
        s = {};
        s.source = c.source;
        s.slot = assigned[k];
        s.distance = now.range;
        s.variance = c.variance;
        s.row.head << now.range_by_position, Vector3d::Zero(), now.range_by_attitude;
        s.row.head = (from_local * s.row.head).eval();
        if (L.lever_arm >= 0) s.row.add3(L.lever_arm, now.range_by_lever_arm);
        s.row.add(L.clock, 1.0 - now.own_rate / speed_of_light);
        s.row.add(L.carrier_clock, 1.0);
        s.row.add(state, 1.0);
        s.innovation = now.range - now.own_rate * clock / speed_of_light + clock - speed_of_light * m->tx_clock +
                       nominal(L.carrier_clock) + nominal(state) - c.phase;
    }
}

template <class Frame>
void RangeUpdate<Frame>::find_integers(InertialFilter<Frame>& f, RangeTracking& tracking, const RangingLog& log,
                                       const RangeEpoch& epoch, RangeListener* listener, CarrierUse& use) const {
    constexpr int often = 2;
    constexpr double span = 2.0, same = 0.02, held_sigma = 0.01;  // s, m, m
    std::array<FloatAmbiguity, Layout::most_ambiguities> floats;
    std::array<int, Layout::most_ambiguities> which;
    std::size_t n = 0;
    for (const CarrierSample& c : log.carriers_of(epoch)) {
        const auto found = std::ranges::find_if(tracking.ambiguities, [&](const Ambiguity& a) {
            return a.source == c.source && a.carrier == c.carrier && a.used && *a.used == f.time();
        });
        if (!c.whole || found == tracking.ambiguities.end() || n == floats.size()) continue;
        const bool halves = c.halves || found->jumped;
        which[n] = static_cast<int>(found - tracking.ambiguities.begin());
        floats[n++] = {c.source, c.carrier,   group_of(log, c),        (halves ? 0.5 : 1.0) * c.wavelength,
                       halves,   c.elevation, c.variance + c.repeated, found->trusted};
    }
    use.whole = static_cast<int>(n);
    const auto size = static_cast<Eigen::Index>(n);
    AmbiguityVector x(size);
    AmbiguityMatrix P(size, size);
    const auto state = [&](Eigen::Index i) { return model_.layout.ambiguity + which[static_cast<std::size_t>(i)]; };
    for (Eigen::Index i = 0; i < size; ++i) {
        x(i) = f.parameters(state(i)) - f.error(state(i));
        for (Eigen::Index j = 0; j < size; ++j) P(i, j) = f.P(state(i), state(j));
    }
    FoundIntegers found;
    settings_.integers->search(std::span(floats).first(n), x, P, found);
    use.ratio = found.ratio;
    const auto of = [&](Eigen::Index i) -> Ambiguity& {
        return tracking.ambiguities[static_cast<std::size_t>(which[static_cast<std::size_t>(i)])];
    };
    bool changed = !found.found || !found.all, compared = false;
    for (Eigen::Index i = 0; i < size && found.found; ++i) of(i).trusted = std::isfinite(found.value(i));
    for (Eigen::Index i = 0; i < size && !changed; ++i) {  // against the first of the group with both an old and a new integer
        if (!of(i).trusted || !std::isfinite(of(i).integer)) continue;
        for (Eigen::Index j = 0; j < i; ++j) {
            if (floats[static_cast<std::size_t>(j)].group != floats[static_cast<std::size_t>(i)].group || !of(j).trusted ||
                !std::isfinite(of(j).integer))
                continue;
            compared = true;
            changed = changed || std::abs((found.value(i) - found.value(j)) - (of(i).integer - of(j).integer)) > same;
            break;
        }
    }
    if (found.found && found.all)
        for (Eigen::Index i = 0; i < size; ++i)
            if (of(i).trusted) of(i).integer = found.value(i);
    if (changed || !compared) {
        tracking.same_integers = 0;
        tracking.same_since = f.time();
    } else {
        ++tracking.same_integers;
    }
    const bool certain =
        !changed && tracking.same_integers >= often && std::abs((f.time() - tracking.same_since).seconds()) >= span;
    if (certain) {
        StateVector dx = StateVector::Zero(f.P.rows());
        for (Eigen::Index i = 0; i < size; ++i) {
            if (!of(i).trusted) continue;
            Eigen::Index first = 0;
            while (first < i && !(of(first).trusted &&
                                  floats[static_cast<std::size_t>(first)].group == floats[static_cast<std::size_t>(i)].group))
                ++first;
            of(i).held = true;
            if (first == i) continue;
            estim::Row row;
            row.add(state(i), 1.0);
            row.add(state(first), -1.0);
            const double variance = row.dot(row.times(f.P, f.used));
            if (variance < held_sigma * held_sigma) continue;
            const double z = (x(i) - x(first)) - (found.value(i) - found.value(first));
            const estim::RowUpdate u = estim::update(dx, f.P, row, z, held_sigma * held_sigma, f.used);
            if (listener != nullptr) listener->scalar(u);
        }
        f.apply(model_, dx);
    }
    for (Eigen::Index i = 0; i < size; ++i) use.held += of(i).held ? 1 : 0;
}

/// Number of phases that would have to be left out for the rest to agree with each other and with the prediction.
template <class Frame>
int RangeUpdate<Frame>::misfits(const InertialFilter<Frame>& f, RangeEpochWork& work) const {
    estim::EpochUpdate update(f.P, f.used);
    StateVector dx = StateVector::Zero(f.P.rows());
    int count = 0;
    while (leave_out_worst(f, work)) {
        ++count;
        if (use_all(test_, update, work, dx, nullptr) || 2 * count > static_cast<int>(work.count)) break;
    }
    return count;
}

/// Opens position, velocity and attitude by what the phases differ from the prediction beyond what they have in common.
template <class Frame>
void RangeUpdate<Frame>::doubt_prediction(InertialFilter<Frame>& f, const RangeTracking& tracking,
                                          const RangeEpochWork& work) const {
    double sum = 0.0, count = 0.0, size = 0.0, since = std::numeric_limits<double>::infinity();
    const auto known = [&](const RangeScalar& s) {  // one that has just begun says nothing
        return tracking.ambiguities[static_cast<std::size_t>(s.slot)].used;
    };
    for (const RangeScalar& s : work.all())
        if (known(s)) sum += s.innovation, count += 1.0;
    for (const RangeScalar& s : work.all()) {
        const auto used = known(s);
        if (!used) continue;
        size = std::max(size, std::abs(s.innovation - sum / count));
        since = std::min(since, std::abs((f.time() - *used).seconds()));
    }
    constexpr double least_time = 0.1;  // s
    const double time = std::max(std::isfinite(since) ? since : 1.0, least_time), rate = 2.0 * size / time;
    // a knock turns the unit too: by what would have moved it that far, within a tenth of a radian
    const double turn = std::min(rate / (units::g0 * time), 0.1);
    f.P.diagonal().template segment<3>(Layout::position).array() += 4.0 * size * size;
    f.P.diagonal().template segment<3>(Layout::velocity).array() += rate * rate;
    f.P.diagonal().template segment<3>(Layout::attitude).array() += turn * turn;
}

template <class Frame>
CarrierUse RangeUpdate<Frame>::use_carriers(InertialFilter<Frame>& f, RangeTracking& tracking, const RangingLog& log,
                                            const RangeEpoch& epoch, RangeListener* listener) const {
    static const RangeTest open(0.0, 0.0);
    CarrierUse out;
    const auto carriers = log.carriers_of(epoch);
    const std::size_t count = std::min(carriers.size(), RangeEpochWork::most);
    std::array<int, RangeEpochWork::most> assigned{};
    for (std::size_t k = 0; k < count; ++k) assigned[k] = ambiguity_of(f, tracking, carriers[k], listener);
    renew(f, tracking, model_.layout.carrier_clock, carrier_clock * carrier_clock, listener);
    RangeEpochWork& work = tracking.work;
    const int excluded = work.excluded;
    StateVector dx = StateVector::Zero(f.P.rows());
    estim::EpochUpdate update(f.P, f.used);
    make_carriers(f, tracking, log, epoch, assigned);
    // Those that do not fit begin anew. Where several satellites' do not, it is the prediction that is doubted first: their arcs were
    // tested before against each other, while an inertial unit that was knocked may be off by a metre. The phases then tell where
    // the antenna is, and which of them have slipped after all.
    if (!use_all(test_, update, work, dx, nullptr)) {
        constexpr int of_one_satellite = 3;
        if (misfits(f, work) > of_one_satellite) {
            doubt_prediction(f, tracking, work);
            ++out.doubted;
            make_carriers(f, tracking, log, epoch, assigned);
        } else {
            for (RangeScalar& s : work.all()) s.use = true;
        }
        while (!use_all(test_, update, work, dx, nullptr)) {
            if (!leave_out_worst(f, work)) break;
            const bool most = 2 * ++out.slipped > static_cast<int>(work.count);
            for (RangeScalar& s : work.all()) {
                if (s.use && !most) continue;
                begin_ambiguity(f, tracking, s.slot, s.innovation, listener);
                tracking.ambiguities[static_cast<std::size_t>(s.slot)].jumped = true;
            }
            make_carriers(f, tracking, log, epoch, assigned);
            if (most) break;
        }
    }
    work.excluded = excluded;
    for (const RangeScalar& s : work.all()) tracking.ambiguities[static_cast<std::size_t>(s.slot)].used = f.time();
    (void)use_all(open, update, work, dx, listener);
    update.apply(f.P);
    f.apply(model_, dx);
    out.phases = static_cast<int>(work.count);
    if (settings_.integers && out.phases > 0) find_integers(f, tracking, log, epoch, listener, out);
    return out;
}

template int RangeUpdate<GeographicFrame>::ambiguity_of(InertialFilter<GeographicFrame>&, RangeTracking&, const CarrierSample&,
                                                        RangeListener*) const;
template int RangeUpdate<EarthFixedFrame>::ambiguity_of(InertialFilter<EarthFixedFrame>&, RangeTracking&, const CarrierSample&,
                                                        RangeListener*) const;
template CarrierUse RangeUpdate<GeographicFrame>::use_carriers(InertialFilter<GeographicFrame>&, RangeTracking&,
                                                               const RangingLog&, const RangeEpoch&, RangeListener*) const;
template CarrierUse RangeUpdate<EarthFixedFrame>::use_carriers(InertialFilter<EarthFixedFrame>&, RangeTracking&,
                                                               const RangingLog&, const RangeEpoch&, RangeListener*) const;

}  // namespace schuler::filter
