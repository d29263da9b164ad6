// One channel from search to phase lock, its losses, and what an inertial aid changes.
#include "schuler/receiver/tracker.h"

#include "schuler/core/error.h"
#include "schuler/math/chi_square.h"
#include "schuler/receiver/search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace schuler::receiver {
namespace {

/// A signal and the channel that follows it, a code period at a time.
struct Scene {
    explicit Scene(TrackingSettings s = {}, SignalStructure signal_of = gps_l1_ca(), std::uint64_t seed = 1)
        : signal(signal_of),
          settings(s),
          model(CorrelationPeak(signal.chip_rate), s.spacing),
          tracker(signal, model.peak(), s),
          random(seed, "tracker") {}

    SignalStructure signal;
    TrackingSettings settings;
    CorrelatorModel model;
    Tracker tracker;
    math::Random random;
    LineOfSight truth{2.2e7, -420.0, 0.0, 0.0};
    std::function<double(double)> cn0_db = [](double) { return 45.0; };
    std::function<double(double)> acceleration = [](double) { return 0.0; };  ///< m/s^2 at a time
    bool aided = false;
    double aid_error = 0.0;  ///< m/s
    long period = 0;         ///< code periods since a symbol began
    int sign = 1;

    [[nodiscard]] int symbol() const { return static_cast<int>(std::lround(signal.symbol_duration / signal.code_period())); }
    [[nodiscard]] double time() const { return static_cast<double>(period) * signal.code_period(); }
    [[nodiscard]] Replica aligned() const { return aligned_replica(signal, truth); }
    [[nodiscard]] ReplicaError error() const { return replica_error(signal, tracker.replica(), truth, 0.0); }

