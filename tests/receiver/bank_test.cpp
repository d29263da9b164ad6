// The whole receiver on signals of known motion: what it measures, what it states of it, and how it comes back.
#include "schuler/receiver/bank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace schuler::receiver {
namespace {

/// Satellites on steady ways, one every 100 m/s, with a strength that all share.
class Steady final : public SignalField {
public:
    explicit Steady(std::size_t size) : size_(size) {}
    [[nodiscard]] std::size_t size() const override { return size_; }
    [[nodiscard]] SignalStructure structure(std::size_t) const override { return gps_l1_ca(); }
    [[nodiscard]] LineOfSight motion(std::size_t i, double t) const override {
        const auto k = static_cast<double>(i);
        const LineOfSight m{2.1e7 + 1e5 * k, -300.0 + 100.0 * k, 0.1, 0.0};
        const double w = 2.0 * std::numbers::pi / 10.0, a = swing;
        LineOfSight out = m.after(t);
        out.range -= a / w / w * std::sin(w * t + k);
        out.rate -= a / w * std::cos(w * t + k);
        out.acceleration += a * std::sin(w * t + k);
        out.jerk += a * w * std::cos(w * t + k);
        return out;
    }
    [[nodiscard]] double cn0(std::size_t, double t) const override {
        return t >= silent_from && t < silent_to ? 0.0 : cn0_from_db(db);
    }
    [[nodiscard]] bool in_view(std::size_t, double) const override { return true; }

    double db = 45.0, silent_from = 1e9, silent_to = 1e9;
    double swing = 5.0;  ///< m/s^2

private:
    std::size_t size_;
};

/// m/s: an oscillator here is off by a constant frequency, if at all.
double drift_of(const Bank& bank) { return bank.now() > 0.0 ? bank.clock() / bank.now() : 0.0; }

/// Predictions as a navigation would give them: off by a steady error.
void guide(Bank& bank, const Steady& field, double range_error, double rate_error, double std_range, double std_rate) {
    std::vector<Prediction> p(field.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
        p[i].motion = field.motion(i, bank.now());
        p[i].motion.range += bank.clock() + range_error;
        p[i].motion.rate += drift_of(bank) + rate_error;
        p[i].drift = drift_of(bank);
        p[i].std_range = std_range;
        p[i].std_rate = std_rate;
    }
    bank.guide(p, bank.now());
}

/// Sums of the errors of measurements, and of their squares over the variances stated.
struct Errors {
    double range = 0.0, range_nis = 0.0, n = 0.0;
    double rate = 0.0, weight = 0.0, rate_nis = 0.0, rates = 0.0;  ///< rate: sum over the variances, weight: of their inverses

