// The transform against its definition.
#include "schuler/math/fft.h"

#include "schuler/core/error.h"
#include "schuler/math/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace schuler::math {
namespace {

TEST(Fft, IsItsDefinitionAndItsInverse) {
    for (const std::size_t n : {1U, 7U, 60U, 1023U}) {
        Random random(n, "fft");
        std::vector<std::complex<float>> x(n), X(n), back(n);
        for (auto& v : x) v = {static_cast<float>(random.normal()), static_cast<float>(random.normal())};
        const Fft fft(n);
        fft.forward(x, X);
        fft.inverse(X, back);
        for (std::size_t k = 0; k < n; k += n / 5 + 1) {
            std::complex<double> sum = 0.0;
            for (std::size_t i = 0; i < n; ++i)
                sum += std::complex<double>(x[i]) *
                       std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(k * i % n) / static_cast<double>(n));
            EXPECT_LT(std::abs(std::complex<double>(X[k]) - sum), 2e-5 * std::sqrt(static_cast<double>(n)) + 1e-5)
                << n << ' ' << k;
            EXPECT_LT(std::abs(back[k] - x[k]), 1e-5F);
        }
    }
    EXPECT_THROW(Fft(0), Error);
    std::vector<std::complex<float>> few(3);
    EXPECT_THROW(Fft(4).forward(few, few), Error);
}

}  // namespace
}  // namespace schuler::math
