#include "array/transfer.hpp"

namespace palpa::array {

void multiply(const Columns& columns, FocusMatrix& matrix) {
  const std::size_t foci = columns.foci;
  matrix.foci = foci;
  matrix.re.assign(foci * foci, 0);
  matrix.im.assign(foci * foci, 0);
  for (std::size_t n = 0; n < columns.transducers; ++n) {
    const double* const cosine = &columns.cosine[n * foci];
    const double* const sine = &columns.sine[n * foci];
    const double* const loud = &columns.loud[n * foci];
    for (std::size_t column = 0; column < foci; ++column) {
      const double re = columns.asked[n * foci + column] * cosine[column];
      const double im = -columns.asked[n * foci + column] * sine[column];
      double* const real = &matrix.re[column * foci];
      double* const imaginary = &matrix.im[column * foci];
      for (std::size_t row = 0; row < foci; ++row) {
        real[row] += loud[row] * (cosine[row] * re - sine[row] * im);
        imaginary[row] += loud[row] * (cosine[row] * im + sine[row] * re);
      }
    }
  }
}

}  // namespace palpa::array