    void add(const Steady& field, const Bank& bank, const std::vector<BankMeasurement>& measured) {
        for (const BankMeasurement& m : measured) {
            // at the moment when the receiver's clock shows now
            const double instant = bank.now() - bank.clock() / gnss::speed_of_light;
            const LineOfSight truth = field.motion(m.signal, instant);
            const double by_phase = (truth.range - field.motion(m.signal, instant - m.rate_span).range) / m.rate_span;  // a mean
            const double received = m.phase_variance > 0.0 ? by_phase : truth.rate;
            const double dp = m.range - truth.range - bank.clock(), dv = m.rate - received - drift_of(bank);
            range += dp;
            range_nis += dp * dp / m.range_variance;
            n += 1.0;
            if (!std::isfinite(m.rate_variance)) continue;  // within a span
            rate += dv / m.rate_variance;
            weight += 1.0 / m.rate_variance;
            rate_nis += dv * dv / m.rate_variance;
            rates += 1.0;
        }
    }
};

BankSettings quiet_clock(Guidance guidance) {
    BankSettings s;
    s.guidance = guidance;
    s.oscillator = {0.0, 0.0, 0.0, 0.0, Eigen::Vector3d::Zero()};
    return s;
}

TEST(Bank, AloneItLosesAndFindsAgainByItself) {
    Steady field(4);
    field.silent_from = 20.0;
    field.silent_to = 80.0;
    Bank bank(field, quiet_clock(Guidance::None), 3);
    std::vector<BankMeasurement> out;
    Errors back;
    for (int k = 0; k < 90'000; ++k) {
        bank.step(Eigen::Vector3d::Zero());
        if (k == 80'040) {  // a dwell takes 50 ms
            for (std::size_t i = 0; i < field.size(); ++i) EXPECT_EQ(bank.state(i), ChannelState::Searching);
        }
        if (k % 1000 != 999) continue;
        bank.measure(out, 1.0);
        if (k > 10'000 && k < 20'000) {
            EXPECT_EQ(out.size(), 4U) << bank.now();
        }
        if (k > 40'000 && k < 80'000) {
            EXPECT_TRUE(out.empty()) << bank.now();
        }
        if (k > 85'000) back.add(field, bank, out);
    }
    EXPECT_EQ(back.n, 20.0);
    EXPECT_LT(back.range_nis / back.n, 3.0) << "what it found is the signal";
}

/// Commanded by a navigation that is wrong by a steady error, deep channels tell that error: mean and variance as stated.
TEST(Bank, GeneratorsTellTheErrorOfTheirCommand) {
    Steady field(4);
    field.db = 30.0;
    Bank bank(field, quiet_clock(Guidance::Generators), 5);
    std::vector<BankMeasurement> out;
    Errors errors;
    for (int k = 0; k < 20'000; ++k) {
        if (k % 10 == 0) guide(bank, field, 6.0, -0.3, 5.0, 0.2);
        bank.step(Eigen::Vector3d::Zero());
        if (k % 20 != 19) continue;
        bank.measure(out, 0.02);
        if (bank.now() >= 2.0) errors.add(field, bank, out);
    }
    const double n = errors.n;
    ASSERT_GT(n, 3000.0);
    EXPECT_NEAR(errors.range / n, 0.0, 0.6);  // of 6 m; noise 16 m a symbol
    EXPECT_NEAR(errors.range_nis / n, 1.0, 0.12);
    EXPECT_NEAR(errors.rates, 4.0 * 18.0 / 0.2, 80.0);  // spans, and symbols by themselves while the phase is not followed
    EXPECT_NEAR(errors.rate / errors.weight, 0.0, 4.0 / std::sqrt(errors.weight));
    EXPECT_NEAR(errors.rate_nis / errors.rates, 1.0, 0.35);  // neighbouring spans share a phase: few are independent
}

/// A navigation that knew nothing for a while commands again: the channel starts from what is known then.
TEST(Bank, GeneratorsResumeFromWhatIsKnownThen) {
    Steady field(4);
    field.db = 18.0;  // so weak that a symbol without it does not tell
    Bank bank(field, quiet_clock(Guidance::Generators), 9);
    std::vector<BankMeasurement> out;
    int measured = 0;
    for (int k = 0; k < 42'000; ++k) {
        const bool lost = k >= 6'000 && k < 39'000;
        if (k % 10 == 0) guide(bank, field, 0.0, 0.0, lost ? 500.0 : 5.0, lost ? 5.0 : 0.2);
        bank.step(Eigen::Vector3d::Zero());
        if (k % 20 != 19) continue;
        bank.measure(out, 0.02);
        if (bank.now() < 39.0) continue;
        for (const BankMeasurement& m : out) {
            EXPECT_LT(std::abs(m.range - field.motion(m.signal, bank.now()).range), 6.0 * std::sqrt(m.range_variance))
                << bank.now();
            ++measured;
        }
    }
    EXPECT_GT(measured, 200);
}

/// Unaided and aided loops: errors as large as they are said to be.
TEST(Bank, StatesTheSigmasOfItsRangesAndRates) {
    for (const double db : {45.0, 35.0}) {
        for (const Guidance guidance : {Guidance::None, Guidance::Loops}) {
            Steady field(8);
            field.db = db;
            BankSettings settings = quiet_clock(guidance);
            settings.oscillator.frequency_std = 1e-6;
            Bank bank(field, settings, 7);
            std::vector<BankMeasurement> out;
            Errors errors;
            for (int k = 0; k < 60'000; ++k) {
                if (guidance == Guidance::Loops && k % 10 == 0) guide(bank, field, 6.0, -0.3, 5.0, 0.2);
                bank.step(Eigen::Vector3d::Zero());
                if (k % 1000 != 999) continue;
                bank.measure(out, 1.0);
                if (bank.now() >= 10.0) errors.add(field, bank, out);
            }
            ASSERT_GT(errors.n, 300.0);
            EXPECT_NEAR(errors.range_nis / errors.n, 1.0, 0.4) << db << (guidance == Guidance::None ? " alone" : " aided");
            EXPECT_NEAR(errors.rate_nis / errors.rates, 1.0, 0.4) << db << (guidance == Guidance::None ? " alone" : " aided");
        }
    }
}

/// A rate is that of the instant it is given for: what of its errors goes with the acceleration is a time by which it is early.
TEST(Bank, ItsRatesAreOfTheirInstant) {
    for (const Guidance guidance : {Guidance::None, Guidance::Loops}) {
        Steady field(8);
        field.swing = 100.0;
        Bank bank(field, quiet_clock(guidance), 11);
        std::vector<BankMeasurement> out;
        double with_acceleration = 0.0, squares = 0.0, nis = 0.0, n = 0.0;
        for (int k = 0; k < 40'000; ++k) {
            if (guidance == Guidance::Loops && k % 10 == 0) guide(bank, field, 0.0, 0.0, 5.0, 0.2);
            bank.step(Eigen::Vector3d::Zero());
            if (k % 200 != 199) continue;
            bank.measure(out, 0.2);
            if (bank.now() < 10.0) continue;
            for (const BankMeasurement& m : out) {
                const LineOfSight truth = field.motion(m.signal, bank.now());
                const double error = m.rate - truth.rate;
                with_acceleration += error * truth.acceleration;
                squares += truth.acceleration * truth.acceleration;
                nis += error * error / m.rate_variance;
                n += 1.0;
            }
        }
        const char* which = guidance == Guidance::None ? "alone" : "aided";
        ASSERT_GT(n, 1000.0) << which;
        // half an update of the loop is 5 ms, half a code period of the aid 0.5 ms
        EXPECT_NEAR(with_acceleration / squares, 0.0, guidance == Guidance::None ? 3e-4 : 5e-5) << which;
        EXPECT_NEAR(nis / n, 1.0, 0.2) << which;
    }
}

/// The oscillator's noise is in all rates of an instant, not quite alike: what they share, and what each has besides, have the stated variances.
TEST(Bank, StatesWhatRatesShareOfTheClocksNoise) {
    constexpr double h0 = 8e-21, c = gnss::speed_of_light, density = 0.5 * c * c * h0;
    for (const Guidance guidance : {Guidance::None, Guidance::Loops}) {
        double shared = 0.0, epochs = 0.0, own = 0.0, freedom = 0.0;
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            Steady field(8);
            BankSettings settings = quiet_clock(guidance);
            settings.oscillator.h0 = h0;
            Bank bank(field, settings, seed);
            std::vector<BankMeasurement> out;
            for (int k = 0; k < 60'000; ++k) {
                if (guidance == Guidance::Loops && k % 10 == 0) guide(bank, field, 0.0, 0.0, 5.0, 0.2);
                bank.step(Eigen::Vector3d::Zero());
                if (k % 500 != 499 || k < 10'000) continue;
                bank.measure(out, 0.5);
                if (out.size() < 8) continue;
                const double common = density / shared_rate_span(settings);
                double mean = 0.0, square = 0.0, each = 0.0;
                for (const BankMeasurement& m : out) {
                    const double e = m.rate - field.motion(m.signal, bank.now() - bank.clock() / c).rate;
                    mean += e / 8.0;
                    square += e * e;
                    each += (m.rate_variance + density / m.rate_span - common) / 8.0;
                }
                own += (square - 8.0 * mean * mean) / each;
                freedom += 7.0;
                shared += mean * mean / (common + each / 8.0);
                epochs += 1.0;
            }
        }
        const char* which = guidance == Guidance::None ? "alone" : "aided";
        ASSERT_GT(epochs, 350.0) << which;
        EXPECT_NEAR(own / freedom, 1.0, 0.12) << which;  // four sigma of the mean of so many squares 0.11
        EXPECT_NEAR(shared / epochs, 1.0, 0.3) << which;
    }
}

}  // namespace
}  // namespace schuler::receiver
