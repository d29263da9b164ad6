// The tight filter with carrier phases relative to a base: float and fixed, slips that no receiver reports, the smoother.
#include "fusion/range_flight.h"
#include "schuler/fusion/integer_search.h"
#include "schuler/math/random.h"
#include "schuler/math/rotation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <utility>

namespace schuler::fusion {
namespace {

using namespace test;

constexpr std::array<double, 2> wavelengths{0.190293672798365, 0.244210213424568};  // m, L1 and L2

/// The flight's ranges without errors other than the clock's, which has a random stream of its own.
RangingLog exact_ranges(const Flight& f, double clock = 300.0) {
    sim::RangingScenario frame{3, 120.0, {}, Time::from_gps(2300, 3600.0), f.earth};
    sim::RangingSettings r;
    r.lever_arm_b = f.settings.gnss.lever_arm_b;
    r.navigation = gnss::nominal_gps(frame.gps, frame.gps + Duration::from_seconds(frame.duration));
    r.masks.throughout = true;
    r.errors.satellite.white = r.errors.satellite.correlated = 0.0;
    r.errors.clock.bias = clock;
    sim::WeavingFlight weave;
    weave.start = {52.3 * units::deg, 104.3 * units::deg, 3000.0};
    weave.duration = frame.duration;
    const auto path = sim::make_path(sim::weaving_path(weave, f.earth.ellipsoid), f.earth.ellipsoid);
    return sim::simulate_ranges(frame, *path, r).log;
}

/// The flight's ranges with the errors that a base leaves, and phases on two carriers. `slip`: whole cycles of the first satellite's
/// first carrier from 60 s on, in the same arc.
Flight flight_with_base(std::uint64_t seed, int slip = 0, double clock = 300.0) {
    Flight f = flight();
    RangingLog log = exact_ranges(f, clock);
    f.settings.ranging.errors.clock.bias = clock;
    math::Random random(seed, "carriers");
    std::map<std::pair<int, std::size_t>, double> cycles;
    for (RangeEpoch& e : log.epochs) {
        e.first_carrier = log.carriers.size();
        for (std::size_t i = e.first; i < e.first + e.count; ++i) {
            RangeSample& m = log.samples[i];
            m.differential = true;
            const double exact = m.pseudorange;
            m.pseudorange += 0.5 * random.normal();
            for (std::size_t k = 0; k < wavelengths.size(); ++k) {
                const auto [it, fresh] = cycles.try_emplace({m.source, k}, 0.0);
                if (fresh) it->second = std::floor(40.0 * random.uniform() - 20.0);
                const bool slipped = m.source == 0 && k == 0 && e.time.seconds() >= 60.0;
                CarrierSample c;
                c.source = m.source;
                c.carrier = static_cast<std::uint8_t>(k);
                c.arc = 1;
                c.wavelength = wavelengths[k];
                c.phase = exact + 0.004 * random.normal() + (it->second + (slipped ? slip : 0)) * c.wavelength;
                c.elevation = 0.5;
                c.variance = 0.004 * 0.004;
                log.carriers.push_back(c);
                ++e.carriers;
            }
        }
    }
    f.recording.ranges = std::move(log);
    f.settings.ranging.errors.satellite = {.white = 0.5, .correlated = 0.5, .correlation_time = 60.0};
    f.settings.ranging.integers = std::make_shared<PpkIntegerSearch>(ppk::IntegerSettings{});
    return f;
}

struct Found {
    double largest = 0.0, sigma = 0.0;  ///< m, three-dimensional
    std::size_t epochs = 0, outside = 0;
};
Found errors(const Flight& f, const std::vector<SolutionRow>& rows, double from) {
    Found out;
    for (const SolutionRow& row : rows) {
        const auto k = static_cast<std::size_t>(std::llround(row.time.seconds()));
        const bool compared = std::abs(row.time.seconds() - static_cast<double>(k)) < 1e-6;
        if (!compared || row.time.seconds() < from || k >= f.recording.reference.size()) continue;
        const Eigen::Vector3d e = earth::ned_difference(f.earth, row.position, f.recording.reference[k].position);
        ++out.epochs;
        out.largest = std::max(out.largest, e.norm());
        out.sigma = std::max(out.sigma, row.std_position.norm());
        out.outside += (e.array().abs() > 3.0 * row.std_position.array()).any() ? 1 : 0;
    }
    return out;
}

TEST(Carriers, IntegersWithinSecondsInBothFrames) {
    for (const Mechanization frame : {Mechanization::Geographic, Mechanization::Ecef}) {
        Flight f = flight_with_base(1);
        f.settings.mechanization = frame;
        const Result fixed = run(f);
        const auto& rows = fixed.forward.carriers;
        ASSERT_GT(rows.size(), 100U);
        EXPECT_GE(rows[3].held, rows[3].ambiguities - 2);
        EXPECT_EQ(rows.back().slipped, 0);
        const Found with = errors(f, fixed.forward.rows, 5.0);
        EXPECT_LT(with.largest, 0.03);
        EXPECT_LT(with.sigma, 0.04);
        EXPECT_LE(with.outside, 1U);
        f.settings.ranging.integers.reset();
        const Result floating = run(f);
        EXPECT_EQ(floating.forward.carriers.back().held, 0);
        const Found without = errors(f, floating.forward.rows, 5.0);
        EXPECT_GT(without.largest, 2.0 * with.largest);
        EXPECT_LE(without.outside, without.epochs / 50);
    }
}

/// The receiver says nothing, and the arc goes on: the other phases and the inertial unit contradict it.
TEST(Carriers, ASlipIsFoundByTheUnit) {
    for (const int cycles : {1, -1, 5, 1000}) {
        const Flight f = flight_with_base(2, cycles);
        const Result result = run(f);
        int slipped = 0;
        for (const CarrierRow& row : result.forward.carriers) slipped += row.slipped;
        EXPECT_EQ(slipped, 1) << cycles;
        const Found found = errors(f, result.forward.rows, 5.0);
        EXPECT_LT(found.largest, 0.03) << cycles;
        EXPECT_LE(found.outside, 1U) << cycles;
    }
}

/// Receivers keep their clocks within a millisecond: the antenna is a hand's breadth elsewhere at the time of the tag, while the satellites,
/// which are faster, are where they were when they sent.
TEST(Carriers, AClockThatIsFarOff) {
    const Flight f = flight_with_base(4, 0, 1e5);
    const Result result = run(f);
    EXPECT_GE(result.forward.carriers.back().held, result.forward.carriers.back().ambiguities - 2);
    const Found found = errors(f, result.forward.rows, 5.0);
    EXPECT_LT(found.largest, 0.03);
    EXPECT_LE(found.outside, 1U);
}

/// Half a metre per second squared for a second that is not there, a turn that is not there: the phases go on and say where the antenna is.
TEST(Carriers, AKnockOfTheUnitIsNoSlip) {
    for (const bool turn : {false, true}) {
        Flight f = flight_with_base(5);
        for (ImuSample& s : f.recording.imu) {
            if (s.time.seconds() < 60.0 || s.time.seconds() >= 61.0) continue;
            constexpr double dt = 0.1;  // s
            (turn ? s.gyro : s.accel) += dt * Eigen::Vector3d(turn ? 0.05 : 0.5, 0.0, 0.0);
        }
        const Result result = run(f);
        int slipped = 0, doubted = 0;
        for (const CarrierRow& row : result.forward.carriers) slipped += row.slipped, doubted += row.doubted ? 1 : 0;
        EXPECT_GE(doubted, 1);
        EXPECT_LE(slipped, 2);
        const Found found = errors(f, result.forward.rows, 5.0), later = errors(f, result.forward.rows, 75.0);
        EXPECT_LE(found.outside, 2U);
        EXPECT_LT(later.largest, 0.05);
        EXPECT_GT(result.forward.carriers.back().held, 0);
    }
}

/// The smoother knows the integers from the first epoch on, and through a hole of twenty seconds.
TEST(Carriers, SmoothedThroughAHole) {
    Flight f = flight_with_base(3);
    f.settings.smooth = true;
    f.settings.outages = {{40.0, 20.0}};
    const Result result = run(f);
    const Found forward = errors(f, result.forward.rows, 5.0), smoothed = errors(f, result.smoothed.rows, 0.0);
    EXPECT_LT(smoothed.largest, 0.03);
    EXPECT_LT(smoothed.sigma, 0.05);
    EXPECT_LE(smoothed.outside, 2U);
    EXPECT_GT(forward.sigma, smoothed.sigma);
    // fixed again within two seconds of the hole's end
    for (const CarrierRow& row : result.forward.carriers) {
        const double t = row.time.seconds();
        if (t > 62.5 && t < 64.0) {
            EXPECT_GE(row.held, row.ambiguities - 2) << t;
        }
    }
}

/// Range rates from the phases of two epochs, with the Doppler beside them; `slip`: m, in the phases of the second satellite at 60 s.
Flight flight_with_phase_rates(bool phases, double slip = 0.0) {
    Flight f = flight();
    RangingLog& log = f.recording.ranges;
    const RangingLog exact = exact_ranges(f);
    math::Random random(4, "phases");
    std::map<int, double> before;
    for (std::size_t k = 0; k < log.epochs.size(); ++k) {
        const RangeEpoch& e = log.epochs[k];
        std::map<int, double> now;
        for (std::size_t i = e.first; i < e.first + e.count; ++i) {
            RangeSample& m = log.samples[i];
            now[m.source] = exact.samples[i].pseudorange;
            const auto old = before.find(m.source);
            const double noise = 0.004 * random.normal();
            if (!phases || old == before.end()) continue;
            m.phase_span = (e.time - log.epochs[k - 1].time).seconds();
            m.doppler_rate = m.range_rate;
            m.std_rate = not_given;
            const bool slipped = m.source == log.samples[1].source && std::lround(e.time.seconds()) == 60;
            m.range_rate = (now[m.source] - old->second + noise + (slipped ? slip : 0.0)) / m.phase_span;
        }
        before = std::move(now);
    }
    f.settings.ranging.errors.satellite.correlated_rate = phases ? 0.005 : 0.0;
    f.settings.ranging.errors.rate_span = phases ? 1.0 : 0.0;
    return f;
}

TEST(PhaseRates, KnowTheVelocityBetterThanTheDopplerAndRefuseSlips) {
    const auto velocity_error = [](const Flight& f, const Result& r) {
        double square = 0.0, n = 0.0, beyond = 0.0;
        for (const SolutionRow& row : r.forward.rows) {
            const auto k = static_cast<std::size_t>(std::llround(row.time.seconds()));
            if (row.time.seconds() < 20.0 || k >= f.recording.reference.size()) continue;
            const Eigen::Vector3d e = row.v_eb_n - f.recording.reference[k].velocity_n;
            square += e.squaredNorm();
            beyond += (e.array().abs() > 3.0 * row.std_velocity.array()).any() ? 1.0 : 0.0;
            n += 1.0;
        }
        return std::pair{std::sqrt(square / n), beyond / n};
    };
    const Flight by_doppler = flight_with_phase_rates(false), by_phases = flight_with_phase_rates(true),
                 with_slip = flight_with_phase_rates(true, 0.19);
    const Result doppler = run(by_doppler), phases = run(by_phases), slipped = run(with_slip);
    const auto [error, beyond] = velocity_error(by_phases, phases);
    EXPECT_LT(error, 0.6 * velocity_error(by_doppler, doppler).first);
    EXPECT_LT(velocity_error(with_slip, slipped).first, 1.1 * error);
    EXPECT_LT(beyond, 0.02);
    const auto refused = std::ranges::count_if(slipped.measurements, [&](const MeasurementRecord& r) {
        return r.kind == MeasurementKind::RangeRate && r.source == with_slip.recording.ranges.samples[1].source &&
               r.status == MeasurementStatus::Rejected && std::lround(r.time.seconds()) == 60;
    });
    EXPECT_EQ(refused, 1);
}

/// Fixes of a float solution share its error for minutes: taken one by one for new, they make the filter sure of it.
TEST(Carriers, FloatFixesCountByWhatTheyAdd) {
    for (const bool shared : {true, false}) {
        Flight f = flight();
        f.settings.coupling = Coupling::Loose;
        f.recording.ranges = {};
        for (const ReferenceSample& truth : f.recording.reference) {
            GnssFix fix;
            fix.time = truth.time;
            const Eigen::Vector3d antenna =
                math::dcm_from_rpy(truth.rpy) * f.settings.gnss.lever_arm_b + Eigen::Vector3d(0.3, -0.2, 0.3);
            fix.position = earth::moved_by_ned(f.earth, truth.position, antenna);
            fix.std_position.setConstant(0.2);
            fix.fix = FixType::RtkFloat;
            fix.lasting = shared && !f.recording.gnss.empty() ? 120.0 : 1.0;
            f.recording.gnss.push_back(fix);
        }
        const Result result = run(f);
        const Found found = errors(f, result.forward.rows, 60.0);
        EXPECT_EQ(found.outside > 0, !shared) << found.largest << " m at " << found.sigma;
    }
}

}  // namespace
}  // namespace schuler::fusion
