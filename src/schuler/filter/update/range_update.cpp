#include "schuler/filter/update/range_update.h"

#include "schuler/gnss/ground_range.h"
#include "schuler/math/chi_square.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::filter {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using gnss::speed_of_light;

RangeTest::RangeTest(double probability, double recovery_time_) : recovery_time(recovery_time_) {
    const auto limit = [&](double dof) {
        return probability > 0.0 ? math::chi_square_quantile(1.0 - probability, dof) : std::numeric_limits<double>::infinity();
    };
    single = limit(1.0);
    whole[0] = std::numeric_limits<double>::infinity();
    for (std::size_t n = 1; n < whole.size(); ++n) whole[n] = limit(static_cast<double>(n));
}

int intersystem_of(const RangeSource& source) {
    if (source.station || source.name.empty()) return -1;
    switch (source.name.front()) {
        case 'R': return 0;
        case 'E': return 1;
        case 'C': return 2;
        default: return -1;
    }
}

/// Sigma of the white part of a pseudorange or rate.
template <class Frame>
double RangeUpdate<Frame>::sigma_of(double stated, double model_sigma, bool station, double elevation, double cn0) const {
    if (stated > 0.0) return stated;
    return station || !settings_.sigma_by_elevation ? model_sigma : model_sigma * gnss::noise_factor(elevation, cn0);
}

template <class Frame>
Matrix9 RangeUpdate<Frame>::local_rows(const NavState& nav) const {
    if constexpr (Frame::errors_are_geographic) return Matrix9::Identity();
    else return ins::geographic_from_ecef_errors(model_.earth, nav).transpose();
}

template <class Frame>
AntennaEstimate RangeUpdate<Frame>::antenna(const InertialFilter<Frame>& f, const StateVector& dx, double way) const {
    const Layout& L = model_.layout;
    earth::Earth turning = model_.earth;
    turning.ellipsoid.w_ie *= way;
    NavState nav = Frame::geographic(model_.earth, Frame::corrected(model_.earth, f.estimated(model_), dx.head<9>()));
    nav.v_eb_n *= way;
    const Vector3d w_ib_b = f.w_ib_b + f.error.template segment<3>(Layout::gyro_bias) + dx.segment<3>(Layout::gyro_bias);
    const auto nominal = [&](int i) { return f.parameters(i) - f.error(i) - dx(i); };
    const Vector3d lever_arm =
        L.lever_arm < 0 ? lever_arm_b_ : Vector3d(nominal(L.lever_arm), nominal(L.lever_arm + 1), nominal(L.lever_arm + 2));
    return antenna_of(turning, nav, nav.q_nb.toRotationMatrix(), way * w_ib_b, lever_arm,
                      f.uncertain_rate(f.rate_variance(model_)), heading_unknown(f.heading_variance(model_)));
}

