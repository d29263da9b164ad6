// What receivers do to phases, put in one by one: noise, reflections, slips, clocks, gaps, air; and bases that are none.
#include "ppk/made_up_logs.h"
#include "ppk/ppk_fixture.h"

#include "schuler/core/error.h"

#include <fmt/format.h>

namespace schuler::ppk {
namespace {

using test::Errors;
using test::errors_of;
using test::Receiver;

const Time beginning = Time::from_gps(2300, 200'000.0);
const Geodetic place{48.78 * test::deg, 9.17 * test::deg, 320.0};

class MadeUp : public testing::Test {
protected:
    MadeUp() : sky(test::made_up_sky(beginning, beginning + Duration::from_seconds(7200))) {
        base.place = [](Time) { return test::place_from(place, 0, 0, 0); };
        base.clock = [](Time) { return -3e-6; };
        rover.place = [](Time t) {  // a circle of 40 m at 5 m/s
            const double a = (t - beginning).seconds() / 8.0;
            return test::place_from(place, 900.0 + 40.0 * std::cos(a), 1200.0 + 40.0 * std::sin(a),
                                    15.0 + 3.0 * std::sin(0.3 * a));
        };
        single = test::without_air();
        settings = test::settings_without_air();
    }
    /// Rover and base of a seed for so many seconds.
    void measure(double seconds, std::uint64_t seed) {
        rover_log = test::measured(sky, rover, beginning, seconds, 2 * seed);
        base_log = test::measured(sky, base, beginning, seconds, 2 * seed + 1);
    }
    Solution solved(std::optional<Ecef> position = {}) {
        const gnss::BroadcastSource source(sky);
        Input input;
        input.rover = &rover_log;
        input.base = &base_log;
        input.rover_name = "rover.obs";
        input.base_name = "base.obs";
        input.base_position = position;
        input.rover_antenna = rover_antenna;
        input.base_antenna = base_antenna;
        input.source = &source;
        input.single = single;
        return solve(input, settings, warnings);
    }
    /// Both receivers under the models' troposphere, solved with them and a mean day's ionosphere (without coefficients).
    void put_under_air() {
        rover.air = base.air = true;
        settings.air.troposphere = true;
        single.ranges.troposphere = gnss::TroposphereModel::Saastamoinen;
        single.ranges.ionosphere = gnss::IonosphereModel::Broadcast;
        settings.air.ionosphere = gnss::BroadcastIonosphere{};
    }
    Errors errors(const Solution& s, double from = 0) { return errors_of(s, rover.place, from); }
    /// Every observation of a satellite's carrier in a log from so many seconds on.
    static void each(gnss::ObservationLog& log, double from, const std::function<void(gnss::SignalObservation&)>& change) {
        for (const gnss::ObservationEpoch& e : log.epochs) {
            if ((e.time - log.epochs.front().time).seconds() < from) continue;
            for (std::size_t i = e.first; i < e.first + e.count; ++i) change(log.observations[i]);
        }
    }
    static std::string text(const Errors& e) {
        return fmt::format(
            "{} epochs, {} fixed, first {}, last not {}, wrong {}, outside {}, rms {:.4f} {:.4f} m, largest {:.3f}", e.epochs,
            e.fixed, e.first_fixed, e.fixed_until, e.wrong, e.outside, e.horizontal(), e.vertical(), e.largest);
    }

    gnss::Navigation sky;
    Receiver rover, base;
    gnss::ObservationLog rover_log, base_log;
    const gnss::Antenna *rover_antenna = nullptr, *base_antenna = nullptr;
    gnss::SinglePointSettings single;
    Settings settings;
    WarningLog warnings;
};

TEST_F(MadeUp, PositionsAreOfTheReferencePointsOfCalibratedAntennas) {
    // decimetres, other ones on each carrier, and a phase that is longer near the horizon
    const auto offset = [](double frequency) {
        return frequency > 1.5e9 ? Eigen::Vector3d(0.01, -0.02, 0.11) : Eigen::Vector3d(-0.01, 0.01, 0.16);
    };
    rover.phase_centre = offset;
    rover.variation = [](double elevation) { return 0.02 * (1.0 - 2.0 * elevation / 3.141592653589793); };
    base.phase_centre = [](double) { return Eigen::Vector3d(0.0, 0.0, 0.05); };
    gnss::Antenna at_rover, at_base;
    for (const double frequency : {1575.42e6, 1227.6e6, 1176.45e6})
        at_rover.carriers.push_back({frequency, offset(frequency), {0.0, 1.5707963267948966, {{0.0, 0.02}}}});
    at_base.carriers.push_back({1575.42e6, {0.0, 0.0, 0.05}, {}});
    measure(60.0, 3);
    const Errors without = errors(solved());
    rover_antenna = &at_rover;
    base_antenna = &at_base;
    const Errors with = errors(solved());
    EXPECT_EQ(with.fixed, with.epochs) << text(with);
    EXPECT_EQ(with.outside, 0U) << text(with);
    EXPECT_LT(with.vertical(), 0.012) << text(with);
    EXPECT_GT(without.vertical(), 0.03) << text(without);
}

TEST_F(MadeUp, SigmasCoverFloatAndFixed) {
    // code errors that last a minute: a filter that takes them for white is soon too sure of its float
    for (const bool integers : {true, false}) {
        for (const std::size_t frequencies : {2U, 1U}) {
            settings.integers.use = integers;
            settings.frequencies = frequencies;
            settings.direction = Direction::Forward;
            Errors all;
            std::size_t epochs = 0;
            double nees = 0;
            for (std::uint64_t seed = 0; seed < 20; ++seed) {
                measure(90.0, seed);
                const Solution s = solved();
                const Errors e = errors(s);
                all.outside += e.outside;
                all.wrong += e.wrong;
                all.fixed += e.fixed;
                epochs += e.epochs;
                const EpochSolution& last = s.epochs.back();
                const Eigen::Vector3d d = last.position.r - rover.place(last.time).r;
                nees += d.dot(last.covariance.inverse() * d) / 20.0;
            }
            fmt::print(
                "integers {}, {} frequencies: {} epochs, {} fixed, {} wrong, {} outside three sigma, NEES at the end {:.2f}\n",
                integers, frequencies, epochs, all.fixed, all.wrong, all.outside, nees);
            EXPECT_EQ(all.wrong, 0U);
            EXPECT_LE(all.outside, epochs / 100);
            EXPECT_LT(nees, 5.0);  // of three degrees, 20 draws: 99.9 % below
            if (integers && frequencies == 2) {
                EXPECT_GT(all.fixed, epochs * 95 / 100);
            }
        }
    }
}

TEST_F(MadeUp, ReflectionsInAStreet) {
    // a tenth of the codes metres too long, phases that err by half a centimetre for half a minute, slips
    rover.outliers = 0.1;
    rover.phase_reflections = 0.004;
    rover.code_sigma = 0.8;
    for (const bool integers : {true, false}) {
        for (const std::size_t frequencies : {2U, 1U}) {
            settings.integers.use = integers;
            settings.frequencies = frequencies;
            Errors all;
            for (std::uint64_t seed = 40; seed < 50; ++seed) {
                measure(120.0, seed);
                math::Random random(seed, "slips");
                const auto satellites = gnss::satellites_of(sky);
                for (int i = 0; i < 20; ++i) {
                    const SatelliteId id =
                        satellites[static_cast<std::size_t>(random.uniform() * static_cast<double>(satellites.size()))];
                    each(rover_log, 10.0 + std::floor(100.0 * random.uniform()), [&](gnss::SignalObservation& o) {
                        if (o.satellite == id) o.phase += 3.0;
                    });
                }
                const Errors e = errors(solved());
                all.outside += e.outside;
                all.wrong += e.wrong;
                all.fixed += e.fixed;
                all.epochs += e.epochs;
                all.square += e.square;
            }
            fmt::print("street, integers {}, {} frequencies: {}\n", integers, frequencies, text(all));
            EXPECT_EQ(all.wrong, 0U);
            // codes that go astray by a few sigma for twenty seconds are no normal errors, and a seed's epochs hang together
            EXPECT_LE(all.outside, all.epochs / (integers && frequencies == 2 ? 100 : 15));
            if (integers && frequencies == 2) {
                EXPECT_GT(all.fixed, all.epochs * 9 / 10);
            }
        }
    }
}

TEST_F(MadeUp, SlipsThatNobodyTells) {
    measure(120.0, 5);
    math::Random random(7, "slips");
    const auto satellites = gnss::satellites_of(sky);
    for (int i = 0; i < 60; ++i) {
        const SatelliteId id = satellites[static_cast<std::size_t>(random.uniform() * static_cast<double>(satellites.size()))];
        const char band = random.uniform() < 0.5 ? '1' : id.system == gnss::System::Gps ? '2' : '5';
        const double cycles = std::round(random.normal() * 3.0) + (i % 3 == 0 ? 0.5 : 0.0);
        each(random.uniform() < 0.8 ? rover_log : base_log, 10.0 + std::floor(100.0 * random.uniform()),
             [&](gnss::SignalObservation& o) {
                 if (o.satellite == id && o.signal.band == band) o.phase += cycles;
             });
    }
    for (const std::size_t frequencies : {2U, 1U}) {
        settings.frequencies = frequencies;
        const Solution s = solved();
        const Errors e = errors(s);
        fmt::print("slips, {} frequencies: {}; found {} + {}\n", frequencies, text(e), s.rover_arcs.found(), s.base_arcs.found());
        EXPECT_EQ(e.wrong, 0U);
        EXPECT_LE(e.outside, 1U);
        EXPECT_GT(s.rover_arcs.found(), 4U);
        EXPECT_GT(s.base_arcs.found(), 0U);
    }
}

TEST_F(MadeUp, ClocksThatJumpByMilliseconds) {
    for (const bool code_alone : {false, true}) {
        rover.clock = [](Time t) { return (t - beginning).seconds() < 40.0 ? 9.7e-4 : -3e-5; };
        measure(80.0, 9);
        // the phase counts on through the step of the clock
        if (code_alone)
            each(rover_log, 40.0,
                 [](gnss::SignalObservation& o) { o.phase += 1e-3 * gnss::frequency_of(o.satellite.system, o.signal.band); });
        const Solution s = solved();
        const Errors e = errors(s);
        fmt::print("clock jumps, code alone {}: {}\n", code_alone, text(e));
        EXPECT_EQ(e.wrong, 0U);
        EXPECT_EQ(e.fixed, 81U);
        EXPECT_EQ(s.rover_arcs.found(), 0U);
    }
}

TEST_F(MadeUp, BaseEveryHalfMinute) {
    base.interval = 30.0;
    measure(180.0, 11);
    const Solution half = solved();
    const Errors e = errors(half);
    fmt::print("base of 30 s: {}\n", text(e));
    EXPECT_EQ(e.wrong, 0U);
    EXPECT_LE(e.outside, 1U);
    EXPECT_GT(e.fixed, 150U);
    // stamps between those of the base, and a base that ends early: its last epoch stands for half a minute
    base.interval = 1.0;
    measure(120.0, 12);
    while (base_log.epochs.back().time > beginning + Duration::from_seconds(60)) base_log.epochs.pop_back();
    const Solution s = solved();
    for (const EpochSolution& x : s.epochs) {
        const double t = (x.tag - beginning).seconds();
        EXPECT_EQ(x.quality == Quality::Single, t > 90.5) << t;
    }
    EXPECT_LE(errors(s).outside, 1U);
}

TEST_F(MadeUp, FixedAgainAfterAllWereGone) {
    measure(120.0, 13);
    for (gnss::ObservationEpoch& e : rover_log.epochs) {
        const double t = (e.time - beginning).seconds();
        if (t >= 50.0 && t < 70.0) e.count = 0;
    }
    each(rover_log, 70.0, [](gnss::SignalObservation& o) { o.phase += 12.0 + o.satellite.number; });
    settings.direction = Direction::Forward;
    const Solution s = solved();
    double again = 1e9;
    for (const EpochSolution& x : s.epochs) {
        const double t = (x.tag - beginning).seconds();
        if (t >= 70.0 && x.quality == Quality::Fixed) again = std::min(again, t - 70.0);
    }
    fmt::print("after 20 s: fixed again after {} s; {}\n", again, text(errors(s)));
    EXPECT_LE(again, 2.0);
    EXPECT_EQ(errors(s).wrong, 0U);
}

TEST_F(MadeUp, LongBaselineUnderADisturbedIonosphere) {
    const auto far = [](Time t) {
        const double a = (t - beginning).seconds() / 8.0;
        return test::place_from(place, 20e3 + 40.0 * std::cos(a), 15e3 + 40.0 * std::sin(a), 400.0);
    };
    rover.place = far;
    put_under_air();
    rover.zenith_delay = 0.01;
    for (const std::size_t frequencies : {2U, 1U}) {
        settings.frequencies = frequencies;
        std::size_t outside = 0, epochs = 0, wrong = 0, fixed = 0;
        for (std::uint64_t seed = 20; seed < 26; ++seed) {
            math::Random random(seed, "ionosphere");
            std::map<SatelliteId, double> gradient;
            for (const SatelliteId id : gnss::satellites_of(sky)) gradient[id] = 2e-6 * random.normal();  // of 25 km: 5 cm
            rover.vertical_ionosphere = [gradient](SatelliteId id, double t) {
                return gradient.at(id) * 25e3 * (1.0 + 1e-3 * t);
            };
            measure(120.0, seed);
            const Solution s = solved();
            const Errors e = errors(s);
            outside += e.outside;
            epochs += e.epochs;
            wrong += e.wrong;
            fixed += e.fixed;
        }
        fmt::print("25 km, {} frequencies: {} epochs, {} fixed, {} wrong, {} outside\n", frequencies, epochs, fixed, wrong,
                   outside);
        EXPECT_LE(outside, epochs / 100);
    }
}

/// A storm: the ionosphere differs by 10 to 50 mm a kilometre. The integers are right, and the height is off by twice the difference:
/// two carriers show it.
TEST_F(MadeUp, AStormOfTheIonosphereOverTwoKilometres) {
    rover.place = [](Time t) {
        const double a = (t - beginning).seconds() / 8.0;
        return test::place_from(place, 1600.0 + 40.0 * std::cos(a), 1200.0 + 40.0 * std::sin(a), 20.0);
    };
    put_under_air();
    settings.frequencies = 2;
    for (const double vertical : {0.0, 0.02, 0.05, 0.1}) {
        std::size_t outside = 0, epochs = 0, fixed = 0;
        double largest = 0.0, sigma = 0.0;
        for (std::uint64_t seed = 40; seed < 44; ++seed) {
            rover.vertical_ionosphere = [vertical](SatelliteId, double) { return vertical; };
            measure(120.0, seed);
            const Solution s = solved();
            const Errors e = errors(s);
            outside += e.outside;
            epochs += e.epochs;
            fixed += e.fixed;
            largest = std::max(largest, e.largest);
            sigma = std::max(sigma, std::sqrt(s.epochs.back().covariance.trace()));
        }
        fmt::print("{} mm over 2 km: {} of {} epochs fixed, {} outside, {:.0f} mm at most, sigma {:.0f} mm\n", 1e3 * vertical,
                   fixed, epochs, outside, 1e3 * largest, 1e3 * sigma);
        EXPECT_LE(outside, epochs / 50);
        if (vertical == 0.0) {
            EXPECT_LT(sigma, 0.02);
        }
    }
}

/// For a filter with its own motion: codes and phases less the base's are ranges with the rover's clock alone, whatever the base's does.
TEST_F(MadeUp, RangesRelativeToTheBase) {
    base.clock = [](Time t) { return (t - beginning).seconds() < 30.5 ? -3e-6 : 1e-3 - 3e-6; };  // a step of a millisecond
    rover.code_sigma = base.code_sigma = 0.2;
    settings.ranges = true;
    measure(60.0, 7);
    const Solution s = solved();
    const RangingLog& log = s.ranges;
    ASSERT_EQ(log.epochs.size(), 61U);
    std::map<std::pair<int, int>, double> ambiguity;  // m, of satellite and carrier
    std::map<int, int> arcs;
    double square = 0.0, n = 0.0, offset = not_given;
    for (const RangeEpoch& e : log.epochs) {
        const double clock = rover.clock(e.time);
        const Ecef place = rover.place(e.time - Duration::from_seconds(clock));
        std::map<int, double> apart;  // phase minus exact range, m
        for (const CarrierSample& c : log.carriers_of(e)) {
            const auto samples = log.of(e);
            const auto m = std::ranges::find(samples, c.source, &RangeSample::source);
            ASSERT_NE(m, samples.end());
            TrackedSatellite satellite;
            satellite.position = m->tx;
            const double exact = line_to(satellite, place, earth::geodetic_from_ecef(earth::wgs84, place)).range +
                                 gnss::speed_of_light * (clock - m->tx_clock);
            if (c.carrier == 0) {
                if (std::isnan(offset)) offset = m->pseudorange - exact;
                square += std::pow(m->pseudorange - exact - offset, 2);
                n += 1.0;
            }
            const int key = 4 * c.source + c.carrier;
            apart[key] = c.phase - exact;
            const auto [it, fresh] = ambiguity.try_emplace({c.source, c.carrier}, apart[key]);
            EXPECT_EQ(arcs.try_emplace(key, c.arc).first->second, c.arc) << "the base's clock is no slip";
            EXPECT_NEAR(c.phase - exact, it->second, 0.3 + std::abs(offset)) << "the base's clock shows";
        }
        // within one carrier of a system the ambiguities differ by whole cycles
        for (const CarrierSample& a : log.carriers_of(e)) {
            const CarrierSample& first = *std::ranges::find_if(log.carriers_of(e), [&](const CarrierSample& c) {
                return c.carrier == a.carrier && log.sources[c.source].name[0] == log.sources[a.source].name[0];
            });
            const double cycles = (apart[4 * a.source + a.carrier] - apart[4 * first.source + first.carrier]) / a.wavelength;
            EXPECT_NEAR(cycles, std::round(cycles), 0.3);
        }
    }
    EXPECT_LT(std::sqrt(square / n), 1.5);
}

TEST_F(MadeUp, BasesThatAreNone) {
    const auto message = [&](std::optional<Ecef> position = {}) { return io::test::message_of([&] { (void)solved(position); }); };
    const Ecef right = test::place_from(place, 0, 0, 0);
    measure(30.0, 30);
    io::test::expect_parts(message(test::place_from(place, 60, 80, 0)), {"base.obs", "base.position", "100 m away", "[48.78"});
    const gnss::ObservationLog rover_kept = rover_log, base_kept = base_log;
    base_log = rover_log;
    io::test::expect_parts(message(), {"base.observations", "rover.obs", "those of the rover"});
    base_log = base_kept;
    for (gnss::ObservationEpoch& e : base_log.epochs) e.time = e.time + Duration::from_seconds(604'800.0);
    io::test::expect_parts(message(), {"base.observations", "no time in common", "2024-02-06", "2024-02-13"});
    // none of the satellites in common, none of the carriers
    base.systems = "G";
    rover.systems = "E";
    measure(30.0, 31);
    io::test::expect_parts(message(), {"base.observations", "no carrier phase in common"});
    rover.systems = "GE";
    measure(30.0, 32);
    for (gnss::SignalObservation& o : base_log.observations) o.phase = not_given;
    io::test::expect_parts(message(), {"base.observations", "no carrier phase in common"});
    // exchanged: the base is carried about
    rover.systems = base.systems = "GE";
    rover.place = [](Time t) { return test::place_from(place, 12.0 * (t - beginning).seconds(), 0, 0); };
    measure(60.0, 33);
    std::swap(rover_log, base_log);
    io::test::expect_parts(message(), {"base.observations", "the base moves", "exchanged"});
    // a header without a position: the base's own solution stands for it, and its sigma is in the answer
    std::swap(rover_log, base_log);
    base_log.approximate = {Eigen::Vector3d::Zero()};
    const Errors e = errors(solved());
    EXPECT_GT(e.largest, 0.05);
    EXPECT_LE(e.outside, 1U);
    EXPECT_EQ(warnings.count("base.position.single"), 1U);
    EXPECT_EQ(errors(solved(right)).wrong, 0U);
}

}  // namespace
}  // namespace schuler::ppk
