#include "acoustics/boundary/dense_lu.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <vector>

namespace palpa::acoustics {
namespace {

using Number = std::complex<float>;

std::ptrdiff_t threads() {
  std::ptrdiff_t count = 0;
  for (const auto& thread : std::filesystem::directory_iterator("/proc/self/task"))
    count += thread.is_directory();
  return count;
}

/// Large on the diagonal, so that it is far from singular.
std::vector<Number> matrix_of(std::size_t size) {
  std::vector<Number> matrix(size * size);
  for (std::size_t row = 0; row < size; ++row) {
    for (std::size_t column = 0; column < size; ++column) {
      const auto angle = static_cast<float>(7 * row + 3 * column * column);
      matrix[row * size + column] = std::polar(row == column ? static_cast<float>(size) : 1.0f, angle);
    }
  }
  return matrix;
}

// OpenBLAS starts a thread per core when it is loaded, or when its user requests threads.
TEST(DenseLu, SolvesWithoutThreadsOfTheLibrarys) {
  constexpr std::size_t size = 300;
  setenv("OPENBLAS_NUM_THREADS", "4", 1);
  const std::ptrdiff_t before = threads();
  const std::vector<Number> matrix = matrix_of(size);
  const DenseLu lu(matrix, size);
  std::vector<Number> right(size);
  for (std::size_t row = 0; row < size; ++row) {
    for (std::size_t column = 0; column < size; ++column)
      right[row] += matrix[row * size + column] * Number(static_cast<float>(column), 1);
  }
  lu.solve(Way::forth, right);
  EXPECT_EQ(threads(), before);
  for (std::size_t i = 0; i < size; ++i)
    EXPECT_LT(std::abs(right[i] - Number(static_cast<float>(i), 1)), 1e-2f) << i;
}

}  // namespace
}  // namespace palpa::acoustics