template <class Frame>
void RangeUpdate<Frame>::make_scalars(InertialFilter<Frame>& f, RangeTracking& tracking, const RangingLog& log,
                                      std::span<const RangeSample> samples, const StateVector& dx,
                                      RangeListener* listener) const {
    const Layout& L = model_.layout;
    const earth::Earth& earth = model_.earth;
    const double way = backward_ ? -1.0 : 1.0;  // direction of the filter's time in that of the ranges
    const Time time = (backward_ ? Time{-f.time().ns} : f.time()) + log.to_gps;
    const auto nominal = [&](int i) { return f.parameters(i) - f.error(i) - dx(i); };  // states are renewed below
    const NavState nav = Frame::geographic(earth, Frame::corrected(earth, f.estimated(model_), dx.head<9>()));
    const AntennaEstimate a = antenna(f, dx, way);
    const Matrix9 from_local = local_rows(nav);
    const auto navigation = [&](estim::Row& row, const Vector3d& position, const Vector3d& velocity, const Vector3d& attitude) {
        row.head << position, velocity, attitude;
        if constexpr (!Frame::errors_are_geographic) row.head = (from_local * row.head).eval();
    };
    RangeEpochWork& work = tracking.work;
    const bool air = settings_.corrections.troposphere != gnss::TroposphereModel::None ||
                     settings_.corrections.ionosphere == gnss::IonosphereModel::Broadcast;
    work.count = 0;
    for (const RangeSample& m : samples) {
        const RangeSource& source = log.sources[m.source];
        if (!m.tx.r.allFinite() || (source.station && !settings_.use_stations) || work.count + 2 > RangeEpochWork::most) continue;
        const Vector3d velocity = m.tx_velocity.allFinite() ? m.tx_velocity : Vector3d(Vector3d::Zero());
        const RangeRows now = range_rows(a, m.tx, velocity);
        // u points down to the receiver: a signal from above has a positive down component
        const bool delayed = air && !source.station && !m.differential;
        const gnss::Direction direction{delayed ? std::atan2(-now.u_n.y(), -now.u_n.x()) : 0.0,
                                        std::asin(std::clamp(now.u_n.z(), -1.0, 1.0))};
        if (!source.station && direction.elevation < settings_.corrections.elevation_mask) continue;
        const double clock = nominal(L.clock), drift = way * nominal(L.drift);
        gnss::AtmosphericDelay air_delay;
        if (delayed)
            air_delay = gnss::atmospheric_delay(time, gnss::system_from_letter(source.name.front()).value_or(gnss::System::Gps),
                                                m.frequency, a.place, direction,
                                                settings_.ionosphere ? &*settings_.ionosphere : nullptr, settings_.corrections);
        const sensor::RangeErrorModel& errors = errors_of(source.station);
        const bool by_model = settings_.slow_by_model && !source.station;
        // multipath varies over tens of seconds and more: noise for a single fix, but a filter would average it
        const double reflections =
            by_model ? settings_.corrections.code_sigma * m.noise * gnss::noise_factor(direction.elevation, m.cn0) : 0.0;
        const double slow_sigma =
            by_model ? std::sqrt(air_delay.variance + m.variance + reflections * reflections) : errors.correlated;
        // reflections change within a minute, air and orbits in ten: one state that changes as the sum of both
        const double slow_time = by_model && reflections > 0.0 && settings_.code_correlation > 0.0
                                     ? slow_sigma * slow_sigma /
                                           ((slow_sigma * slow_sigma - reflections * reflections) / errors.correlation_time +
                                            reflections * reflections / settings_.code_correlation)
                                     : errors.correlation_time;
        const int assigned = slot_of(f, tracking, m.source, source.station, slow_sigma, slow_time, listener),
                  offset = intersystem_of(source);
        if (assigned >= 0) tracking.slots[static_cast<std::size_t>(assigned)].last = f.time();
        const int slot = assigned >= 0 && errors.correlated > 0.0 ? L.source + assigned : -1;
        const int slow_rate = assigned >= 0 && has_slow_rate(source.station) ? L.source_rate + assigned : -1;

        const auto next = [&](bool is_rate) -> RangeScalar& {
            RangeScalar& s = work.scalars[work.count++];  // may contain data of another epoch
            s.source = m.source;
            s.station = source.station;
            s.is_rate = is_rate;
            s.use = true;
            s.phase_change = false;
            s.slot = slot;
            s.distance = now.range;
            s.sequential = 0.0;
            s.s = 1.0;
            s.row.count = 0;
            return s;
        };
        if (std::isfinite(m.pseudorange)) {
            // the residual of the models belongs to the slow error, if that is a state
            double delay = air_delay.delay, more = by_model && slot >= 0 ? 0.0 : m.variance;
            if (delayed) {
                if (slot < 0) more += air_delay.variance;
            } else if (source.station && settings_.corrections.troposphere != gnss::TroposphereModel::None) {
                delay = gnss::ground_range_delay(earth::geodetic_from_ecef(earth.ellipsoid, m.tx), a.place, now.range);
            }
            RangeScalar& s = next(false);
            // Measured when the receiver's clock showed the tag, that is, bias/c earlier, at another place. The transmitter's is that of
            // the transmission, whatever the clock.
            const double computed = now.range - now.own_rate * clock / speed_of_light + clock - speed_of_light * m.tx_clock +
                                    delay +
                                    (source.station ? nominal(L.network)
                                     : offset >= 0  ? nominal(L.intersystem + offset)
                                                    : 0.0) +
                                    (slot >= 0 ? nominal(slot) : 0.0);
            const double sigma = sigma_of(m.std, errors.white * m.noise, source.station, direction.elevation, m.cn0);
            s.variance = sigma * sigma + more;
            navigation(s.row, now.range_by_position, Vector3d::Zero(), now.range_by_attitude);
            if (L.lever_arm >= 0) s.row.add3(L.lever_arm, now.range_by_lever_arm);
            s.row.add(L.clock, 1.0 - now.own_rate / speed_of_light);
            if (source.station) s.row.add(L.network, 1.0);
            else if (offset >= 0) s.row.add(L.intersystem + offset, 1.0);
            if (slot >= 0) s.row.add(slot, 1.0);
            s.innovation = computed - m.pseudorange + s.row.dot(dx);
        }
        const bool by_phase = m.phase_span > 0.0 && spans_phases(f, tracking, m);
        const double measured = m.phase_span > 0.0 && !by_phase ? m.doppler_rate : m.range_rate;
        if (settings_.use_rates && std::isfinite(measured) && (m.tx_velocity.allFinite() || source.station)) {
            const RangeTracking::Phase* phase = by_phase ? phase_of(f, tracking, m, listener) : nullptr;
            RangeScalar& s = next(true);
            const bool of_log = by_phase && !(m.std_rate > 0.0);
            const double sigma = of_log
                                     ? settings_.phase_change_std / m.phase_span * gnss::noise_factor(direction.elevation, m.cn0)
                                     : sigma_of(m.std_rate, errors.rate, source.station, direction.elevation, m.cn0);
            s.variance = sigma * sigma;
            s.phase_change = of_log;
            if (of_log) {  // an epoch whose stamp is late by the IMU's clock is elsewhere on the path
                const Vector3d turned = (a.v_e - tracking.cloned_velocity) / m.phase_span * timing_std_;
                s.variance += std::pow((a.C_en * now.u_n).dot(turned), 2);
            }
            double rate = now.rate, of_phase = 0.0;
            if (by_phase) {
                const PhaseRate r = phase_rate(f, a, now, m, phase, dx);
                rate = r.rate;
                navigation(s.row, r.by_position, Vector3d::Zero(), r.by_attitude);
                if (L.lever_arm >= 0) s.row.add3(L.lever_arm, r.by_lever_arm);
                s.row.add3(L.antenna, r.by_clone);
            } else {
                // Rates also depend on position, by 0.1 to 0.2 mm/s per metre: with slowly varying rate errors of a few mm/s
                // (atmosphere, orbit, tracking), not covered by white noise, a hundred epochs would shift the position by metres.
                const Vector3d by_position = by_model ? Vector3d(Vector3d::Zero()) : now.rate_by_position;
                navigation(s.row, by_position, way * now.rate_by_velocity, now.rate_by_attitude);
                if (L.lever_arm >= 0) s.row.add3(L.lever_arm, now.rate_by_lever_arm);
                s.row.add3(Layout::gyro_bias, way * now.rate_by_gyro_bias);
            }
            if (phase != nullptr) {
                const double per_span = 1.0 / m.phase_span;
                s.row.add(phase->end, per_span);
                s.row.add(phase->begin, -per_span);
                of_phase = (nominal(phase->end) - nominal(phase->begin)) * per_span;
                s.variance *= unshared;
            }
            s.row.add(L.drift, way);
            if (L.rate_noise >= 0) s.row.add(L.rate_noise, way);
            const double common = L.rate_noise >= 0 ? way * nominal(L.rate_noise) : 0.0;
            double slow = 0.0;
            if (slow_rate >= 0) {  // as the receiver measures it, in either direction of the filter's time
                s.row.add(slow_rate, 1.0);
                slow = nominal(slow_rate);
            } else if (has_slow_rate(source.station)) {
                s.variance += errors.correlated_rate * errors.correlated_rate;  // no slot is free
            }
            s.innovation = rate + drift + common + of_phase + slow - speed_of_light * m.tx_clock_rate - measured + s.row.dot(dx);
        }
    }
}

