// IMU increments without holes, and measurements in order of validity.
#include "schuler/fusion/timeline.h"
#include "schuler/core/error.h"
#include "schuler/core/units.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <map>
#include <tuple>

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;

constexpr double dt = 0.01;  // s, nominal

/// Motion whose rates are polynomials, so that their integrals are known.
Vector3d angle_at(double t) { return {0.1 * t, 0.02 * t * t, -0.3 * t}; }
Vector3d velocity_at(double t) { return {0.5 * t * t, -0.2 * t, -9.8 * t}; }

/// Samples over (k dt - dt, k dt], k = 1..count, those of `lost` left out.
std::vector<ImuSample> samples(int count, ImuKind kind, ImuStamp stamp, const std::function<bool(int)>& lost = {}) {
    std::vector<ImuSample> list;
    for (int k = 1; k <= count; ++k) {
        if (lost && lost(k)) continue;
        const double end = 1000.0 + k * dt;
        const double unit = kind == ImuKind::Rates ? dt : 1.0;
        const double mark = stamp == ImuStamp::End ? end : stamp == ImuStamp::Center ? end - 0.5 * dt : end - dt;
        list.push_back({Time::from_seconds(mark), (angle_at(k * dt) - angle_at((k - 1) * dt)) / unit,
                        (velocity_at(k * dt) - velocity_at((k - 1) * dt)) / unit});
    }
    return list;
}

ImuSettings settings_of(ImuKind kind, ImuStamp stamp) {
    ImuSettings s;
    s.kind = kind;
    s.stamp = stamp;
    return s;
}

/// Every increment starts where the one before it ends.
void expect_gapless(const ImuTimeline& timeline) {
    double sum = 0.0;
    for (std::size_t i = 0; i < timeline.increments.size(); ++i) {
        const ImuIncrement& inc = timeline.increments[i];
        ASSERT_GT(inc.dt, 0.0);
        sum += inc.dt;
        if (i == 0) continue;
        ASSERT_NEAR((inc.time - timeline.increments[i - 1].time).seconds(), inc.dt, 1e-9) << i;
    }
    const double span = (timeline.increments.back().time - timeline.increments.front().time).seconds();
    EXPECT_NEAR(sum, span + timeline.increments.front().dt, 1e-8);
}

TEST(ImuTimeline, KindsAndStampsOfTheSameMotionGiveTheSameIncrements) {
    for (const ImuKind kind : {ImuKind::Rates, ImuKind::Increments})
        for (const ImuStamp stamp : {ImuStamp::Start, ImuStamp::Center, ImuStamp::End}) {
            WarningLog warnings;
            const ImuTimeline timeline = make_imu_timeline(samples(500, kind, stamp), settings_of(kind, stamp), warnings);
            ASSERT_EQ(timeline.increments.size(), 500u);
            EXPECT_NEAR(timeline.median_dt, dt, 1e-9);
            EXPECT_TRUE(warnings.empty());
            EXPECT_TRUE(timeline.bridges.empty());
            expect_gapless(timeline);
            for (int k = 1; k <= 500; ++k) {
                const ImuIncrement& inc = timeline.increments[static_cast<std::size_t>(k - 1)];
                ASSERT_NEAR(inc.time.seconds(), 1000.0 + k * dt, 3e-9) << k;
                ASSERT_NEAR(inc.dt, dt, 3e-9);
                // Ends of centred samples are halves of nanoseconds: a relative 1e-7 of 10 ms.
                ASSERT_LT((inc.dtheta - (angle_at(k * dt) - angle_at((k - 1) * dt))).norm(), 1e-9);
                ASSERT_LT((inc.dv - (velocity_at(k * dt) - velocity_at((k - 1) * dt))).norm(), 1e-7);
            }
        }
}

