#include "acoustics/compressed/fast_operator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <limits>
#include <vector>

#include "acoustics/boundary/blas.hpp"
#include "acoustics/boundary/galerkin.hpp"
#include "acoustics/compressed/block_gmres.hpp"
#include "acoustics/compressed/hierarchical_matrix.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

/// Factors of squares along a matrix' diagonal: an approximate inverse of the whole matrix.
class SquareFactors {
 public:
  /// The squares are the largest clusters of at most `most` vertices each. The same bytes for any number of threads.
  /// Throws failure() if a square is singular, GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
  SquareFactors(const HierarchicalMatrix& matrix, std::uint32_t most, const std::atomic<bool>* give_up = nullptr);

  /// Replaces `count` vectors y, in the matrix' order, by the squares' inverses (or transposed inverses) times x.
  void solve(Way way, const SplitVectors& x, std::size_t count, const SplitVectors& y) const;

 private:
  struct Square {
    HierarchicalMatrix::Square place;
    std::vector<std::complex<float>> factors;  // of the transposed matrix: LAPACK is column-major
    std::vector<int> pivots;
  };
  std::vector<Square> squares_;
};

using Number = std::complex<float>;

const Blas& blas_for(std::size_t squares) {
  return blas(std::clamp<std::size_t>(squares, 1, worker_count()));
}

SquareFactors::SquareFactors(const HierarchicalMatrix& matrix, std::uint32_t most, const std::atomic<bool>* give_up) {
  for (const HierarchicalMatrix::Square& place : matrix.squares(most))
    squares_.push_back({place, {}, {}});
  const Blas& call = blas_for(squares_.size());
  parallel_chunks(squares_.size(), 1, [&](std::size_t at, std::size_t, std::size_t) {
    stop_if(give_up);
    Square& square = squares_[at];
    square.factors = matrix.entries(square.place);
    const int size = static_cast<int>(square.place.end - square.place.begin);
    square.pivots.resize(static_cast<std::size_t>(size));
    int info = 0;
    call.cgetrf(&size, &size, square.factors.data(), &size, square.pivots.data(), &info);
    if (info != 0) throw failure("The matrix of the surface is singular");
  });
}

void SquareFactors::solve(Way way, const SplitVectors& x, std::size_t count, const SplitVectors& y) const {
  const Blas& call = blas_for(squares_.size());
  const char transposed = way == Way::forth ? 'T' : 'N';
  parallel_chunks(squares_.size(), 1, [&](std::size_t at, std::size_t, std::size_t) {
    const Square& square = squares_[at];
    const std::size_t size = square.place.end - square.place.begin;
    thread_local std::vector<Number> columns;
    columns.resize(size * count);
    for (std::size_t v = 0; v < count; ++v) {
      const float* const from = x.of + 2 * x.stride * v + square.place.begin;
      for (std::size_t i = 0; i < size; ++i)
        columns[v * size + i] = {from[i], from[x.stride + i]};
    }
    const int n = static_cast<int>(size), rights = static_cast<int>(count);
    int info = 0;
    call.cgetrs(&transposed, &n, &rights, square.factors.data(), &n, square.pivots.data(), columns.data(), &n, &info);
    for (std::size_t v = 0; v < count; ++v) {
      float* const to = y.of + 2 * y.stride * v + square.place.begin;
      for (std::size_t i = 0; i < size; ++i) {
        to[i] = columns[v * size + i].real();
        to[y.stride + i] = columns[v * size + i].imag();
      }
    }
  });
}

/// Errors of the compressed blocks and residuals. Pressures then differ by about 0.05 % from those of the dense matrix.
constexpr double block_tolerance = 5e-4, residual_tolerance = 5e-5;
/// Larger squares save few iterations, and cost more in each.
constexpr std::uint32_t square_size = 256;
/// Right-hand sides that are solved at once: more take more memory, and hardly less time for each.
constexpr std::size_t together = 16;

class FastOperator : public SurfaceOperator {
 public:
  FastOperator(const Patches& body, double wave_number, const std::atomic<bool>* give_up)
      : matrix_(body, wave_number, block_tolerance, give_up), inverse_(matrix_, square_size, give_up) {}