/// Repeats the sequential update with the scalars in use; false if a limit is exceeded.
template <class Frame>
bool RangeUpdate<Frame>::use_all(const RangeTest& test, estim::EpochUpdate& update, RangeEpochWork& work, StateVector& dx,
                                 RangeListener* listener) const {
    update.reset();
    for (const RangeScalar& s : work.all())
        if (s.use) update.add(s.row, s.innovation, s.variance);
    dx = update.solve();
    double sum = 0.0;
    int n = 0;
    bool good = true;
    for (RangeScalar& s : work.all()) {
        if (!s.use) continue;
        if (listener != nullptr) listener->scalar(update.result(s.row, n));
        s.s = update.s(n);
        s.sequential = update.innovation(n) / std::sqrt(s.s);
        const double square = s.sequential * s.sequential;
        sum += square;
        ++n;
        good = good && square <= test.single;
    }
    return good && sum <= test.whole[static_cast<std::size_t>(n)];
}

/// A jump common to all satellites' pseudoranges is due to the clock: opens its state. True if there was one.
template <class Frame>
bool RangeUpdate<Frame>::follow_clock_jump(InertialFilter<Frame>& f, const RangeEpochWork& work) const {
    const int clock = model_.layout.clock;
    std::array<double, RangeEpochWork::most> z;
    std::size_t n = 0;
    double noise = 0.0;
    for (const RangeScalar& s : work.all()) {
        if (s.is_rate || s.station) continue;
        z[n++] = s.innovation;
        noise = std::max(noise, s.variance);
    }
    if (n < 2) return false;
    const auto middle = z.begin() + static_cast<std::ptrdiff_t>(n / 2), end = z.begin() + static_cast<std::ptrdiff_t>(n);
    std::nth_element(z.begin(), middle, end);
    const double jump = *middle;
    const double sigma = std::sqrt(f.P(clock, clock) + f.P.diagonal().template head<3>().sum() + noise);
    const auto near = std::count_if(z.begin(), end, [&](double x) { return std::abs(x - jump) < 0.2 * std::abs(jump); });
    if (std::abs(jump) < 30.0 + 6.0 * sigma || 3 * static_cast<std::size_t>(near) < 2 * n) return false;
    f.P(clock, clock) += jump * jump;
    return true;
}

