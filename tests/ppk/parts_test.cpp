// The parts one by one: rows against differences, integers on made-up states, the base between its epochs, arcs, two passes.
#include "ppk/made_up_logs.h"

#include "schuler/ppk/arcs.h"
#include "schuler/ppk/combine.h"
#include "schuler/ppk/differences.h"
#include "schuler/ppk/integers.h"

#include "support/perturbation.h"

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

namespace schuler::ppk {
namespace {

using test::measured;
using test::Receiver;

const Time start = Time::from_gps(2300, 200'000.0);
const Geodetic origin{48.78 * test::deg, 9.17 * test::deg, 320.0};

/// A rover and a base ten kilometres apart without noise, ready for the filter.
struct Pair {
    gnss::Navigation sky = test::made_up_sky(start, start + Duration::from_seconds(3600));
    gnss::BroadcastSource source{sky};
    Receiver at_base, at_rover;
    Ecef base = test::place_from(origin, 0, 0, 0), rover = test::place_from(origin, 8e3, 6e3, 150.0);
    gnss::ObservationLog base_log, rover_log;
    gnss::SinglePointSettings single;
    Settings settings;
    SignalPlan plan;
    std::vector<TrackedEpoch> base_epochs, rover_epochs;

    explicit Pair(double seconds = 5.0, double interval = 1.0) {
        for (Receiver* r : {&at_base, &at_rover}) r->code_sigma = r->phase_sigma = 0.0;
        at_base.place = [p = base](Time) { return p; };
        at_rover.place = [p = rover](Time) { return p; };
        at_base.interval = interval;
        at_base.air = at_rover.air = true;
        settings.air.ionosphere = gnss::BroadcastIonosphere{};
        base_log = measured(sky, at_base, start, seconds, 1);
        rover_log = measured(sky, at_rover, start, seconds, 2);
        single.ranges.ionosphere = gnss::IonosphereModel::None;
        track();
    }
    void track() {
        plan = common_signals(rover_log, base_log, single.ranges, 2);
        gnss::SinglePoint solver(source, std::nullopt, single);
        base_epochs = tracked(base_log, {Side::Base, base}, plan, source, solver, single.ranges);
        rover_epochs = tracked(rover_log, {Side::Rover, std::nullopt}, plan, source, solver, single.ranges);
    }
    ArcCounts number() {
        number_arcs(base_epochs, true, settings.arcs, settings.air);
        return number_arcs(rover_epochs, false, settings.arcs, settings.air);
    }
    [[nodiscard]] BaseStation station() const { return {base_epochs, base, settings.air, settings.base}; }
};

SCHULER_JACOBIAN(single_differences, "ppk.single_differences") {
    // columns: position; the modelled air moves with it by less than the tolerance
    static Pair pair;
    pair.number();
    static const BaseStation station = pair.station();
    static const BaseEpoch base = *station.at(pair.rover_epochs[2].tag);
    const auto at = [](const Eigen::Vector3d& dx) {
        return single_differences(pair.rover_epochs[2], base, station, pair.plan, {pair.rover.r + dx}, pair.settings, false);
    };
    const auto differences = at(Eigen::Vector3d::Zero());
    const auto n = static_cast<Eigen::Index>(differences.size());
    Eigen::MatrixXd H(2 * n, 3);
    for (Eigen::Index i = 0; i < n; ++i) H.row(i) = H.row(n + i) = differences[static_cast<std::size_t>(i)].towards.transpose();
    const auto output = [at, n](const Eigen::VectorXd& dx) -> Eigen::VectorXd {
        const auto moved = at(dx);
        Eigen::VectorXd out(2 * n);
        for (Eigen::Index i = 0; i < n; ++i) {  // computed grows by what measured less computed falls by
            out[i] = -moved[static_cast<std::size_t>(i)].phase;
            out[n + i] = -moved[static_cast<std::size_t>(i)].code;
        }
        return out;
    };
    const Eigen::VectorXd step = Eigen::Vector3d::Constant(5.0);
    return {{"ten kilometres", H, output, step,
             schuler::test::tolerance_of(H, 0.0, Eigen::VectorXd::Constant(2 * n, 2e-3), Eigen::VectorXd::Ones(3))}};
}

TEST(Differences, DoubleDifferencesOfNoiseFreeLogsAreWholeCycles) {
    Pair pair;
    pair.settings.air.ionosphere.reset();  // the logs have none
    pair.number();
    const BaseStation station = pair.station();
    for (const TrackedEpoch& e : pair.rover_epochs) {
        const auto d = single_differences(e, *station.at(e.tag), station, pair.plan, pair.rover, pair.settings, false);
        ASSERT_GE(d.size(), 20U);
        for (const Difference& x : d) {
            const auto reference =
                std::ranges::find_if(d, [&](const Difference& r) { return r.id.system == x.id.system && r.band == x.band; });
            const double cycles = (x.phase - reference->phase) / x.wavelength;
            EXPECT_NEAR(cycles, std::round(cycles), 0.02) << gnss::name_of(x.id) << x.band;
            EXPECT_NEAR(x.code - reference->code, 0.0, 0.01);
            EXPECT_TRUE(x.whole);
        }
    }
}

TEST(Differences, SignalsThatBothHave) {
    Pair pair;
    // the base tracks L2 by another mode: its phase is used, its code trusted less; a carrier it lacks is not there
    for (gnss::SignalObservation& o : pair.base_log.observations) {
        if (o.satellite.system == gnss::System::Gps && o.signal.band == '2') o.signal.attribute = 'W';
        if (o.satellite.system == gnss::System::Galileo && o.signal.band == '5') o.phase = not_given;
    }
    pair.track();
    pair.number();
    for (std::size_t i = 0; i < gnss::satellite_count; ++i) {
        if (pair.plan.of[i].empty()) continue;
        const bool gps = i < gnss::numbers_per_system;
        ASSERT_EQ(pair.plan.of[i].size(), gps ? 2U : 1U);
        EXPECT_TRUE(pair.plan.of[i][0].same());
        if (gps) {
            EXPECT_FALSE(pair.plan.of[i][1].same());
        }
    }
    const BaseStation station = pair.station();
    const auto d = single_differences(pair.rover_epochs[0], *station.at(pair.rover_epochs[0].tag), station, pair.plan, pair.rover,
                                      pair.settings, false);
    for (const Difference& x : d)
        EXPECT_EQ(x.code_variance > 1.0 + 0.2, x.band == '2' || x.code_variance > 1.2) << gnss::name_of(x.id);
    EXPECT_TRUE(std::ranges::any_of(d, [](const Difference& x) { return x.band == '2'; }));
}

TEST(BaseStation, BetweenItsEpochsNothingIsLost) {
    Pair pair(90.0, 30.0);
    pair.settings.air.ionosphere.reset();  // the logs have none
    pair.number();
    const BaseStation station = pair.station();
    EXPECT_FALSE(station.at(start - Duration::from_seconds(31)));
    EXPECT_TRUE(station.at(start - Duration::from_seconds(29)));
    EXPECT_FALSE(station.at(start + Duration::from_seconds(121)));
    const auto there = station.at(start + Duration::from_seconds(30.0)),
               between = station.at(start + Duration::from_seconds(41.0));
    ASSERT_TRUE(there && between);
    EXPECT_EQ(there->variance, 0.0);
    EXPECT_FALSE(there->repeated);
    EXPECT_NEAR(between->age, 11.0, 1e-9);
    EXPECT_TRUE(between->repeated);
    EXPECT_NEAR(between->variance, 1.5e-3 * 1.5e-3 * 11.0 * 19.0 / 30.0, 1e-9);
    // the base's clock runs on meanwhile, by 3 m/s
    const BaseSignal &then = there->satellites[0].signals[0], &now = between->satellites[0].signals[0];
    EXPECT_NEAR(now.code - then.code, 11.0 * 1e-8 * gnss::speed_of_light, 0.01);
    EXPECT_NEAR(now.phase - then.phase, now.code - then.code, 1e-3);
    // double differences of interpolated residuals are those of the epoch itself
    Pair dense(90.0, 1.0);
    dense.settings.air.ionosphere.reset();
    dense.number();
    const BaseStation exact_station = dense.station();
    const auto exact = exact_station.at(start + Duration::from_seconds(41.0));
    ASSERT_EQ(exact->satellites.size(), between->satellites.size());
    const auto of = [](const BaseEpoch& e, std::size_t i) {
        return e.satellites[i].signals[0].code - e.satellites[0].signals[0].code;
    };
    for (std::size_t i = 1; i < exact->satellites.size(); ++i) EXPECT_NEAR(of(*between, i), of(*exact, i), 1e-3);
    // a slip in between: its phase is not there until the next epoch
    for (TrackedEpoch& e : pair.base_epochs)
        if (e.tag > start + Duration::from_seconds(45.0)) e.satellites[0].signals[0].arc = 99;
    const BaseStation slipped = pair.station();
    const SatelliteId id = pair.base_epochs[0].satellites[0].id;
    const auto signal = [&](double t) {
        const auto e = slipped.at(start + Duration::from_seconds(t));
        return std::ranges::find(e->satellites, id, &BaseSatellite::id)->signals[0];
    };
    EXPECT_TRUE(std::isnan(signal(41.0).phase));
    EXPECT_TRUE(std::isfinite(signal(41.0).code));
    EXPECT_TRUE(std::isfinite(signal(71.0).phase));
}

TEST(Arcs, EachWayInWhichACountBreaks) {
    const auto arc = [](const Pair& p, std::size_t epoch, std::size_t satellite, std::size_t k) {
        return p.rover_epochs[epoch].satellites[satellite].signals[k].arc;
    };
    Pair pair(8.0);
    pair.rover_epochs[3].satellites[1].signals[0].lost = true;
    for (std::size_t e = 4; e < 9; ++e) pair.rover_epochs[e].satellites[2].signals[0].half_cycle = true;
    for (std::size_t e = 5; e < 9; ++e) {
        for (std::size_t k = 0; k < 2; ++k) {
            TrackedSignal& s = pair.rover_epochs[e].satellites[3].signals[k];
            s.phase += (k == 0 ? 77.0 : 60.0) * s.wavelength;  // the geometry-free combination of L1 and L2 is blind to this one
        }
        TrackedSignal& half = pair.rover_epochs[e].satellites[4].signals[1];
        half.phase += 0.5 * half.wavelength;
    }
    for (std::size_t e = 1; e < 9; ++e)  // a receiver's clock that steps by a millisecond, in the phases alone
        for (TrackedSatellite& s : pair.rover_epochs[e].satellites)
            for (TrackedSignal& t : s.signals) t.phase += e >= 6 ? 1e-3 * gnss::speed_of_light : 0.0;
    const ArcCounts counts = pair.number();
    EXPECT_EQ(counts.told, 2U);
    EXPECT_GE(counts.found(), 2U);
    EXPECT_EQ(counts.gaps, 0U);
    EXPECT_NE(arc(pair, 3, 1, 0), arc(pair, 2, 1, 0));
    EXPECT_EQ(arc(pair, 3, 1, 1), arc(pair, 2, 1, 1));
    EXPECT_NE(arc(pair, 4, 2, 0), arc(pair, 3, 2, 0));
    EXPECT_NE(arc(pair, 5, 3, 0), arc(pair, 4, 3, 0));
    EXPECT_NE(arc(pair, 5, 3, 1), arc(pair, 4, 3, 1));
    EXPECT_NE(arc(pair, 5, 4, 1), arc(pair, 4, 4, 1));
    EXPECT_TRUE(pair.rover_epochs[8].satellites[4].signals[1].jumped);
    EXPECT_FALSE(pair.rover_epochs[8].satellites[1].signals[0].jumped);
    for (std::size_t e = 1; e < 9; ++e)  // the others, also through the clock's step
        for (std::size_t s = 5; s < pair.rover_epochs[e].satellites.size(); ++s)
            EXPECT_EQ(arc(pair, e, s, 0), arc(pair, 0, s, 0));
}

TEST(Arcs, FewSatellitesHaveTheirCarriersAndTheirDopplers) {
    Pair pair(8.0);
    for (TrackedEpoch& e : pair.rover_epochs) e.satellites.resize(4);
    TrackedEpoch* epochs = pair.rover_epochs.data();
    for (std::size_t e = 5; e < 9; ++e) {
        TrackedSignal& s = epochs[e].satellites[1].signals[1];
        s.phase += s.wavelength;
    }
    ArcCounts counts = pair.number();
    EXPECT_EQ(counts.geometry_free, 1U);
    EXPECT_EQ(counts.unexplained, 0U);
    EXPECT_NE(epochs[5].satellites[1].signals[0].arc,
              epochs[4].satellites[1].signals[0].arc);  // which of the two slipped is not known
    EXPECT_EQ(epochs[5].satellites[0].signals[0].arc, epochs[4].satellites[0].signals[0].arc);
    // one carrier: the Doppler
    for (std::size_t e = 0; e < 9; ++e)
        for (std::size_t i = 0; i < 4; ++i) {
            TrackedSignal& s = epochs[e].satellites[i].signals[0];
            epochs[e].satellites[i].signals[1] = {};
            s.doppler = 100.0 * static_cast<double>(i);
            s.phase = 2e7 + s.doppler * static_cast<double>(e) + (i == 2 && e >= 4 ? 8.0 * s.wavelength : 0.0);
        }
    counts = number_arcs(pair.rover_epochs, false, pair.settings.arcs, pair.settings.air);
    EXPECT_EQ(counts.unexplained, 1U);
    EXPECT_NE(epochs[4].satellites[2].signals[0].arc, epochs[3].satellites[2].signals[0].arc);
}

/// Positions and double differences of a float solution with its covariance.
struct Float {
    Eigen::VectorXd x;
    Eigen::MatrixXd P;
    std::vector<WholeState> whole;
    Eigen::VectorXd truth;

    explicit Float(std::uint64_t seed, double code = 0.4) {
        math::Random random(seed, "float");
        constexpr Eigen::Index n = 10;
        Eigen::MatrixXd G(n, 3);
        for (Eigen::Index i = 0; i < n; ++i) G.row(i) = random.normal3().normalized().transpose();
        // position by codes, ambiguities by phases at that position
        const Eigen::Matrix3d position = code * code * (G.transpose() * G).inverse();
        P = Eigen::MatrixXd::Zero(3 + n, 3 + n);
        P.topLeftCorner<3, 3>() = position;
        P.topRightCorner(3, n) = -position * G.transpose();
        P.bottomLeftCorner(n, 3) = P.topRightCorner(3, n).transpose();
        P.bottomRightCorner(n, n) = G * position * G.transpose() + 4e-3 * 4e-3 * Eigen::MatrixXd::Identity(n, n);
        truth = Eigen::VectorXd::Zero(3 + n);
        for (Eigen::Index i = 0; i < n; ++i) {
            const double wavelength = i % 2 == 0 ? 0.19 : 0.24;
            truth[3 + i] =
                wavelength * std::floor(1000.0 * random.uniform()) + (i % 2 == 0 ? 3.7 : -1.1);  // clocks: of the group
            whole.push_back({{gnss::System::Gps, static_cast<std::uint8_t>(1 + i / 2)},
                             static_cast<int>(i % 2),
                             3 + i,
                             wavelength,
                             false,
                             0.5 + 0.1 * static_cast<double>(i),
                             0.0,
                             false});
        }
        const Eigen::MatrixXd root = P.llt().matrixL();
        Eigen::VectorXd noise(3 + n);
        for (Eigen::Index i = 0; i < noise.size(); ++i) noise[i] = random.normal();
        x = truth + root * noise;
    }
};

TEST(Integers, TheConditionedPositionIsThatOfTheKnownIntegers) {
    int fixed = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        const Float f(seed);
        IntegerSettings settings;
        const IntegerTrial trial = fix_integers(f.x, f.P, f.whole, 3, settings);
        if (!trial.fix) continue;
        ++fixed;
        // the oracle: least squares with the true double differences as exact measurements
        Eigen::MatrixXd T = Eigen::MatrixXd::Zero(8, 13);
        for (Eigen::Index i = 0; i < 8; ++i) {
            T(i, 3 + i) = 1.0;
            T(i, 11 + i % 2) = -1.0;  // the highest of each group are the last two
        }
        const Eigen::MatrixXd K = f.P * T.transpose() * (T * f.P * T.transpose()).inverse();
        const Eigen::VectorXd exact = f.x + K * (T * f.truth - T * f.x);
        const Eigen::MatrixXd P = f.P - K * T * f.P;
        if (trial.fix->count == 8) {
            EXPECT_LT((f.x.head<3>() + trial.fix->correction - exact.head<3>()).norm(), 1e-6) << seed;
            EXPECT_LT((trial.fix->covariance - P.topLeftCorner<3, 3>()).norm(), 1e-8) << seed;
        }
        const Eigen::Vector3d error = f.x.head<3>() + trial.fix->correction;
        EXPECT_LT(error.dot(trial.fix->covariance.ldlt().solve(error)), 30.0) << seed;
    }
    EXPECT_GT(fixed, 100);
}

TEST(Integers, NotWhereTheyCannotBeKnown) {
    int fixed = 0, wrong = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        Float f(seed, 3.0);
        const IntegerTrial trial = fix_integers(f.x, f.P, f.whole, 3, {});
        fixed += trial.fix ? 1 : 0;
        wrong += trial.fix && (f.x.head<3>() + trial.fix->correction).norm() > 0.3 && trial.fix->count == 8 ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0);
}

TEST(Integers, HalfCyclesAreToldFromWholeOnes) {
    int tried = 0, told = 0, halved = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        // with it nothing fits, without it all does
        Float f(seed, 0.2);
        for (WholeState& w : f.whole) w.trusted = w.state != 5;
        if (!fix_integers(f.x, f.P, f.whole, 3, {}).fix) continue;
        ++tried;
        f.x[5] += 0.5 * 0.19;
        const IntegerTrial trial = fix_integers(f.x, f.P, f.whole, 3, {});
        if (trial.fix && trial.fix->broken == std::vector<Eigen::Index>{5}) {
            ++told;
            const Eigen::Vector3d error = f.x.head<3>() + trial.fix->correction;
            EXPECT_LT(error.dot(trial.fix->covariance.ldlt().solve(error)), 30.0) << seed;
        }
        // taken for half cycles it is one of them
        f.whole[2].halves = true;
        f.whole[2].wavelength *= 0.5;
        const IntegerTrial halves = fix_integers(f.x, f.P, f.whole, 3, {});
        halved += halves.fix && halves.fix->broken.empty() && halves.fix->states.size() == f.whole.size() ? 1 : 0;
    }
    EXPECT_GT(tried, 50);
    EXPECT_GT(told, tried * 8 / 10);
    EXPECT_GT(halved, tried * 8 / 10);
}

TEST(Combined, TheBetterOneUnlessTheyContradict) {
    EpochSolution fixed, floating;
    fixed.quality = Quality::Fixed;
    fixed.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    floating.quality = Quality::Float;
    floating.covariance = 0.04 * Eigen::Matrix3d::Identity();
    floating.position.r = {0.3, 0.0, 0.0};
    EXPECT_EQ(combined(fixed, floating).quality, Quality::Fixed);
    EXPECT_EQ(combined(floating, fixed).position.r, fixed.position.r);
    EpochSolution other = fixed;
    other.position.r = {0.0, 0.19, 0.0};
    const EpochSolution doubt = combined(fixed, other);
    EXPECT_EQ(doubt.quality, Quality::Float);
    EXPECT_GT(std::sqrt(doubt.covariance(1, 1)), 0.19);
    EpochSolution single = floating;
    single.quality = Quality::Single;
    EXPECT_EQ(combined(single, floating).quality, Quality::Float);
    EXPECT_EQ(combined(single, EpochSolution{}).quality, Quality::Single);
}

}  // namespace
}  // namespace schuler::ppk
