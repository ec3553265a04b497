#include "acoustics/compressed/band_least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace palpa::acoustics {
namespace {

/// A diagonal entry below this part of the largest one is rounding: the columns come from vectors in single precision.
constexpr double dependent = 1e-5;

}  // namespace

BandLeastSquares::BandLeastSquares(std::vector<std::vector<Number>> rights) : rights_(std::move(rights)) {}

void BandLeastSquares::Reflection::apply(std::vector<Number>& to) const {
  if (v.empty() || to.size() <= row) return;
  if (to.size() < row + v.size()) to.resize(row + v.size());
  Number along = 0;
  for (std::size_t i = 0; i < v.size(); ++i)
    along += std::conj(v[i]) * to[row + i];
  along *= 2;
  for (std::size_t i = 0; i < v.size(); ++i)
    to[row + i] -= along * v[i];
}

void BandLeastSquares::add(std::vector<Number> column) {
  const std::size_t row = columns_.size();
  column.resize(std::max(column.size(), row + 1));
  for (const Reflection& reflection : reflections_)
    reflection.apply(column);
  // Takes the part from `row` on to its first entry.
  Reflection reflection{row, {column.begin() + static_cast<std::ptrdiff_t>(row), column.end()}};
  const auto length = [](const std::vector<Number>& v) {
    double sum = 0;
    for (const Number& x : v)
      sum += std::norm(x);
    return std::sqrt(sum);
  };
  const double size = length(reflection.v), first = std::abs(column[row]);
  const Number turn = first > 0 ? column[row] / first : 1.0;
  reflection.v[0] += turn * size;
  const double whole = length(reflection.v);
  if (whole > 0) {
    for (Number& x : reflection.v)
      x /= whole;
  } else {
    reflection.v.clear();
  }
  reflection.apply(column);
  for (std::vector<Number>& right : rights_) {
    right.resize(std::max(right.size(), row + reflection.v.size()));
    reflection.apply(right);
  }
  reflections_.push_back(std::move(reflection));
  columns_.push_back(std::move(column));
}

std::vector<double> BandLeastSquares::residuals() const {
  std::vector<double> left;
  for (const std::vector<Number>& right : rights_) {
    double sum = 0;
    for (std::size_t i = columns_.size(); i < right.size(); ++i)
      sum += std::norm(right[i]);
    left.push_back(std::sqrt(sum));
  }
  return left;
}

std::vector<BandLeastSquares::Number> BandLeastSquares::solve() const {
  const std::size_t size = columns_.size(), count = rights_.size();
  double most = 0;
  for (std::size_t c = 0; c < size; ++c)
    most = std::max(most, std::abs(columns_[c][c]));
  std::vector<Number> x(size * count);
  for (std::size_t j = 0; j < count; ++j) {
    std::vector<Number> right = rights_[j];
    right.resize(std::max(right.size(), size));
    for (std::size_t c = size; c-- > 0;) {
      if (!(std::abs(columns_[c][c]) > dependent * most)) continue;
      const Number value = right[c] / columns_[c][c];
      x[c * count + j] = value;
      for (std::size_t i = 0; i < c; ++i)
        right[i] -= value * columns_[c][i];
    }
  }
  return x;
}

}  // namespace palpa::acoustics
