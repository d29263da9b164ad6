// Residuals of the pre-filters: unbiased, as noisy as they say, and good for holding a signal that a loop loses.
#include "schuler/receiver/deep_channel.h"

#include "schuler/core/error.h"

#include <gtest/gtest.h>
#include <Eigen/LU>

#include <cmath>
#include <optional>

namespace schuler::receiver {
namespace {

struct Judged {
    double range_mean = 0.0, rate_mean = 0.0, range_nis = 0.0, rate_nis = 0.0, range_variance = 0.0, rate_variance = 0.0;
    int count = 0, coherent = 0;
    double carrier_rate = 0.0, carrier_nis = 0.0,
           carrier_variance = 0.0;  ///< rates over fifty symbols from the phases at their ends
    int spans = 0;
};

/// Residuals of a navigation that is wrong by a constant: each symbol commanded anew.
Judged judge(Prefilter kind, double db, double range_error, double rate_error, int symbols,
             SignalStructure signal = gps_l1_ca()) {
    DeepSettings settings;
    settings.prefilter = kind;
    settings.cn0_time = 4.0;
    const CorrelatorModel model(CorrelationPeak(signal.chip_rate), settings.spacing);
    DeepChannel channel(signal, model.peak(), settings);
    math::Random random(21, "deep");
    LineOfSight truth{2.1e7, 310.0, 3.0, 0.0};
    const double cn0 = cn0_from_db(db), T = signal.code_period();
    const auto predicted = [&] {
        LineOfSight p = truth;
        p.range += range_error;
        p.rate += rate_error;
        return p;
    };
    channel.start(predicted(), 0);
    Judged out;
    std::optional<ChannelMeasurement> begin;
    int sign = 1;
    const int per_symbol = static_cast<int>(std::lround(signal.symbol_duration / T));
    for (int i = 0; i < symbols * per_symbol; ++i) {
        if (i % per_symbol == 0) sign = random.bits() % 2 == 0 ? 1 : -1;
        const Correlators dump = model.dump(replica_error(signal, channel.replica(), truth, T), cn0, T, sign, random);
        truth = truth.after(T);
        const auto m = channel.step(dump);
        if (!m) continue;
        channel.command(predicted(), 0.1);
        if (i < 100 * per_symbol || m->status == ChannelMeasurement::Status::NoSignal) continue;
        ++out.count;
        if (m->status != ChannelMeasurement::Status::Coherent) {
            begin.reset();
        } else if (++out.coherent % 50 == 0) {
            if (begin) {
                const double span = 50.0 * signal.symbol_duration, rate = (m->carrier - begin->carrier) / span;
                const double variance = (m->carrier_variance + begin->carrier_variance) / (span * span);
                out.carrier_rate += rate;
                out.carrier_nis += (rate - rate_error) * (rate - rate_error) / variance;
                out.carrier_variance += variance;
                ++out.spans;
            }
            begin = *m;
        }
        const double middle = range_error + rate_error * signal.symbol_duration / 2.0;
        out.range_mean += m->range;
        out.rate_mean += m->rate;
        out.range_nis += std::pow(m->range - middle, 2) / m->range_variance;
        out.rate_nis += std::pow(m->rate - rate_error, 2) / m->rate_variance;
        out.range_variance += m->range_variance;
        out.rate_variance += m->rate_variance;
    }
    for (double* x : {&out.range_mean, &out.rate_mean, &out.range_nis, &out.rate_nis, &out.range_variance, &out.rate_variance})
        *x /= out.count;
    for (double* x : {&out.carrier_rate, &out.carrier_nis, &out.carrier_variance}) *x /= out.spans;
    return out;
}

TEST(DeepChannel, NoncoherentResidualsAreUnbiasedAndAsNoisyAsTheySay) {
    for (const double db : {18.0, 25.0, 35.0, 45.0}) {
        const Judged j = judge(Prefilter::Noncoherent, db, 9.0, 0.3, 4000);
        const double bias = 4.0 / std::sqrt(j.count);
        // 10 and 8 %: the C/N0 that scales them is estimated from the same signal
        EXPECT_NEAR(j.range_mean, 9.0, bias * std::sqrt(j.range_variance) + 0.9) << db;
        EXPECT_NEAR(j.rate_mean, 0.3, bias * std::sqrt(j.rate_variance) + 0.03) << db;
        EXPECT_NEAR(j.range_nis, 1.0, 0.2) << db;
        EXPECT_NEAR(j.rate_nis, 1.0, 0.2) << db;
    }
}

TEST(DeepChannel, PhasesTellTheRateWhileTheyAreFollowed) {
    for (const double db : {25.0, 30.0, 40.0}) {
        constexpr double off = 0.3;  // three times what the command is said to be off
        const Judged coherent = judge(Prefilter::Coherent, db, 9.0, off, 6000),
                     noncoherent = judge(Prefilter::Noncoherent, db, 9.0, off, 6000);
        EXPECT_GT(coherent.coherent, coherent.count * 95 / 100) << db;
        // against the mean of the fifty symbols' own rates
        EXPECT_LT(coherent.carrier_variance, 0.05 * noncoherent.rate_variance / 50.0) << db;
        EXPECT_LT(coherent.range_variance, noncoherent.range_variance) << db;
        EXPECT_NEAR(coherent.carrier_rate, off, 4.0 * std::sqrt(coherent.carrier_variance / coherent.spans)) << db;
        EXPECT_LT(coherent.carrier_nis, 1.3) << db;
        EXPECT_GT(coherent.carrier_nis, 0.2) << db;
        EXPECT_NEAR(coherent.range_mean, 9.0, 1.2) << db;
        EXPECT_NEAR(coherent.range_nis, 1.0, 0.2) << db;
    }
    for (const double rate_error : {4.75, 9.5}) {  // 25 and 50 Hz: the phase is not what it seems
        const Judged lost = judge(Prefilter::Coherent, 40.0, 0.0, rate_error, 1000);
        EXPECT_LT(lost.coherent, lost.count / 20) << rate_error;
    }
    const Judged weak = judge(Prefilter::Coherent, 15.0, 9.0, 0.3, 3000);
    EXPECT_LT(weak.coherent, weak.count / 20) << "what is not followed is not called so";
}

TEST(DeepChannel, SeesGlonass) {
    const Judged j = judge(Prefilter::Coherent, 40.0, 9.0, 0.2, 3000, glonass_l1_of(5));
    EXPECT_NEAR(j.range_mean, 9.0, 1.5);
    EXPECT_NEAR(j.range_nis, 1.0, 0.2);
}

/// Range and rate of one line of sight filtered outside, as a navigation filter would: the motion is known from an inertial
/// system but for white acceleration `q` (m/s^2/sqrt(Hz)), simulated as well.
struct OutsideFilter {
    SignalStructure signal = gps_l1_ca();
    CorrelatorModel model{CorrelationPeak(signal.chip_rate), 0.5};
    DeepChannel channel;
    math::Random random{22, "hold"};
    LineOfSight truth{2.1e7, -200.0, 0.0, 0.0};
    Eigen::Matrix2d P;
    double q;
    int measurements = 0;

