// The chi-square distribution: probabilities and quantiles for gates and consistency bounds.
#pragma once

namespace schuler::math {

/// P(X <= x) for X chi-square with dof > 0 degrees of freedom (need not be whole); 0 for x <= 0. Relative error below 1e-12
/// for dof up to 1e6 and probabilities above 1e-280. Throws Error(Input) unless dof > 0 and x is a number.
[[nodiscard]] double chi_square_cdf(double x, double dof);

/// P(X > x), accurate in the upper tail, where 1 - cdf is not; otherwise as chi_square_cdf.
[[nodiscard]] double chi_square_survival(double x, double dof);

/// x with P(X <= x) = p, 0 < p < 1; relative error below 1e-11. Throws Error(Input) outside the domain.
[[nodiscard]] double chi_square_quantile(double p, double dof);

}  // namespace schuler::math
