// The standard normal distribution, to about twelve digits.
#pragma once

namespace palpa {

double normal_density(double z);
double normal_cdf(double z);
/// z with normal_cdf(z) = p, for 0 < p < 1.
double normal_quantile(double p);

}  // namespace palpa
