// The receiver of samples, on samples made here: at a rate of no whole number of samples a code period, with known symbols.
#include "schuler/receiver/sample_receiver.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::receiver {
namespace {

constexpr double rate = 4.0034e6;  // 4003.4 samples a period; 4003 is prime
constexpr double noise_std = 20.0;
constexpr int prn = 14;

/// A code delayed by `delay` chips at first, with a Doppler that moves it; symbol k has the sign of bit k.
struct Signal {
    double delay, doppler, cn0;
    CaCode code = ca_code(prn);

    [[nodiscard]] static int symbol(long k) { return (k * k + 3 * k) % 7 < 3 ? 1 : -1; }
    [[nodiscard]] double chips(double t) const { return (1.023e6 + doppler * 1.023e6 / 1575.42e6) * t - delay; }
    [[nodiscard]] std::complex<double> at(double t) const {
        const double c = chips(t), periods = std::floor(c / 1023.0);
        const int sign = symbol(static_cast<long>(std::floor(periods / 20.0)));
        const double amplitude =
            noise_std * std::sqrt(2.0 * cn0 / rate) * sign * code[static_cast<std::size_t>(c - 1023.0 * periods)];
        return std::polar(1.0, 2.0 * std::numbers::pi * std::fmod(doppler * t, 1.0)) * amplitude;
    }
};

TEST(SampleReceiver, DumpsFollowTheCodesBoundary) {
    // Half a period off the milliseconds, and moving by 65 chips.
    const Signal signal{511.0, 30e3, cn0_from_db(50.0)};
    SampleReceiverSettings settings;
    settings.satellites = {prn, 20};
    settings.doppler = 30.5e3;
    SampleReceiver receiver({rate, 0.0}, settings);
    math::Random random(3, "samples");
    std::vector<IfSample> samples(receiver.piece());
    std::vector<ChannelSample> rows;
    std::size_t n = 0;
    while (static_cast<double>(n) / rate < 3.6) {
        for (IfSample& s : samples) {
            const std::complex<double> x = signal.at(static_cast<double>(n++) / rate);
            s = {static_cast<std::int8_t>(std::lround(x.real() + noise_std * random.normal())),
                 static_cast<std::int8_t>(std::lround(x.imag() + noise_std * random.normal()))};
        }
        receiver.process(samples, [&](const ChannelSample& row) { rows.push_back(row); });
    }
    const SatelliteRecord& r = receiver.satellites().front();
    EXPECT_FALSE(receiver.satellites().back().found);
    ASSERT_TRUE(r.found && r.locked);
    EXPECT_NEAR(r.last.doppler, signal.doppler, 0.05);
    EXPECT_NEAR(std::remainder(r.last.code_delay + signal.chips(r.last.time) - 1.023e6 * r.last.time, 1023.0), 0.0, 0.02);
    EXPECT_NEAR(db_from_cn0(r.last.cn0), 50.0, 0.3);
    EXPECT_EQ(r.edge_changes, r.dump_changes);
    EXPECT_NEAR(static_cast<double>(r.changes), static_cast<double>(r.edge_changes), 1.0) << "the first symbol has no neighbour";

    // Symbols, their ends to a sample, and full sums also where the sign has changed.
    int polarity = 0, wrong = 0;
    double changed = 0.0, same = 0.0, n_changed = 0.0, n_same = 0.0, doppler = 0.0;
    for (const ChannelSample& row : rows) {
        if (!row.locked || row.time < r.locked_at + 0.1) continue;
        doppler += row.doppler;
        const double end = signal.chips(row.time) / 20460.0;
        EXPECT_NEAR(end, std::round(end), 1.5 / 4003.0 / 20.0);
        const long k = std::lround(end) - 1;
        const int sign = (row.prompt.real() > 0.0 ? 1 : -1) * Signal::symbol(k);
        if (polarity == 0) polarity = sign;
        wrong += sign != polarity;
        if (Signal::symbol(k) == Signal::symbol(k - 1)) {
            same += std::abs(row.prompt);
            n_same += 1.0;
        } else {
            changed += std::abs(row.prompt);
            n_changed += 1.0;
        }
    }
    EXPECT_GT(n_same + n_changed, 40.0);
    EXPECT_EQ(wrong, 0);
    EXPECT_NEAR(doppler / (n_same + n_changed), signal.doppler, 0.2) << "no loop works against the moved boundary";
    EXPECT_NEAR(same / n_same, std::sqrt(2.0 * r.last.cn0 * 0.02), 0.5) << "no power is lost over a symbol";
    EXPECT_NEAR(changed / n_changed, same / n_same, 0.01 * same / n_same);
}

TEST(SampleReceiver, SearchesAgainAndNoticesALoss) {
    // One satellite sets at 3.2 s as another one rises, which the next search finds. Pieces do not begin with milliseconds.
    const IfFormat format{2.5e6, 0.0};
    SampleReceiverSettings settings;
    settings.satellites = {5, 9};
    settings.search_interval = 1.5;
    SampleReceiver receiver(format, settings);
    const IfSatellite both[] = {{5, {2.1e7, 100.0, 0.0, 0.0}, cn0_from_db(47.0), 1},
                                {9, {2.2e7, -300.0, 0.0, 0.0}, cn0_from_db(46.0), 2}};
    IfGenerator first(format, std::span(both, 1), 1), second(format, std::span(both + 1, 1), 2);
    std::vector<IfSample> stream, made(format.samples_per_period());
    const std::size_t piece = receiver.piece() + 333;
    for (int ms = 0; ms < 13'000; ++ms) {
        (ms < 3200 ? first : second).generate(made);  // the second one's time begins with it
        stream.insert(stream.end(), made.begin(), made.end());
        if (stream.size() >= piece) {
            receiver.process(std::span(stream).first(piece), nullptr);
            stream.erase(stream.begin(), stream.begin() + static_cast<std::ptrdiff_t>(piece));
        }
        if (ms == 3000) {
            EXPECT_TRUE(receiver.satellites()[0].locked);
        }
    }
    const SatelliteRecord &set = receiver.satellites()[0], &risen = receiver.satellites()[1];
    EXPECT_EQ(set.losses, 1);
    EXPECT_FALSE(set.tracked);
    EXPECT_TRUE(risen.locked);
    EXPECT_NEAR(risen.found_at, 4.53, 0.03) << "searches begin with pieces of 10 ms and a little";
    EXPECT_GT(risen.locked_at, 5.5);
    const LineOfSight motion = both[1].motion.after(risen.last.time - 3.2);
    EXPECT_NEAR(std::remainder(risen.last.code_delay - motion.range / gps_l1_ca().chip_length(), 1023.0), 0.0, 0.05);
}

TEST(SampleReceiver, RefusesSettingsThatCannotBe) {
    const auto refused = [](auto change) {
        SampleReceiverSettings settings;
        change(settings);
        EXPECT_THROW(SampleReceiver({}, settings), Error);
    };
    refused([](SampleReceiverSettings& s) { s.satellites = {33}; });
    refused([](SampleReceiverSettings& s) { s.satellites = {4, 5, 4}; });
    refused([](SampleReceiverSettings& s) { s.search_interval = 0.0; });
    refused([](SampleReceiverSettings& s) { s.search_periods = 0; });
    refused([](SampleReceiverSettings& s) { s.doppler = -1.0; });
    refused([](SampleReceiverSettings& s) { s.tracking.pll_bandwidth = std::nan(""); });
}

}  // namespace
}  // namespace schuler::receiver