namespace {

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 64, 64>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 64, 1>;

}  // namespace

/// Excludes the scalar that disagrees most with all the others; false if none exceeds its limit.
template <class Frame>
bool RangeUpdate<Frame>::leave_out_worst(const InertialFilter<Frame>& f, RangeEpochWork& work) const {
    std::array<std::size_t, RangeEpochWork::most> index;
    Eigen::Index n = 0;
    for (std::size_t i = 0; i < work.count; ++i)
        if (work.scalars[i].use) index[static_cast<std::size_t>(n++)] = i;
    if (n == 0) return false;
    Square S(n, n);
    Column z(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const RangeScalar& a = work.scalars[index[static_cast<std::size_t>(i)]];
        const StateVector ph = a.row.times(f.P, f.used);
        for (Eigen::Index j = 0; j < n; ++j) S(i, j) = work.scalars[index[static_cast<std::size_t>(j)]].row.dot(ph);
        S(i, i) += a.variance;
        z(i) = a.innovation;
    }
    const Square inverse = S.llt().solve(Square::Identity(n, n));
    const Column w = inverse * z;
    double worst = test_.single;
    Eigen::Index which = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
        const double square = w(i) * w(i) / inverse(i, i);
        if (square <= worst) continue;
        worst = square;
        which = i;
    }
    if (which < 0 && z.dot(w) > test_.whole[static_cast<std::size_t>(n)]) {  // jointly too large, but none individually
        (w.array().square() / inverse.diagonal().array()).maxCoeff(&which);
    }
    if (which < 0) return false;
    work.scalars[index[static_cast<std::size_t>(which)]].use = false;
    ++work.excluded;
    return true;
}

