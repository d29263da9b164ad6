#include "schuler/fusion/range_update.h"

#include "schuler/gnss/ground_range.h"
#include "schuler/math/chi_square.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>

namespace schuler::fusion {

using Eigen::Vector3d;
using L = TightLayout;
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

namespace {

/// Adds three entries of a row.
void add3(estim::SparseRow<RangeScalar::most_entries>& row, int at, const Vector3d& v) {
    for (int i = 0; i < 3; ++i) row.add(at + i, v(i));
}

/// The nine entries of errors in local level, mapped to the filter's own.
template <class Frame>
void add_navigation(estim::SparseRow<RangeScalar::most_entries>& row, const Matrix9& to_local, const Vector3d& position,
                    const Vector3d& velocity, const Vector3d& attitude, bool with_velocity) {
    if constexpr (Frame::errors_are_geographic) {
        add3(row, Layout::position, position);
        if (with_velocity) add3(row, Layout::velocity, velocity);
        add3(row, Layout::attitude, attitude);
    } else {
        Vector9 local;
        local << position, velocity, attitude;
        const Vector9 own = to_local.transpose() * local;
        add3(row, Layout::position, own.head<3>());
        if (with_velocity) add3(row, Layout::velocity, own.segment<3>(3));
        add3(row, Layout::attitude, own.tail<3>());
    }
}

/// Sigma of the white part of a pseudorange or rate.
double sigma_of(const TightModel& model, double stated, double model_sigma, bool station, double elevation, double cn0) {
    if (stated > 0.0) return stated;
    return station || !model.ranging.sigma_by_elevation ? model_sigma : model_sigma * gnss::noise_factor(elevation, cn0);
}

}  // namespace

template <class Frame>
void make_scalars(const TightModel& model, TightFilter<Frame>& filter, const RangingLog& log, std::span<const RangeSample> samples,
                  const TightVector& dx, RangeEpochWork& work) {
    const RangingFilterSettings& settings = model.ranging;
    const earth::Earth& earth = model.inertial.earth;
    TightFilter<Frame> const& f = filter;
    const typename Frame::State state = Frame::corrected(earth, f.inertial.nav, dx.head<9>());
    const NavState nav = Frame::geographic(earth, state);
    const Vector3d w_ib_b = f.inertial.w_ib_b + dx.segment<3>(Layout::gyro_bias);
    const AntennaEstimate a = antenna_of(earth, nav, nav.q_nb.toRotationMatrix(), w_ib_b, model.lever_arm_b);
    Matrix9 to_local = Matrix9::Identity();
    if constexpr (!Frame::errors_are_geographic) to_local = ins::geographic_from_ecef_errors(earth, nav);
    const TightVector nominal = f.parameters - dx;
    const bool air = settings.corrections.troposphere != gnss::TroposphereModel::None ||
                     settings.corrections.ionosphere == gnss::IonosphereModel::Broadcast;
    work.count = 0;
    for (const RangeSample& m : samples) {
        const RangeSource& source = log.sources[m.source];
        if (!m.tx.r.allFinite() || (source.station && !settings.use_stations) || work.count + 2 > RangeEpochWork::most) continue;
        const Vector3d velocity = m.tx_velocity.allFinite() ? m.tx_velocity : Vector3d(Vector3d::Zero());
        const RangeRows r = range_rows(a, m.tx, velocity);
        // u points down to the receiver: what comes from above has a positive down component
        const gnss::Direction direction{std::atan2(-r.u_n.y(), -r.u_n.x()), std::asin(std::clamp(r.u_n.z(), -1.0, 1.0))};
        if (!source.station && direction.elevation < settings.corrections.elevation_mask) continue;
        const double clock = nominal(L::clock), drift = nominal(L::drift);
        const int slot = filter.slot_of(model, m.source, source.station), offset = intersystem_of(source);
        if (slot >= 0) filter.slots[static_cast<std::size_t>(slot - L::source)].last = f.time();

        RangeScalar scalar;
        scalar.source = m.source;
        scalar.station = source.station;
        scalar.slot = slot;
        scalar.distance = r.range;
        const sensor::RangeErrorModel& errors = source.station ? settings.errors.station : settings.errors.satellite;
        if (std::isfinite(m.pseudorange)) {
            double delay = 0.0, more = m.variance;
            if (air && !source.station) {
                const gnss::AtmosphericDelay d =
                    gnss::atmospheric_delay(f.time(), m.frequency, a.place, direction,
                                            settings.klobuchar ? &*settings.klobuchar : nullptr, settings.corrections);
                delay = d.delay;
                // what the models leave is the slow error's, where that is a state
                if (slot < 0) more += d.variance;
            } else if (source.station && settings.corrections.troposphere != gnss::TroposphereModel::None) {
                delay = gnss::ground_range_delay(earth::geodetic_from_ecef(earth.ellipsoid, m.tx), a.place, r.range);
            }
            RangeScalar s = scalar;
            // measured when the receiver's clock showed the time, which is bias/c after it was
            const double computed = r.range - r.rate * clock / speed_of_light + clock - speed_of_light * m.tx_clock + delay +
                                    (source.station ? nominal(L::network) : offset >= 0 ? nominal(L::intersystem + offset) : 0.0) +
                                    (slot >= 0 ? nominal(slot) : 0.0);
            const double sigma = sigma_of(model, m.std, errors.white, source.station, direction.elevation, m.cn0);
            s.variance = sigma * sigma + more;
            add_navigation<Frame>(s.row, to_local, r.range_by_position, Vector3d::Zero(), r.range_by_attitude, false);
            s.row.add(L::clock, 1.0 - r.rate / speed_of_light);
            if (source.station) s.row.add(L::network, 1.0);
            else if (offset >= 0) s.row.add(L::intersystem + offset, 1.0);
            if (slot >= 0) s.row.add(slot, 1.0);
            s.innovation = computed - m.pseudorange + s.row.dot(dx);
            work.scalars[work.count++] = s;
        }
        if (settings.use_rates && std::isfinite(m.range_rate) && (m.tx_velocity.allFinite() || source.station)) {
            RangeScalar s = scalar;
            s.is_rate = true;
            const double sigma = sigma_of(model, m.std_rate, errors.rate, source.station, direction.elevation, m.cn0);
            s.variance = sigma * sigma;
            add_navigation<Frame>(s.row, to_local, r.rate_by_position, r.rate_by_velocity, r.rate_by_attitude, true);
            add3(s.row, Layout::gyro_bias, r.rate_by_gyro_bias);
            s.row.add(L::drift, 1.0);
            s.innovation = r.rate + drift - speed_of_light * m.tx_clock_rate - m.range_rate + s.row.dot(dx);
            work.scalars[work.count++] = s;
        }
    }
}

namespace {

/// Uses the scalars that are in use one by one on a copy of the covariance; false where a limit is exceeded.
template <class Frame>
bool use_all(const RangeTest& test, const TightFilter<Frame>& f, RangeEpochWork& work, TightMatrix& P, TightVector& dx) {
    double sum = 0.0;
    std::size_t n = 0;
    bool good = true;
    for (RangeScalar& s : work.all()) {
        if (!s.use) continue;
        const estim::SparseUpdate u = estim::update_sparse<L::size>(dx, P, s.row, s.innovation, s.variance, f.used);
        s.s = u.s;
        s.sequential = u.innovation / std::sqrt(u.s);
        const double square = s.sequential * s.sequential;
        sum += square;
        ++n;
        good = good && square <= test.single;
    }
    return good && sum <= test.whole[n];
}

/// A jump that all satellites' pseudoranges share belongs to the clock: opens it. True where there was one.
template <class Frame>
bool follow_clock_jump(TightFilter<Frame>& f, const RangeEpochWork& work) {
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
    const double sigma = std::sqrt(f.P(L::clock, L::clock) + f.P.diagonal().template head<3>().sum() + noise);
    const auto near = std::count_if(z.begin(), end, [&](double x) { return std::abs(x - jump) < 0.2 * std::abs(jump); });
    if (std::abs(jump) < 30.0 + 6.0 * sigma || 3 * static_cast<std::size_t>(near) < 2 * n) return false;
    f.P(L::clock, L::clock) += jump * jump;
    return true;
}

using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 64, 64>;
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 64, 1>;

/// Leaves out the scalar that fits worst to all the others; false where none is beyond its limit.
template <class Frame>
bool leave_out_worst(const RangeTest& test, const TightFilter<Frame>& f, RangeEpochWork& work) {
    std::array<std::size_t, RangeEpochWork::most> index;
    Eigen::Index n = 0;
    for (std::size_t i = 0; i < work.count; ++i)
        if (work.scalars[i].use) index[static_cast<std::size_t>(n++)] = i;
    if (n == 0) return false;
    Square S(n, n);
    Column z(n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const RangeScalar& a = work.scalars[index[static_cast<std::size_t>(i)]];
        TightVector ph = TightVector::Zero();
        for (std::size_t k = 0; k < static_cast<std::size_t>(a.row.count); ++k) ph += a.row.value[k] * f.P.col(a.row.index[k]);
        for (Eigen::Index j = 0; j < n; ++j) S(i, j) = work.scalars[index[static_cast<std::size_t>(j)]].row.dot(ph);
        S(i, i) += a.variance;
        z(i) = a.innovation;
    }
    const Square inverse = S.llt().solve(Square::Identity(n, n));
    const Column w = inverse * z;
    double worst = test.single;
    Eigen::Index which = -1;
    for (Eigen::Index i = 0; i < n; ++i) {
        const double square = w(i) * w(i) / inverse(i, i);
        if (square <= worst) continue;
        worst = square;
        which = i;
    }
    if (which < 0 && z.dot(w) > test.whole[static_cast<std::size_t>(n)]) {   // together too large, none by itself
        (w.array().square() / inverse.diagonal().array()).maxCoeff(&which);
    }
    if (which < 0) return false;
    work.scalars[index[static_cast<std::size_t>(which)]].use = false;
    ++work.excluded;
    return true;
}

/// A station so near that the range is not linear over the uncertainty of the position (math.md 5.3).
template <class Frame>
bool is_curved(const TightFilter<Frame>& f, const RangeEpochWork& work) {
    const double spread = f.P.diagonal().template head<3>().sum();
    return std::ranges::any_of(work.all(), [&](const RangeScalar& s) {
        return !s.is_rate && spread / (2.0 * s.distance) > 0.1 * std::sqrt(s.variance);
    });
}

/// Sources that go on disagreeing: their slow error is opened so far that they may be used again and learnt anew.
template <class Frame>
void open_sources(const RangeTest& test, TightFilter<Frame>& f, const RangeEpochWork& work) {
    for (const RangeScalar& s : work.all()) {
        if (s.is_rate || s.slot < 0) continue;
        auto& slot = f.slots[static_cast<std::size_t>(s.slot - L::source)];
        if (s.use) slot.doubted.reset();
        else if (!slot.doubted) slot.doubted = f.time();   // from here: silence before does not speak against the source
        if (!slot.doubted || (f.time() - *slot.doubted).seconds() < test.recovery_time) continue;
        f.P(s.slot, s.slot) += s.innovation * s.innovation;
        slot.doubted.reset();
    }
}

/// The scalars in use once more, for the hypotheses of faults; f.P is that before the epoch.
template <class Frame>
void follow_faults(TightFilter<Frame>& f, const RangeEpochWork& work) {
    for (const RangeScalar& s : work.all())
        if (s.use && !s.is_rate) f.watch.begin(s.source, f.time());
    TightMatrix P = f.P;
    TightVector unused = TightVector::Zero();
    for (const RangeScalar& s : work.all()) {
        if (!s.use) continue;
        f.watch.follow(P, s.row, s.sequential * std::sqrt(s.s), s.variance, f.used, s.is_rate ? -1 : s.source);
        (void)estim::update_sparse<L::size>(unused, P, s.row, 0.0, s.variance, f.used);
    }
}

/// A fault that the watch has found is estimated with the rest as if nothing had been known of its size [Friedland1969]: the estimate loses
/// what it did, the covariance gains what its size is uncertain by, and the slow error of the source holds it from now on.
template <class Frame>
int repair_faults(const TightModel& model, const RangeTest& test, TightFilter<Frame>& f, const RangeEpochWork& work) {
    const FaultHypothesis<L::size>* found = f.watch.found(test.watch);
    if (found == nullptr) return -1;
    const int source = found->source;
    TightVector moved = found->response;
    for (const RangeScalar& s : work.all())
        if (s.source == source && s.slot >= 0) {
            moved(s.slot) -= 1.0;   // what the slow error is from now on includes the fault
            break;
        }
    f.P += moved * moved.transpose() / found->information;
    f.apply(model, moved * (found->evidence / found->information));
    f.watch.all.clear();
    return source;
}

}  // namespace

template <class Frame>
int update_with_ranges(const TightModel& model, const RangeTest& test, TightFilter<Frame>& f, const RangingLog& log,
                       std::span<const RangeSample> samples, RangeEpochWork& work) {
    constexpr int most_iterations = 4;
    TightVector dx = TightVector::Zero();
    make_scalars(model, f, log, samples, dx, work);
    work.excluded = 0;
    work.clock_jump = false;
    TightMatrix P = f.P;
    while (!use_all(test, f, work, P, dx)) {
        dx.setZero();
        if (!work.clock_jump && follow_clock_jump(f, work)) work.clock_jump = true;
        else if (!leave_out_worst(test, f, work)) {
            // each by itself is in order, in this order or another
            P = f.P;
            (void)use_all(RangeTest(0.0, 0.0), f, work, P, dx);
            break;
        }
        P = f.P;
    }
    if (is_curved(f, work)) {
        std::array<bool, RangeEpochWork::most> use{};
        for (std::size_t i = 0; i < work.count; ++i) use[i] = work.scalars[i].use;
        for (int i = 1; i < most_iterations; ++i) {
            const TightVector about = dx;
            make_scalars(model, f, log, samples, about, work);
            for (std::size_t k = 0; k < work.count; ++k) work.scalars[k].use = use[k];
            P = f.P;
            dx.setZero();
            (void)use_all(RangeTest(0.0, 0.0), f, work, P, dx);
            if ((dx - about).head<3>().norm() < 1e-3) break;
        }
    }
    const int taken = static_cast<int>(std::ranges::count_if(work.all(), &RangeScalar::use));
    if (f.watch.on) follow_faults(f, work);
    f.P = P;
    open_sources(test, f, work);
    const int ranges = static_cast<int>(std::ranges::count_if(work.all(), [](const RangeScalar& s) { return !s.is_rate; }));
    const int good = static_cast<int>(std::ranges::count_if(work.all(), [](const RangeScalar& s) { return !s.is_rate && s.use; }));
    if (2 * good >= ranges) work.disagreeing = 0;
    else if (work.disagreeing++ == 0) work.disagreeing_since = f.time();
    constexpr int long_run = 10;
    constexpr double long_time = 1.0;   // s: a deep receiver's epochs come fifty a second
    if (work.disagreeing >= long_run && (f.time() - work.disagreeing_since).seconds() >= long_time) {
        // most ranges contradict the inertial prediction for long: then that is wrong by about as much
        double size = 0.0;
        for (const RangeScalar& s : work.all())
            if (!s.is_rate) size = std::max(size, std::abs(s.innovation));
        f.P.diagonal().template head<3>().array() += size * size;
        f.P.diagonal().template segment<3>(Layout::velocity).array() += std::min(100.0, 0.01 * size * size);
        f.P(L::clock, L::clock) += size * size;
        work.disagreeing = 0;
    }
    f.apply(model, dx);
    work.alarm = f.watch.on ? repair_faults(model, test, f, work) : -1;
    return taken;
}

#define SCHULER_INSTANTIATE(Frame)                                                                                              \
    template void make_scalars(const TightModel&, TightFilter<Frame>&, const RangingLog&, std::span<const RangeSample>,          \
                               const TightVector&, RangeEpochWork&);                                                             \
    template int update_with_ranges(const TightModel&, const RangeTest&, TightFilter<Frame>&, const RangingLog&,                 \
                                    std::span<const RangeSample>, RangeEpochWork&);
SCHULER_INSTANTIATE(GeographicFrame)
SCHULER_INSTANTIATE(EarthFixedFrame)
#undef SCHULER_INSTANTIATE

}  // namespace schuler::fusion
