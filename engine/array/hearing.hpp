// What foci hear: of factors through the small matrix, and of bounded transducers over the whole array.
#pragma once

#include "array/even_out.hpp"
#include "array/transfer.hpp"

namespace palpa::array {

/// p = R c: what sounds where amplitudes are in proportion to the sums.
class MatrixHearing final : public Hearing {
 public:
  explicit MatrixHearing(const FocusMatrix& matrix) : matrix_(matrix) {}
  void hear(std::span<const std::complex<double>> factors, std::span<std::complex<double>> pressure) const override;
  void slope(std::span<const std::complex<double>> factors, std::span<const std::complex<double>> pressure,
             std::span<std::complex<double>> slopes) const override;

 private:
  const FocusMatrix& matrix_;
};

/// p = G x with x = s / max(|s|, bound) and s = B c: sums above `bound` become 1 and move across their own direction
/// only, the others are in proportion. The bound 1 is `clamp`, 0 is `uniform`.
class BoundedHearing final : public Hearing {
 public:
  BoundedHearing(const Columns& columns, double bound) : columns_(columns), bound_(bound) {}
  void hear(std::span<const std::complex<double>> factors, std::span<std::complex<double>> pressure) const override;
  void slope(std::span<const std::complex<double>> factors, std::span<const std::complex<double>> pressure,
             std::span<std::complex<double>> slopes) const override;

 private:
  const Columns& columns_;
  double bound_;
};

}  // namespace palpa::array
