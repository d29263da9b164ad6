// What the loops are said to be wrong by: against the closed formulas, against loops run on noise, and in every phase of a signal's life.
#include "schuler/receiver/loop_error.h"

#include "schuler/receiver/bank.h"
#include "schuler/receiver/loop_theory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <string>

namespace schuler::receiver {
namespace {

using std::numbers::pi;

TEST(LoopError, DetectorIsThatOfNoisyPrompts) {
    const CorrelatorModel model(CorrelationPeak(1.023e6), 0.5);
    for (const double snr : {0.2, 1.0, 3.0, 20.0}) {
        math::Random random(1, "detector");
        constexpr double off = 0.1;  // rad
        double sum = 0.0, square = 0.0;
        constexpr int n = 100'000;
        for (int i = 0; i < n; ++i) {
            const double output = costas_phase(model.dump({0.0, off, 0.0}, snr / 0.01, 0.01, i % 2 == 0 ? 1 : -1, random).prompt);
            sum += output / n;
            square += output * output / n;
        }
        const DiscriminatorResponse detector = phase_detector(snr);
        const double variance = (square - sum * sum) / (4.0 * pi * pi);
        EXPECT_NEAR(sum / off, detector.slope, 4.0 * std::sqrt(square / n) / off) << snr;
        EXPECT_GT(detector.variance / variance, 0.94) << snr;
        EXPECT_LT(detector.variance / variance, 1.26) << snr;
    }
}

/// In the steady state the covariance is that of the closed formulas, which are of other origin.
TEST(LoopError, SteadyStateIsThermalJitter) {
    const CorrelationPeak peak(1.023e6);
    const CodeError code_error(peak, 0.5, CodeDiscriminator::EarlyLatePower);
    for (const auto& [bandwidth, integration] : {std::pair{5.0, 1}, std::pair{3.0, 20}, std::pair{15.0, 10}}) {
        const double T = 1e-3 * integration, cn0 = cn0_from_db(40.0);
        const LoopModel model(LoopModel::Carrier::Phase, CarrierLoop(bandwidth, 0.0, T), CodeLoop(0.5, T), T,
                              gps_l1_ca().chips_per_cycle());
        LoopError error;
        error.start({});
        error.close_phase();
        DiscriminatorNoise noise;
        noise.carrier_variance = phase_detector(cn0 * T).variance;
        noise.code_variance = code_error.variance(2.0 * cn0 * T);
        for (double t = 0.0; t < 30.0; t += T) error.update(model, noise);
        const double command = theory::pll_command_jitter(theory::pll_response(bandwidth, integration, 1e-3), cn0, T);
        EXPECT_NEAR(std::sqrt(error.frequency_variance()) / command, 1.0, 0.01) << bandwidth;
        const double jitter = theory::pll_jitter(bandwidth, cn0, T) / (2.0 * pi);
        const double excess = std::sqrt(error.phase_variance()) / jitter - 1.0;  // of the sampled loop over the continuous one
        EXPECT_GT(excess, -0.01) << bandwidth;
        EXPECT_LT(excess, 3.0 * bandwidth * T) << bandwidth;
        const double code = theory::dll_jitter(0.5, cn0, T, peak, 0.5, CodeDiscriminator::EarlyLatePower);
        EXPECT_NEAR(std::sqrt(error.code_variance()) / code, 1.0, 0.05) << bandwidth;
    }
}

/// A signal that breaks off is noticed in its first prompt, and one that goes on is not lowered for its scatter.
TEST(FadingCn0, NoticesWhatAnAverageHides) {
    const CorrelatorModel model(CorrelationPeak(1.023e6), 0.5);
    math::Random random(2, "fading");
    for (const double db : {45.0, 35.0, 27.0}) {
        Cn0Estimator average(0.01, 0.5, 1.0, cn0_from_db(db));
        FadingCn0 fading(0.01, 1.0 / 30.0, 1.0, cn0_from_db(db));
        double ratio = 0.0;
        for (int i = 0; i < 2000; ++i) {
            const std::complex<double> prompt = model.dump({}, cn0_from_db(db), 0.01, 1, random).prompt;
            average.add(prompt);
            fading.add(prompt);
            ratio += fading.recent(average.cn0()) / average.cn0() / 2000.0;
        }
        EXPECT_GT(ratio, 0.93) << db;
        for (int i = 0; i < 10; ++i) {
            const std::complex<double> prompt = model.dump({}, 0.0, 0.01, 1, random).prompt;
            average.add(prompt);
            fading.add(prompt);
            if (i == 0 && db > 30.0) {
                EXPECT_LT(db_from_cn0(fading.recent(average.cn0())), 31.0) << db;
            }
        }
        EXPECT_GT(db_from_cn0(average.cn0()), db - 1.5);
        EXPECT_LT(db_from_cn0(fading.recent(average.cn0())), 24.0) << db;
    }
}

/// Satellites in all directions of a vehicle that accelerates, their strength as a function of time.
class Flight final : public SignalField {
public:
    Flight(std::function<double(double)> db_of, const std::function<double(double)>& acceleration, double duration)
        : db_(std::move(db_of)) {
        LineOfSight s;
        for (long k = 0; static_cast<double>(k) * Bank::period <= duration; ++k) {
            const double t = static_cast<double>(k) * Bank::period;
            s.acceleration = acceleration(t);
            s.jerk = (acceleration(t + Bank::period) - s.acceleration) / Bank::period;
            path_.push_back(s);
            s = s.after(Bank::period);
        }
    }
    [[nodiscard]] std::size_t size() const override { return 6; }
    [[nodiscard]] SignalStructure structure(std::size_t) const override { return gps_l1_ca(); }
    [[nodiscard]] LineOfSight motion(std::size_t i, double t) const override {
        const double k = static_cast<double>(i), along = std::cos(1.0 + 0.9 * k);
        const auto row = std::min(static_cast<std::size_t>(std::max(0.0, t / Bank::period + 1e-6)), path_.size() - 1);
        const LineOfSight s = path_[row].after(t - static_cast<double>(row) * Bank::period);
        LineOfSight out = LineOfSight{2.1e7 + 1e5 * k, -300.0 + 100.0 * k, 0.1, 0.0}.after(t);
        out.range += along * s.range;
        out.rate += along * s.rate;
        out.acceleration += along * s.acceleration;
        out.jerk += along * s.jerk;
        return out;
    }
    [[nodiscard]] double cn0(std::size_t, double t) const override {
        const double db = db_(t);
        return db > 0.0 ? cn0_from_db(db) : 0.0;
    }
    [[nodiscard]] bool in_view(std::size_t, double) const override { return true; }

private:
    std::function<double(double)> db_;
    std::vector<LineOfSight> path_;
};

/// Mean squares of errors over their variances.
struct Squares {
    double range = 0.0, ranges = 0.0, rate = 0.0, rates = 0.0;
    [[nodiscard]] double of_ranges() const { return range / ranges; }
    [[nodiscard]] double of_rates() const { return rate / rates; }
};

struct Episode {
    std::string name;
    std::function<double(double)> db;
    std::function<double(double)> acceleration = [](double) { return 0.0; };
    double from = 0.0, to = 0.0;  ///< s, counted
};

/// Every value by itself: read at longer intervals than the loops' memory, neighbouring values would be independent.
Squares squares_of(const Episode& e, Guidance guidance, int seeds) {
    constexpr double apart = 100.0;  // s
    const Flight flight(e.db, e.acceleration, e.to + 1.0);
    Squares out;
    for (int seed = 1; seed <= seeds; ++seed) {
        BankSettings settings;
        settings.guidance = guidance;
        settings.oscillator = {0.0, 0.0, 1e-23, 1e-7, Eigen::Vector3d::Zero()};
        Bank bank(flight, settings, static_cast<std::uint64_t>(seed));
        math::Random random(static_cast<std::uint64_t>(seed), "guide");
        std::vector<Prediction> predictions(flight.size());
        std::vector<double> off(flight.size());
        for (double& x : off) x = 0.05 * random.normal();  // m/s, of a navigation
        std::vector<BankMeasurement> measured;
        double before = 0.0, drift = 0.0;
        for (long k = 0; static_cast<double>(k) * Bank::period < e.to; ++k) {
            if (k % 10 == 0 && guidance == Guidance::Loops) {
                for (std::size_t i = 0; i < flight.size(); ++i) {
                    off[i] += 0.05 * std::sqrt(2.0 * 0.01 / 20.0) * random.normal() - off[i] * 0.01 / 20.0;
                    predictions[i] = {flight.motion(i, bank.now()), 5.0, 0.06, drift};
                    predictions[i].motion.range += bank.clock();
                    predictions[i].motion.rate += drift + off[i];
                }
                bank.guide(predictions, bank.now());
            }
            bank.step(Eigen::Vector3d::Zero());
            drift = (bank.clock() - before) / Bank::period;
            before = bank.clock();
            if (k % 100 != 99 || bank.now() < e.from) continue;
            bank.measure(measured, apart);
            for (const BankMeasurement& m : measured) {
                const LineOfSight truth = flight.motion(m.signal, bank.now() - bank.clock() / gnss::speed_of_light);
                out.range += std::pow(m.range - truth.range - bank.clock(), 2) / m.range_variance;
                out.ranges += 1.0;
                if (!std::isfinite(m.rate_variance)) continue;
                out.rate += std::pow(m.rate - truth.rate - drift, 2) / m.rate_variance;
                out.rates += 1.0;
            }
        }
    }
    return out;
}

std::function<double(double)> steady(double db) {
    return [db](double) { return db; };
}

/// 45 dB-Hz until `at`, and then something else.
std::function<double(double)> until(double at, std::function<double(double)> then) {
    return [=](double t) { return t < at ? 45.0 : then(t - at); };
}

/// A turn: the acceleration changes within a quarter of a second.
std::function<double(double)> turn_of(double g, double from, double to) {
    return [=](double t) {
        const auto ramp = [](double x) { return std::clamp(x / 0.25, 0.0, 1.0); };
        return 9.81 * g * (ramp(t - from) - ramp(t - to));
    };
}

const std::array<Episode, 8>& episodes() {
    static const auto none = [](double) { return 0.0; };
    static const std::array<Episode, 8> all{{
        {"acquisition at 45 dB-Hz", steady(45.0), none, 0.0, 6.0},
        {"acquisition at 33 dB-Hz", steady(33.0), none, 0.0, 6.0},
        {"fading by 10 dB a second", until(6.0, [](double t) { return std::max(15.0, 45.0 - 10.0 * t); }), none, 5.0, 11.0},
        {"a signal that breaks off", until(6.03, [](double) { return 0.0; }), none, 5.5, 9.0},
        {"lost for a third of a second", until(6.03, [](double t) { return t < 0.33 ? 0.0 : 45.0; }), none, 6.0, 9.0},
        {"a jammer for five seconds", until(6.0, [](double t) { return t < 5.0 ? 20.0 : 40.0; }), none, 5.5, 16.0},
        {"28 dB-Hz", until(6.0, [](double) { return 28.0; }), none, 6.0, 12.0},
        {"a turn of 5 g", steady(40.0), turn_of(5.0, 6.07, 8.07), 5.5, 10.0},
    }};
    return all;
}

TEST(Bank, ErrorsAreAsStatedWhateverHappensToTheSignal) {
    for (const Guidance guidance : {Guidance::None, Guidance::Loops}) {
        for (const Episode& e : episodes()) {
            const Squares s = squares_of(e, guidance, 4);
            const std::string which = e.name + (guidance == Guidance::None ? ", alone" : ", aided");
            ASSERT_GT(s.ranges, 100.0) << which;
            EXPECT_LT(s.of_ranges(), 1.6) << which;
            EXPECT_GT(s.of_ranges(), 0.4) << which;
            if (s.rates < 100.0) continue;
            EXPECT_LT(s.of_rates(), 1.6) << which;
            EXPECT_GT(s.of_rates(), 0.4) << which;
        }
    }
}

}  // namespace
}  // namespace schuler::receiver
