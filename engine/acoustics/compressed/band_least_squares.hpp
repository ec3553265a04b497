// Least squares for a matrix that grows by columns, each with more rows than the last: the small problem within block
// GMRES.
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace palpa::acoustics {

/// The x_j that minimise |H x_j - g_j|, by Householder's reflections of the columns of H.
class BandLeastSquares {
 public:
  using Number = std::complex<double>;

  /// The right-hand sides g; missing entries are zero.
  explicit BandLeastSquares(std::vector<std::vector<Number>> rights);

  /// A further column of H; it has at least as many entries as there are columns. Missing entries are zero.
  void add(std::vector<Number> column);

  std::size_t columns() const { return columns_.size(); }
  /// |H x_j - g_j| of the best x_j.
  std::vector<double> residuals() const;
  /// The best x_j: entry [column * right-hand sides + j]. Columns that, in single
  /// precision, depend on those before get zero.
  std::vector<Number> solve() const;

 private:
  /// I - 2 v v^H, where v begins at this row.
  struct Reflection {
    std::size_t row;
    std::vector<Number> v;
    void apply(std::vector<Number>& to) const;
  };

  std::vector<std::vector<Number>> rights_, columns_;
  std::vector<Reflection> reflections_;
};

}  // namespace palpa::acoustics
