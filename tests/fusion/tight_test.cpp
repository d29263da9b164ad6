// The tight filter on simulated ranges: clock, faults, jumps of the clock, few satellites, near stations, both mechanizations.
#include "fusion/range_flight.h"
#include "schuler/earth/earth.h"
#include "schuler/fusion/run_pass.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace schuler::fusion {
namespace {

using namespace test;
using Eigen::Vector3d;

std::map<int, int> rejected_pseudoranges(const Result& result, double from, double to) {
    std::map<int, int> out;
    for (const MeasurementRecord& r : result.measurements)
        if (r.kind == MeasurementKind::Pseudorange && r.status == MeasurementStatus::Rejected && r.time.seconds() >= from &&
            r.time.seconds() < to)
            ++out[static_cast<int>(std::lround(r.time.seconds()))];
    return out;
}

/// Coasting from a perfect clock: 71 m after ten minutes with an OCXO, 1600 m with a TCXO (math.md 5.2).
TEST(TightFilter, ClockCoastsAsItsDensitiesSay) {
    for (const auto& [oscillator, expected] : {std::pair{sensor::ocxo, 71.5}, std::pair{sensor::tcxo, 1598.5}}) {
        Settings settings;
        settings.ranging.errors.clock = oscillator;
        settings.coupling = Coupling::Tight;
        const InertialModel model = make_model(settings, make_layout(settings, {}));
        InertialFilter<GeographicFrame> f(model);
        estim::Transition phi;
        NavState nav;
        nav.position = {0.9, 1.0, 100.0};
        f.set_nav(nav);
        for (int k = 1; k <= 6000; ++k) {
            f.propagate(model, {Time::from_seconds(0.1 * k), 0.1, Vector3d::Zero(), Vector3d(0, 0, -0.98)}, {});
            if (k % 7 == 0) (void)f.propagate_covariance(model, phi);  // whenever it is wanted
        }
        (void)f.propagate_covariance(model, phi);
        EXPECT_NEAR(std::sqrt(f.P(model.layout.clock, model.layout.clock)), expected, 0.01 * expected);
    }
}

TEST(TightFilter, BothMechanizationsAgree) {
    Flight f = flight();
    const Result n = run(f);
    f.settings.mechanization = Mechanization::Ecef;
    const Result e = run(f);
    ASSERT_EQ(n.forward.rows.size(), e.forward.rows.size());
    for (std::size_t i = 0; i < n.forward.rows.size(); ++i) {
        EXPECT_LT(earth::ned_difference(f.earth, n.forward.rows[i].position, e.forward.rows[i].position).norm(), 2e-3);
        EXPECT_LT((n.forward.rows[i].std_position - e.forward.rows[i].std_position).norm(), 1e-3);
    }
    EXPECT_LT(largest_error(f, n, 20.0), 8.0);
    // a slot has a value while it is a source's
    const auto slow = std::ranges::find(n.states, "range_slow_error", &LayoutBlock::name);
    ASSERT_NE(slow, n.states.end());
    std::size_t used = 0;
    for (const ParameterRow& row : n.forward.parameters) {
        ASSERT_EQ(row.sources.size(), static_cast<std::size_t>(slow->size));
        for (std::size_t k = 0; k < row.sources.size(); ++k) {
            EXPECT_EQ(row.sources[k] >= 0, std::isfinite(row.std[static_cast<std::size_t>(slow->offset - 9) + k])) << k;
            used += row.sources[k] >= 0 ? 1 : 0;
        }
    }
    EXPECT_GT(used, 4 * n.forward.parameters.size());
    EXPECT_LT(used, n.forward.parameters.size() * static_cast<std::size_t>(slow->size));
}

/// A gain error of the accelerometers under a force beyond that of rest is an error of velocity that grows with time, and one of
/// the gyros in a turn one of attitude: what they are after ten seconds.
TEST(TightFilter, GainErrorsGrowInManoeuvresOnly) {
    constexpr double gain = 2e-3, force = 30.0, rate = 0.5;  // m/s^2 beyond 1 g, rad/s
    const auto sigmas = [&](double turn, const Vector3d& f_b) {
        Settings settings;
        settings.coupling = Coupling::Tight;
        InertialModel model = make_model(settings, make_layout(settings, {}));
        model.process = {};
        model.gyro_gain = model.accel_gain = gain;
        InertialFilter<GeographicFrame> f(model);
        NavState nav;
        nav.position = {0.9, 1.0, 100.0};
        f.set_nav(nav);
        estim::Transition phi;
        for (int k = 1; k <= 1000; ++k) {
            f.propagate(model, {Time::from_seconds(0.01 * k), 0.01, Vector3d(0.01 * turn, 0.0, 0.0), 0.01 * f_b}, {});
            if (k % 10 == 0) (void)f.propagate_covariance(model, phi);
        }
        return std::pair{std::sqrt(f.P(3, 3)), std::sqrt(f.P(6, 6))};
    };
    const auto [v_rest, a_rest] = sigmas(0.0, {0.0, 0.0, -units::g0});
    const auto [v_pushed, a_pushed] = sigmas(0.0, {force, 0.0, -units::g0});
    const auto [v_turning, a_turning] = sigmas(rate, {0.0, 0.0, -units::g0});
    EXPECT_NEAR(v_pushed, std::hypot(v_rest, gain * force * 10.0), 0.05 * v_pushed);
    EXPECT_NEAR(a_turning, std::hypot(a_rest, gain * rate * 10.0), 0.05 * a_turning);
    EXPECT_LT(v_rest, 0.1 * v_pushed);
    EXPECT_LT(a_rest, 0.1 * a_turning);
    EXPECT_LT(a_pushed, 0.1 * a_turning);
}

/// A receiver in the loop that gives the ranges of a log: the same solution, and what it is told is the antenna's motion.
TEST(TightFilter, AReceiverInTheLoopHearsWhereItIs) {
    Flight f = flight();
    const Result logged = run(f);
    const RangingLog log = std::exchange(f.recording.ranges, {});
    std::size_t next = 0;
    std::vector<ReceiverAiding> aidings;
    const auto receiver = [&](const ReceiverAiding& aiding, Time until, RangingLog& heard) {
        EXPECT_LT(aiding.time, until);
        aidings.push_back(aiding);
        heard.sources = log.sources;
        for (; next < log.epochs.size() && log.epochs[next].time <= until; ++next) {
            const auto samples = log.of(log.epochs[next]);
            heard.epochs.push_back({log.epochs[next].time, heard.samples.size(), samples.size()});
            heard.samples.insert(heard.samples.end(), samples.begin(), samples.end());
        }
    };
    WarningLog unheard;
    const Result result = run_filter(f.recording, f.settings, unheard, {}, {}, receiver);
    ASSERT_EQ(result.forward.rows.size(), logged.forward.rows.size());
    for (std::size_t i = 0; i < logged.forward.rows.size(); ++i) {
        const SolutionRow &a = result.forward.rows[i], &b = logged.forward.rows[i];
        EXPECT_LT(earth::ned_difference(f.earth, a.position, b.position).norm(), 1e-3);
    }
    ASSERT_GT(aidings.size(), 1000U);
    double changed = 0.0, told = 0.0;
    for (std::size_t k = 600; k + 1 < aidings.size(); ++k) {
        const ReceiverAiding &a = aidings[k], &b = aidings[k + 1];
        const double t = a.time.seconds(), dt = (b.time - a.time).seconds();
        if (std::abs(t - std::round(t)) < 0.15) continue;  // the epochs of ranges move the solution
        EXPECT_LT(((b.antenna.r_e - a.antenna.r_e) / dt - 0.5 * (a.antenna.v_e + b.antenna.v_e)).norm(), 0.01) << t;
        EXPECT_LT(((b.antenna.v_e - a.antenna.v_e) / dt - 0.5 * (a.antenna.a_e + b.antenna.a_e)).norm(), 0.1) << t;
        const Vector3d change = (b.antenna.a_e - a.antenna.a_e) / dt;
        changed += change.squaredNorm();
        told += change.dot(a.jerk_e);
    }
    EXPECT_NEAR(told / changed, 1.0, 0.2);
    const ReceiverAiding& last = aidings.back();  // 0.1 s before the end
    const SolutionRow& end = result.forward.rows.back();
    const Vector3d ahead = last.antenna.v_e * (end.time - last.time).seconds();
    const Vector3d arm = last.antenna.r_e + ahead - earth::ecef_from_geodetic(f.earth.ellipsoid, end.position).r;
    const Eigen::Matrix3d C_eb = earth::C_en(end.position.lat, end.position.lon) * math::dcm_from_rpy(end.rpy);
    EXPECT_LT((arm - C_eb * f.settings.gnss.lever_arm_b).norm(), 1.0);
    EXPECT_NEAR(std::sqrt(last.P(0, 0)), logged.forward.rows.back().std_position.x(), 0.2);
    EXPECT_GT(last.std_clock, 0.1);
}

TEST(TightFilter, OneAndTwoFaultySatellitesAreLeftOut) {
    const Flight clean = flight();
    const double healthy = largest_error(clean, run(clean), 60.0);
    for (const std::vector<std::uint16_t>& faulty : {std::vector<std::uint16_t>{2}, std::vector<std::uint16_t>{1, 4}}) {
        Flight f = flight();
        for (const std::uint16_t source : faulty) spoil(f.recording.ranges, source, 60.0, source == 4 ? -60.0 : 80.0);
        f.settings.constraints.recovery_time = 1e3;
        const Result guarded = run(f);
        const auto rejected = rejected_pseudoranges(guarded, 60.0, 121.0);
        EXPECT_EQ(rejected.size(), 61U);
        for (const auto& [second, count] : rejected) EXPECT_GE(count, static_cast<int>(faulty.size())) << second;
        EXPECT_LT(largest_error(f, guarded, 60.0), healthy + 3.0);
        f.settings.constraints.gate_probability = 0.0;
        EXPECT_GT(largest_error(f, run(f), 60.0), healthy + 8.0);
    }
}

/// A step in one range that is taken for its slow error after a while stays there, whether the source is heard or not: an error that were
/// to decay in ten minutes as that of the atmosphere does would be taken for a motion of half a metre a second.
TEST(TightFilter, ALearntFaultDoesNotDecay) {
    Flight f = flight();
    const double healthy = largest_error(f, run(f), 30.0);
    constexpr std::uint16_t source = 2;
    spoil(f.recording.ranges, source, 30.0, 300.0);
    for (const RangeEpoch& e : f.recording.ranges.epochs)
        for (std::size_t i = e.first; e.time.seconds() > 60.0 && i < e.first + e.count; ++i)
            if (RangeSample& m = f.recording.ranges.samples[i]; m.source == source)
                m.pseudorange = m.range_rate = RangeSample::none;
    const Result result = run(f);
    EXPECT_LT(largest_error(f, result, 30.0), healthy + 2.0);
    const auto block = std::ranges::find(result.states, "range_slow_error", &LayoutBlock::name);
    ASSERT_NE(block, result.states.end());
    const ParameterRow& last = result.forward.parameters.back();
    EXPECT_GT(last.time.seconds(), 110.0);
    const auto slot = std::ranges::find(last.sources, static_cast<std::int16_t>(source)) - last.sources.begin();
    ASSERT_LT(slot, std::ssize(last.sources));
    EXPECT_NEAR(last.value[static_cast<std::size_t>(block->offset - Layout::navigation + slot)], 300.0, 10.0);
}

/// A source that was not heard has not disagreed: one false range when it is back leaves its slow error as it was.
TEST(TightFilter, SilenceDoesNotSpeakAgainstASource) {
    constexpr std::uint16_t source = 2;
    Flight f = flight();
    for (const RangeEpoch& e : f.recording.ranges.epochs)
        for (std::size_t i = e.first; i < e.first + e.count; ++i) {
            RangeSample& m = f.recording.ranges.samples[i];
            const double t = e.time.seconds();
            if (m.source != source || t < 40.0 || t >= 81.0) continue;
            if (t < 80.0) m.pseudorange = m.range_rate = std::numeric_limits<double>::quiet_NaN();
            else m.pseudorange += 1000.0;
        }
    int rejected = 0, used = 0;
    double largest = 0.0;
    for (const MeasurementRecord& r : run(f).measurements) {
        if (r.kind != MeasurementKind::Pseudorange || r.source != source || r.time.seconds() < 79.5) continue;
        ++(r.status == MeasurementStatus::Rejected ? rejected : used);
        if (r.status == MeasurementStatus::Accepted) largest = std::max(largest, r.sigma(0));
    }
    EXPECT_EQ(rejected, 1);
    EXPECT_EQ(used, 40);
    EXPECT_LT(largest, 10.0);
}

TEST(TightFilter, FollowsAJumpOfTheClock) {
    Flight f = flight();
    for (std::uint16_t source = 0; source < f.recording.ranges.sources.size(); ++source)
        spoil(f.recording.ranges, source, 60.0, 299'792.458);  // a millisecond
    const Result result = run(f);
    EXPECT_LT(largest_error(f, result, 20.0), 8.0);
    EXPECT_LE(rejected_pseudoranges(result, 60.0, 121.0).size(), 1U);
}

/// A single satellite holds its line of sight; without any the clock and the position go their way.
TEST(TightFilter, OneSatelliteIsOfUse) {
    Flight one = flight({}, {{60.0, 1, 0}}), none = flight({}, {{60.0, 0, 0}});
    const Result with = run(one), without = run(none);
    EXPECT_LT(with.forward.rows.back().std_position.norm(), 0.98 * without.forward.rows.back().std_position.norm());
    EXPECT_TRUE(with.forward.rows.back().std_position.allFinite());
    std::size_t used = 0;
    for (const MeasurementRecord& r : with.measurements)
        used += r.kind == MeasurementKind::Pseudorange && r.time.seconds() > 61.5 ? 1 : 0;
    EXPECT_EQ(used, 59U);
}

/// A range to a station 600 m away is far from linear over 100 m: iterated, the update finds the place.
TEST(RangeUpdate, IteratesNearStations) {
    const earth::Earth earth;
    NavState truth;
    truth.position = {0.9, 1.0, 300.0};
    Settings settings;
    settings.ranging.corrections.troposphere = gnss::TroposphereModel::None;
    settings.ranging.errors.station = {0.1, 0.0, 600.0, 0.1};
    settings.ranging.errors.network = 0.0;
    settings.ranging.errors.clock.bias = 1e-3;
    settings.coupling = Coupling::Tight;
    const InertialModel model = make_model(settings, make_layout(settings, {}));
    RangingLog log;
    const Vector3d offsets[] = {{600, 0, 200}, {-300, 520, 250}, {-300, -520, 150}};
    for (const Vector3d& at : offsets) {
        RangeSample m;
        m.source = log.source("ADSB-" + std::to_string(log.sources.size()), true);
        m.tx = earth::ecef_from_geodetic(earth.ellipsoid, earth::moved_by_ned(earth, truth.position, at));
        const AntennaEstimate a = antenna_of(earth, truth, Eigen::Matrix3d::Identity(), Vector3d::Zero(), Vector3d::Zero());
        m.pseudorange = range_rows(a, m.tx, Vector3d::Zero()).range;
        log.samples.push_back(m);
    }
    log.epochs.push_back({Time{}, 0, log.samples.size()});
    InertialFilter<GeographicFrame> f(model);
    start_ranging(f, model.layout, settings.ranging.errors);
    NavState wrong = truth;
    wrong.position = earth::moved_by_ned(earth, truth.position, {90.0, -70.0, 50.0});
    f.set_nav(wrong);
    f.P.diagonal().head<3>().setConstant(1e4);
    RangeTracking tracking;
    const RangeTest test(1e-4, 10.0);
    const Vector3d no_arm = Vector3d::Zero();
    const RangeUpdate<GeographicFrame> update(model, settings.ranging, no_arm, test);
    (void)update(f, tracking, log, log.of(log.epochs.front()), nullptr);
    EXPECT_LT(earth::ned_difference(earth, f.nav.position, truth.position).norm(), 0.1);
}

/// A filter that knows its place, and ranges of satellites overhead that are off by so many metres.
struct Overhead {
    explicit Overhead(const std::vector<double>& off, double sigma) {
        settings.ranging.corrections.troposphere = gnss::TroposphereModel::None;
        settings.ranging.corrections.ionosphere = gnss::IonosphereModel::None;
        NavState nav;
        nav.position = {0.9, 1.0, 300.0};
        f.set_nav(nav);
        start_ranging(f, model.layout, settings.ranging.errors);
        f.P(model.layout.clock, model.layout.clock) = 1.0;
        const AntennaEstimate a = antenna_of(earth, nav, Eigen::Matrix3d::Identity(), Vector3d::Zero(), Vector3d::Zero());
        for (std::size_t i = 0; i < off.size(); ++i) {
            RangeSample m;
            m.source = log.source("G0" + std::to_string(i + 1), false);
            const double azimuth = 2.0 * static_cast<double>(i);
            const Vector3d up(10e3 * std::cos(azimuth), 10e3 * std::sin(azimuth), -20e3);
            m.tx.r = earth::ecef_from_geodetic(earth.ellipsoid, nav.position).r +
                     1e3 * (earth::C_en(nav.position.lat, nav.position.lon) * up);
            m.std = sigma;
            m.pseudorange = range_rows(a, m.tx, Vector3d::Zero()).range + off[i];
            log.samples.push_back(m);
        }
    }
    void update() {
        const RangeUpdate<GeographicFrame> with_ranges(model, settings.ranging, no_arm, test);
        (void)with_ranges(f, tracking, log, log.samples, nullptr);
    }
    [[nodiscard]] const RangeEpochWork& work() const { return tracking.work; }

    static Settings tight() {
        Settings s;
        s.coupling = Coupling::Tight;
        return s;
    }

    earth::Earth earth;
    Settings settings = tight();
    InertialModel model = make_model(settings, make_layout(settings, {}));
    InertialFilter<GeographicFrame> f{model};
    RangingLog log;
    RangeTracking tracking;
    RangeTest test{1e-4, 10.0};
    Vector3d no_arm = Vector3d::Zero();
};

TEST(RangeUpdate, NoiseIsNoJumpOfTheClock) {
    Overhead noisy({435.0, -700.0, 391.0}, 150.0);
    noisy.update();
    EXPECT_FALSE(noisy.work().clock_jump);
    EXPECT_EQ(noisy.work().excluded, 1);
    Overhead jump({435.0, 435.0, 435.0}, 5.0);
    jump.update();
    EXPECT_TRUE(jump.work().clock_jump);
    EXPECT_EQ(jump.work().excluded, 0);
}

/// Rates by phase share the phases between them: what they tell of a constant velocity is what generalised least squares finds with the
/// covariance of such differences. A phase that was lost for a span begins another chain.
TEST(RangeUpdate, RatesByPhaseShareThePhasesBetweenThem) {
    constexpr double span = 0.2, sigma = 5e-3, velocity = 0.7;  // s, m, m/s downwards
    constexpr int spans = 20;
    for (const int lost : {0, 11}) {
        Overhead o({0.0}, 1.0);
        o.settings.coupling = Coupling::Deep;
        o.model = make_model(o.settings, make_layout(o.settings, {}));
        o.model.process = {};
        o.model.clock_psd = o.model.drift_psd = 0.0;
        const NavState nav = o.f.geographic(o.model);
        const Vector3d rest = -span * earth::terms_at(o.earth, nav.position, nav.v_eb_n).g_n;  // velocity increment
        o.f = InertialFilter<GeographicFrame>(o.model);
        o.f.set_nav(nav);
        o.f.P(Layout::velocity + 2, Layout::velocity + 2) = 100.0;
        RangeSample& m = o.log.samples.front();
        m.pseudorange = RangeSample::none;
        m.phase_std = sigma;
        m.phase_span = span;
        m.std_rate = std::sqrt(2.0) * sigma / span;
        // A circular orbit, and the Earth that turns below it while the light is on its way.
        const double radius = m.tx.r.norm(), turn = std::sqrt(o.earth.ellipsoid.gm / std::pow(radius, 3));
        const Vector3d first = m.tx.r / radius, second = first.cross(Vector3d::UnitX()).normalized();
        const auto earth_at = [&](double t) { return Eigen::AngleAxisd(o.earth.ellipsoid.w_ie * t, Vector3d::UnitZ()); };
        const auto orbit = [&](double t) -> Vector3d {
            return radius * (std::cos(turn * t) * first + std::sin(turn * t) * second);
        };
        const Vector3d down = earth::C_en(nav.position.lat, nav.position.lon).col(2);
        const Vector3d begin = earth::ecef_from_geodetic(o.earth.ellipsoid, nav.position).r;
        const auto range = [&](double t, double v) {
            const Vector3d antenna = earth_at(t) * (begin + v * t * down);
            double light = 0.07;  // s
            for (int i = 0; i < 5; ++i) light = (antenna - orbit(t - light)).norm() / gnss::speed_of_light;
            return gnss::speed_of_light * light;
        };
        const auto rate = [&](int k, double v) { return (range(span * k, v) - range(span * (k - 1), v)) / span; };
        math::Random random(5, "phases");
        estim::Transition phi;
        double phase = sigma * random.normal();
        std::vector<double> rates, by_velocity;
        std::vector<int> when;
        for (int k = 1; k <= spans; ++k) {
            o.f.propagate(o.model, {Time::from_seconds(span * k), span, Vector3d::Zero(), rest}, {});
            (void)o.f.propagate_covariance(o.model, phi);
            const double next = sigma * random.normal();
            const double sent = span * k - range(span * k, velocity) / gnss::speed_of_light;
            const auto transmitter = [&](double t) -> Vector3d { return earth_at(-t) * orbit(t); };
            m.tx.r = transmitter(sent);
            m.tx_velocity = (transmitter(sent + 0.01) - transmitter(sent - 0.01)) / 0.02;
            m.range_rate = rate(k, velocity) + (next - phase) / span;
            m.phase_goes_on = k > 1 && k != lost + 1;
            phase = next;
            if (k == lost) continue;
            o.update();
            if (k == 1 || k == lost + 1) continue;  // how the velocity changed since the begin of its span nobody has followed
            rates.push_back(m.range_rate - rate(k, 0.0));
            by_velocity.push_back((rate(k, velocity) - rate(k, 0.0)) / velocity);
            when.push_back(k);
        }
        const auto n = static_cast<Eigen::Index>(rates.size());
        Eigen::MatrixXd R = Eigen::MatrixXd::Zero(n, n);
        const double one = std::pow(sigma / span, 2);  // of one end
        for (Eigen::Index i = 0; i < n; ++i) {
            R(i, i) = 2.0 * one * (1.0 + RangeUpdate<GeographicFrame>::unshared);
            const bool goes_on = i + 1 < n && when[static_cast<std::size_t>(i + 1)] == when[static_cast<std::size_t>(i)] + 1;
            if (goes_on) R(i, i + 1) = R(i + 1, i) = -one;
        }
        const Eigen::Map<const Eigen::VectorXd> h(by_velocity.data(), n);
        const Eigen::VectorXd weights = R.ldlt().solve(h);
        const double information = h.dot(weights);
        const double estimate = o.f.geographic(o.model).v_eb_n.z(), variance = o.f.P(Layout::velocity + 2, Layout::velocity + 2);
        EXPECT_NEAR(variance * information, 1.0, 5e-3) << lost;
        EXPECT_NEAR(estimate, weights.dot(Eigen::Map<const Eigen::VectorXd>(rates.data(), n)) / information,
                    0.1 * std::sqrt(variance))
            << lost;
        EXPECT_LT(std::abs(estimate - velocity), 4.0 * std::sqrt(variance)) << lost;
    }
}

/// Fifty epochs a second: what most ranges contradict is given up after a second, not after ten epochs.
TEST(RangeUpdate, GivesUpItsPlaceAfterASecondOfDisagreement) {
    Overhead wrong({500.0, -400.0, 300.0, -600.0}, 1.0);
    double opened = -1.0;
    estim::Transition phi;
    for (int k = 1; k <= 100 && opened < 0.0; ++k) {
        wrong.f.propagate(wrong.model, {Time::from_seconds(0.02 * k), 0.02, Vector3d::Zero(), Vector3d(0, 0, -0.1962)}, {});
        (void)wrong.f.propagate_covariance(wrong.model, phi);
        wrong.update();
        if (wrong.f.P(0, 0) > 1e4) opened = 0.02 * k;
    }
    EXPECT_NEAR(opened, 1.02, 0.03);
}

}  // namespace
}  // namespace schuler::fusion