TEST(ImuTimeline, AxesComeBeforeTheMounting) {
    ImuSettings s = settings_of(ImuKind::Rates, ImuStamp::End);
    s.C_bs << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;  // right-forward-up sensor
    s.mounting_rpy = Vector3d(0.0, 0.0, 90.0 * units::deg);
    WarningLog warnings;
    std::vector<ImuSample> list;
    for (int k = 1; k <= 5; ++k) list.push_back({Time::from_seconds(k * dt), {1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}});
    const ImuTimeline timeline = make_imu_timeline(list, s, warnings);
    // Axes give (2, 1, -3); a quarter turn about down takes forward to right: (-1, 2, -3).
    EXPECT_LT((timeline.increments[2].dtheta / dt - Vector3d(-1.0, 2.0, -3.0)).norm(), 1e-12);
    EXPECT_LT((timeline.increments[2].dv / dt - Vector3d(-4.0, 5.0, -6.0)).norm(), 1e-12);
}

TEST(ImuTimeline, RepeatedAndBackwardRowsAreLeftOut) {
    std::vector<ImuSample> list = samples(300, ImuKind::Increments, ImuStamp::End);
    const ImuSample bad{list[100].time, Vector3d::Constant(99.0), Vector3d::Constant(99.0)};
    list.insert(list.begin() + 101, bad);                                    // same time again
    list.insert(list.begin() + 200, {list[150].time, bad.gyro, bad.accel});  // back in time
    WarningLog warnings;
    const ImuTimeline timeline = make_imu_timeline(list, settings_of(ImuKind::Increments, ImuStamp::End), warnings);
    EXPECT_EQ(timeline.duplicates, 2u);
    EXPECT_EQ(warnings.count("imu.duplicates"), 1u);
    EXPECT_EQ(timeline.increments.size(), 300u);
    expect_gapless(timeline);
    Vector3d angle = Vector3d::Zero();
    for (const ImuIncrement& inc : timeline.increments) angle += inc.dtheta;
    EXPECT_LT((angle - angle_at(3.0)).norm(), 1e-12);
}

TEST(ImuTimeline, HoleIsBridgedAndTheSampleAfterItKeepsItsOwn) {
    for (const ImuKind kind : {ImuKind::Rates, ImuKind::Increments}) {
        const auto lost = [](int k) { return k > 200 && k <= 250; };
        WarningLog warnings;
        const ImuTimeline timeline =
            make_imu_timeline(samples(500, kind, ImuStamp::End, lost), settings_of(kind, ImuStamp::End), warnings);
        EXPECT_EQ(timeline.gaps, 1u);
        EXPECT_EQ(warnings.count("imu.gaps"), 1u);
        expect_gapless(timeline);
        ASSERT_EQ(timeline.bridges.size(), 1u);
        const Bridge& bridge = timeline.bridges[0];
        ASSERT_EQ(bridge.first, 200u);
        double bridged = 0.0;
        Vector3d angle = Vector3d::Zero(), velocity = Vector3d::Zero();
        for (std::size_t i = bridge.first; i <= bridge.last; ++i) {
            bridged += timeline.increments[i].dt;
            angle += timeline.increments[i].dtheta;
            velocity += timeline.increments[i].dv;
        }
        EXPECT_NEAR(bridged, 50 * dt, 1e-8);
        EXPECT_NEAR(timeline.increments[bridge.last].time.seconds(), 1000.0 + 250 * dt, 1e-8);
        // Rates that change evenly are interpolated exactly.
        EXPECT_LT((angle - (angle_at(2.5) - angle_at(2.0))).norm(), 1e-8);
        EXPECT_LT((velocity - (velocity_at(2.5) - velocity_at(2.0))).norm(), 1e-6);
        // The sample after the hole measured its own 10 ms, and no more.
        const ImuIncrement& own = timeline.increments[bridge.last + 1];
        EXPECT_NEAR(own.time.seconds(), 1000.0 + 251 * dt, 1e-8);
        EXPECT_NEAR(own.dt, dt, 1e-8);
        EXPECT_LT((own.dtheta - (angle_at(2.51) - angle_at(2.50))).norm(), 1e-9);
        EXPECT_LT((own.dv - (velocity_at(2.51) - velocity_at(2.50))).norm(), 1e-6);
        EXPECT_GT(bridge.noise.gyro_psd, 0.0);
        EXPECT_GT(bridge.noise.accel_psd, 0.0);
    }
}