    void run(double seconds) {
        const double T = signal.code_period();
        for (const long end = period + std::lround(seconds / T); period < end;) {
            if (period % symbol() == 0) sign = random.bits() % 2 == 0 ? 1 : -1;
            truth.acceleration = acceleration(time());
            const ReplicaError e = replica_error(signal, tracker.replica(), truth, T);
            const Correlators dump = model.dump(e, cn0_from_db(cn0_db(time())), T, sign, random);
            truth = truth.after(T);
            ++period;
            LineOfSight aid = truth;
            aid.rate += aid_error;
            tracker.step(dump, aided ? &aid : nullptr);
        }
    }
};

TEST(Tracker, PullsInFindsTheSymbolsAndLocks) {
    for (int seed = 1; seed <= 12; ++seed) {
        const double db = seed % 2 == 0 ? 36.0 : 45.0;
        Scene s({}, gps_l1_ca(), static_cast<std::uint64_t>(seed));
        s.cn0_db = [&](double) { return db; };
        Replica start = s.aligned();
        start.code_phase += 0.24;
        start.carrier_frequency += 180.0;
        s.period = 7;  // the first dump is the eighth of its symbol
        s.tracker.start(start);
        s.run(5.0);
        EXPECT_EQ(s.tracker.state(), TrackState::Phase) << seed;
        EXPECT_TRUE(s.tracker.phase_locked());
        EXPECT_EQ(s.tracker.dumps_into_symbol(), s.period % 20) << seed;
        EXPECT_NEAR(db_from_cn0(s.tracker.cn0()), db, 1.2);
        EXPECT_NEAR(s.error().frequency, 0.0, 5.0) << seed;
        EXPECT_NEAR(s.error().code, 0.0, 0.05);
        const double half_cycles = s.error().phase / std::numbers::pi;
        EXPECT_NEAR(half_cycles, std::round(half_cycles), 0.1);
    }
}

TEST(Tracker, FollowsGlonass) {
    TrackingSettings settings;
    settings.integration = 5;
    Scene s(settings, glonass_l1_of(-4));
    s.tracker.start(s.aligned());
    s.run(4.0);
    EXPECT_TRUE(s.tracker.phase_locked());
    EXPECT_EQ(s.tracker.dumps_into_symbol(), s.period % 10);
    EXPECT_NEAR(s.error().code, 0.0, 0.05);
}

TEST(Tracker, CarrierToNoiseFromTheSignalItself) {
    for (const double db : {25.0, 32.0, 40.0, 50.0}) {
        Cn0Estimator estimator(0.010, 2.0, 1.0, 1000.0);
        const CorrelatorModel model(CorrelationPeak(1.023e6), 0.5);
        math::Random random(4, "cn0");
        for (int i = 0; i < 2000; ++i) estimator.add(model.dump({}, cn0_from_db(db), 0.010, i % 7 < 4 ? 1 : -1, random).prompt);
        EXPECT_NEAR(db_from_cn0(estimator.cn0()), db, 0.8);
    }
}

TEST(Tracker, AnAccelerationBreaksTheLoopAloneAndNotTheAidedOne) {
    // 10 g begun within a tenth of a second: 100 g/s of jerk, far beyond a loop of 5 Hz.
    TrackingSettings narrow;
    narrow.pll_bandwidth = 5.0;
    narrow.integration = 20;
    for (const bool aided : {false, true}) {
        Scene s(narrow);
        s.aided = aided;
        s.aid_error = 0.3;  // what clock and navigation leave, constant
        s.cn0_db = [](double) { return 38.0; };
        s.tracker.start(s.aligned(), 0);
        s.run(4.0);
        ASSERT_TRUE(s.tracker.phase_locked());
        s.acceleration = [](double t) { return std::clamp((t - 4.0) * 980.0, 0.0, 98.0); };
        s.run(1.0);
        EXPECT_EQ(std::abs(s.error().frequency) < 5.0, aided);
        // alone, the loop may settle on a false frequency half a cycle an integration away: its own detector is no judge
        EXPECT_TRUE(s.tracker.phase_locked() || !aided);
    }
}

TEST(Tracker, CodeGoesOnWithTheInertialRateWhenTheCarrierIsLost) {
    Scene s;
    s.aided = true;
    s.aid_error = 0.05;
    s.tracker.start(s.aligned(), 0);
    s.run(4.0);
    ASSERT_TRUE(s.tracker.phase_locked());
    s.cn0_db = [](double) { return 18.0; };
    s.acceleration = [](double t) { return 20.0 * std::sin(t); };
    s.run(30.0);
    EXPECT_EQ(s.tracker.state(), TrackState::CodeOnly);
    EXPECT_NEAR(s.error().code, 0.0, 0.12);
    s.cn0_db = [](double) { return 40.0; };
    s.run(5.0);
    EXPECT_TRUE(s.tracker.phase_locked());
    EXPECT_NEAR(s.error().code, 0.0, 0.05);
    // Alone, the same fading loses the signal.
    Scene alone;
    alone.tracker.start(alone.aligned(), 0);
    alone.run(4.0);
    alone.cn0_db = [](double) { return 18.0; };
    alone.acceleration = [](double t) { return 20.0 * std::sin(t); };
    alone.run(30.0);
    EXPECT_TRUE(alone.tracker.state() == TrackState::Lost || std::abs(alone.error().code) > 0.5);
}

/// Half a cycle a sum off, the phase loop is locked as well as at the signal's own frequency.
TEST(Tracker, FindsOutThatItsLockIsFalse) {
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        Scene s({}, gps_l1_ca(), seed);
        s.tracker.start(s.aligned(), 0);
        s.run(4.0);
        ASSERT_TRUE(s.tracker.phase_locked()) << seed;
        s.truth.rate += 50.0 * s.signal.wavelength();  // sums of 10 ms
        for (int i = 0; i < 40; ++i) {
            s.run(0.050);
            if (i > 3 && std::isfinite(s.tracker.frequency_variance())) {
                EXPECT_NEAR(s.error().frequency, 0.0, 5.0) << seed << ' ' << i;
            }
        }
        EXPECT_TRUE(s.tracker.phase_locked()) << seed;
        EXPECT_TRUE(std::isfinite(s.tracker.frequency_variance())) << seed;
    }
}

