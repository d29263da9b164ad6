// Samples: codes against the interface document, correlators against their model, a generated file searched and tracked.
#include "schuler/receiver/if_samples.h"

#include "schuler/core/error.h"
#include "schuler/io/atomic_file.h"
#include "schuler/io/receiver/if_file.h"
#include "schuler/receiver/tracker.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

namespace schuler::receiver {
namespace {

TEST(CaCode, FirstTenChipsAsPublished) {
    // octal, PRN 1 to 32 [ISGPS200:table 3-Ia]
    constexpr std::array published{01440, 01620, 01710, 01744, 01133, 01455, 01131, 01454, 01626, 01504, 01642,
                                   01750, 01764, 01772, 01775, 01776, 01156, 01467, 01633, 01715, 01746, 01763,
                                   01063, 01706, 01743, 01761, 01770, 01774, 01127, 01453, 01625, 01712};
    for (int prn = 1; prn <= 32; ++prn) {
        const CaCode code = ca_code(prn);
        int first = 0, balance = 0;
        for (std::size_t i = 0; i < 10; ++i) first = 2 * first + (code[i] < 0 ? 1 : 0);
        for (const int chip : code) balance += chip;
        EXPECT_EQ(first, published[static_cast<std::size_t>(prn - 1)]) << prn;
        EXPECT_EQ(balance, -1) << "one more 1 than 0";
        // a Gold code: three values away from the peak
        for (std::size_t shift = 1; shift < 1023; shift += 7) {
            int sum = 0;
            for (std::size_t i = 0; i < 1023; ++i) sum += code[i] * code[(i + shift) % 1023];
            EXPECT_TRUE(sum == -1 || sum == 63 || sum == -65) << prn << ' ' << shift;
        }
    }
    EXPECT_THROW((void)ca_code(33), Error);
    EXPECT_THROW((void)ca_code(0), Error);
}

TEST(IfSamples, CorrelatorsAreWhatTheModelSays) {
    // Mean and spread of 400 dumps of samples, at an offset in code and frequency, against the correlator model.
    const IfFormat format{5e6, 0.3e6};  // no whole number of samples a chip: every place within a chip is met
    const double cn0 = cn0_from_db(50.0);
    const IfSatellite satellite{7, {2.0e4 * 299.792458, 250.0, 0.0, 0.0}, cn0, 5};
    IfGenerator generator(format, {&satellite, 1}, 3);
    const SignalStructure signal = gps_l1_ca();
    SampleCorrelator correlator(format, 7, 0.5);
    const CorrelatorModel model(CorrelationPeak(signal.chip_rate), 0.5);
    std::vector<IfSample> samples(format.samples_per_period());
    std::array<std::complex<double>, 3> mean{};
    double variance = 0.0, product = 0.0;
    constexpr int dumps = 400;
    const ReplicaError error{0.13, 0.4, 130.0};
    const Correlators expected = model.expected(error, cn0, 1e-3, 1);
    for (int i = 0; i < dumps; ++i) {
        generator.generate(samples);
        const double begin = i * 1e-3;
        const LineOfSight now = satellite.motion.after(begin);
        Replica replica{-now.range / signal.chip_length() + error.code, -now.rate / signal.chip_length(),
                        -now.range / signal.wavelength() + (error.phase / (2.0 * std::numbers::pi) - error.frequency * 0.5e-3),
                        -now.rate / signal.wavelength() + error.frequency};
        Correlators c = correlator.correlate(samples, begin, replica, noise_of(samples));
        if ((c.prompt * std::conj(expected.prompt)).real() < 0.0) c = {-c.early, -c.prompt, -c.late};
        mean[0] += c.early / static_cast<double>(dumps);
        mean[1] += c.prompt / static_cast<double>(dumps);
        mean[2] += c.late / static_cast<double>(dumps);
        const auto d = c.prompt - expected.prompt, e = c.early - expected.early;
        variance += std::norm(d) / (2.0 * dumps);
        product += (d * std::conj(e)).real() / (2.0 * dumps);
    }
    EXPECT_LT(std::abs(mean[0] - expected.early), 0.4);
    EXPECT_LT(std::abs(mean[1] - expected.prompt), 0.4);
    EXPECT_LT(std::abs(mean[2] - expected.late), 0.4);
    EXPECT_GT(std::abs(expected.prompt), 10.0);
    EXPECT_NEAR(variance, 1.0, 0.15);
    EXPECT_NEAR(product / variance, 0.75, 0.05);
}

TEST(IfSamples, AGeneratedFileIsSearchedAndTrackedSlow) {
    const IfFormat format{4e6, 0.0};
    const double seconds = 3.5;
    const std::vector<IfSatellite> sky{{3, {2.134e7, -520.0, 4.0, 0.0}, cn0_from_db(44.0), 1},
                                       {22, {2.31e7, 310.0, 0.0, 0.0}, cn0_from_db(47.0), 2}};
    const test::TemporaryFolder folder("if_track");
    const auto path = folder.path() / "two.ibyte";
    const std::size_t n = format.samples_per_period();
    const int periods = static_cast<int>(seconds * 1e3);
    {
        IfGenerator generator(format, sky, 9);
        std::vector<IfSample> all(n * static_cast<std::size_t>(periods));
        for (int i = 0; i < periods; ++i) generator.generate(std::span(all).subspan(static_cast<std::size_t>(i) * n, n));
        io::write_file(path, {reinterpret_cast<const char*>(all.data()), 2 * all.size()});
    }
    const FftAcquisition acquisition(format, 5000.0, 8);
    std::vector<IfSample> first(acquisition.samples_needed());
    ASSERT_TRUE(io::IfFile(path).read(first));
    EXPECT_FALSE(acquisition.acquire(first, 11).found);
    for (const IfSatellite& satellite : sky) {
        const Acquired acquired = acquisition.acquire(first, satellite.prn);
        ASSERT_TRUE(acquired.found) << satellite.prn;
        const SignalStructure signal = gps_l1_ca();
        EXPECT_NEAR(acquired.replica.carrier_frequency, -satellite.motion.rate / signal.wavelength(), 300.0);
        TrackingSettings settings;
        SampleCorrelator correlator(format, satellite.prn, settings.spacing);
        Tracker tracker(signal, CorrelationPeak(signal.chip_rate), settings);
        tracker.start(acquired.replica);
        io::IfFile file(path);
        ASSERT_EQ(file.size(), n * static_cast<std::size_t>(periods));
        std::vector<IfSample> samples(n);
        for (int i = 0; file.read(samples); ++i)
            tracker.step(correlator.correlate(samples, i * 1e-3, tracker.replica(), noise_of(samples)));
        EXPECT_TRUE(tracker.phase_locked()) << satellite.prn;
        const LineOfSight end = satellite.motion.after(seconds);
        const double code = tracker.replica().code_phase + end.range / signal.chip_length();
        EXPECT_NEAR(std::remainder(code, 1023.0) * signal.chip_length(), 0.0, 12.0);
        EXPECT_NEAR(tracker.replica().carrier_frequency, -end.rate / signal.wavelength(), 5.0);
        EXPECT_NEAR(db_from_cn0(tracker.cn0()), db_from_cn0(satellite.cn0), 1.5);
    }
}

TEST(IfSamples, RefusesFilesAndRatesThatCannotBe) {
    const auto refused = [](double rate, double frequency) { EXPECT_THROW((IfFormat{rate, frequency}.check()), Error) << rate; };
    refused(0.0, 0.0);
    refused(-4e6, 0.0);
    refused(1e3, 0.0);
    refused(1e12, 0.0);
    refused(4e6, 1.5e6);
    refused(std::nan(""), 0.0);
    const test::TemporaryFolder folder("if_bad");
    const auto put = [&](const char* name, const char* bytes) {
        std::ofstream(folder.path() / name, std::ios::binary) << bytes;
        return folder.path() / name;
    };
    EXPECT_THROW(io::IfFile(folder.path() / "none"), Error);
    EXPECT_THROW(io::IfFile(put("empty", "")), Error);
    EXPECT_THROW(io::IfFile(put("odd", "abc")), Error);
    EXPECT_THROW(io::IfFile(put("even", "abcd"), "float"), Error);
    EXPECT_EQ(io::IfFile(put("even", "abcd")).size(), 2U);
    std::vector<IfSample> few(10);
    EXPECT_THROW((void)FftAcquisition({}).acquire(few, 1), Error);
    EXPECT_THROW(IfGenerator({}, {}, 1, 100.0), Error);
    EXPECT_THROW(IfGenerator({4e6 + 0.5, 0.0}, {}, 1), Error) << "no whole number of samples a period";
}

}  // namespace
}  // namespace schuler::receiver
