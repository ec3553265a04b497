#include "acoustics/compressed/square_factors.hpp"

#include <algorithm>

#include "acoustics/boundary/blas.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

using Number = std::complex<float>;

const Blas& blas_for(std::size_t squares) {
  return blas(std::clamp<std::size_t>(squares, 1, worker_count()));
}

}  // namespace

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

}  // namespace palpa::acoustics
