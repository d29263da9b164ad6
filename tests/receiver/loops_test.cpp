// Loops run on correlator signals, judged by the closed formulas, which no loop uses.
#include "schuler/receiver/loops.h"
#include "schuler/receiver/loop_theory.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

namespace schuler::receiver {
namespace {

using std::numbers::pi;

/// Mean and standard deviation of samples that are a loop's memory apart.
struct Spread {
    double sum = 0.0, square = 0.0;
    int count = 0;
    void add(double x) {
        sum += x;
        square += x * x;
        ++count;
    }
    [[nodiscard]] double mean() const { return sum / count; }
    [[nodiscard]] double std() const { return std::sqrt(square / count - mean() * mean()); }
};

struct Case {
    double bandwidth, db_hz, interval;
};
constexpr int wanted = 2000;  ///< samples, each 1/bandwidth after the other: the estimate itself is good to 2 %

/// A phase loop on a signal with random message bits; the frequency loop is left out.
Spread run_pll(const Case& c, double jerk, int samples, bool noise) {
    const CorrelatorModel model(CorrelationPeak(1.023e6), 1.0);
    math::Random random(11, "pll");
    CarrierLoop loop(c.bandwidth, 0.0, c.interval);
    const double cn0 = cn0_from_db(c.db_hz);
    double phase = 0.0, command = 0.0, f = 0.0, rate = 0.0;  // cycles of replica minus signal; signal's frequency
    const int every = static_cast<int>(std::ceil(1.0 / (c.bandwidth * c.interval)));
    Spread out;
    for (int i = 0; out.count < samples; ++i) {
        const double df = command - (f + rate * c.interval / 2.0);
        const double middle = phase + (command - f - rate * c.interval / 4.0) * c.interval / 2.0;
        const ReplicaError error{0.0, 2.0 * pi * middle, df};
        const Correlators d = noise ? model.dump(error, cn0, c.interval, random.bits() % 2 == 0 ? 1 : -1, random)
                                    : model.expected(error, cn0, c.interval, 1);
        phase += df * c.interval;
        f += rate * c.interval;
        rate += jerk * c.interval;
        command = loop.update(costas_phase(d.prompt) / (2.0 * pi), 0.0);
        if (i > 60 * every && i % every == 0) out.add(middle);
    }
    return out;
}

TEST(Loops, PhaseJitterOverNoiseAndBandwidth) {
    for (const Case& c : {Case{10.0, 45.0, 0.001}, Case{18.0, 35.0, 0.001}, Case{5.0, 30.0, 0.005}, Case{2.0, 26.0, 0.010},
                          Case{1.0, 23.0, 0.020}}) {
        const double expected = theory::pll_jitter(c.bandwidth, cn0_from_db(c.db_hz), c.interval);
        EXPECT_NEAR(2.0 * pi * run_pll(c, 0.0, wanted, true).std() / expected, 1.0, 0.1) << c.bandwidth << ' ' << c.db_hz;
    }
}

TEST(Loops, PhaseErrorUnderJerk) {
    // 1 g/s is 51.5 cycles/s^3
    const Case c{15.0, 45.0, 0.001};
    const Spread s = run_pll(c, 51.5, 20, false);
    EXPECT_NEAR(s.mean() / theory::pll_stress(c.bandwidth, 51.5), 1.0, 0.02);
    EXPECT_LT(s.std(), 2e-3 * std::abs(s.mean()));
}

/// A frequency loop with prompts in pairs.
Spread run_fll(const Case& c, double second_derivative, int samples, bool noise) {
    const CorrelatorModel model(CorrelationPeak(1.023e6), 1.0);
    math::Random random(12, "fll");
    const double update = 2.0 * c.interval;
    CarrierLoop loop(0.0, c.bandwidth, update);
    const double cn0 = cn0_from_db(c.db_hz);
    double command = 0.0, f = 0.0, rate = 0.0, phase = 0.0;
    const int every = static_cast<int>(std::ceil(1.0 / (c.bandwidth * update)));
    Spread out;
    std::array<std::complex<double>, 2> pair;
    for (int i = 0; out.count < samples; ++i) {
        double mean = 0.0;
        for (std::complex<double>& prompt : pair) {
            const double df = command - (f + rate * c.interval / 2.0);
            const ReplicaError error{0.0, 2.0 * pi * (phase + df * c.interval / 2.0), df};
            prompt = (noise ? model.dump(error, cn0, c.interval, 1, random) : model.expected(error, cn0, c.interval, 1)).prompt;
            mean += df / 2.0;
            phase += df * c.interval;
            f += rate * c.interval;
            rate += second_derivative * c.interval;
        }
        command = loop.update(0.0, frequency_between(pair[0], pair[1], c.interval));
        if (i > 60 * every && i % every == 0) out.add(mean);
    }
    return out;
}

TEST(Loops, FrequencyJitterOverNoiseAndBandwidth) {
    for (const Case& c : {Case{5.0, 45.0, 0.001}, Case{2.0, 38.0, 0.002}, Case{2.0, 35.0, 0.005}, Case{0.5, 32.0, 0.010}}) {
        const double expected = theory::fll_jitter(c.bandwidth, cn0_from_db(c.db_hz), c.interval);
        EXPECT_NEAR(run_fll(c, 0.0, wanted, true).std() / expected, 1.0, 0.1) << c.bandwidth << ' ' << c.db_hz;
    }
}

TEST(Loops, FrequencyErrorUnderJerk) {
    const Case c{5.0, 45.0, 0.001};
    EXPECT_NEAR(run_fll(c, 51.5, 20, false).mean() / theory::fll_stress(c.bandwidth, 51.5), 1.0, 0.03);
}

/// A code loop alone, the carrier taken as followed.
Spread run_dll(const Case& c, const CorrelatorModel& model, CodeDiscriminator kind, double acceleration, int samples,
               bool noise) {
    math::Random random(13, "dll");
    CodeLoop loop(c.bandwidth, c.interval);
    const CodeError discriminate(model.peak(), model.spacing(), kind);
    const double cn0 = cn0_from_db(c.db_hz);
    double code = 0.0, command = 0.0, rate = 0.0;
    const int every = static_cast<int>(std::ceil(1.0 / (c.bandwidth * c.interval)));
    Spread out;
    for (int i = 0; out.count < samples; ++i) {
        const double slip = command - (rate + acceleration * c.interval / 2.0);
        const ReplicaError error{code + slip * c.interval / 2.0, 0.3, 0.0};
        const Correlators d = noise ? model.dump(error, cn0, c.interval, 1, random) : model.expected(error, cn0, c.interval, 1);
        code += slip * c.interval;
        rate += acceleration * c.interval;
        command = loop.update(discriminate(d, 2.0 * cn0 * c.interval));
        if (i > 60 * every && i % every == 0) out.add(code);
    }
    return out;
}

TEST(Loops, CodeJitterOverNoiseBandwidthSpacingAndFrontEnd) {
    const auto early_late = CodeDiscriminator::EarlyLatePower, dot = CodeDiscriminator::DotProduct;
    const CorrelationPeak open(1.023e6), narrow(1.023e6, 4e6);
    struct CodeCase {
        Case loop;
        CorrelationPeak peak;
        double spacing;
        CodeDiscriminator kind;
    };
    for (const CodeCase& k :
         {CodeCase{{1.0, 40.0, 0.020}, open, 1.0, early_late}, CodeCase{{2.0, 35.0, 0.010}, open, 1.0, dot},
          CodeCase{{0.5, 26.0, 0.020}, open, 1.0, early_late}, CodeCase{{0.5, 23.0, 0.020}, open, 0.5, dot},
          CodeCase{{1.0, 40.0, 0.010}, narrow, 0.3, early_late}, CodeCase{{1.0, 32.0, 0.010}, narrow, 0.5, dot},
          CodeCase{{1.0, 45.0, 0.005}, CorrelationPeak(0.511e6), 0.5, early_late}}) {
        const Case& c = k.loop;
        const double expected = theory::dll_jitter(c.bandwidth, cn0_from_db(c.db_hz), c.interval, k.peak, k.spacing, k.kind);
        const Spread s = run_dll(c, CorrelatorModel(k.peak, k.spacing), k.kind, 0.0, wanted, true);
        EXPECT_NEAR(s.std() / expected, 1.0, 0.1) << c.bandwidth << ' ' << c.db_hz << ' ' << k.spacing;
        EXPECT_LT(std::abs(s.mean()), 4.0 * s.std() / std::sqrt(wanted));
    }
}

TEST(Loops, CodeErrorUnderAcceleration) {
    const Case c{1.0, 45.0, 0.005};
    const CorrelatorModel model(CorrelationPeak(1.023e6), 1.0);
    const double acceleration = 20.0 / gps_l1_ca().chip_length();
    const Spread s = run_dll(c, model, CodeDiscriminator::DotProduct, acceleration, 20, false);
    EXPECT_NEAR(s.mean() / theory::dll_stress(c.bandwidth, acceleration), 1.0, 0.02);
}

TEST(Loops, NoiseBandwidthOfTheStandardForms) {
    // One-sided noise bandwidth from the closed loop's response, integrated numerically: H(s) of each standard form.
    const auto bandwidth = [](auto response) {
        double sum = 0.0;
        const double df = 0.005;
        for (double f = df / 2.0; f < 4000.0; f += df) sum += std::norm(response(std::complex<double>(0.0, 2.0 * pi * f))) * df;
        return sum;
    };
    const double w2 = loop::second_order(3.0), w3 = loop::third_order(3.0);
    EXPECT_NEAR(bandwidth([&](auto s) { return (loop::a2 * w2 * s + w2 * w2) / (s * s + loop::a2 * w2 * s + w2 * w2); }), 3.0,
                0.01);
    EXPECT_NEAR(bandwidth([&](auto s) {
                    const auto n = loop::b3 * w3 * s * s + loop::a3 * w3 * w3 * s + w3 * w3 * w3;
                    return n / (s * s * s + n);
                }),
                3.0, 0.01);
}

TEST(Loops, RefusesWhatWouldNotHold) {
    EXPECT_THROW(CarrierLoop(0.0, 0.0, 0.001), Error);
    EXPECT_THROW(CarrierLoop(-1.0, 5.0, 0.001), Error);
    EXPECT_THROW(CarrierLoop(18.0, 0.0, 0.020), Error);
    EXPECT_THROW(CodeLoop(0.0, 0.020), Error);
    EXPECT_THROW(CodeLoop(1.0, 0.0), Error);
}

}  // namespace
}  // namespace schuler::receiver
