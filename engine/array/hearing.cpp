#include "array/hearing.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// e^{-i phase of p}, 0 where there is none.
Complex back(const Complex& p) {
  const double size = std::abs(p);
  return size > 0 ? std::conj(p) / size : Complex(0);
}

/// One transducer's sum, s = B c. Products are written out: those of std::complex mind infinities.
Complex sum_of(const Columns& columns, std::size_t first, std::span<const Complex> factors) {
  double re = 0, im = 0;
  for (std::size_t j = 0; j < columns.foci; ++j) {
    const double cosine = columns.asked[first + j] * columns.cosine[first + j];
    const double sine = columns.asked[first + j] * columns.sine[first + j];
    re += factors[j].real() * cosine + factors[j].imag() * sine;
    im += factors[j].imag() * cosine - factors[j].real() * sine;
  }
  return {re, im};
}

}  // namespace

void MatrixHearing::hear(std::span<const Complex> factors, std::span<Complex> pressure) const {
  for (std::size_t row = 0; row < matrix_.foci; ++row) {
    double re = 0, im = 0;
    for (std::size_t column = 0; column < matrix_.foci; ++column) {
      const Complex entry = matrix_.at(row, column);
      re += entry.real() * factors[column].real() - entry.imag() * factors[column].imag();
      im += entry.real() * factors[column].imag() + entry.imag() * factors[column].real();
    }
    pressure[row] = {re, im};
  }
}

void MatrixHearing::slope(std::span<const Complex> /*factors*/, std::span<const Complex> pressure,
                          std::span<Complex> slopes) const {
  for (std::size_t row = 0; row < matrix_.foci; ++row) {
    const Complex turn = back(pressure[row]);
    for (std::size_t column = 0; column < matrix_.foci; ++column)
      slopes[row * matrix_.foci + column] = turn * matrix_.at(row, column);
  }
}

void BoundedHearing::hear(std::span<const Complex> factors, std::span<Complex> pressure) const {
  std::array<double, most_solved_foci> re{}, im{};
  for (std::size_t n = 0; n < columns_.transducers; ++n) {
    const std::size_t first = n * columns_.foci;
    const Complex sum = sum_of(columns_, first, factors);
    const double most = std::max(std::sqrt(std::norm(sum)), bound_);
    const double x = most > 0 ? sum.real() / most : 0, y = most > 0 ? sum.imag() / most : 0;
    for (std::size_t j = 0; j < columns_.foci; ++j) {
      const double loud = columns_.loud[first + j];
      re[j] += loud * (x * columns_.cosine[first + j] - y * columns_.sine[first + j]);
      im[j] += loud * (x * columns_.sine[first + j] + y * columns_.cosine[first + j]);
    }
  }
  for (std::size_t j = 0; j < columns_.foci; ++j)
    pressure[j] = {re[j], im[j]};
}

void BoundedHearing::slope(std::span<const Complex> factors, std::span<const Complex> pressure,
                           std::span<Complex> slopes) const {
  const std::size_t foci = columns_.foci;
  std::array<Complex, most_solved_foci> turn;
  for (std::size_t j = 0; j < foci; ++j)
    turn[j] = back(pressure[j]);
  std::array<double, most_solved_foci * most_solved_foci> re, im;
  std::fill_n(re.begin(), foci * foci, 0.0);
  std::fill_n(im.begin(), foci * foci, 0.0);
  std::array<double, most_solved_foci> ask_re, ask_im;
  for (std::size_t n = 0; n < columns_.transducers; ++n) {
    const std::size_t first = n * foci;
    const Complex sum = sum_of(columns_, first, factors);
    const double size = std::sqrt(std::norm(sum));
    if (!(size > 0)) continue;
    const double x = sum.real() / size, y = sum.imag() / size;
    // What the factors do to the sum, seen along its own direction.
    const double steep = 1 / std::max(size, bound_);
    for (std::size_t q = 0; q < foci; ++q) {
      const double cosine = columns_.asked[first + q] * columns_.cosine[first + q] * steep;
      const double sine = columns_.asked[first + q] * columns_.sine[first + q] * steep;
      ask_re[q] = x * cosine - y * sine;
      ask_im[q] = -(x * sine + y * cosine);
    }
    for (std::size_t j = 0; j < foci; ++j) {
      const double loud = columns_.loud[first + j];
      const double give_re = loud * (x * columns_.cosine[first + j] - y * columns_.sine[first + j]);
      const double give_im = loud * (x * columns_.sine[first + j] + y * columns_.cosine[first + j]);
      const double across = turn[j].real() * give_im + turn[j].imag() * give_re;
      // Where the sum is bounded only the part across that direction counts.
      const double along = size > bound_ ? 0 : turn[j].real() * give_re - turn[j].imag() * give_im;
      double* const row_re = &re[j * foci];
      double* const row_im = &im[j * foci];
      for (std::size_t q = 0; q < foci; ++q) {
        row_re[q] += along * ask_re[q] - across * ask_im[q];
        row_im[q] += along * ask_im[q] + across * ask_re[q];
      }
    }
  }
  for (std::size_t e = 0; e < foci * foci; ++e)
    slopes[e] = {re[e], im[e]};
}

}  // namespace palpa::array
