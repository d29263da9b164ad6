// Rates from phases at the ends of a span, from the symbols where there is no phase.
#include "schuler/receiver/rate_span.h"

#include <gtest/gtest.h>

namespace schuler::receiver {
namespace {

using Status = ChannelMeasurement::Status;

/// What the generator has made of the carrier at the end of symbol k, m: of a command of 900 m/s that is corrected by 0.3 m/s at each symbol.
double generated(int k) { return 1e7 + 0.02 * (900.0 * k + 0.15 * k * (k - 1)); }

/// A symbol of 20 ms that ends `k` symbols after the start, of a signal that the command is 0.5 m/s ahead of; its own rate says so within 2 m/s.
ChannelMeasurement symbol(int k, Status status, double noise = 0.0) {
    ChannelMeasurement m;
    m.status = status;
    m.rate = 0.5 + noise;
    m.rate_variance = 4.0;
    m.duration = 0.02;
    m.carrier = 77.0 + 0.5 * 0.02 * k;
    m.carrier_variance = 1e-4;
    return m;
}

std::optional<RateSpan::Rate> add(RateSpan& span, int k, Status status, double noise = 0.0) {
    return span.add(symbol(k, status, noise), 0.02 * k, generated(k), k % 10 == 0);
}

TEST(RateSpan, PhasesTellOnceASpan) {
    RateSpan span;
    for (int k = 3; k <= 10; ++k) {  // before the first whole span each symbol speaks for itself
        const auto rate = add(span, k, Status::Coherent, 1.0);
        ASSERT_TRUE(rate);
        EXPECT_DOUBLE_EQ(rate->rate, 1.5);
        EXPECT_DOUBLE_EQ(rate->variance, 4.0);
        EXPECT_DOUBLE_EQ(rate->duration, 0.02);
    }
    for (int end : {20, 30}) {
        for (int k = end - 9; k < end; ++k) EXPECT_FALSE(add(span, k, Status::Coherent, k % 2 == 0 ? 1.0 : -1.0)) << k;
        const auto rate = add(span, end, Status::Coherent);
        ASSERT_TRUE(rate);
        EXPECT_NEAR(rate->rate, (generated(end) - generated(end - 10)) / 0.2 - 0.5,
                    1e-8);  // as received, whatever was commanded when
        EXPECT_NEAR(rate->variance, 2e-4 / 0.04, 1e-12);
        EXPECT_NEAR(rate->duration, 0.2, 1e-12);
        EXPECT_DOUBLE_EQ(rate->phase_variance, 1e-4);
        EXPECT_EQ(rate->goes_on, end == 30);  // that of 10 was of symbols
    }
}

TEST(RateSpan, ALostPhaseLeavesWhatTheSymbolsSaid) {
    RateSpan span;
    (void)add(span, 10, Status::Coherent);
    for (int k = 11; k < 14; ++k) EXPECT_FALSE(add(span, k, Status::Coherent, 1.0));
    const auto lost = add(span, 14, Status::Noncoherent, -1.0);
    ASSERT_TRUE(lost);
    EXPECT_DOUBLE_EQ(lost->rate, 1.0);
    EXPECT_DOUBLE_EQ(lost->variance, 1.0);
    EXPECT_DOUBLE_EQ(lost->duration, 0.08);
    EXPECT_EQ(lost->phase_variance, 0.0);
    const auto alone = add(span, 15, Status::Coherent, 1.0);
    ASSERT_TRUE(alone);
    EXPECT_DOUBLE_EQ(alone->variance, 4.0);
}

TEST(RateSpan, APhaseThatSlipsIsNotBelieved) {
    RateSpan span;
    (void)add(span, 10, Status::Coherent);
    for (int k = 11; k < 20; ++k) (void)add(span, k, Status::Coherent, 4.0);  // ten symbols are good to 0.63 m/s
    const auto rate = add(span, 20, Status::Coherent, 4.0);
    ASSERT_TRUE(rate);
    EXPECT_DOUBLE_EQ(rate->rate, 4.5);
    EXPECT_DOUBLE_EQ(rate->variance, 0.4);
}

TEST(RateSpan, WhatWasBeforeAResetIsForgotten) {
    RateSpan span;
    for (int k = 10; k < 13; ++k) (void)add(span, k, Status::Coherent, 9.0);
    span.reset();
    const auto rate = add(span, 13, Status::Noncoherent);
    ASSERT_TRUE(rate);
    EXPECT_DOUBLE_EQ(rate->rate, 0.5);
    EXPECT_DOUBLE_EQ(rate->duration, 0.02);
}

}  // namespace
}  // namespace schuler::receiver
