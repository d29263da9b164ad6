// The run along the data allocates nothing: operator new is replaced in this program and counts.
#include "ahrs/simulated_motion.h"
#include "filter/stream_drive.h"
#include "fusion/range_flight.h"

#include "schuler/ahrs/mekf.h"
#include "schuler/filter/states/model.h"
#include "schuler/fusion/still.h"
#include "schuler/fusion/timeline.h"
#include "schuler/fusion/tuning/tune.h"
#include "schuler/math/chi_square.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>
#include <variant>
#include <vector>

namespace {
std::atomic<long> allocations{0};

void* counted(std::size_t size, std::size_t alignment) {
    allocations.fetch_add(1, std::memory_order_relaxed);
    const std::size_t whole = (size + alignment - 1) / alignment * alignment;
    return std::aligned_alloc(alignment, whole == 0 ? alignment : whole);
}

void* counted_or_throw(std::size_t size, std::size_t alignment) {
    void* p = counted(size, alignment);
    if (p == nullptr) throw std::bad_alloc();
    return p;
}
}  // namespace

// Every form whose memory these forms of delete may get: the address sanitizer brings its own of those left out, and would
// complain of the stranger. Not inlined: the compiler would see std::free meet new.
#define SCHULER_APART __attribute__((noinline))
SCHULER_APART void* operator new(std::size_t size) { return counted_or_throw(size, alignof(std::max_align_t)); }
SCHULER_APART void* operator new(std::size_t size, std::align_val_t alignment) {
    return counted_or_throw(size, static_cast<std::size_t>(alignment));
}
SCHULER_APART void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    return counted(size, alignof(std::max_align_t));
}
SCHULER_APART void* operator new(std::size_t size, std::align_val_t alignment, const std::nothrow_t&) noexcept {
    return counted(size, static_cast<std::size_t>(alignment));
}
SCHULER_APART void* operator new[](std::size_t size) { return counted_or_throw(size, alignof(std::max_align_t)); }
SCHULER_APART void* operator new[](std::size_t size, std::align_val_t alignment) {
    return counted_or_throw(size, static_cast<std::size_t>(alignment));
}
SCHULER_APART void operator delete[](void* p) noexcept { std::free(p); }
SCHULER_APART void operator delete[](void* p, std::size_t) noexcept { std::free(p); }
SCHULER_APART void operator delete[](void* p, std::align_val_t) noexcept { std::free(p); }
SCHULER_APART void operator delete[](void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }
SCHULER_APART void operator delete(void* p) noexcept { std::free(p); }
SCHULER_APART void operator delete(void* p, std::size_t) noexcept { std::free(p); }
SCHULER_APART void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
SCHULER_APART void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace schuler::fusion {
namespace {

using Eigen::Vector3d;
using namespace testing;

template <class Frame>
long allocations_of_a_run() {
    sim::Scenario scenario = town_drive(61, 5.0, 50.0);
    scenario.baro.rate = 5.0;
    shake(scenario);
    std::get<sim::RoutePath>(scenario.path).standstill = 25.0;
    Recording recording = sim::simulate(scenario).recording;
    for (std::size_t i = 0; i < recording.imu.size(); i += 10)
        recording.mag.push_back({recording.imu[i].time, Vector3d(2e-5, 0.0, 4e-5)});
    Settings f = settings_of(scenario);
    f.scale_factors = f.estimate_lever_arm = f.constraints.nonholonomic = true;
    f.gnss.errors.correlated_position.setOnes();
    f.gnss.errors.correlated_distance = 1e4;
    f.gnss.latency = 0.003;  // epochs fall inside increments, which are split

    WarningLog warnings;
    RunData data;
    data.recording = &recording;
    data.imu = make_imu_timeline(recording.imu, f.imu, warnings);
    data.events = make_events(recording, f, recording.gnss.front().time, warnings);
    data.fix_noise = fix_noise(recording, f.gnss, warnings);
    data.still = find_still(data.imu, recording, data.events, f);
    for (int dof = 1; dof <= 3; ++dof) data.gates.chi_square[dof] = math::chi_square_quantile(0.9999, dof);
    const Layout layout = make_layout(f, recording);
    EXPECT_EQ(layout.size, 36);
    EXPECT_GT(data.still.windows.size(), 10u);
    const InertialModel model = make_model(f, layout);
    const Pass<Frame> pass(model, data, f);

    const ReferenceSample& truth = recording.reference.front();
    Start start;
    start.nav = {truth.time, truth.position, truth.velocity_n, math::quaternion_from_rpy(truth.rpy)};
    start.std_position = start.std_velocity = start.std_rpy = start.std_gyro_bias = start.std_accel_bias =
        Vector3d::Constant(0.01);
    FilterRun<Frame> run = first_step<Frame>(model, data, f, start);
    PassObserver<Frame> nobody;
    const long before = allocations.load();
    pass.advance(run, 3999, nobody);  // stands, then drives: every kind of measurement has its turn
    const long made = allocations.load() - before;
    EXPECT_EQ(run.increment, 4000u);
    EXPECT_GT(run.event, 400u);
    EXPECT_GT(run.still, 10u);
    EXPECT_GT(run.outputs, 390u);
    return made;
}

TEST(Allocation, NoneInTheWalk) {
    EXPECT_EQ(allocations_of_a_run<GeographicFrame>(), 0);
    EXPECT_EQ(allocations_of_a_run<EarthFixedFrame>(), 0);
}

/// Feeds all samples, asks for the state after each and saves in the middle; returns what was allocated after the making. `sound`: the
/// log as it was, if the samples are spoilt.
long allocations_of_a_stream(const Recording& recording, const Settings& settings, const Recording* sound = nullptr) {
    constexpr Phase last = Phase::Navigating;
    const Batch batch = run_batch(sound != nullptr ? *sound : recording, settings);
    NavigatorMade made = Navigator::make(stream_settings(recording, settings, batch));
    EXPECT_TRUE(made) << made.key << made.reason;
    Navigator& navigator = *made.navigator;
    const std::vector<Sample> samples = samples_of(recording);
    std::vector<std::byte> bytes(navigator.save({}) + 2'000'000);
    std::size_t rows = 0, k = 0;
    const long before = allocations.load();
    for (const RangeSource& s : recording.ranges.sources) (void)navigator.range_source(s.name, s.station);
    for (const Sample& s : samples) {
        (void)feed(navigator, s, recording.ranges);
        if (++k % 8 == 0) {
            (void)navigator.state();
            (void)navigator.lagged();
            (void)navigator.sensor_errors();
        }
        while (navigator.poll()) {}
        while (navigator.poll_row()) ++rows;
        if (k == samples.size() / 2) {
            EXPECT_LT(navigator.save(bytes), bytes.size());
            EXPECT_EQ(navigator.restore(bytes), RestoreStatus::Restored);
        }
    }
    const long made_in_use = allocations.load() - before;
    EXPECT_GT(rows, 80u);
    EXPECT_EQ(navigator.phase(), last);
    return made_in_use;
}

/// Every coupling that a navigator has, in both frames.
TEST(Allocation, NoneInAnyPresetFedSampleBySample) {
    const StreamLog car = car_log(61);
    test::Flight flight = test::flight();
    flight.settings.output_rate = 5.0;
    struct Preset {
        const char* name;
        void (*choose)(Settings&);
        bool ranges = false;
    };
    const Preset presets[] = {
        {"loose", [](Settings&) {}},
        {"ins15", [](Settings& s) { s.scale_factors = false; }},
        {"ins21", [](Settings& s) { s.constraints.nonholonomic = false; }},
        {"aggressive", [](Settings& s) { s.loose_kind = LooseKind::Aggressive; }},
        {"separate", [](Settings& s) { s.coupling = Coupling::Separate; }},
        {"complex22",
         [](Settings& s) {
             s.gnss.errors.correlated_position.setOnes();
             s.gnss.errors.correlated_velocity.setConstant(0.05);
             s.integrity.use = true;
             s.integrity.window = 10.0;
             s.loop = Loop::Mixed;
         }},
        {"open", [](Settings& s) { s.loop = Loop::Open; }},
        {"everything",
         [](Settings& s) {
             s.misalignments = s.estimate_lever_arm = s.constraints.nonholonomic_auto = true;
             s.gnss.latency_std = 0.02;
         }},
        {"tight", [](Settings&) {}, true},
        {"tight with protection", [](Settings& s) { s.ranging.protection.use = true; }, true},
        {"tight, open",
         [](Settings& s) {
             s.loop = Loop::Open;
             s.scale_factors = s.misalignments = true;
         },
         true},
    };
    for (const Preset& preset : presets) {
        for (const Mechanization frame : {Mechanization::Geographic, Mechanization::Ecef}) {
            Settings settings = preset.ranges ? flight.settings : car.settings;
            preset.choose(settings);
            settings.mechanization = frame;
            EXPECT_EQ(allocations_of_a_stream(preset.ranges ? flight.recording : car.recording, settings), 0)
                << preset.name << (frame == Mechanization::Ecef ? ", ECEF" : "");
        }
    }
}

/// Faults, clock jumps and appearing satellites: the rare ways through an epoch of ranges.
TEST(Allocation, NoneInTheRareWays) {
    test::Flight flight = test::flight();
    flight.settings.ranging.protection.use = true;
    flight.settings.output_rate = 5.0;
    test::spoil(flight.recording.ranges, 0, 30.0, 12.0);
    test::spoil(flight.recording.ranges, 1, 40.0, 300.0);
    for (std::uint16_t s = 0; s < flight.recording.ranges.sources.size(); ++s) test::spoil(flight.recording.ranges, s, 60.0, 3e5);
    EXPECT_EQ(allocations_of_a_stream(flight.recording, flight.settings), 0);
    // holes, hangs, wild fixes, and the alignment
    StreamLog car = car_log(61);
    std::erase_if(car.recording.imu, [](const ImuSample& s) { return s.time.seconds() > 1035.0 && s.time.seconds() < 1037.0; });
    for (ImuSample& s : car.recording.imu)
        if (s.time.seconds() > 1040.0 && s.time.seconds() < 1040.5)
            s.gyro = Vector3d::Constant(0.01), s.accel = Vector3d(0, 0, -9.8);
    for (std::size_t i = 0; i < car.recording.gnss.size(); i += 7) car.recording.gnss[i].position.lat += 1e-4;
    EXPECT_EQ(allocations_of_a_stream(car.recording, car.settings), 0);
    // disputes between the receiver and the navigation, with and without integrity control
    StreamLog disputed = disputed_log(14);
    EXPECT_EQ(allocations_of_a_stream(disputed.recording, disputed.settings), 0);
    disputed.settings.integrity.use = true;
    disputed.settings.integrity.window = 10.0;
    EXPECT_EQ(allocations_of_a_stream(disputed.recording, disputed.settings), 0);
}

/// Samples that are no numbers, infinite, absurd, or have such sigmas, among sound ones: of every instrument.
TEST(Allocation, NoneFromSamplesThatAreNoNumbers) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinite = std::numeric_limits<double>::infinity();
    auto spoilt = [n = 0]() mutable {
        return std::array{nan, infinite, -infinite, 1e300, -1e300, 5e-324}[static_cast<std::size_t>(n++ % 6)];
    };
    const StreamLog car = car_log(61);
    Recording r = car.recording;
    const auto some = [](auto& samples, std::size_t every, const auto& spoil) {
        for (std::size_t i = every - 1; i < samples.size(); i += every) spoil(samples[i], i / every);
    };
    some(r.imu, 50,
         [&](ImuSample& s, std::size_t i) { (i % 2 == 0 ? s.gyro : s.accel)(static_cast<Eigen::Index>(i % 3)) = spoilt(); });
    some(r.gnss, 3, [&](GnssFix& s, std::size_t i) {
        if (i % 4 == 0) s.position.lat = spoilt();
        else if (i % 4 == 1) s.velocity_n.setConstant(spoilt());
        else if (i % 4 == 2) s.std_position.setConstant(spoilt());
        else s.position_age = spoilt();
    });
    some(r.baro, 3, [&](BaroSample& s, std::size_t) { s.height = spoilt(); });
    some(r.mag, 3, [&](MagSample& s, std::size_t) { s.field_b.setConstant(spoilt()); });
    some(r.odometer, 3, [&](OdometerSample& s, std::size_t i) { (i % 2 == 0 ? s.speed : s.std) = spoilt(); });
    some(r.heading, 3, [&](HeadingSample& s, std::size_t i) { (i % 2 == 0 ? s.heading : s.std) = spoilt(); });
    some(r.gauges, 3, [&](GaugeSample& s, std::size_t) { s.height.setConstant(spoilt()); });
    some(r.body_velocity, 3,
         [&](BodyVelocitySample& s, std::size_t i) { s.velocity_b(static_cast<Eigen::Index>(i % 3)) = spoilt(); });
    EXPECT_EQ(allocations_of_a_stream(r, car.settings, &car.recording), 0);
    const test::Flight flight = [] {
        test::Flight f = test::flight();
        f.settings.output_rate = 5.0;
        return f;
    }();
    Recording ranged = flight.recording;
    some(ranged.ranges.samples, 7, [&](RangeSample& s, std::size_t i) {
        if (i % 5 == 0) s.pseudorange = spoilt();
        else if (i % 5 == 1) s.range_rate = spoilt();
        else if (i % 5 == 2) s.std = spoilt();
        else if (i % 5 == 3) s.tx.r.setConstant(spoilt());
        else s.tx_clock = spoilt();
    });
    EXPECT_EQ(allocations_of_a_stream(ranged, flight.settings, &flight.recording), 0);
}

TEST(Allocation, IsCounted) {
    const long before = allocations.load();
    const std::vector<double> some(3);
    const std::vector<Eigen::Matrix4d> aligned(2);
    EXPECT_EQ(allocations.load() - before, 2);
    EXPECT_EQ(some.size() + aligned.size(), 5u);
}

TEST(Allocation, NoneInTheAttitudeFilter) {
    const ahrs::testing::Motion motion;
    const auto data = ahrs::testing::simulated(motion, 1);
    ahrs::Mekf filter{ahrs::MekfSettings{}};
    const long before = allocations.load();
    for (const ahrs::testing::Instant& i : data) {
        filter.step(motion.dt, i.gyro, i.accel);
        filter.magnetometer(i.field);
    }
    const long after = allocations.load();
    EXPECT_EQ(after, before);
    EXPECT_TRUE(filter.started());
}

}  // namespace
}  // namespace schuler::fusion
