#include "acoustics/elements/polynomial.hpp"

#include <algorithm>
#include <cmath>

namespace palpa::acoustics {
namespace {

using Powers = std::array<double, most_degree + 1>;

Powers powers_of(double x) {
  Powers powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i)
    powers[i] = powers[i - 1] * x;
  return powers;
}

}  // namespace

Monomials monomials(std::uint32_t degree, double s, double t) {
  const Powers of_s = powers_of(s), of_t = powers_of(t);
  Monomials all{};
  std::size_t next = 0;
  for (std::uint32_t sum = 0; sum <= degree; ++sum) {
    for (std::uint32_t j = 0; j <= sum; ++j)
      all[next++] = of_s[sum - j] * of_t[j];
  }
  return all;
}

MonomialSlopes monomial_slopes(std::uint32_t degree, double s, double t) {
  const Powers of_s = powers_of(s), of_t = powers_of(t);
  MonomialSlopes all{};
  std::size_t next = 0;
  for (std::uint32_t sum = 0; sum <= degree; ++sum) {
    for (std::uint32_t j = 0; j <= sum; ++j) {
      const std::uint32_t i = sum - j;
      all.by_s[next] = i > 0 ? i * of_s[i - 1] * of_t[j] : 0;
      all.by_t[next] = j > 0 ? j * of_s[i] * of_t[j - 1] : 0;
      ++next;
    }
  }
  return all;
}

void LeastSquares::add(const Monomials& row, double weight) {
  for (std::size_t i = 0; i < terms_; ++i) {
    const double scaled = weight * row[i];
    for (std::size_t j = 0; j <= i; ++j)
      matrix_[i * terms_ + j] += scaled * row[j];
  }
}

void LeastSquares::factor() {
  // Cholesky. A small multiple of the identity keeps what the equations leave open at zero.
  double trace = 0;
  for (std::size_t i = 0; i < terms_; ++i)
    trace += matrix_[i * terms_ + i];
  const double least = 1e-11 * trace / static_cast<double>(terms_);
  for (std::size_t i = 0; i < terms_; ++i) {
    matrix_[i * terms_ + i] += least;
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = matrix_[i * terms_ + j];
      for (std::size_t l = 0; l < j; ++l)
        sum -= matrix_[i * terms_ + l] * matrix_[j * terms_ + l];
      matrix_[i * terms_ + j] = i == j ? std::sqrt(std::max(sum, 0.5 * least)) : sum / matrix_[j * terms_ + j];
    }
  }
}

void LeastSquares::solve(std::span<double> sums, std::size_t count) const {
  const auto take = [&](std::size_t from, std::size_t to, double factor) {
    double* const into = &sums[to * count];
    const double* const source = &sums[from * count];
    for (std::size_t side = 0; side < count; ++side)
      into[side] -= factor * source[side];
  };
  const auto scale = [&](std::size_t row) {
    const double by = 1 / matrix_[row * terms_ + row];
    for (std::size_t side = 0; side < count; ++side)
      sums[row * count + side] *= by;
  };
  for (std::size_t i = 0; i < terms_; ++i) {
    for (std::size_t l = 0; l < i; ++l)
      take(l, i, matrix_[i * terms_ + l]);
    scale(i);
  }
  for (std::size_t i = terms_; i-- > 0;) {
    for (std::size_t l = i + 1; l < terms_; ++l)
      take(l, i, matrix_[l * terms_ + i]);
    scale(i);
  }
}

}  // namespace palpa::acoustics