    OutsideFilter(Prefilter kind, Eigen::Vector2d error, double noise)
        : channel(signal, model.peak(), {.prefilter = kind}), q(noise) {
        P = error.cwiseAbs2().asDiagonal();
        LineOfSight predicted = truth;
        predicted.range += error[0];
        predicted.rate += error[1];
        channel.start(predicted, 0);
    }
    [[nodiscard]] double range_error() const { return channel.predicted().range - truth.range; }
    [[nodiscard]] double rate_error() const { return channel.predicted().rate - truth.rate; }

    void run(double seconds, double db) {
        const double T = signal.code_period(), D = signal.symbol_duration, cn0 = cn0_from_db(db);
        for (int i = 0; i < static_cast<int>(std::lround(seconds / D)); ++i) {
            truth.acceleration = 15.0 * std::sin(0.04 * i);
            LineOfSight now = channel.predicted();
            now.acceleration = truth.acceleration;
            channel.command(now, 1.0);
            std::optional<ChannelMeasurement> m;
            for (int k = 0; k < 20; ++k) {
                m = channel.step(
                    model.dump(replica_error(signal, channel.replica(), truth, T), cn0, T, i % 3 == 0 ? 1 : -1, random));
                truth = truth.after(T);
            }
            ASSERT_TRUE(m.has_value());
            truth.rate += q * std::sqrt(D) * random.normal();
            Eigen::Matrix2d F;
            F << 1.0, D, 0.0, 1.0;
            P = (F * P * F.transpose()).eval();
            P(1, 1) += q * q * D;
            if (m->status == ChannelMeasurement::Status::NoSignal) continue;
            ++measurements;
            const Eigen::Matrix2d R = Eigen::Vector2d(m->range_variance, m->rate_variance).asDiagonal();
            const Eigen::Matrix2d S = P + R, K = P * S.inverse();
            const Eigen::Vector2d dx = K * Eigen::Vector2d(m->range, m->rate);
            P = (P - K * S * K.transpose()).eval();
            LineOfSight corrected = channel.predicted();
            corrected.range -= dx[0];
            corrected.rate -= dx[1];
            channel.command(corrected, 1.0);
        }
    }
};

TEST(DeepChannel, AnOutsideFilterHoldsWhatALoopWouldLose) {
    for (const Prefilter kind : {Prefilter::Noncoherent, Prefilter::Coherent}) {
        OutsideFilter f(kind, {30.0, 0.5}, 0.05);
        f.run(60.0, 15.0);
        EXPECT_GT(f.measurements, 2500);
        EXPECT_LT(std::sqrt(f.P(0, 0)), 20.0);
        EXPECT_NEAR(f.range_error(), 0.0, 4.0 * std::sqrt(f.P(0, 0)));
        EXPECT_NEAR(f.rate_error(), 0.0, 4.0 * std::sqrt(f.P(1, 1)));
    }
}

TEST(DeepChannel, IsBackWithinASecondOfAnOutage) {
    // Half a minute without a signal leaves tens of metres and 0.3 m/s; nothing is searched.
    OutsideFilter f(Prefilter::Noncoherent, {10.0, 0.2}, 0.02);
    f.run(10.0, 40.0);
    EXPECT_NEAR(f.range_error(), 0.0, 6.0);
    f.measurements = 0;
    f.run(30.0, -20.0);
    EXPECT_LT(f.measurements, 300) << "of 1500: noise is seldom to be taken for a signal";
    EXPECT_NEAR(f.range_error(), 0.0, 4.0 * std::sqrt(f.P(0, 0)));
    f.truth.range += 35.0;
    f.truth.rate += 0.3;
    f.P += Eigen::Vector2d(35.0 * 35.0, 0.09).asDiagonal().toDenseMatrix();
    f.run(1.0, 40.0);
    EXPECT_NEAR(f.range_error(), 0.0, 10.0);
    EXPECT_NEAR(f.rate_error(), 0.0, 0.3);
}

TEST(DeepChannel, RefusesSettings) {
    DeepSettings settings;
    settings.spacing = 0.0;
    EXPECT_THROW(DeepChannel(gps_l1_ca(), CorrelationPeak(1.023e6), settings), Error);
    settings.spacing = 0.5;
    settings.followed = 2.0;
    EXPECT_THROW(DeepChannel(gps_l1_ca(), CorrelationPeak(1.023e6), settings), Error);
}

}  // namespace
}  // namespace schuler::receiver
