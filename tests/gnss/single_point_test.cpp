// Single-point position and velocity on the signal generator's noise-free data, with faults put in.
#include "schuler/gnss/single_point.h"
#include "schuler/core/units.h"
#include "schuler/gnss/phase_velocity.h"

#include "schuler/earth/ellipsoid.h"
#include "schuler/io/rinex/rinex.h"
#include "schuler/io/text/csv/csv_recording.h"

#include "gnss/spirent_truth.h"
#include "io/io_fixture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

namespace schuler::gnss {
namespace {

using units::deg;

/// Files of one folder of the data sets.
struct Files {
    ObservationLog log;
    Navigation navigation;

    Files(const std::string& folder, const std::string& observations, const std::vector<std::string>& navigation_files) {
        WarningLog warnings;
        const auto path = io::test::data_folder() / folder;
        log = io::read_rinex_observations(path / observations, warnings).log;
        for (const std::string& name : navigation_files)
            navigation.add(io::read_rinex_navigation(path / name, warnings).navigation);
    }
};

/// A moving receiver with its truth.
struct MovingFiles : Files {
    std::vector<ReferenceSample> reference;

    MovingFiles() : Files("spirent_rose_noatm", "rover.obs", {"gps.nav", "galileo.nav"}) {
        WarningLog warnings;
        reference =
            io::read_reference_csv(io::test::data_folder() / "spirent_rose_noatm" / "reference.csv", {}, warnings).samples;
    }
};

SinglePointSettings without_atmosphere() {
    SinglePointSettings s;
    s.ranges.ionosphere = IonosphereModel::None;
    s.ranges.troposphere = TroposphereModel::None;
    return s;
}

void use_systems(SinglePointSettings& settings, std::string_view letters) {
    for (std::size_t i = 0; i < system_count; ++i)
        settings.ranges.systems[i] = letters.find(letter_of(static_cast<System>(i))) != std::string_view::npos;
}

const Geodetic static_truth{30.0 * deg, 95.0 * deg, 0.0};

Eigen::Vector3d ned_error(const Ecef& estimate, const Geodetic& truth) {
    return earth::C_en(truth.lat, truth.lon).transpose() * (estimate.r - earth::ecef_from_geodetic(earth::wgs84, truth).r);
}

struct StaticFiles : Files {
    StaticFiles()
        : Files("spirent_static_4h", "noatm.obs", {"nav_GN.23N", "nav_EN.23L", "nav_CN.23C", "nav_JN.23J", "nav_RN.23G"}) {}
};

/// Satellites all around a receiver at rest.
std::vector<Range> made_up_ranges(const Geodetic& at) {
    const Ecef receiver = earth::ecef_from_geodetic(earth::wgs84, at);
    const Eigen::Matrix3d C_en = earth::C_en(at.lat, at.lon);
    std::vector<Range> ranges;
    for (int k = 0; k < 8; ++k) {
        const double azimuth = 0.7 * k, elevation = (15.0 + 8.0 * k) * deg;
        const Eigen::Vector3d u(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                                -std::sin(elevation));
        Range r;
        r.satellite = {System::Gps, static_cast<std::uint8_t>(k + 1)};
        r.position.r = receiver.r + 2.2e7 * (C_en * u);
        r.sigma = 0.5 + 0.1 * k;
        r.slow = 2.0;
        r.pseudorange = model_range(r, receiver, at, nullptr, without_atmosphere().ranges).range + 40.0;
        ranges.push_back(r);
    }
    return ranges;
}

TEST(SinglePoint, GainsTellWhatEachRangesErrorDoes) {
    const BroadcastSource nobody{Navigation{}};
    SinglePoint solver(nobody, std::nullopt, without_atmosphere());
    const std::vector<Range> ranges = made_up_ranges(static_truth);
    const SinglePointSolution right = solver.solve(ranges, Time{});
    ASSERT_EQ(right.status, SinglePointStatus::Solved);
    Eigen::Matrix3d whole = Eigen::Matrix3d::Zero(), slow = whole;
    for (std::size_t k = 0; k < ranges.size(); ++k) {
        std::vector<Range> wrong = ranges;
        wrong[k].pseudorange += 1.0;
        const Eigen::Vector3d moved = solver.solve(wrong, Time{}).position.r - right.position.r, gain = right.satellites[k].gain;
        EXPECT_LT((moved - gain).norm(), 1e-5) << k;
        EXPECT_GT(gain.norm(), 0.01) << k;
        whole += (4.0 + ranges[k].sigma * ranges[k].sigma) * gain * gain.transpose();
        slow += 4.0 * gain * gain.transpose();
    }
    EXPECT_LT((right.covariance - whole).norm(), 1e-9);
    EXPECT_LT((right.slow_covariance - slow).norm(), 1e-9);
}

TEST(SinglePoint, AgreementOfFewIsNoFixWhereAsManyWereLeftOut) {
    const BroadcastSource nobody{Navigation{}};
    SinglePointSettings settings = without_atmosphere();
    SinglePoint solver(nobody, std::nullopt, settings);
    std::vector<Range> ranges = made_up_ranges(static_truth);
    ranges[1].pseudorange += 90.0;
    ranges[6].pseudorange -= 150.0;
    EXPECT_EQ(solver.solve(ranges, Time{}).status, SinglePointStatus::Solved);  // six agree, two against them
    ranges[3].pseudorange += 200.0;
    EXPECT_NE(solver.solve(ranges, Time{}).status, SinglePointStatus::Solved);  // of five one more than determine a fix
}

TEST(SinglePoint, TheSigmaOfTheHeightHasWhatTheModelOfTheIonosphereMissesEverywhereAlike) {
    const BroadcastSource nobody{Navigation{}};
    SinglePointSettings settings;
    settings.ranges.troposphere = TroposphereModel::None;
    const BroadcastIonosphere ionosphere{KlobucharCoefficients{{3e-8, 0, 0, 0}, {1.2e5, 0, 0, 0}}, std::nullopt};
    const Ecef receiver = earth::ecef_from_geodetic(earth::wgs84, static_truth);
    std::vector<Range> ranges = made_up_ranges(static_truth);
    const Time noon = Time::from_gps(2244, 8.0 * 3600.0);  // at 95 degrees east
    std::vector<double> delays;
    for (Range& r : ranges) {
        r.slow = 0.0;
        r.frequency = l1_frequency;
        r.transmit = noon;
        const ModelledRange with = model_range(r, receiver, static_truth, &ionosphere, settings.ranges);
        delays.push_back(with.range - model_range(r, receiver, static_truth, nullptr, settings.ranges).range);
        r.pseudorange = with.range + 40.0;
    }
    SinglePoint solver(nobody, ionosphere, settings);
    const SinglePointSolution right = solver.solve(ranges, noon);
    ASSERT_EQ(right.status, SinglePointStatus::Solved);
    // one sigma of the model: half of every delay, which all satellites show
    for (std::size_t k = 0; k < ranges.size(); ++k) ranges[k].pseudorange += 0.5 * delays[k];
    const SinglePointSolution off = solver.solve(ranges, noon);
    ASSERT_EQ(off.status, SinglePointStatus::Solved);
    const Eigen::Matrix3d C_ne = earth::C_en(static_truth.lat, static_truth.lon).transpose();
    const double height = std::abs(ned_error(off.position, static_truth).z());
    EXPECT_GT(height, 3.0);
    EXPECT_GT(std::sqrt((C_ne * right.covariance * C_ne.transpose())(2, 2)), height);
    EXPECT_GT(std::sqrt((C_ne * right.slow_covariance * C_ne.transpose())(2, 2)), height);
}

TEST(SinglePoint, TheCovarianceCoversWhomElseTheFaultMayBelongTo) {
    const BroadcastSource nobody{Navigation{}};
    SinglePoint solver(nobody, std::nullopt, without_atmosphere());
    std::vector<Range> ranges = made_up_ranges(static_truth);
    ranges.resize(6);  // two more than unknowns: a fault is found, not always whose
    for (std::size_t k = 0; k < ranges.size(); ++k)
        ranges[k].pseudorange += k % 2 == 0 ? 1.5 : -1.5;  // noise that pulls at the decision
    int decided = 0;
    const SinglePointSolution right = solver.solve(ranges, Time{});
    ASSERT_EQ(right.status, SinglePointStatus::Solved);
    for (std::size_t k = 0; k < ranges.size(); ++k) {
        for (const double fault : {-60.0, 40.0}) {
            std::vector<Range> wrong = ranges;
            wrong[k].pseudorange += fault;
            const SinglePointSolution s = solver.solve(wrong, Time{});
            if (s.status != SinglePointStatus::Solved || s.excluded() == 0)
                continue;  // unseen: the business of protection levels
            ++decided;
            const Eigen::Vector3d error = s.position.r - right.position.r;
            EXPECT_LT(error.dot(s.covariance.ldlt().solve(error)), 16.0) << k << " " << fault;
        }
    }
    EXPECT_GT(decided, 3);
}

constexpr double made_up_mu = 3.986005e14;

/// Adds messages of one orbit, each displaced along it.
struct MadeUpMessages {
    Navigation navigation;
    Time first = Time::from_gps(2244, 36000.0);

