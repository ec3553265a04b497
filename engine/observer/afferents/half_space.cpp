#include "observer/afferents/half_space.hpp"

#include <cmath>
#include <numbers>

namespace palpa::observer {
namespace {

constexpr double pi = std::numbers::pi;

struct Elliptic {
  double first, second;  // K and E
};

/// By the arithmetic-geometric mean; 0 <= modulus < 1.
Elliptic elliptic(double modulus) {
  double a = 1, b = std::sqrt(1 - modulus * modulus), c = modulus, sum = c * c / 2, power = 1;
  for (int i = 0; i < 12 && std::abs(c) > 1e-17; ++i) {
    const double next = (a + b) / 2;
    c = (a - b) / 2;
    b = std::sqrt(a * b);
    a = next;
    sum += power * c * c;
    power *= 2;
  }
  const double first = pi / (2 * a);
  return {first, first * (1 - sum)};
}

}  // namespace

double stress_of_point(double z, double r) {
  const double square = r * r + z * z;
  return 3 * z * z * z / (2 * pi * square * square * std::sqrt(square));
}

double deflection_of_disc(double a, double r) {
  if (std::abs(r - a) < 1e-9 * a) return 4 * a / (pi * skin_stiffness);  // E(1) = 1
  if (r < a) return 4 * a / (pi * skin_stiffness) * elliptic(r / a).second;
  const double ratio = a / r;
  if (ratio < 0.02) return a * ratio / skin_stiffness;  // a point force, within 1e-4
  const Elliptic value = elliptic(ratio);
  return 4 * r / (pi * skin_stiffness) * (value.second - (1 - ratio * ratio) * value.first);
}

}  // namespace palpa::observer
