#include "acoustics/bodies/sphere_series.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <vector>

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;

/// h_n of one argument, and the slopes of j_n and h_n, n = 0 .. count - 1, as long as y_n can be represented.
struct Bessel {
  std::vector<double> j_slope;
  std::vector<Complex> h, h_slope;

  Bessel(std::size_t count, double x) {
    const auto hankel = [x](std::size_t n) {
      const auto order = static_cast<unsigned>(n);
      return Complex(std::sph_bessel(order, x), std::sph_neumann(order, x));
    };
    Complex here = hankel(0);
    for (std::size_t n = 0; n < count; ++n) {
      const Complex next = hankel(n + 1);
      const Complex slope = static_cast<double>(n) / x * here - next;
      j_slope.push_back(slope.real());
      h.push_back(here);
      h_slope.push_back(slope);
      here = next;
    }
  }
};

/// Further terms decrease faster than exponentially.
std::size_t terms_for(double ka) {
  return static_cast<std::size_t>(ka + 6 * std::cbrt(ka) + 24);
}

double cosine(const Vec3& a, const Vec3& b) {
  return std::clamp(glm::dot(a, b) / (glm::length(a) * glm::length(b)), -1.0, 1.0);
}

/// Sum over n of factors[n] P_n(cosine).
Complex legendre_sum(const std::vector<Complex>& factors, double cosine) {
  Complex sum = 0;
  double before = 0, here = 1;
  for (std::size_t n = 0; n < factors.size(); ++n) {
    const auto order = static_cast<double>(n);
    sum += here * factors[n];
    const double next = ((2 * order + 1) * cosine * here - order * before) / (order + 1);
    before = here;
    here = next;
  }
  return sum;
}

/// (2n + 1) i^n.
Complex plane_factor(std::size_t n) {
  constexpr Complex powers[]{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  return static_cast<double>(2 * n + 1) * powers[n % 4];
}

}  // namespace

SphereSeries SphereSeries::plane_wave(double wave_number, double radius, const Vec3& direction) {
  const double ka = wave_number * radius;
  const Bessel at(terms_for(ka), ka);
  SphereSeries series;
  series.axis_ = direction;
  for (std::size_t n = 0; n < at.h.size(); ++n)
    series.factors_.push_back(Complex(0, 1) / (ka * ka) * plane_factor(n) / at.h_slope[n]);
  return series;
}

SphereSeries SphereSeries::point_source(double wave_number, double radius, const Vec3& source) {
  const double ka = wave_number * radius;
  const Bessel at(terms_for(ka), ka), from(at.h.size(), wave_number * glm::length(source));
  SphereSeries series;
  series.axis_ = source;
  for (std::size_t n = 0; n < at.h.size(); ++n) {
    const double scale = -static_cast<double>(2 * n + 1) / (wave_number * radius * radius);
    series.factors_.push_back(scale * from.h[n] / at.h_slope[n]);
  }
  return series;
}

Complex SphereSeries::at(const Vec3& place) const {
  return legendre_sum(factors_, cosine(axis_, place));
}

double sphere_force_function(double ka) {
  const std::size_t terms = terms_for(ka);
  const Bessel at(terms + 1, ka);
  double sum = 0;
  for (std::size_t n = 0; n < terms; ++n) {
    const Complex s = -at.j_slope[n] / at.h_slope[n], t = -at.j_slope[n + 1] / at.h_slope[n + 1];
    sum += (static_cast<double>(n) + 1) * (s.real() + t.real() + 2 * (s.real() * t.real() + s.imag() * t.imag()));
  }
  return -4 / (ka * ka) * sum;
}

}  // namespace palpa::acoustics
