// The solver of the fast operator. test_fast_operator.cpp checks the solutions.
#include "acoustics/compressed/block_gmres.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstdint>
#include <random>
#include <vector>

#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;

/// A dense system in doubles, and vectors as the solver has them.
class System {
 public:
  System(std::size_t size, double diagonal, std::uint32_t seed) : size_(size), matrix_(size * size) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    for (Complex& entry : matrix_)
      entry = Complex(normal(random), normal(random)) / std::sqrt(2.0 * static_cast<double>(size));
    for (std::size_t i = 0; i < size; ++i)
      matrix_[i * size + i] += diagonal;
  }
  std::size_t stride() const { return (size_ + split_lanes - 1) / split_lanes * split_lanes; }
  Complex& at(std::size_t row, std::size_t column) { return matrix_[row * size_ + column]; }

  VectorMap map() const {
    return [this](const SplitVectors& x, std::size_t count, const SplitVectors& y) {
      for (std::size_t v = 0; v < count; ++v) {
        std::fill_n(y.of + 2 * y.stride * v, 2 * y.stride, 0.0F);
        for (std::size_t row = 0; row < size_; ++row) {
          Complex sum = 0;
          for (std::size_t column = 0; column < size_; ++column)
            sum += matrix_[row * size_ + column] * get(x, v, column);
          y.of[2 * y.stride * v + row] = static_cast<float>(sum.real());
          y.of[2 * y.stride * v + y.stride + row] = static_cast<float>(sum.imag());
        }
      }
    };
  }
  static Complex get(const SplitVectors& x, std::size_t v, std::size_t row) {
    return {static_cast<double>(x.of[2 * x.stride * v + row]),
            static_cast<double>(x.of[2 * x.stride * v + x.stride + row])};
  }

 private:
  std::size_t size_;
  std::vector<Complex> matrix_;
};

const VectorMap same = [](const SplitVectors& x, std::size_t count, const SplitVectors& y) {
  std::copy_n(x.of, 2 * x.stride * count, y.of);
};

std::vector<float> vectors(std::size_t size, std::size_t stride, std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  std::vector<float> of(2 * stride * count);
  for (std::size_t v = 0; v < 2 * count; ++v) {
    for (std::size_t i = 0; i < size; ++i)
      of[stride * v + i] = normal(random);
  }
  return of;
}

TEST(BlockGmres, NeedsFewerIterationsTogetherAndAfterPreconditioning) {
  constexpr std::size_t size = 150;
  const System system(size, 1.3, 1);
  const std::size_t stride = system.stride();
  std::vector<float> b = vectors(size, stride, 10, 7), x(b.size());
  const auto iterations = [&](const VectorMap& precondition, std::size_t count) {
    return block_gmres(system.map(), precondition, {b.data(), stride}, count, {x.data(), stride}, {}).iterations;
  };
  EXPECT_LT(iterations(same, 10), iterations(same, 1));
  // A few steps of the solver itself are close to the inverse.
  const VectorMap close = [&](const SplitVectors& right, std::size_t count, const SplitVectors& solution) {
    GmresSetting rough;
    rough.tolerance = 0.05;
    block_gmres(system.map(), same, right, count, solution, rough);
  };
  EXPECT_LT(2 * iterations(close, 1), iterations(same, 1));
}

TEST(BlockGmres, TakesDependentAndEmptyRightHandSides) {
  constexpr std::size_t size = 90;
  const System system(size, 2, 3);
  const std::size_t stride = system.stride();
  std::vector<float> b = vectors(size, stride, 4, 7), x(b.size());
  // The second is i times the first, the third is nothing, the fourth the sum of the first two.
  for (std::size_t i = 0; i < stride; ++i) {
    b[2 * stride + i] = -b[stride + i];
    b[3 * stride + i] = b[i];
    b[4 * stride + i] = b[5 * stride + i] = 0;
    b[6 * stride + i] = b[i] + b[2 * stride + i];
    b[7 * stride + i] = b[stride + i] + b[3 * stride + i];
  }
  const SolveReport report = block_gmres(system.map(), same, {b.data(), stride}, 4, {x.data(), stride}, {});
  EXPECT_LE(report.residual, GmresSetting{}.tolerance);
  for (std::size_t i = 0; i < size; ++i) {
    const Complex first = System::get({x.data(), stride}, 0, i);
    EXPECT_LE(std::abs(System::get({x.data(), stride}, 1, i) - Complex(0, 1) * first), 1e-3);
    EXPECT_EQ(System::get({x.data(), stride}, 2, i), Complex(0));
    EXPECT_LE(std::abs(System::get({x.data(), stride}, 3, i) - Complex(1, 1) * first), 2e-3);
  }
  std::fill(b.begin(), b.end(), 0.0F);
  const SolveReport nothing = block_gmres(system.map(), same, {b.data(), stride}, 4, {x.data(), stride}, {});
  EXPECT_EQ(nothing.iterations, 0u);
  EXPECT_EQ(nothing.residual, 0);
}

TEST(BlockGmres, StartsAgainWhenItsMemoryIsFull) {
  constexpr std::size_t size = 150;
  const System system(size, 2, 1);
  const std::size_t stride = system.stride();
  std::vector<float> b = vectors(size, stride, 3, 7), x(b.size());
  GmresSetting setting;
  setting.most_directions = 18;
  const SolveReport report = block_gmres(system.map(), same, {b.data(), stride}, 3, {x.data(), stride}, setting);
  EXPECT_LE(report.residual, setting.tolerance);
  // After five iterations there are eighteen directions.
  EXPECT_GT(report.iterations, 5u);
}

TEST(BlockGmres, ReportsTheResidualWhereThereIsNoSolution) {
  constexpr std::size_t size = 64;
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE(seed);
    System system(size, 0, seed);
    for (std::size_t i = 0; i < size; ++i)
      system.at(0, i) = 0;  // nothing reaches the first row
    const std::size_t stride = system.stride();
    std::vector<float> b(2 * stride), x(2 * stride);
    b[0] = 3;
    b[1] = 4;
    const SolveReport report = block_gmres(system.map(), same, {b.data(), stride}, 1, {x.data(), stride}, {});
    EXPECT_NEAR(report.residual, 0.6, 0.01);
    EXPECT_LE(report.iterations, GmresSetting{}.most_iterations);
    // The solution is the one whose residual is reported.
    std::vector<float> image(2 * stride);
    system.map()({x.data(), stride}, 1, {image.data(), stride});
    double left = 0;
    for (std::size_t i = 0; i < 2 * stride; ++i)
      left += std::pow(static_cast<double>(b[i] - image[i]), 2);
    EXPECT_NEAR(std::sqrt(left) / 5, report.residual, 1e-4);
  }
}

TEST(BlockGmres, IsGivenUp) {
  const System system(32, 2, 1);
  std::vector<float> b = vectors(32, 32, 1, 7), x(b.size());
  const std::atomic<bool> stop = true;
  EXPECT_THROW(block_gmres(system.map(), same, {b.data(), 32}, 1, {x.data(), 32}, {}, &stop), GivenUp);
}

}  // namespace
}  // namespace palpa::acoustics