TEST(ImuTimeline, LongerHolesAndLivelierMotionAreLessCertain) {
    const auto noise_of = [](int length, double liveliness) {
        std::vector<ImuSample> list =
            samples(1000, ImuKind::Rates, ImuStamp::End, [length](int k) { return k > 500 && k <= 500 + length; });
        for (std::size_t i = 0; i < list.size(); ++i) {
            list[i].gyro += Vector3d::Constant(liveliness * std::sin(0.7 * static_cast<double>(i)));
            list[i].accel += Vector3d::Constant(liveliness * std::cos(0.9 * static_cast<double>(i)));
        }
        WarningLog warnings;
        return make_imu_timeline(list, settings_of(ImuKind::Rates, ImuStamp::End), warnings).bridges.at(0).noise;
    };
    const BridgeNoise base = noise_of(50, 5.0);
    EXPECT_GT(noise_of(100, 5.0).gyro_psd, 1.5 * base.gyro_psd);
    EXPECT_NEAR(noise_of(50, 10.0).gyro_psd / base.gyro_psd, 4.0, 0.1);
    EXPECT_NEAR(noise_of(50, 10.0).accel_psd / base.accel_psd, 4.0, 0.1);
    // 0.51 s of it; a sine of amplitude 5 has a mean square of 12.5: variance of the integral over the hole per second.
    EXPECT_NEAR(base.gyro_psd, 0.5 * 0.51 * 12.5, 0.05 * 0.5 * 0.51 * 12.5);
}

/// A hole in a calm stretch of a log that turns elsewhere: a turn may have begun in it.
TEST(ImuTimeline, CalmBeforeAHoleDoesNotMakeItCertain) {
    const auto noise_of = [](double turn) {
        std::vector<ImuSample> list = samples(4000, ImuKind::Rates, ImuStamp::End, [](int k) { return k > 500 && k <= 600; });
        for (std::size_t i = 1500; i < list.size(); ++i) list[i].gyro.z() += turn * std::sin(0.02 * static_cast<double>(i));
        WarningLog warnings;
        return make_imu_timeline(list, settings_of(ImuKind::Rates, ImuStamp::End), warnings).bridges.at(0).noise;
    };
    EXPECT_GT(noise_of(0.5).gyro_psd, 3.0 * noise_of(0.0).gyro_psd);
    EXPECT_EQ(noise_of(0.5).accel_psd, noise_of(0.0).accel_psd);
}

/// A unit that hangs repeats itself to the last digit: those rows are a hole. One that always repeats (a coarse log) is left alone.
TEST(ImuTimeline, ARowThatHangsIsNoMeasurement) {
    const auto gaps_of = [](bool hangs, bool coarse, bool noiseless = false) {
        std::vector<ImuSample> list = samples(2000, ImuKind::Rates, ImuStamp::End, [](int) { return false; });
        for (std::size_t i = 0; i < list.size(); ++i) {
            list[i].gyro += 1e-4 * Vector3d(std::sin(7.0 * static_cast<double>(i)), std::cos(5.0 * static_cast<double>(i)), 1.0);
            if (coarse && i > 0 && i % 4 != 0) list[i].gyro = list[i - 1].gyro;
            if (hangs && i > 700 && i <= 800) list[i].gyro = list[700].gyro;
        }
        WarningLog warnings;
        ImuSettings settings = settings_of(ImuKind::Rates, ImuStamp::End);
        settings.noiseless = noiseless;
        return make_imu_timeline(list, settings, warnings).bridges.size();
    };
    EXPECT_EQ(gaps_of(true, false, true), 0U);  // straight on, and simulated without noise
    EXPECT_EQ(gaps_of(false, false), 0U);
    EXPECT_EQ(gaps_of(true, false), 1U);
    EXPECT_EQ(gaps_of(false, true), 0U);
}

TEST(ImuTimeline, OneLostIncrementIsReplacedWithoutBeingAGap) {
    WarningLog warnings;
    const ImuTimeline timeline =
        make_imu_timeline(samples(500, ImuKind::Increments, ImuStamp::End, [](int k) { return k == 300; }),
                          settings_of(ImuKind::Increments, ImuStamp::End), warnings);
    EXPECT_EQ(timeline.gaps, 0u);
    EXPECT_TRUE(timeline.bridges.empty());
    expect_gapless(timeline);
    Vector3d angle = Vector3d::Zero();
    for (const ImuIncrement& inc : timeline.increments) angle += inc.dtheta;
    EXPECT_LT((angle - angle_at(5.0)).norm(), 1e-8);
}

