#include "array/field/transfer.hpp"

#include "base/lanes.hpp"

namespace palpa::array {
namespace {

[[gnu::always_inline]] inline void add_all(const Columns& columns, double* __restrict matrix_re,
                                           double* __restrict matrix_im) {
  const std::size_t foci = columns.foci;
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const double* const cosine = &columns.cosine[n * foci];
    const double* const sine = &columns.sine[n * foci];
    const double* const loud = &columns.loud[n * foci];
    for (std::size_t column = 0; column < foci; ++column) {
      const double re = columns.asked[n * foci + column] * cosine[column];
      const double im = -columns.asked[n * foci + column] * sine[column];
      double* const real = matrix_re + column * foci;
      double* const imaginary = matrix_im + column * foci;
      for (std::size_t row = 0; row < foci; ++row) {
        real[row] += loud[row] * (cosine[row] * re - sine[row] * im);
        imaginary[row] += loud[row] * (cosine[row] * im + sine[row] * re);
      }
    }
  }
}

}  // namespace

void multiply(const Columns& columns, FocusMatrix& matrix) {
  matrix.foci = columns.foci;
  matrix.re.assign(columns.foci * columns.foci, 0);
  matrix.im.assign(columns.foci * columns.foci, 0);
  in_lanes([&](auto) PALPA_INLINED { add_all(columns, matrix.re.data(), matrix.im.data()); });
}

}  // namespace palpa::array
