// Correlators against the integrals they stand for: the peak from the spectrum, the carrier's ramp, the noise's covariance.
#include "schuler/receiver/correlator.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::receiver {
namespace {

using std::numbers::pi;

/// Integral of a smooth function by Simpson's rule.
template <class F>
auto simpson(F f, double from, double to, int halves) {
    const double h = (to - from) / (2.0 * halves);
    auto sum = f(from) + f(to);
    for (int i = 1; i < 2 * halves; ++i) sum += (i % 2 == 1 ? 4.0 : 2.0) * f(from + i * h);
    return sum * (h / 3.0);
}

TEST(CorrelationPeak, IsTheTransformOfTheBandLimitedSpectrum) {
    for (const double band : {1.0, 2.0, 4.0, 20.0}) {  // chip rates, two-sided
        const CorrelationPeak peak(1.023e6, band * 1.023e6);
        for (const double tau : {0.0, 0.013, -0.1, 0.5, 0.77, -1.0, 1.3, 1.97}) {
            const auto spectrum = [&](double f) {
                const double sinc = f == 0.0 ? 1.0 : std::sin(pi * f) / (pi * f);
                return sinc * sinc * std::cos(2.0 * pi * f * tau);
            };
            EXPECT_NEAR(peak(tau), simpson(spectrum, -band / 2.0, band / 2.0, 2000), 2e-7) << band << ' ' << tau;
            const double h = 1e-3;
            EXPECT_NEAR(peak.slope(tau), (peak(tau + h) - peak(tau - h)) / (2.0 * h), 2e-3) << band << ' ' << tau;
        }
    }
    const CorrelationPeak open(1.023e6);
    EXPECT_DOUBLE_EQ(open(0.3), 0.7);
    EXPECT_DOUBLE_EQ(open(-1.2), 0.0);
    EXPECT_NEAR(sine_integral(4.0 - 1e-9), sine_integral(4.0 + 1e-9), 1e-9);
    EXPECT_NEAR(sine_integral(1.0), 0.946083070367183, 1e-14);
    EXPECT_NEAR(sine_integral(10.0), 1.658347594218874, 1e-12);
}

TEST(Correlator, MeanIsTheIntegralOverTheDump) {
    // A code and a carrier that slip during 20 ms: amplitude over noise from the definition of C/N0, one sample a microsecond.
    const SignalStructure gps = gps_l1_ca();
    const CorrelatorModel model(CorrelationPeak(gps.chip_rate), 0.5);
    const LineOfSight truth{21'345'678.9, -431.0, 0.0, 0.0};
    const double cn0 = cn0_from_db(37.0), T = 0.020;
    Replica replica{-truth.range / gps.chip_length() + 0.11, 0.0, -truth.range / gps.wavelength() + 0.2, 0.0};
    replica.carrier_frequency = -truth.rate / gps.wavelength() + 17.0;
    replica.code_rate = -truth.rate / gps.chip_length() + 0.1;
    const Correlators out = model.expected(replica_error(gps, replica, truth, T), cn0, T, -1);
    const auto mean = [&](double offset) {
        return simpson(
            [&](double t) {
                const double tau = 0.11 + offset + 0.1 * t;
                return -(1.0 - std::abs(tau)) * std::polar(std::sqrt(2.0 * cn0 / T), -2.0 * pi * (0.2 + 17.0 * t));
            },
            0.0, T, 500);
    };
    EXPECT_LT(std::abs(out.early - mean(0.25)), 0.01);
    EXPECT_LT(std::abs(out.prompt - mean(0.0)), 0.01);
    EXPECT_LT(std::abs(out.late - mean(-0.25)), 0.01);
    EXPECT_GT(std::abs(out.prompt), 7.0);
    EXPECT_LT(std::abs(out.early), std::abs(out.late)) << "a replica ahead finds the signal in its late correlator";
}

TEST(Correlator, NoiseHasTheFrontEndsCovariance) {
    const double chip_rate = gps_l1_ca().chip_rate;
    for (const double bandwidth : {std::numeric_limits<double>::infinity(), 2.0e6}) {
        const CorrelationPeak peak(chip_rate, bandwidth);
        const CorrelatorModel model(peak, 0.4);
        math::Random random(3, "noise");
        Eigen::Matrix3cd sum = Eigen::Matrix3cd::Zero();
        constexpr int count = 40'000;
        for (int i = 0; i < count; ++i) {
            const Correlators c = model.dump({}, 0.0, 0.001, 1, random);
            const Eigen::Vector3cd v(c.early, c.prompt, c.late);
            sum += v * v.adjoint() / (2.0 * count);
        }
        Eigen::Matrix3d expected;
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) expected(r, c) = peak(0.2 * (r - c));
        EXPECT_LT((sum.real() - expected).cwiseAbs().maxCoeff(), 0.03);
        EXPECT_LT(sum.imag().cwiseAbs().maxCoeff(), 0.03);
    }
}

TEST(Correlator, GlonassByItsParameters) {
    const SignalStructure low = glonass_l1_of(-7), high = glonass_l1_of(6);
    EXPECT_NEAR(high.carrier_frequency - low.carrier_frequency, 13 * 562'500.0, 1e-6);
    EXPECT_NEAR(low.code_period(), 1e-3, 1e-15);
    EXPECT_NEAR(low.chip_length(), 586.67, 0.01);
    EXPECT_NEAR(high.wavelength(), 299'792'458.0 / 1605.375e6, 1e-12);
    EXPECT_THROW((void)glonass_l1_of(7), Error);
}

TEST(Correlator, RefusesWhatCannotBe) {
    EXPECT_THROW(CorrelationPeak(1.023e6, 0.4e6), Error);
    EXPECT_THROW(CorrelationPeak(-1.0), Error);
    const CorrelationPeak peak(1.023e6);
    EXPECT_THROW(CorrelatorModel(peak, 0.0), Error);
    EXPECT_THROW(CorrelatorModel(peak, 2.0), Error);
}

}  // namespace
}  // namespace schuler::receiver