  std::size_t unknowns() const override { return matrix_.order().size(); }
  bool iterates() const override { return true; }

  SolveReport solve(Way way, std::span<std::complex<float>> columns, const std::atomic<bool>* give_up) const override {
    SolveReport worst;
    const std::size_t size = unknowns();
    for (std::size_t first = 0; first < columns.size(); first += together * size) {
      const SolveReport report =
          solve_together(way, columns.subspan(first, std::min(together * size, columns.size() - first)), give_up);
      worst.iterations = std::max(worst.iterations, report.iterations);
      worst.residual = std::max(worst.residual, report.residual);
    }
    return worst;
  }

 private:
  SolveReport solve_together(Way way, std::span<std::complex<float>> columns, const std::atomic<bool>* give_up) const {
    const std::size_t size = unknowns(), stride = matrix_.stride(), count = columns.size() / size;
    std::vector<float> right(2 * stride * count), solution(2 * stride * count);
    std::vector<float> scales(count);
    for (std::size_t v = 0; v < count; ++v) {
      const auto column = columns.subspan(v * size, size);
      // Squares of large numbers would exceed the range of floats.
      for (const std::complex<float>& value : column) {
        const float loud = std::max(std::abs(value.real()), std::abs(value.imag()));
        const bool number = std::isfinite(value.real()) && std::isfinite(value.imag()) && std::isfinite(scales[v]);
        scales[v] = number ? std::max(scales[v], loud) : std::numeric_limits<float>::quiet_NaN();
      }
      // Sound that is not a number stays so: its solution is zero times that.
      const float factor = scales[v] > 0 && std::isfinite(1 / scales[v]) ? 1 / scales[v] : 0;
      if (factor == 0) continue;
      float* const to = &right[2 * stride * v];
      for (std::size_t i = 0; i < size; ++i) {
        to[i] = column[matrix_.order()[i]].real() * factor;
        to[stride + i] = column[matrix_.order()[i]].imag() * factor;
      }
    }
    GmresSetting setting;
    setting.tolerance = residual_tolerance;
    const auto multiply = [&](const SplitVectors& x, std::size_t vectors, const SplitVectors& y) {
      matrix_.multiply(way, x, vectors, y);
    };
    const auto precondition = [&](const SplitVectors& x, std::size_t vectors, const SplitVectors& y) {
      inverse_.solve(way, x, vectors, y);
    };
    const SolveReport report =
        block_gmres(multiply, precondition, {right.data(), stride}, count, {solution.data(), stride}, setting, give_up);
    if (report.residual > residual_tolerance) {
      throw failure(
          fmt::format("The sound on the surface did not converge: after {} iterations the residual is {:.1e}, and "
                      "should be {:.0e}; "
                      "a mesh with more even faces may help",
                      report.iterations, report.residual, residual_tolerance));
    }
    for (std::size_t v = 0; v < count; ++v) {
      const float* const from = &solution[2 * stride * v];
      for (std::size_t i = 0; i < size; ++i)
        columns[v * size + matrix_.order()[i]] = scales[v] * std::complex<float>(from[i], from[stride + i]);
    }
    return report;
  }

  HierarchicalMatrix matrix_;
  SquareFactors inverse_;
};

}  // namespace

std::unique_ptr<SurfaceOperator> make_fast_operator(const Patches& body, double wave_number,
                                                    const std::atomic<bool>* give_up) {
  return std::make_unique<FastOperator>(body, wave_number, give_up);
}

std::uint64_t fast_operator_bytes(const geometry::Mesh& body, double wave_number) {
  const std::uint64_t vertices = body.positions.size();
  const std::uint64_t vectors = GmresSetting{}.most_directions + 12 * together, square = square_size;
  return HierarchicalMatrix::expected_bytes(body, wave_number) + assembly_bytes(body) +
         vertices * (vectors + square) * sizeof(std::complex<float>);
}

}  // namespace palpa::acoustics
