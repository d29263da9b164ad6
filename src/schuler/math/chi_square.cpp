#include "schuler/math/chi_square.h"

#include "schuler/core/fail.h"

#include <fmt/format.h>
#include <boost/math/special_functions/gamma.hpp>

#include <cmath>

namespace schuler::math {
namespace {

void require_positive(double dof) {
    if (!(dof > 0.0) || !std::isfinite(dof)) {
        fail(input_error(fmt::format("chi-square with {} degrees of freedom", dof), {}, "the number must be positive"));
    }
}

void require_domain(double x, double dof) {
    require_positive(dof);
    if (std::isnan(x)) fail(input_error("chi-square probability of a value that is not a number"));
}

}  // namespace

double chi_square_cdf(double x, double dof) {
    require_domain(x, dof);
    if (x <= 0.0) return 0.0;
    return std::isinf(x) ? 1.0 : boost::math::gamma_p(0.5 * dof, 0.5 * x);
}

double chi_square_survival(double x, double dof) {
    require_domain(x, dof);
    if (x <= 0.0) return 1.0;
    return std::isinf(x) ? 0.0 : boost::math::gamma_q(0.5 * dof, 0.5 * x);
}

double chi_square_quantile(double p, double dof) {
    if (!(p > 0.0 && p < 1.0)) {
        fail(input_error(fmt::format("chi-square quantile of probability {}", p), {}, "the probability must be between 0 and 1"));
    }
    require_positive(dof);
    return 2.0 * (p < 0.5 ? boost::math::gamma_p_inv(0.5 * dof, p) : boost::math::gamma_q_inv(0.5 * dof, 1.0 - p));
}

}  // namespace schuler::math
