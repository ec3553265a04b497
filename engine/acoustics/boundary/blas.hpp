// OpenBLAS, loaded when the first matrix is factored. Nothing else needs it, and loading it is expensive: it
// immediately starts a thread per core. Each thread busy-waits at first, and does not end if memory is short.
#pragma once

#include <complex>
#include <cstddef>

namespace palpa::acoustics {

/// The functions that palpa uses. All are column-major; LAPACK's functions take pointers and count from 1.
struct Blas {
  using Number = std::complex<float>;

  void (*cgemm)(int order, int left_transposed, int right_transposed, int rows, int columns, int inner,
                const void* factor, const void* left, int left_stride, const void* right, int right_stride,
                const void* factor_before, void* result, int result_stride);
  void (*ctrsm)(int order, int side, int upper_or_lower, int transposed, int unit, int rows, int columns,
                const void* factor, const void* triangle, int triangle_stride, void* right, int right_stride);
  void (*cgetrf)(const int* rows, const int* columns, Number* matrix, const int* stride, int* pivots, int* info);
  void (*cgetrs)(const char* transposed, const int* rows, const int* columns, const Number* factors, const int* stride,
                 const int* pivots, Number* right, const int* right_stride, int* info);
  void (*claswp)(const int* columns, Number* matrix, const int* stride, const int* first, const int* last,
                 const int* pivots, const int* step);
};

/// Loads the library on the first call, without its own threads. After that, up to `threads` threads may call its
/// functions at a time. Throws failure() if there is no OpenBLAS, or not enough memory for each of these threads: the
/// library itself would retry the allocation for ever.
const Blas& blas(std::size_t threads);

}  // namespace palpa::acoustics
