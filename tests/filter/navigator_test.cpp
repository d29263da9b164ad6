// The navigator against the batch: the same bits in any order, bad and late samples, saving, holes.
#include "filter/stream_drive.h"
#include "fusion/range_flight.h"

#include "schuler/filter/navigator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace schuler::fusion {
namespace {

using namespace testing;
using Eigen::Vector3d;

Navigator made(const NavigatorSettings& settings) {
    NavigatorMade m = Navigator::make(settings);
    EXPECT_TRUE(m) << m.key << ": " << m.reason;
    return std::move(*m.navigator);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

void expect_batch_bits(const Recording& recording, const Settings& settings, double still_delay = 0.65) {
    for (const Mechanization frame : {Mechanization::Geographic, Mechanization::Ecef}) {
        Settings s = settings;
        s.mechanization = frame;
        const Batch batch = run_batch(recording, s);
        NavigatorSettings n = stream_settings(recording, s, batch);
        n.still_delay = still_delay;
        Navigator in_order = made(n), in_disorder = made(n);
        const std::vector<Sample> samples = samples_of(recording);
        const std::vector<SolutionRow> rows = stream(in_order, samples, recording.ranges);
        EXPECT_GT(rows.size(), 0.9 * static_cast<double>(batch.rows.size()) - 15.0);
        EXPECT_EQ(same_bits(rows, batch.rows), rows.size());
        // GNSS loses a part of the lag to its own latency
        const std::vector<SolutionRow> again = stream(in_disorder, shuffled(samples, 0.3, 0.3, 3), recording.ranges);
        EXPECT_GT(in_disorder.counters().reordered[0], 100u);
        for (std::size_t k = 0; k < source_count; ++k)
            EXPECT_EQ(in_disorder.counters().of(static_cast<Source>(k), FeedStatus::Late), 0u) << k;
        EXPECT_GE(again.size() + 2, rows.size());
        EXPECT_EQ(same_bits(again, rows), again.size());
    }
}

TEST(Navigator, IsTheLooseBatchToTheLastBitInAnyOrder) {
    StreamLog log = car_log(61);
    EXPECT_GT(run_batch(log.recording, log.settings).data.still.windows.size(), 20u);
    expect_batch_bits(log.recording, log.settings);
    log.settings.constraints.zero_velocity = false;
    expect_batch_bits(log.recording, log.settings, 0.0);
}

TEST(Navigator, IsTheTightBatchToTheLastBitInAnyOrder) {
    test::Flight f = test::flight();
    f.settings.output_rate = 5.0;
    expect_batch_bits(f.recording, f.settings, 0.0);
}

TEST(Navigator, IsTheBatchWithIntegrityPartsAndOpenLoop) {
    StreamLog log = car_log(6);
    log.settings.loose_kind = LooseKind::Aggressive;
    log.settings.integrity.use = true;
    log.settings.integrity.window = 10.0;
    log.settings.gnss.errors.correlated_position.setOnes();
    for (const auto& [loop, coupling] : {std::pair{Loop::Mixed, Coupling::Loose}, {Loop::Closed, Coupling::Separate}}) {
        Settings s = log.settings;
        s.loop = loop;
        s.coupling = coupling;
        const Batch batch = run_batch(log.recording, s);
        Navigator navigator = made(stream_settings(log.recording, s, batch));
        const std::vector<SolutionRow> rows = stream(navigator, samples_of(log.recording), {});
        EXPECT_GT(rows.size() + 15, batch.rows.size());
        EXPECT_EQ(same_bits(rows, batch.rows), rows.size());
    }
}

TEST(Navigator, DisputesAreThoseOfTheBatch) {
    const StreamLog log = disputed_log(14);
    const Batch batch = run_batch(log.recording, log.settings);
    const NavigatorSettings n = stream_settings(log.recording, log.settings, batch);
    Navigator whole = made(n), first = made(n), second = made(n);
    const std::vector<Sample> samples = samples_of(log.recording);
    const std::vector<SolutionRow> rows = stream(whole, samples, {});
    EXPECT_EQ(same_bits(rows, batch.rows), rows.size());
    std::size_t reconsidered = 0;
    while (const std::optional<NavigatorEvent> e = whole.poll())
        reconsidered += e->kind == NavigatorEvent::Kind::Reconsidered ? 1u : 0u;
    EXPECT_GT(reconsidered, 0u);
    // saved before, while and after two hypotheses go side by side
    auto fed = samples.begin();
    for (const double at : {1066.0, 1091.0, 1091.8, 1092.4, 1093.0, 1096.0}) {
        const auto cut = std::ranges::find_if(samples, [&](const Sample& s) { return s.arrival.seconds() > at; });
        (void)stream(first, {fed, cut}, {});
        fed = cut;
        ASSERT_EQ(second.restore(first.save()), RestoreStatus::Restored);
        const std::vector<SolutionRow> rest = stream(second, {cut, samples.end()}, {});
        EXPECT_GT(rest.size(), 100u);
        const std::vector<SolutionRow> same(rows.end() - static_cast<std::ptrdiff_t>(rest.size()), rows.end());
        EXPECT_EQ(same_bits(rest, same), rest.size()) << at;
    }
}

TEST(Navigator, RefusesBadSamplesUnharmed) {
    const StreamLog log = car_log(7);
    const Batch batch = run_batch(log.recording, log.settings);
    const NavigatorSettings n = stream_settings(log.recording, log.settings, batch);
    Navigator healthy = made(n), disturbed = made(n);
    const std::vector<Sample> samples = samples_of(log.recording);
    const std::vector<SolutionRow> rows = stream(healthy, samples, {});
    std::vector<SolutionRow> others;
    std::size_t k = 0;
    for (const Sample& s : samples) {
        (void)feed(disturbed, s, {});
        if (++k % 50 == 0 && k > 500) {
            const Time now = s.arrival + Duration{1'000'003};
            const ImuSample imu{now, Vector3d::Zero(), Vector3d(0.0, 0.0, -9.8)};
            EXPECT_EQ(disturbed.feed(ImuSample{now, Vector3d(nan, 0, 0), imu.accel}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(ImuSample{now, imu.gyro, Vector3d(0, 1e300, 0)}), FeedStatus::BadValue);
            for (const std::int64_t ns : {INT64_MIN, INT64_MAX}) {
                EXPECT_EQ(disturbed.feed(ImuSample{Time{ns}, imu.gyro, imu.accel}), FeedStatus::BadValue);
                EXPECT_EQ(disturbed.feed(BaroSample{Time{ns}, 100.0}), FeedStatus::BadValue);
            }
            EXPECT_EQ(disturbed.feed(ImuSample{now - Duration{5'000'000'000}, imu.gyro, imu.accel}), FeedStatus::Late);
            EXPECT_EQ(disturbed.feed(ImuSample{now + Duration{500'000'000'000}, imu.gyro, imu.accel}), FeedStatus::TooFarAhead);
            GnssFix fix = log.recording.gnss.back();
            fix.time = now;
            const auto refused = [&](auto&& spoil, FeedStatus status) {
                GnssFix bad = fix;
                spoil(bad);
                EXPECT_EQ(disturbed.feed(bad), status);
            };
            refused([](GnssFix& f) { f.position.lat = 7.0; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.position = {0.0, 0.0, 0.0}; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.position.h = 1e9; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.velocity_n.x() = std::numeric_limits<double>::infinity(); }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.std_position.y() = -1.0; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.std_velocity.z() = 1e30; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.std_position.x() = 1e-9; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.std_velocity.y() = 1e-12; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.position_age = nan; }, FeedStatus::BadValue);
            refused([](GnssFix& f) { f.time = f.time - Duration{3'000'000'000}; }, FeedStatus::Late);
            refused([](GnssFix& f) { f.time = f.time + Duration{60'000'000'000}; }, FeedStatus::TooFarAhead);
            EXPECT_EQ(disturbed.feed(BaroSample{now, nan}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(MagSample{now, Vector3d::Zero()}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(OdometerSample{now, 10.0, -2.0}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(HeadingSample{now, 1e9, 0.1}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(OdometerSample{now, 10.0, 1e-12}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(HeadingSample{now, 1.0, 1e-9}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(GaugeSample{now, Vector3d(nan, 1e9, 0.0)}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(GaugeSample{now, Vector3d::Constant(nan)}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(BodyVelocitySample{now, Vector3d(nan, 0.0, 0.0)}), FeedStatus::BadValue);
            EXPECT_EQ(disturbed.feed(now, {}), FeedStatus::NotUsed);
        }
        while (const std::optional<SolutionRow> row = disturbed.poll_row()) others.push_back(*row);
    }
    EXPECT_GT(disturbed.counters().of(Source::Gnss, FeedStatus::BadValue), 100u);
    EXPECT_EQ(others.size(), rows.size());
    EXPECT_EQ(same_bits(others, rows), rows.size());
    EXPECT_TRUE(healthy.state()->nav.position.lat == disturbed.state()->nav.position.lat);
}

TEST(Navigator, NoSampleThrows) {
    const StreamLog log = car_log(15);
    const Batch batch = run_batch(log.recording, log.settings);
    NavigatorSettings n = stream_settings(log.recording, log.settings, batch);
    n.start.reset();
    Navigator navigator = made(n);
    math::Random random(15, "garbage");
    const auto any = [&] {
        constexpr double inf = std::numeric_limits<double>::infinity(), huge = std::numeric_limits<double>::max();
        const double values[] = {nan,    inf, -inf, huge, -huge,           0.0,
                                 1e-310, 1.0, -1.0, 1e6,  random.normal(), 100.0 * random.normal()};
        return values[static_cast<std::size_t>(random.uniform() * 12.0) % 12];
    };
    const auto any3 = [&] { return Vector3d(any(), any(), any()); };
    std::size_t k = 0, taken = 0, rows = 0;
    for (const Sample& s : samples_of(log.recording)) {
        (void)feed(navigator, s, {});
        const std::int64_t times[] = {
            s.arrival.ns, s.arrival.ns + 1'000'000, s.arrival.ns - 300'000'000, INT64_MIN, INT64_MAX, 0};
        const Time time{times[static_cast<std::size_t>(random.uniform() * 6.0) % 6]};
        GnssFix fix{time, {any(), any(), any()}, any3(), any3(), any3()};
        fix.position_age = any();
        fix.velocity_age = any();
        FeedStatus status = FeedStatus::Taken;
        switch (k++ % 8) {
            case 0: status = navigator.feed(ImuSample{time, any3(), any3()}); break;
            case 1: status = navigator.feed(fix); break;
            case 2: status = navigator.feed(BaroSample{time, any()}); break;
            case 3: status = navigator.feed(MagSample{time, any3()}); break;
            case 4: status = navigator.feed(OdometerSample{time, any(), any()}); break;
            case 5: status = navigator.feed(GaugeSample{time, any3()}); break;
            case 6: status = navigator.feed(BodyVelocitySample{time, any3()}); break;
            default: status = navigator.feed(HeadingSample{time, any(), any()}); break;
        }
        taken += status == FeedStatus::Taken ? 1u : 0u;
        if (const std::optional<NavigatorState> state = navigator.state(); state && k % 10 == 0) {
            EXPECT_TRUE(state->covariance.allFinite());
            EXPECT_TRUE(state->nav.v_eb_n.allFinite());
        }
        while (navigator.poll_row()) ++rows;
    }
    EXPECT_GT(taken, 100u);
    EXPECT_GT(rows, 100u);
}

TEST(Navigator, LateAndRepeatedSamplesAreCounted) {
    const StreamLog log = car_log(8);
    const Batch batch = run_batch(log.recording, log.settings);
    Navigator navigator = made(stream_settings(log.recording, log.settings, batch));
    std::vector<Sample> samples = samples_of(log.recording);
    std::size_t late = 0, n = 0;
    for (Sample& s : samples)  // every tenth fix comes 0.6 s after its stamp, too late by its latency too
        if (std::holds_alternative<GnssFix>(s.what) && ++n % 10 == 0) s.arrival = s.arrival + Duration{600'000'000}, ++late;
    std::ranges::stable_sort(samples, {}, &Sample::arrival);
    (void)stream(navigator, samples, {});
    EXPECT_NEAR(static_cast<double>(navigator.counters().of(Source::Gnss, FeedStatus::Late)), static_cast<double>(late), 1.0);
    EXPECT_EQ(navigator.counters().of(Source::Gnss, FeedStatus::Taken) + navigator.counters().of(Source::Gnss, FeedStatus::Late),
              n);
    EXPECT_EQ(navigator.feed(log.recording.imu.back()), FeedStatus::Duplicate);
    std::size_t told = 0;
    while (const std::optional<NavigatorEvent> e = navigator.poll())
        told += e->kind == NavigatorEvent::Kind::Refused && e->source == Source::Gnss && e->status == FeedStatus::Late ? 1u : 0u;
    EXPECT_EQ(told, navigator.counters().of(Source::Gnss, FeedStatus::Late));
}

TEST(Navigator, GoesOnWithTheSameBitsAfterRestoring) {
    StreamLog log = car_log(9);
    log.settings.integrity.use = true;
    log.settings.integrity.window = 10.0;
    test::Flight flight = test::flight();
    flight.settings.ranging.protection.use = true;
    for (const auto& [recording, settings] : {std::pair{&log.recording, &log.settings}, {&flight.recording, &flight.settings}}) {
        for (const Mechanization frame : {Mechanization::Geographic, Mechanization::Ecef}) {
            settings->mechanization = frame;
            const Batch batch = run_batch(*recording, *settings);
            const NavigatorSettings n = stream_settings(*recording, *settings, batch);
            Navigator first = made(n), second = made(n);
            const std::vector<Sample> samples = samples_of(*recording);
            const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
            (void)stream(first, {samples.begin(), middle}, recording->ranges);
            (void)first.state();
            const std::vector<std::byte> bytes = first.save();
            ASSERT_EQ(second.restore(bytes), RestoreStatus::Restored);
            EXPECT_EQ(second.save(), bytes);
            const std::vector<SolutionRow> a = stream(first, {middle, samples.end()}, recording->ranges);
            const std::vector<SolutionRow> b = stream(second, {middle, samples.end()}, recording->ranges);
            EXPECT_GT(a.size(), 50u);
            EXPECT_EQ(b.size(), a.size());
            EXPECT_EQ(same_bits(a, b), a.size());
            const NavigatorState x = *first.state(), y = *second.state();
            EXPECT_EQ(x.covariance, y.covariance);
            EXPECT_EQ(x.nav.q_nb.coeffs(), y.nav.q_nb.coeffs());
            EXPECT_EQ(first.save(), second.save());
        }
    }
}

TEST(Navigator, RefusesForeignAndDamagedBytes) {
    const StreamLog log = car_log(9, 20.0);
    const Batch batch = run_batch(log.recording, log.settings);
    NavigatorSettings n = stream_settings(log.recording, log.settings, batch);
    Navigator navigator = made(n);
    (void)stream(navigator, samples_of(log.recording), {});
    const std::vector<std::byte> bytes = navigator.save();
    const auto spoiled = [&](std::size_t at) {
        std::vector<std::byte> b = bytes;
        b[at] ^= std::byte{4};
        return navigator.restore(b);
    };
    EXPECT_EQ(spoiled(0), RestoreStatus::Foreign);
    EXPECT_EQ(spoiled(8), RestoreStatus::OtherVersion);
    EXPECT_EQ(spoiled(16), RestoreStatus::OtherSettings);
    EXPECT_EQ(spoiled(bytes.size() / 2), RestoreStatus::Damaged);
    EXPECT_EQ(spoiled(bytes.size() - 1), RestoreStatus::Damaged);
    EXPECT_EQ(navigator.restore(std::span(bytes).first(bytes.size() - 1)), RestoreStatus::TooShort);
    EXPECT_EQ(navigator.restore({}), RestoreStatus::TooShort);
    EXPECT_EQ(navigator.save(), bytes);  // as it was
    const auto with = [&](auto&& change) {
        NavigatorSettings other = n;
        change(other.filter);
        return made(other).restore(bytes);
    };
    EXPECT_EQ(with([](Settings&) {}), RestoreStatus::Restored);
    EXPECT_EQ(with([](Settings& s) { s.imu.errors.gyro_noise *= 2.0; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.mag.declination = 0.5; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.mag.deviation_std *= 2.0; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.earth.ellipsoid.gm *= 1.0 + 1e-9; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.earth.gravity = earth::GravityModel::PaperA; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.constraints.floor_position = 50.0; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.constraints.zero_velocity_std *= 3.0; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.constraints.recovery_time = 30.0; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.gnss.std_floor_position.z() = 1.0; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.feedback_period = 5.0; }), RestoreStatus::OtherSettings);
    EXPECT_EQ(with([](Settings& s) { s.separate.position_time = 5.0; }), RestoreStatus::OtherSettings);
}

TEST(Navigator, PredictsToTheNewestSample) {
    StreamLog log = car_log(10);
    log.settings.loose_kind = LooseKind::Aggressive;  // which corrects between measurements too
    const Batch batch = run_batch(log.recording, log.settings);
    NavigatorSettings n = stream_settings(log.recording, log.settings, batch);
    n.still_delay = 0.0;
    Navigator asked = made(n), silent = made(n);
    const earth::Earth earth;
    double worst = 0.0;
    std::size_t k = 0;
    for (const Sample& s : samples_of(log.recording)) {
        (void)feed(asked, s, {});
        (void)feed(silent, s, {});
        const std::optional<NavigatorState> now = asked.state();
        if (!now || !std::holds_alternative<ImuSample>(s.what)) continue;
        EXPECT_EQ(now->nav.time, s.arrival);
        const std::optional<NavigatorState> then = asked.lagged();
        EXPECT_NEAR((now->nav.time - then->nav.time).seconds(), n.lag, 0.03);
        while (k + 1 < log.recording.reference.size() && log.recording.reference[k + 1].time <= s.arrival) ++k;
        if (log.recording.reference[k].time != s.arrival) continue;
        const Vector3d d = earth::ned_difference(earth, now->nav.position, log.recording.reference[k].position);
        worst = std::max(worst, d.cwiseQuotient(now->covariance.diagonal().head<3>().cwiseSqrt()).cwiseAbs().maxCoeff());
        EXPECT_GT(now->covariance(0, 0), then->covariance(0, 0));
    }
    EXPECT_LT(worst, 5.0);
    EXPECT_GT(worst, 0.1);
    // asking changes nothing: carried on step by step or all at once, the state is the same
    const NavigatorState a = *asked.state(), b = *silent.state();
    EXPECT_EQ(a.nav.position.lat, b.nav.position.lat);
    EXPECT_EQ(a.nav.v_eb_n, b.nav.v_eb_n);
    EXPECT_LT((a.covariance - b.covariance).norm(), 1e-9 * b.covariance.norm());
}

TEST(Navigator, BridgesHolesAndBeginsAnewOnAnotherAxis) {
    const StreamLog log = car_log(11, 60.0);
    const Batch batch = run_batch(log.recording, log.settings);
    NavigatorSettings n = stream_settings(log.recording, log.settings, batch);
    Navigator navigator = made(n);
    std::vector<Sample> samples = samples_of(log.recording);
    const Time origin = samples.front().arrival;
    std::erase_if(samples, [&](const Sample& s) {  // two seconds without the IMU
        const double t = (s.arrival - origin).seconds();
        return std::holds_alternative<ImuSample>(s.what) && t > 30.0 && t < 32.0;
    });
    (void)stream(navigator, samples, {});
    EXPECT_EQ(navigator.counters().holes, 1u);
    EXPECT_EQ(navigator.phase(), Phase::Navigating);
    const ReferenceSample& truth = log.recording.reference.back();
    EXPECT_LT(earth::ned_difference({}, navigator.state()->nav.position, truth.position).norm(), 5.0);
    bool hole = false;
    while (const std::optional<NavigatorEvent> e = navigator.poll())
        hole = hole || (e->kind == NavigatorEvent::Kind::Hole && std::abs(e->seconds - 2.0) < 0.05);
    EXPECT_TRUE(hole);
    // the clock of the logger is set: an hour on
    for (ImuSample s : log.recording.imu) {
        s.time = s.time + Duration{3'600'000'000'000};
        (void)navigator.feed(s);
    }
    EXPECT_EQ(navigator.counters().restarts, 1u);
    EXPECT_EQ(navigator.phase(), Phase::WaitingForPosition);
    EXPECT_FALSE(navigator.state());
}

TEST(Navigator, TakesAUnitThatHangsForAHole) {
    StreamLog log = car_log(12, 60.0);
    const auto hang = [&](double from, double to) {
        const ImuSample* last = nullptr;
        for (ImuSample& s : log.recording.imu) {
            const double t = s.time.seconds() - 1000.0;
            if (t >= from && t < to && last != nullptr) s.gyro = last->gyro, s.accel = last->accel;
            last = &s;
        }
    };
    const Batch batch = run_batch(log.recording, log.settings);
    hang(40.0, 41.5);
    Navigator navigator = made(stream_settings(log.recording, log.settings, batch));
    (void)stream(navigator, samples_of(log.recording), {});
    std::size_t hangs = 0;
    double hole = 0.0;
    while (const std::optional<NavigatorEvent> e = navigator.poll()) {
        hangs += e->kind == NavigatorEvent::Kind::Hang ? 1u : 0u;
        if (e->kind == NavigatorEvent::Kind::Hole) hole += e->seconds;
    }
    EXPECT_NEAR(static_cast<double>(hangs), 140.0, 2.0);
    EXPECT_NEAR(hole, 1.4, 0.05);
    EXPECT_LT(earth::ned_difference({}, navigator.state()->nav.position, log.recording.reference.back().position).norm(), 5.0);
    // a unit without noise that has not moved yet does not hang
    NavigatorSettings n = stream_settings(log.recording, log.settings, batch);
    Navigator other = made(n);
    for (const ImuSample& s : log.recording.imu) (void)other.feed(ImuSample{s.time, Vector3d::Zero(), Vector3d(0.0, 0.0, -9.8)});
    EXPECT_EQ(other.counters().holes, 0u);
    EXPECT_TRUE(other.state());
}

TEST(Navigator, SaysWhatItCannotBeTold) {
    const auto status = [](auto&& spoil) {
        NavigatorSettings n;
        spoil(n);
        const NavigatorMade m = Navigator::make(n);
        EXPECT_EQ(static_cast<bool>(m), m.status == MakeStatus::Made);
        return m.status;
    };
    EXPECT_EQ(status([](NavigatorSettings&) {}), MakeStatus::Made);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.imu_interval = nan; }), MakeStatus::BadSettings);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.lag = -1.0; }), MakeStatus::BadSettings);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.gnss.velocity_latency = 0.6; }), MakeStatus::BadSettings);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.coupling = Coupling::Tight; }), MakeStatus::BadSettings);
    EXPECT_EQ(status([](NavigatorSettings& n) {
                  n.filter.coupling = Coupling::Intermediate;
                  n.rates.ranges = 1.0;
              }),
              MakeStatus::NotForStreams);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.coupling = Coupling::Deep; }), MakeStatus::NotForStreams);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.smooth = true; }), MakeStatus::NotForStreams);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.backward = true; }), MakeStatus::NotForStreams);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.output_lever_arm_b.x() = 1.0; }), MakeStatus::NotForStreams);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.output_instants.emplace_back(); }), MakeStatus::NotForStreams);
    // probabilities without a quantile: refused by their own key, not by an exception on the way
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.constraints.gate_probability = 0.0; }), MakeStatus::Made);
    EXPECT_EQ(status([](NavigatorSettings& n) { n.filter.constraints.gate_probability = 1e-20; }), MakeStatus::BadSettings);
    EXPECT_EQ(status([](NavigatorSettings& n) {
                  n.filter.integrity.use = true;
                  n.filter.integrity.false_alarm = 1.0;
              }),
              MakeStatus::BadSettings);
    EXPECT_EQ(status([](NavigatorSettings& n) {
                  n.filter.ranging.protection.use = true;
                  n.filter.ranging.protection.missed_detection = 0.5;
              }),
              MakeStatus::BadSettings);
}

/// A covariance that overflows: the navigator says so and begins anew, by fixes as by ranges.
TEST(Navigator, DivergenceIsAnEventAndNoException) {
    const StreamLog car = car_log(61);
    const test::Flight flight = test::flight();
    for (const bool ranges : {false, true}) {
        const Recording& recording = ranges ? flight.recording : car.recording;
        for (const Mechanization frame : {Mechanization::Geographic, Mechanization::Ecef}) {
            Settings settings = ranges ? flight.settings : car.settings;
            settings.mechanization = frame;
            NavigatorSettings n = stream_settings(recording, settings, run_batch(recording, settings));
            n.filter.imu.errors.gyro_noise = 1e170;
            Navigator navigator = made(n);
            std::size_t diverged = 0;
            for (const RangeSource& s : recording.ranges.sources) (void)navigator.range_source(s.name, s.station);
            for (const Sample& s : samples_of(recording)) {
                (void)feed(navigator, s, recording.ranges);
                while (const std::optional<NavigatorEvent> e = navigator.poll())
                    diverged += e->kind == NavigatorEvent::Kind::Diverged ? 1u : 0u;
            }
            EXPECT_GE(diverged, 1u) << ranges;
        }
    }
}

}  // namespace
}  // namespace schuler::fusion