    void add(SatelliteId satellite, int hour, double displaced_m) {
        KeplerEphemeris k;
        k.sqrt_a = 5153.7;
        k.e = 0.01;
        k.i0 = 0.96;
        k.accuracy = 2.0;
        k.satellite = satellite;
        const double a = k.sqrt_a * k.sqrt_a, n = std::sqrt(made_up_mu / (a * a * a));
        k.toe = k.toc = first + Duration::from_seconds(3600.0 * hour);
        k.m0 = n * 3600.0 * hour + displaced_m / a;
        k.omega0 = 0.0;  // of the beginning of the week: the same plane in each message
        navigation.kepler.push_back(k);
    }
};

TEST(SinglePoint, EphemeridesThatContradictEachOtherAreNotUsed) {
    MadeUpMessages messages;
    const Time first = messages.first;
    for (int hour = 0; hour < 4; ++hour) {
        messages.add({System::Gps, 1}, hour, 0.0);
        messages.add({System::Gps, 2}, hour, hour == 3 ? 80.0 : 0.0);
        messages.add({System::Gps, 3}, hour, 80.0 * (hour % 2));
    }
    const BroadcastSource source(messages.navigation);
    EXPECT_EQ(source.contradicting(), (std::vector<SatelliteId>{{System::Gps, 2}, {System::Gps, 3}}));
    const Signal l1{'1', 'C'};
    const auto at = [&](std::uint8_t number, double hour) {
        return source.at({System::Gps, number}, l1, first + Duration::from_seconds(3600.0 * hour)).has_value();
    };
    EXPECT_TRUE(at(1, 0.1) && at(1, 3.1));
    EXPECT_TRUE(at(2, 0.1) && at(2, 1.1));
    EXPECT_EQ(source.kepler({System::Gps, 2}, first + Duration::from_seconds(3 * 3600.0))->toe,
              first + Duration::from_seconds(3600.0));
    EXPECT_FALSE(at(3, 0.1) || at(3, 3.1));
}

TEST(SinglePoint, MessagesOfBeiDouSixHoursApartAreNoContradiction) {
    MadeUpMessages messages;
    messages.add({System::BeiDou, 21}, 0, 0.0);
    messages.add({System::BeiDou, 21}, 6, 40.0);  // half-way each is three hours old
    messages.add({System::BeiDou, 22}, 0, 0.0);
    messages.add({System::BeiDou, 22}, 1, 80.0);
    const BroadcastSource source(messages.navigation);
    EXPECT_EQ(source.contradicting(), (std::vector<SatelliteId>{{System::BeiDou, 22}}));
    EXPECT_EQ(source.navigation().kepler.size(), 2U);
}

TEST(SinglePoint, SignalGeneratorAtRestEveryEpochToMillimetres) {
    SKIP_WITHOUT_DATA();
    const StaticFiles files;
    const BroadcastSource source(files.navigation);
    // the ephemerides of BeiDou's geostationary satellites are thousands of kilometres off, and GLONASS's leave the orbit: they contradict
    // each other and are not used, so that BeiDou alone has a fix at every epoch too and nothing is left to exclude
    for (const std::string_view systems : {"G", "C", "GE", "GEJ", "GECJ", "GRECJ"}) {
        SinglePointSettings settings = without_atmosphere();
        use_systems(settings, systems);
        SinglePoint solver(source, std::nullopt, settings);
        int solved = 0, excluded = 0;
        double largest = 0.0;
        for (const ObservationEpoch& e : files.log.epochs) {
            const SinglePointSolution s = solver.solve(files.log.of(e), e.time, files.log.channels);
            ASSERT_EQ(s.status, SinglePointStatus::Solved) << systems << " " << name_of(s.status);
            ++solved;
            excluded += s.excluded();
            const Eigen::Vector3d error = ned_error(s.position, static_truth);
            largest = std::max(largest, error.head<2>().norm());
            EXPECT_LT(error.head<2>().norm(), 0.005) << systems;
            EXPECT_LT(std::abs(error.z()), 0.01) << systems;
            EXPECT_LT(s.velocity.norm(), 0.005) << systems;
        }
        std::printf("%s: %d epochs, largest horizontal error %.1f mm\n", std::string(systems).c_str(), solved, 1e3 * largest);
        EXPECT_EQ(solved, 49);
        EXPECT_EQ(excluded, 0);
    }
}

TEST(SinglePoint, DirectionsAgreeWithTheGenerator) {
    SKIP_WITHOUT_DATA();
    const StaticFiles files;
    const BroadcastSource source(files.navigation);
    SinglePoint solver(source, std::nullopt, without_atmosphere());
    const ObservationEpoch& first = files.log.epochs.front();
    const SinglePointSolution s = solver.solve(files.log.of(first), first.time, files.log.channels);
    int found = 0;
    for (const Truth& t : spirent_truth()) {
        const auto use = std::ranges::find(s.satellites, t.satellite, &SatelliteUse::satellite);
        if (t.time != first.time || use == s.satellites.end() || !use->used) continue;
        ++found;
        constexpr double digits = 6e-5;  // half of the log's last digit, 1e-4 rad
        const double turn = std::remainder(use->direction.azimuth - t.direction.azimuth, 360.0 * deg);
        EXPECT_NEAR(turn, 0.0, digits) << name_of(t.satellite);
        EXPECT_NEAR(use->direction.elevation, t.direction.elevation, digits) << name_of(t.satellite);
    }
    EXPECT_EQ(found, s.used());
    EXPECT_GT(found, 20);
}

TEST(SinglePoint, MovingReceiver) {
    SKIP_WITHOUT_DATA();
    const MovingFiles files;
    const BroadcastSource source(files.navigation);
    std::map<std::int64_t, const ReferenceSample*> truth;
    for (const ReferenceSample& r : files.reference) truth[r.time.ns] = &r;
    for (const IonosphereModel ionosphere : {IonosphereModel::None, IonosphereModel::Dual}) {
        SinglePointSettings settings = without_atmosphere();
        settings.ranges.ionosphere = ionosphere;
        SinglePoint solver(source, std::nullopt, settings);
        std::size_t compared = 0;
        double sum = 0.0, sum_velocity = 0.0;
        for (const ObservationEpoch& e : files.log.epochs) {
            const SinglePointSolution s = solver.solve(files.log.of(e), e.time, files.log.channels);
            ASSERT_EQ(s.status, SinglePointStatus::Solved);
            const auto at = truth.find((e.time - Time::from_gps(2244, 0.0)).ns);
            if (at == truth.end()) continue;
            const Geodetic& where = at->second->position;
            const Eigen::Vector3d error = ned_error(s.position, where);
            const Eigen::Vector3d velocity = earth::C_en(where.lat, where.lon).transpose() * s.velocity - at->second->velocity_n;
            ++compared;
            EXPECT_LT(error.norm(), ionosphere == IonosphereModel::None ? 0.01 : 0.03);
            sum += error.squaredNorm();
            sum_velocity += velocity.squaredNorm();
        }
        EXPECT_GT(compared, 590U);
        EXPECT_LT(std::sqrt(sum / static_cast<double>(compared)), ionosphere == IonosphereModel::None ? 0.002 : 0.01);
        EXPECT_LT(std::sqrt(sum_velocity / static_cast<double>(compared)), 0.01);
    }
}

TEST(PhaseVelocity, MovingReceiverToAMillimetreASecondAndCycleSlips) {
    SKIP_WITHOUT_DATA();
    const MovingFiles files;
    const BroadcastSource source(files.navigation);
    std::map<std::int64_t, Ecef> truth;
    for (const ReferenceSample& r : files.reference) truth[r.time.ns] = earth::ecef_from_geodetic(earth::wgs84, r.position);
    const SinglePointSettings settings = without_atmosphere();
    SinglePoint solver(source, std::nullopt, settings);
    PhaseDifferences plain(source, settings.ranges), slipping(source, settings.ranges);
    double sum = 0.0, sum_slipping = 0.0;
    int compared = 0, slips = 0;
    for (const ObservationEpoch& e : files.log.epochs) {
        const auto all = files.log.of(e);
        const SinglePointSolution s = solver.solve(all, e.time, files.log.channels);
        // one cycle more on every sixteenth satellite, others at each epoch: up to four phases jump by 0.19 m in a second
        std::vector<SignalObservation> slipped(all.begin(), all.end());
        const auto k = static_cast<std::size_t>(&e - files.log.epochs.data());
        for (SignalObservation& o : slipped) o.phase += o.satellite.number % 16 == k % 16 ? 1.0 : 0.0;
        const auto v = plain.update(all, e.time, files.log.channels, s),
                   w = slipping.update(slipped, e.time, files.log.channels, s);
        if (!v) continue;
        ASSERT_TRUE(w);
        slips += w->slips;
        EXPECT_EQ(v->slips, 0);
        const std::int64_t now = (e.time - Time::from_gps(2244, 0.0)).ns;
        if (!truth.contains(now) || !truth.contains(now - 1'000'000'000)) continue;
        const Eigen::Vector3d moved = truth[now].r - truth[now - 1'000'000'000].r;
        sum += (v->velocity * v->interval - moved).squaredNorm();
        sum_slipping += (w->velocity * w->interval - moved).squaredNorm();
        ++compared;
    }
    EXPECT_GT(compared, 590);
    EXPECT_GT(slips, 500);
    EXPECT_LT(std::sqrt(sum / compared), 0.001);
    EXPECT_LT(std::sqrt(sum_slipping / compared), 0.001);
}

TEST(SinglePoint, FaultsAreExcludedOrRefused) {
    SKIP_WITHOUT_DATA();
    const Files files("spirent_rose_noatm", "rover.obs", {"gps.nav", "galileo.nav"});
    const BroadcastSource source(files.navigation);
    SinglePoint solver(source, std::nullopt, without_atmosphere());
    const ObservationEpoch& e = files.log.epochs.front();
    const auto all = files.log.of(e);
    const SinglePointSolution clean = solver.solve(all, e.time, files.log.channels);
    ASSERT_EQ(clean.excluded(), 0);
    const auto faulty = [&](std::initializer_list<std::pair<SatelliteId, double>> faults) {
        std::vector<SignalObservation> changed(all.begin(), all.end());
        for (SignalObservation& o : changed) {
            for (const auto& [satellite, size] : faults) o.pseudorange += o.satellite == satellite ? size : 0.0;
        }
        return solver.solve(changed, e.time, files.log.channels);
    };
    const SatelliteId a{System::Gps, 20}, b{System::Gps, 14};
    for (const double size : {60.0, -1e4, 3e6}) {
        const SinglePointSolution s = faulty({{a, size}});
        ASSERT_EQ(s.status, SinglePointStatus::Solved) << size;
        EXPECT_EQ(s.excluded(), 1) << size;
        EXPECT_LT((s.position.r - clean.position.r).norm(), 0.01) << size;
        for (const SatelliteUse& use : s.satellites) EXPECT_EQ(use.excluded, use.satellite == a) << size;
    }
    const SinglePointSolution two = faulty({{a, 150.0}, {b, -90.0}});
    EXPECT_EQ(two.status, SinglePointStatus::Solved);
    EXPECT_EQ(two.excluded(), 2);
    EXPECT_LT((two.position.r - clean.position.r).norm(), 0.01);
    // with as many satellites as leave one redundant a fault is seen but cannot be found
    std::vector<SignalObservation> few;
    std::map<SatelliteId, int> kept;
    for (const SignalObservation& o : all) {
        const auto use = std::ranges::find(clean.satellites, o.satellite, &SatelliteUse::satellite);
        if (use == clean.satellites.end() || !use->used || o.satellite.system != System::Gps) continue;
        if (kept.size() == 5 && !kept.contains(o.satellite)) continue;
        ++kept[o.satellite];
        few.push_back(o);
    }
    EXPECT_EQ(solver.solve(few, e.time, files.log.channels).status, SinglePointStatus::Solved);
    for (SignalObservation& o : few) o.pseudorange += o.satellite == few.front().satellite ? 250.0 : 0.0;
    EXPECT_EQ(solver.solve(few, e.time, files.log.channels).status, SinglePointStatus::Inconsistent);
    few.resize(3);
    EXPECT_EQ(solver.solve(few, e.time, files.log.channels).status, SinglePointStatus::TooFew);
}

TEST(SinglePoint, ClockOfTheReceiverMovesTheTimeAndNotThePlace) {
    SKIP_WITHOUT_DATA();
    const StaticFiles files;
    const BroadcastSource source(files.navigation);
    SinglePointSettings settings = without_atmosphere();
    use_systems(settings, "GE");
    SinglePoint solver(source, std::nullopt, settings);
    const ObservationEpoch& e = files.log.epochs.front();
    // half a millisecond fast: tag and pseudoranges grow alike; Galileo's ranges 30 m longer besides
    constexpr double offset = 5e-4;
    const auto all = files.log.of(e);
    std::vector<SignalObservation> shifted(all.begin(), all.end());
    for (SignalObservation& o : shifted)
        o.pseudorange += speed_of_light * offset + (o.satellite.system == System::Galileo ? 30.0 : 0.0);
    const SinglePointSolution s = solver.solve(shifted, e.time + Duration::from_seconds(offset), files.log.channels);
    ASSERT_EQ(s.status, SinglePointStatus::Solved);
    EXPECT_LT(ned_error(s.position, static_truth).norm(), 0.01);
    EXPECT_NEAR((s.time - e.time).seconds(), 0.0, 5e-9);
    EXPECT_NEAR(s.intersystem_bias(clock_of(System::Galileo)), 30.0, 0.01);
}

}  // namespace
}  // namespace schuler::gnss