/// True for a station so close that the range is not linear over the position uncertainty (math.md 5.3).
template <class Frame>
bool RangeUpdate<Frame>::is_curved(const InertialFilter<Frame>& f, const RangeEpochWork& work) const {
    const double spread = f.P.diagonal().template head<3>().sum();
    return std::ranges::any_of(work.all(), [&](const RangeScalar& s) {
        return !s.is_rate && spread / (2.0 * s.distance) > 0.1 * std::sqrt(s.variance);
    });
}

/// Persistently disagreeing sources: their slow error is opened so that they can be used and estimated again. With a fault watch,
/// a source that disagrees while most do not is faulty, and re-estimation would turn its fault into a slow error that is expected
/// to decay: it is returned, otherwise -1.
template <class Frame>
int RangeUpdate<Frame>::doubt_sources(InertialFilter<Frame>& f, RangeTracking& tracking) const {
    int wrong = -1, doubted = 0, all = 0;
    for (const RangeScalar& s : tracking.work.all()) {
        if (s.is_rate || s.slot < 0 || tracking.watch.leaves_out(s.source)) continue;
        RangeTracking::Slot& slot = tracking.slots[static_cast<std::size_t>(s.slot - model_.layout.source)];
        ++all;
        if (s.use) slot.doubted.reset();
        else if (!slot.doubted) slot.doubted = f.time();  // from here: earlier absence is not evidence against the source
        if (slot.doubted) ++doubted;
        if (slot.doubted && (f.time() - *slot.doubted).seconds() >= test_.recovery_time) wrong = s.source;
    }
    if (tracking.watch.on && 3 * doubted <= all) return wrong;
    for (const RangeScalar& s : tracking.work.all()) {
        if (s.is_rate || s.slot < 0 || tracking.watch.leaves_out(s.source)) continue;
        RangeTracking::Slot& slot = tracking.slots[static_cast<std::size_t>(s.slot - model_.layout.source)];
        if (!slot.doubted || (f.time() - *slot.doubted).seconds() < test_.recovery_time) continue;
        f.P(s.slot, s.slot) += s.innovation * s.innovation;
        // What is learnt now is a fault, which does not decay as the atmosphere's errors do: 300 m that are expected to decay in ten
        // minutes would be taken for a motion of half a metre a second.
        StateProcess constant = f.slot_process[static_cast<std::size_t>(s.slot - model_.layout.source)];
        constant.decay = 0.0;
        f.set_slot_process(static_cast<std::size_t>(s.slot - model_.layout.source), constant);
        slot.doubted.reset();
    }
    return -1;
}

/// Passes the scalars in use to the fault watch; f.P is that before the epoch.
template <class Frame>
void RangeUpdate<Frame>::follow_faults(InertialFilter<Frame>& f, RangeTracking& tracking) const {
    std::array<WatchedScalar, RangeEpochWork::most> scalars;
    std::size_t n = 0;
    for (const RangeScalar& s : tracking.work.all()) {
        if (!s.use) continue;
        if (!s.is_rate) tracking.watch.begin(s.source, f.time(), f.P.rows());
        // The changes of phases are known so well that their small lasting errors would be evidence of faults, and a wrong pseudorange
        // does not show in them: they belong to no source.
        scalars[n++] = {&s.row, s.innovation, s.variance, s.phase_change ? -1 : s.source, s.is_rate};
    }
    tracking.watch.follow(f.P, std::span(scalars).first(n), f.time(), f.used);
    tracking.watch.weigh();
}

