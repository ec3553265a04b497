#include "acoustics/bodies/sphere_grid.hpp"

#include <cmath>
#include <numbers>

#include "acoustics/elements/triangle_rules.hpp"

namespace palpa::acoustics {

using Complex = std::complex<double>;

SphereGrid::SphereGrid(std::size_t order, std::size_t rings) : order_(order), rings_(rings), around_(2 * rings) {
  constexpr double pi = std::numbers::pi;
  for (std::size_t j = 0; j < around_; ++j)
    turns_.push_back(std::polar(1.0, 2 * pi * static_cast<double>(j) / static_cast<double>(around_)));
  const std::size_t per_ring = (order_ + 1) * (order_ + 2) / 2;
  legendre_.resize(rings_ * per_ring);
  std::size_t ring = 0;
  for (const LineSample& sample : gauss_rule(rings_)) {
    const double z = 2 * sample.at - 1, r = std::sqrt(1 - z * z);
    ring_weights_.push_back(2 * sample.weight * 2 * pi / static_cast<double>(around_));
    for (const Complex& turn : turns_) {
      directions_.emplace_back(r * turn.real(), r * turn.imag(), z);
      weights_.push_back(ring_weights_.back());
    }
    // Legendre's associated functions, normalised; by their stable recurrence, from l = m upwards.
    double* const table = &legendre_[ring++ * per_ring];
    double sectoral = std::sqrt(1 / (4 * pi));
    for (std::size_t m = 0; m <= order_; ++m) {
      const auto of_m = static_cast<double>(m);
      if (m > 0) sectoral *= r * std::sqrt((2 * of_m + 1) / (2 * of_m));
      double before = 0, here = sectoral;
      table[m * (m + 1) / 2 + m] = here;
      for (std::size_t l = m + 1; l <= order_; ++l) {
        const auto of_l = static_cast<double>(l), below = of_l - 1;
        const double up = std::sqrt((4 * of_l * of_l - 1) / (of_l * of_l - of_m * of_m));
        const double down = std::sqrt((below * below - of_m * of_m) / (4 * below * below - 1));
        const double next = up * (z * here - down * before);
        before = here;
        here = next;
        table[l * (l + 1) / 2 + m] = here;
      }
    }
  }
}

std::vector<Complex> SphereGrid::coefficients(std::span<const Complex> values) const {
  std::vector<Complex> result((order_ + 1) * (order_ + 1));
  const auto most = static_cast<std::ptrdiff_t>(order_);
  for (std::size_t ring = 0; ring < rings_; ++ring) {
    for (std::ptrdiff_t m = -most; m <= most; ++m) {
      const auto size = static_cast<std::size_t>(std::abs(m));
      // e^{-i m angle}
      const std::size_t step = m > 0 ? around_ - size : size;
      Complex sum = 0;
      for (std::size_t j = 0, at = 0; j < around_; ++j, at = (at + step) % around_)
        sum += values[ring * around_ + j] * turns_[at];
      sum *= ring_weights_[ring];
      for (std::size_t l = size; l <= order_; ++l)
        result[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(l * l + l) + m)] += legendre(ring, l, size) * sum;
    }
  }
  return result;
}

std::vector<Complex> SphereGrid::values(std::span<const Complex> coefficients) const {
  std::vector<Complex> result(directions_.size());
  const auto most = static_cast<std::ptrdiff_t>(order_);
  for (std::size_t ring = 0; ring < rings_; ++ring) {
    for (std::ptrdiff_t m = -most; m <= most; ++m) {
      const auto size = static_cast<std::size_t>(std::abs(m));
      Complex sum = 0;
      for (std::size_t l = size; l <= order_; ++l)
        sum += legendre(ring, l, size) *
               coefficients[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(l * l + l) + m)];
      const std::size_t step = m < 0 ? around_ - size : size;
      for (std::size_t j = 0, at = 0; j < around_; ++j, at = (at + step) % around_)
        result[ring * around_ + j] += sum * turns_[at];
    }
  }
  return result;
}

}  // namespace palpa::acoustics