/// With an aid the frequency is known from before the loss, much better than a weak signal tells it in half a second.
TEST(Tracker, AidedItReturnsToTheFrequencyItHad) {
    TrackingSettings narrow;
    narrow.pll_bandwidth = 3.0;
    narrow.integration = 20;
    int back = 0;
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Scene s(narrow, gps_l1_ca(), seed);
        s.aided = true;
        s.aid_error = 0.3;
        s.tracker.start(s.aligned(), 0);
        s.run(4.0);
        ASSERT_TRUE(s.tracker.phase_locked()) << seed;
        s.cn0_db = [](double) { return 5.0; };
        s.run(4.0);
        EXPECT_EQ(s.tracker.state(), TrackState::CodeOnly) << seed;
        s.cn0_db = [](double) { return 27.0; };
        for (int i = 0; i < 60; ++i) {
            s.run(0.1);
            if (!std::isfinite(s.tracker.frequency_variance())) continue;
            EXPECT_NEAR(s.error().frequency, 0.0, 4.0) << seed << ' ' << i;
            back += i == 59 ? 1 : 0;
        }
    }
    EXPECT_GE(back, 11);
}

TEST(Tracker, RefusesSettingsThatCannotWork) {
    const CorrelationPeak peak(1.023e6);
    const auto refused = [&](auto change) {
        TrackingSettings s;
        change(s);
        EXPECT_THROW(Tracker(gps_l1_ca(), peak, s), Error);
    };
    refused([](TrackingSettings& s) { s.integration = 3; });
    refused([](TrackingSettings& s) { s.integration = 0; });
    refused([](TrackingSettings& s) { s.pll_bandwidth = 50.0; });
    refused([](TrackingSettings& s) { s.spacing = 1.5; });
    refused([](TrackingSettings& s) { s.phase_lock = 1.0; });
    refused([](TrackingSettings& s) { s.dll_bandwidth = -1.0; });
}

TEST(Search, FindsAsOftenAsTheNoncentralChiSquareSays) {
    // One cell, ten noncoherent milliseconds. Oracle: the noncentral chi-square as a Poisson mixture of central ones.
    const SignalStructure gps = gps_l1_ca();
    const CorrelatorModel model(CorrelationPeak(gps.chip_rate), 0.5);
    SearchSettings settings;
    settings.false_alarm = 1e-4;
    math::Random random(5, "search");
    const double cn0 = cn0_from_db(32.0);
    const LineOfSight truth{2.2e7, 0.0, 0.0, 0.0};
    const Replica centre{-truth.range / gps.chip_length(), 0.0, 0.0, 0.0};
    int found = 0;
    constexpr int runs = 4000;
    Search search(gps, model, settings, {0.2, 1.0}, centre);
    ASSERT_EQ(search.dwells_per_sweep(), 1);
    for (int i = 0; i < runs; ++i) {
        Search once(search);
        EXPECT_FALSE(once.step(truth, cn0, random)) << "not before it was confirmed";
        found += once.candidate() ? 1 : 0;
    }
    const double lambda = 10.0 * 2.0 * cn0 * 0.001;
    double probability = 0.0, weight = std::exp(-lambda / 2.0);
    for (int k = 0; k < 200; ++k, weight *= lambda / 2.0 / k)
        probability += weight * math::chi_square_survival(search.threshold(), 20.0 + 2.0 * k);
    EXPECT_NEAR(found / static_cast<double>(runs), probability, 0.025);
    EXPECT_GT(probability, 0.2);
    EXPECT_LT(probability, 0.9);
}

/// What is found is off by as much as it says: the tracker begins with that.
TEST(Search, ItsErrorsAreThoseOfItsCells) {
    const SignalStructure gps = gps_l1_ca();
    const CorrelatorModel model(CorrelationPeak(gps.chip_rate), 0.5);
    math::Random random(6, "search");
    const LineOfSight truth{2.2e7, 0.0, 0.0, 0.0};
    double code = 0.0, frequency = 0.0;
    constexpr int runs = 400;
    ReplicaUncertainty stated;
    for (int i = 0; i < runs; ++i) {
        Replica centre = aligned_replica(gps, truth);
        centre.code_phase += 4.0 * random.uniform() - 2.0;
        centre.carrier_frequency += 600.0 * random.uniform() - 300.0;
        Search search(gps, model, {}, {3.0, 400.0}, centre);
        LineOfSight now = truth;
        while (!search.step(now, cn0_from_db(45.0), random)) now = now.after(search.dwell());
        const ReplicaError e = replica_error(gps, search.replica(), now.after(search.dwell()), 0.0);
        stated = search.uncertainty();
        code += e.code * e.code / runs;
        frequency += e.frequency * e.frequency / runs;
    }
    EXPECT_LT(code / (stated.code * stated.code), 1.5);
    EXPECT_GT(code / (stated.code * stated.code), 0.3);
    EXPECT_LT(frequency / (stated.frequency * stated.frequency), 1.5);
    EXPECT_GT(frequency / (stated.frequency * stated.frequency), 0.3);
    Scene s;
    s.tracker.start(s.aligned(), 0, {0.2, 30.0});
    EXPECT_DOUBLE_EQ(s.tracker.code_variance(), 0.04);
}