/// Excludes a source found faulty from now on, and replaces the estimate by that of the filter without it: the effect of the
/// fault is removed, whatever its shape.
template <class Frame>
void RangeUpdate<Frame>::leave_out(InertialFilter<Frame>& f, RangeTracking& tracking, int source, RangeListener* listener) const {
    const auto clean = std::ranges::find(tracking.watch.without, source, &WithoutSource::source);
    if (clean != tracking.watch.without.end()) {
        f.P += clean->excess;
        f.apply(model_, -clean->offset);
    }
    tracking.watch.clear();
    std::erase_if(tracking.watch.left_out, [&](const LeftOutSource& l) { return l.source == source; });
    tracking.watch.left_out.push_back({source, f.time()});
    for (std::size_t k = 0; k < Layout::slots; ++k) {
        RangeTracking::Slot& slot = tracking.slots[k];
        if (slot.source != source) continue;
        slot.doubted.reset();
        const double decay = f.slot_process[k].decay, time = decay > 0.0 ? 1.0 / decay : errors_of(slot.station).correlation_time,
                     variance = 0.5 * f.slot_process[k].psd * time;
        renew(f, tracking, model_.layout.source + static_cast<int>(k), variance, listener);
        f.set_slot_process(k, StateProcess::markov(std::sqrt(variance), time));
        if (has_slow_rate(slot.station)) {
            const double sigma = errors_of(slot.station).correlated_rate;
            renew(f, tracking, model_.layout.source_rate + static_cast<int>(k), sigma * sigma, listener);
        }
    }
}

/// Excluded sources: not used at this epoch, and readmitted once the means of range and rate over a window agree with the estimate.
template <class Frame>
void RangeUpdate<Frame>::follow_left_out(const InertialFilter<Frame>& f, RangeTracking& tracking) const {
    constexpr double window = 120.0, limit = 3.0;  // s, sigmas
    RangeEpochWork& work = tracking.work;
    std::erase_if(tracking.watch.left_out, [&](LeftOutSource& l) {
        constexpr double probation = 600.0;  // s
        if (l.on_probation()) return (f.time() - l.since).seconds() > probation;
        double range_variance = 0.0, rate_variance = 0.0, range_noise = 0.0, rate_noise = 0.0;
        bool seen = false;
        for (RangeScalar& s : work.all()) {
            if (s.source != l.source) continue;
            s.use = false;
            ++work.excluded;
            const double state = s.row.dot(s.row.times(f.P, f.used));
            (s.is_rate ? l.rate : l.range) += s.innovation;
            ++(s.is_rate ? l.rates : l.ranges);
            (s.is_rate ? rate_variance : range_variance) = state;
            (s.is_rate ? rate_noise : range_noise) = s.variance;
            seen = true;
        }
        if (!seen || (f.time() - l.since).seconds() < window) return false;
        const auto agrees = [](double sum, int n, double variance, double noise) {
            return n == 0 || sum * sum < limit * limit * n * n * (variance + noise / n);
        };
        const bool good = l.ranges > 1 && agrees(l.range, l.ranges, range_variance, range_noise) &&
                          agrees(l.rate, l.rates, rate_variance, rate_noise);
        l = {l.source, f.time(), good ? LeftOutSource::probation : 0};
        return false;
    });
}