TEST(ImuTimeline, JitterOfStampsDoesNotChangeIncrements) {
    std::vector<ImuSample> list = samples(500, ImuKind::Increments, ImuStamp::End);
    for (std::size_t i = 0; i < list.size(); ++i) list[i].time.ns += i % 2 == 0 ? 600'000 : -600'000;
    WarningLog warnings;
    const ImuTimeline timeline = make_imu_timeline(list, settings_of(ImuKind::Increments, ImuStamp::End), warnings);
    expect_gapless(timeline);
    for (std::size_t i = 1; i < list.size(); ++i) ASSERT_LT((timeline.increments[i].dtheta - list[i].gyro).norm(), 1e-15) << i;
}

// 400 Hz with stamps of whole milliseconds: steps of 2, 3, 2, 3 ms, and no increment is lost.
TEST(ImuTimeline, CoarseStampsDoNotChangeIncrements) {
    std::vector<ImuSample> list;
    for (int k = 2; k <= 803; ++k)
        list.push_back({Time{k * 5 / 2 * 1'000'000LL}, Vector3d::Constant(1e-3), Vector3d::Constant(1e-2)});
    WarningLog warnings;
    const ImuTimeline timeline = make_imu_timeline(list, settings_of(ImuKind::Increments, ImuStamp::End), warnings);
    expect_gapless(timeline);
    Vector3d angle = Vector3d::Zero();
    for (const ImuIncrement& inc : timeline.increments) angle += inc.dtheta;
    EXPECT_LT((angle - Vector3d::Constant(0.802)).norm(), 1e-12);
}

TEST(ImuTimeline, RefusesALogThatIsTooShort) {
    WarningLog warnings;
    EXPECT_THROW((void)make_imu_timeline({}, {}, warnings), Error);
    EXPECT_THROW((void)make_imu_timeline({{Time{}, {}, {}}, {Time{}, {}, {}}}, {}, warnings), Error);
}

/// Fixes at 1 Hz from 5000 s on, all different.
Recording fixes(int count) {
    Recording r;
    for (int k = 0; k < count; ++k) {
        GnssFix fix;
        fix.time = Time::from_seconds(5000.0 + k);
        fix.position = {0.8 + 1e-7 * k, 0.2, 100.0};
        fix.velocity_n = Vector3d(1.0, 2.0, 3.0);
        r.gnss.push_back(fix);
    }
    return r;
}

std::vector<Event> events_of(const Recording& recording, const Settings& settings) {
    WarningLog warnings;
    return make_events(recording, settings, recording.gnss.front().time, warnings);
}

TEST(Events, EveryChannelHasItsAge) {
    Recording recording = fixes(20);
    for (GnssFix& fix : recording.gnss) fix.position_age = 0.02, fix.velocity_age = 0.03;
    for (int k = 0; k < 40; ++k) recording.baro.push_back({Time::from_seconds(5000.0 + 0.5 * k), 50.0 + 0.1 * k, not_given});
    Settings settings;
    settings.gnss.latency = 0.1;
    settings.gnss.height_latency = 1.3;
    settings.gnss.velocity_latency = 0.25;
    settings.gnss.velocity_down_latency = -0.05;
    const std::vector<Event> events = events_of(recording, settings);
    std::map<std::pair<MeasurementKind, int>, int> count;
    for (std::size_t i = 0; i < events.size(); ++i) {
        const Event& e = events[i];
        EXPECT_GE(e.valid, events[i > 0 ? i - 1 : 0].valid);
        ++count[{e.kind, e.components}];
        const double age = (e.stamp - e.valid).seconds();
        if (e.kind == MeasurementKind::Baro) {
            EXPECT_EQ(e.stamp, recording.baro[e.index].time);
            EXPECT_DOUBLE_EQ(age, 0.0);
            continue;
        }
        EXPECT_EQ(e.stamp, recording.gnss[e.index].time);
        const double expected =
            e.kind == MeasurementKind::GnssPosition ? (e.components == 3 ? 0.12 : 1.32) : (e.components == 3 ? 0.28 : -0.02);
        EXPECT_NEAR(age, expected, 1e-9);
    }
    const std::map<std::pair<MeasurementKind, int>, int> all{{{MeasurementKind::GnssPosition, 3}, 20},
                                                             {{MeasurementKind::GnssPosition, 4}, 20},
                                                             {{MeasurementKind::GnssVelocity, 3}, 20},
                                                             {{MeasurementKind::GnssVelocity, 4}, 20},
                                                             {{MeasurementKind::Baro, 4}, 40}};
    EXPECT_EQ(count, all);
}

