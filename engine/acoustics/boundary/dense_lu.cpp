#include "acoustics/boundary/dense_lu.hpp"

#include <cblas.h>

#include <algorithm>
#include <utility>

#include "acoustics/boundary/blas.hpp"
#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/system/parallel.hpp"

namespace palpa::acoustics {
namespace {

using Number = std::complex<float>;
constexpr std::size_t panel = 128;       // columns factored at a time
constexpr std::size_t tile = 256;        // remaining columns per thread
constexpr std::size_t few_columns = 16;  // right-hand sides per thread

/// blas() for as many threads as work on `chunks` chunks.
const Blas& blas_for(std::size_t chunks) {
  return blas(std::min<std::size_t>(worker_count(), std::max<std::size_t>(chunks, 1)));
}

}  // namespace

DenseLu::DenseLu(std::vector<Number> matrix, std::size_t size, const std::atomic<bool>* give_up)
    : size_(size), factors_(std::move(matrix)), pivots_(size) {
  const Blas& call = blas_for(chunk_count(size, tile));
  const auto n = static_cast<int>(size);
  Activity activity("factoring the matrix", size);
  for (std::size_t first = 0; first < size; first += panel) {
    stop_if(give_up);
    const std::size_t width = std::min(panel, size - first), next = first + width;
    Number* const corner = &factors_[first * size + first];
    const int tall = static_cast<int>(size - first), wide = static_cast<int>(width);
    int info = 0;
    call.cgetrf(&tall, &wide, corner, &n, &pivots_[first], &info);
    if (info != 0) throw failure("The matrix of the surface is singular");
    for (std::size_t i = first; i < next; ++i)
      pivots_[i] += static_cast<int>(first);
    const auto swap = [&](std::size_t from, std::size_t to) {
      const int count = static_cast<int>(to - from), top = static_cast<int>(first) + 1, last = static_cast<int>(next);
      const int step = 1;
      call.claswp(&count, &factors_[from * size], &n, &top, &last, pivots_.data(), &step);
    };
    if (first > 0) swap(0, first);
    parallel_chunks(size - next, tile, [&](std::size_t, std::size_t begin, std::size_t end) {
      stop_if(give_up);
      swap(next + begin, next + end);
      const Number one = 1, minus_one = -1;
      const int columns = static_cast<int>(end - begin);
      Number* const top = &factors_[(next + begin) * size + first];
      call.ctrsm(CblasColMajor, CblasLeft, CblasLower, CblasNoTrans, CblasUnit, wide, columns, &one, corner, n, top, n);
      call.cgemm(CblasColMajor, CblasNoTrans, CblasNoTrans, static_cast<int>(size - next), columns, wide, &minus_one,
                 corner + width, n, top, n, &one, top + width, n);
    });
    activity.reach(next);
  }
}

void DenseLu::solve(Way way, std::span<Number> columns) const {
  const auto n = static_cast<int>(size_);
  const Blas& call = blas_for(chunk_count(columns.size() / size_, few_columns));
  const char transposed = way == Way::forth ? 'T' : 'N';
  parallel_chunks(columns.size() / size_, few_columns, [&](std::size_t, std::size_t begin, std::size_t end) {
    const int count = static_cast<int>(end - begin);
    int info = 0;
    call.cgetrs(&transposed, &n, &count, factors_.data(), &n, pivots_.data(), &columns[begin * size_], &n, &info);
  });
}

}  // namespace palpa::acoustics