/// Most ranges contradict the inertial prediction for long: the prediction is then wrong by about this amount.
template <class Frame>
void RangeUpdate<Frame>::doubt_the_estimate(InertialFilter<Frame>& f, RangeTracking& tracking) const {
    RangeEpochWork& work = tracking.work;
    const int ranges = static_cast<int>(std::ranges::count_if(
        work.all(), [&](const RangeScalar& s) { return !s.is_rate && !tracking.watch.leaves_out(s.source); }));
    const int good =
        static_cast<int>(std::ranges::count_if(work.all(), [](const RangeScalar& s) { return !s.is_rate && s.use; }));
    if (2 * good >= ranges) work.disagreeing = 0;
    else if (work.disagreeing++ == 0) work.disagreeing_since = f.time();
    constexpr int long_run = 10;
    constexpr double long_time = 1.0;  // s: a deep receiver has fifty epochs per second
    if (work.disagreeing < long_run || (f.time() - work.disagreeing_since).seconds() < long_time) return;
    double size = 0.0;
    for (const RangeScalar& s : work.all())
        if (!s.is_rate) size = std::max(size, std::abs(s.innovation));
    f.P.diagonal().template head<3>().array() += size * size;
    f.P.diagonal().template segment<3>(Layout::velocity).array() += std::min(100.0, 0.01 * size * size);
    f.P(model_.layout.clock, model_.layout.clock) += size * size;
    work.disagreeing = 0;
}

template <class Frame>
int RangeUpdate<Frame>::operator()(InertialFilter<Frame>& f, RangeTracking& tracking, const RangingLog& log,
                                   std::span<const RangeSample> samples, RangeListener* listener) const {
    constexpr int most_iterations = 4;
    static const RangeTest open(0.0, 0.0);
    RangeEpochWork& work = tracking.work;
    StateVector dx = StateVector::Zero(f.P.rows());
    if (const int noise = model_.layout.rate_noise; noise >= 0) {
        renew(f, tracking, noise, settings_.errors.clock.phase_psd() / settings_.errors.rate_span, listener);
    }
    make_scalars(f, tracking, log, samples, dx, listener);
    work.excluded = 0;
    work.clock_jump = false;
    follow_left_out(f, tracking);
    estim::EpochUpdate update(f.P, f.used);
    bool agreed = true;
    while (!use_all(test_, update, work, dx, nullptr)) {
        if (!work.clock_jump && follow_clock_jump(f, work)) work.clock_jump = true;
        else if (!leave_out_worst(f, work)) {
            agreed = false;  // each is acceptable by itself, in this order or another
            break;
        }
    }
    if (!agreed) (void)use_all(open, update, work, dx, nullptr);
    std::array<bool, RangeEpochWork::most> use{};
    for (std::size_t i = 0; i < work.count; ++i) use[i] = work.scalars[i].use;
    for (int i = 1; is_curved(f, work) && i < most_iterations; ++i) {
        const StateVector about = dx;
        make_scalars(f, tracking, log, samples, about, nullptr);
        for (std::size_t k = 0; k < work.count; ++k) work.scalars[k].use = use[k];
        (void)use_all(open, update, work, dx, nullptr);
        if ((dx - about).head<3>().norm() < 1e-3) break;
    }
    if (listener != nullptr) (void)use_all(open, update, work, dx, listener);
    const int taken = static_cast<int>(std::ranges::count_if(work.all(), &RangeScalar::use));
    if (tracking.watch.on) follow_faults(f, tracking);
    update.apply(f.P);
    const int doubted = doubt_sources(f, tracking);
    doubt_the_estimate(f, tracking);
    f.apply(model_, dx);
    if (model_.layout.phase < 0 || std::ranges::any_of(samples, [](const RangeSample& m) { return m.phase_span > 0.0; }))
        clone_antenna(f, tracking, listener);
    work.alarm = doubted;
    if (tracking.watch.on && doubted < 0)
        if (const WithoutSource* found = tracking.watch.found(test_.watch)) work.alarm = found->source;
    if (work.alarm >= 0) leave_out(f, tracking, work.alarm, listener);
    return taken;
}

template class RangeUpdate<GeographicFrame>;
template class RangeUpdate<EarthFixedFrame>;

}  // namespace schuler::filter