/// Time until the signal is found and followed in phase, s; -1 when not within `limit`.
double start_time(const SearchWindow& window, const SearchSettings& settings, const Replica& offset, bool time_known, double db,
                  bool aided, double limit, std::uint64_t seed = 1) {
    Scene s({}, gps_l1_ca(), seed);
    s.cn0_db = [=](double) { return db; };
    s.aided = aided;
    Replica centre = s.aligned();
    centre.code_phase += offset.code_phase;
    centre.carrier_frequency += offset.carrier_frequency;
    Search search(s.signal, s.model, settings, window, centre);
    while (!search.step(s.truth, cn0_from_db(db), s.random)) {
        if (search.elapsed() > limit) return -1.0;
        s.truth = s.truth.after(search.dwell());
    }
    s.truth = s.truth.after(search.dwell());
    s.tracker.start(search.replica(), time_known ? std::optional<int>(0) : std::nullopt);
    while (!s.tracker.phase_locked()) {
        if (s.time() > limit) return -1.0;
        s.run(0.020);
    }
    return search.elapsed() + s.time();
}

TEST(Search, ColdWarmAndInertialStarts) {
    const SignalStructure gps = gps_l1_ca();
    const SearchWindow cold = cold_window(gps, 5000.0, 1e-6), hot = predicted_window(gps, 3000.0, 60.0),
                       inertial = predicted_window(gps, 30.0, 0.5);
    SearchSettings settings;
    const double t_cold = start_time(cold, settings, {300.0, 0.0, 0.0, 4400.0}, false, 40.0, false, 60.0);
    const double t_hot = start_time(hot, settings, {25.0, 0.0, 0.0, 700.0}, false, 40.0, false, 60.0);
    SearchSettings deep = settings;
    deep.coherent = 10;
    deep.noncoherent = 10;
    const double t_inertial = start_time(inertial, deep, {0.2, 0.0, 0.0, 2.0}, true, 40.0, true, 60.0);
    EXPECT_GT(t_cold, t_hot + 0.2);
    EXPECT_GT(t_hot, 1.5);  // pulling in and listening for symbols
    EXPECT_GT(t_inertial, 0.0);
    EXPECT_LT(t_inertial, 1.3);
    // A strong signal is found in its own bin and not in one beside it.
    int found = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed)
        found +=
            start_time(cold, settings, {300.0, 0.0, 0.0, 520.0 * static_cast<double>(seed)}, false, 45.0, false, 5.0, seed) > 0.0
                ? 1
                : 0;
    EXPECT_GE(found, 9);
    // A weak signal: the wide search does not find it in the time the narrow one needs.
    EXPECT_LT(start_time(cold, settings, {300.0, 0.0, 0.0, 4400.0}, false, 28.0, false, 6.0), 0.0);
    const double weak = start_time(inertial, deep, {0.2, 0.0, 0.0, 2.0}, true, 28.0, true, 6.0);
    EXPECT_GT(weak, 0.0);
    EXPECT_LT(weak, 3.0);
}

TEST(Search, RefusesEmptyWindowsAndSettings) {
    const SignalStructure gps = gps_l1_ca();
    const CorrelatorModel model(CorrelationPeak(gps.chip_rate), 0.5);
    EXPECT_THROW(Search(gps, model, {}, {0.0, 10.0}, {}), Error);
    SearchSettings bad;
    bad.coherent = 21;
    EXPECT_THROW(Search(gps, model, bad, {1.0, 10.0}, {}), Error);
}

}  // namespace
}  // namespace schuler::receiver
