#include "schuler/math/binomial.h"

#include "schuler/core/error.h"

#include <fmt/format.h>
#include <boost/math/special_functions/beta.hpp>

namespace schuler::math {

std::array<double, 2> binomial_bounds(std::size_t events, std::size_t trials, double confidence) {
    if (events > trials) throw input_error(fmt::format("{} events in {} trials", events, trials));
    if (!(confidence > 0.0 && confidence < 1.0))
        throw input_error(fmt::format("bounds with confidence {}", confidence), {}, "the confidence must be between 0 and 1");
    const auto k = static_cast<double>(events), n = static_cast<double>(trials);
    const double tail = 0.5 * (1.0 - confidence);
    // the tails of the binomial are incomplete beta functions of the probability
    return {events == 0 ? 0.0 : boost::math::ibeta_inv(k, n - k + 1.0, tail),
            events == trials ? 1.0 : boost::math::ibetac_inv(k + 1.0, n - k, tail)};
}

}  // namespace schuler::math