TEST(Events, EqualAgesAreOneEventAndAbsentComponentsNone) {
    Recording recording = fixes(4);
    recording.gnss[1].position.h = not_given;
    recording.gnss[2].velocity_n = not_given3();
    recording.gnss[3].fix = FixType::None;
    Settings settings;
    std::vector<std::tuple<MeasurementKind, int, std::size_t>> got;
    for (const Event& e : events_of(recording, settings)) got.emplace_back(e.kind, e.components, e.index);
    // clang-format off
    const std::vector<std::tuple<MeasurementKind, int, std::size_t>> expected{
        {MeasurementKind::GnssPosition, 7, 0}, {MeasurementKind::GnssVelocity, 7, 0}, {MeasurementKind::GnssPosition, 3, 1},
        {MeasurementKind::GnssVelocity, 7, 1}, {MeasurementKind::GnssPosition, 7, 2}};
    // clang-format on
    EXPECT_EQ(got, expected);
    settings.gnss.use_velocity = false;
    for (const Event& e : events_of(recording, settings)) EXPECT_EQ(e.kind, MeasurementKind::GnssPosition);
}

TEST(Events, OutagesExcludeTheirEndsAndTellTheFirstFixAfter) {
    Recording recording = fixes(60);
    recording.gnss.erase(recording.gnss.begin() + 45);  // the second outage ends at 45: its end epoch is the fix at 46
    Settings settings;
    settings.gnss.latency = 0.4;  // outages go by stamps
    settings.outages = {{10.0, 5.0}, {40.0, 5.0}};
    std::map<int, int> table;  // stamp: outage, + 10 for an end epoch
    for (const Event& e : events_of(recording, settings)) {
        const int t = static_cast<int>(std::lround((e.stamp - recording.gnss.front().time).seconds()));
        const bool inside = (t > 10 && t < 15) || (t > 40 && t < 45);
        EXPECT_EQ(e.withheld, inside) << t;
        if (e.kind == MeasurementKind::GnssVelocity) {
            EXPECT_FALSE(e.outage_end);
            continue;
        }
        if (e.outage >= 0) table[t] = e.outage + (e.outage_end ? 10 : 0);
        EXPECT_FALSE(e.outage_end && e.withheld);
    }
    const std::map<int, int> expected{{11, 0}, {12, 0}, {13, 0}, {14, 0}, {15, 10}, {41, 1}, {42, 1}, {43, 1}, {44, 1}, {46, 11}};
    EXPECT_EQ(table, expected);
}

TEST(Events, RepeatedValuesAreDropped) {
    Recording recording = fixes(10);
    recording.gnss.insert(recording.gnss.begin() + 5, recording.gnss[5]);
    for (int k = 0; k < 20; ++k)
        recording.baro.push_back({Time::from_seconds(5000.0 + 0.2 * k), 50.0 + k / 4, not_given});  // each value four times
    WarningLog warnings;
    const std::vector<Event> events = make_events(recording, {}, recording.gnss.front().time, warnings);
    int gnss = 0, baro = 0;
    for (const Event& e : events) (e.kind == MeasurementKind::Baro ? baro : gnss) += 1;
    EXPECT_EQ(gnss, 20);
    EXPECT_EQ(baro, 5);
    EXPECT_EQ(warnings.count("gnss.duplicates"), 1u);
}

}  // namespace
}  // namespace schuler::fusion
