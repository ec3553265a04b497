#include "array/solvers/hearing.hpp"

#include <array>
#include <cmath>

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// One transducer's sum, s = B c. Products are written out, because those of std::complex check for infinities.
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

void hear(const FocusMatrix& matrix, std::span<const Complex> factors, std::span<Complex> pressure) {
  for (std::size_t row = 0; row < matrix.foci; ++row) {
    double re = 0, im = 0;
    for (std::size_t column = 0; column < matrix.foci; ++column) {
      const Complex entry = matrix.at(row, column);
      re += entry.real() * factors[column].real() - entry.imag() * factors[column].imag();
      im += entry.real() * factors[column].imag() + entry.imag() * factors[column].real();
    }
    pressure[row] = {re, im};
  }
}

Complex bounded(const Complex& sum, Constraint constraint) {
  const double size = magnitude(sum);
  const bool full = constraint == Constraint::uniform || (constraint == Constraint::clamp && size > 1);
  return size > 0 && full ? sum / size : sum;
}

void hear_bounded(const Columns& columns, Constraint constraint, std::span<const Complex> factors,
                  std::span<Complex> pressure) {
  std::array<double, most_solved_foci> re{}, im{};
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const std::size_t first = n * columns.foci;
    const Complex drive = bounded(sum_of(columns, first, factors), constraint);
    const double x = drive.real(), y = drive.imag();
    for (std::size_t j = 0; j < columns.foci; ++j) {
      const double loud = columns.loud[first + j];
      re[j] += loud * (x * columns.cosine[first + j] - y * columns.sine[first + j]);
      im[j] += loud * (x * columns.sine[first + j] + y * columns.cosine[first + j]);
    }
  }
  for (std::size_t j = 0; j < columns.foci; ++j)
    pressure[j] = {re[j], im[j]};
}

}  // namespace palpa::array
