// OpenBLAS, loaded when the first matrix is factored. Nothing else needs it, and it is expensive to have: as soon as it
// is loaded it starts a thread per core, which waits busily at first, and which does not end where memory is short.
#pragma once

#include <complex>
#include <cstddef>

namespace palpa::acoustics {

/// What palpa calls of it. All by columns; LAPACK's functions take pointers and count from 1.
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

/// Loads the library on the first call, without threads of its own. From then on up to `threads` threads may call its
/// functions at a time. Throws failure() where there is no OpenBLAS, or not enough memory for what each of these
/// threads needs: the library itself would try for ever to get it.
const Blas& blas(std::size_t threads);

}  // namespace palpa::acoustics
