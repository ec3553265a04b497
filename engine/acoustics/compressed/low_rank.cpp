#include "acoustics/compressed/low_rank.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>

#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;

/// The number of further rows that must agree with the product before it is accepted. A row may vanish on one part of
/// the columns only because the surface is flat there.
constexpr std::size_t checked_rows = 2;

/// A split matrix that grows by columns.
class Growing {
 public:
  Growing(std::size_t rows, std::vector<float>& of) : stride_(split_stride(rows)), of_(of) { of_.clear(); }
  std::size_t stride() const { return stride_; }
  /// A further column: zero.
  float* grow() {
    of_.resize(of_.size() + 2 * stride_);
    return &of_[of_.size() - 2 * stride_];
  }
  void shrink() { of_.resize(of_.size() - 2 * stride_); }
  const float* column(std::size_t c) const { return &of_[2 * stride_ * c]; }
  /// column += the first `count` columns times minus the entries of another matrix' row.
  void subtract(std::size_t count, const Growing& other, std::size_t row, std::vector<float>& factors,
                float* column) const {
    factors.resize(2 * count);
    for (std::size_t c = 0; c < count; ++c) {
      factors[2 * c] = -other.column(c)[row];
      factors[2 * c + 1] = -other.column(c)[other.stride_ + row];
    }
    if (count > 0) add_columns({of_.data(), stride_, count, stride_}, factors.data(), 1, {column, stride_});
  }
  /// Dot products of the first `count` columns, conjugated, with another.
  void dots(std::size_t count, const float* column, std::vector<float>& conjugate, std::vector<float>& factors) const {
    conjugate.assign(column, column + 2 * stride_);
    for (std::size_t i = stride_; i < 2 * stride_; ++i)
      conjugate[i] = -conjugate[i];
    factors.resize(2 * count);
    if (count > 0) dot_columns({of_.data(), stride_, count, stride_}, {conjugate.data(), stride_}, 1, factors.data());
  }

 private:
  std::size_t stride_;
  std::vector<float>& of_;
};

double norm2(const float* column, std::size_t stride) {
  double sum = 0;
  for (std::size_t i = 0; i < 2 * stride; ++i)
    sum += static_cast<double>(column[i]) * static_cast<double>(column[i]);
  return sum;
}

/// The largest entry among those that were not used; the number of entries if all were.
std::size_t largest(const float* column, std::size_t stride, const std::vector<std::uint8_t>& used) {
  std::size_t best = used.size();
  float most = -1;
  for (std::size_t i = 0; i < used.size(); ++i) {
    const float size = column[i] * column[i] + column[stride + i] * column[stride + i];
    if (used[i] || size <= most) continue;
    most = size;
    best = i;
  }
  return best;
}

/// A row that was not used, far from those that were asked for before.
std::size_t other_row(const std::vector<std::uint8_t>& used, std::size_t asked) {
  // Steps by the golden section come near every row.
  const auto start = static_cast<std::size_t>(std::fmod(0.381966 + 0.618034 * static_cast<double>(asked), 1.0) *
                                              static_cast<double>(used.size()));
  for (std::size_t i = 0; i < used.size(); ++i) {
    const std::size_t row = (start + i) % used.size();
    if (!used[row]) return row;
  }
  return used.size();
}

}  // namespace

bool approximate(const MatrixEntries& entries, const ClusterPatches& rows, const ClusterPatches& columns,
                 double tolerance, std::size_t most, LowRank& out, const std::atomic<bool>* give_up) {
  thread_local std::vector<float> factors, more_factors, conjugate;
  Growing left(rows.size, out.left), right(columns.size, out.right);
  std::vector<std::uint8_t> row_used(rows.size), column_used(columns.size);
  out.rank = 0;
  double sum2 = 0;  // squared norm of the product
  std::size_t asked = 0, agreed = 0;
  std::size_t row = other_row(row_used, asked++);
  while (row < rows.size) {
    stop_if(give_up);
    row_used[row] = 1;
    float* const v = right.grow();
    entries.row(rows.begin + static_cast<std::uint32_t>(row), columns, {v, v + right.stride()});
    right.subtract(out.rank, left, row, factors, v);
    const double v2 = norm2(v, right.stride());
    const std::size_t column = largest(v, right.stride(), column_used);
    // The rows together would have this squared norm.
    const bool agrees = v2 * static_cast<double>(rows.size) <= tolerance * tolerance * sum2 || v2 == 0;
    if (agrees || column == columns.size) {
      right.shrink();
      if (++agreed >= checked_rows) return true;
      row = other_row(row_used, asked++);
      continue;
    }
    agreed = 0;
    if (out.rank == most) return false;
    column_used[column] = 1;
    const Complex pivot(static_cast<double>(v[column]), static_cast<double>(v[right.stride() + column]));
    const std::complex<float> scale(1.0 / pivot);
    for (std::size_t i = 0; i < right.stride(); ++i) {
      const std::complex<float> value = std::complex<float>(v[i], v[right.stride() + i]) * scale;
      v[i] = value.real();
      v[right.stride() + i] = value.imag();
    }
    float* const u = left.grow();
    entries.column(columns.begin + static_cast<std::uint32_t>(column), rows, {u, u + left.stride()});
    left.subtract(out.rank, right, column, factors, u);
    const double u2 = norm2(u, left.stride()), step2 = u2 * norm2(v, right.stride());
    left.dots(out.rank, u, conjugate, factors);
    right.dots(out.rank, v, conjugate, more_factors);
    for (std::size_t c = 0; c < out.rank; ++c) {
      sum2 += 2 * (static_cast<double>(factors[2 * c]) * static_cast<double>(more_factors[2 * c]) -
                   static_cast<double>(factors[2 * c + 1]) * static_cast<double>(more_factors[2 * c + 1]));
    }
    sum2 += step2;
    ++out.rank;
    row = step2 <= tolerance * tolerance * sum2 ? other_row(row_used, asked++) : largest(u, left.stride(), row_used);
  }
  return true;
}

}  // namespace palpa::acoustics
