#include "array/field/split_rows.hpp"

#include <cassert>
#include <cstring>

#include "base/lanes.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

/// One row's entries.
struct Row {
  const double *re, *im;
};
struct RowOut {
  double *re, *im;
};

/// Sums of the products of real parts, of imaginary parts, and of the two mixed kinds.
struct Products {
  double re_re = 0, im_im = 0, re_im = 0, im_re = 0;
};

[[gnu::always_inline]] inline Products multiply(const Row& a, const Row& b, std::size_t count) {
  Four rr[2]{}, ii[2]{}, ri[2]{}, ir[2]{};
  for (std::size_t n = 0; n < count; n += 8) {
    for (std::size_t k = 0; k < 2; ++k) {
      const Four a_re = four(a.re + n + 4 * k), a_im = four(a.im + n + 4 * k);
      const Four b_re = four(b.re + n + 4 * k), b_im = four(b.im + n + 4 * k);
      rr[k] += a_re * b_re;
      ii[k] += a_im * b_im;
      ri[k] += a_re * b_im;
      ir[k] += a_im * b_re;
    }
  }
  return {total(rr[0] + rr[1]), total(ii[0] + ii[1]), total(ri[0] + ri[1]), total(ir[0] + ir[1])};
}

/// `sign` 1: adds the row; -1: its conjugate.
[[gnu::always_inline]] inline void add(Complex factor, double sign, const Row& from, const RowOut& to,
                                       std::size_t count) {
  const double x = factor.real(), y = factor.imag();
  for (std::size_t n = 0; n < count; ++n) {
    const double re = from.re[n], im = sign * from.im[n];
    to.re[n] += x * re - y * im;
    to.im[n] += x * im + y * re;
  }
}

Row row_of(const SplitRows& rows, std::size_t row) {
  return {rows.re.data() + row * rows.stride, rows.im.data() + row * rows.stride};
}
RowOut row_of(SplitRows& rows, std::size_t row) {
  return {rows.re.data() + row * rows.stride, rows.im.data() + row * rows.stride};
}

Products products_of(const SplitRows& a, std::size_t row_a, const SplitRows& b, std::size_t row_b) {
  assert(a.stride == b.stride && row_a < a.rows && row_b < b.rows);
  return in_lanes([&](auto) PALPA_INLINED { return multiply(row_of(a, row_a), row_of(b, row_b), a.stride); });
}
void add_signed(Complex factor, double sign, const SplitRows& from, std::size_t row_from, SplitRows& to,
                std::size_t row_to) {
  assert(from.stride == to.stride && row_from < from.rows && row_to < to.rows);
  const Row row = row_of(from, row_from);
  const RowOut sum = row_of(to, row_to);
  in_lanes([&](auto) PALPA_INLINED { add(factor, sign, row, sum, to.stride); });
}

/// `sign` 1: in phase with the arriving pressure; -1: conjugate.
void split(const Columns& columns, const std::vector<double>& sizes, double sign, SplitRows& rows) {
  rows.reset(columns.foci, columns.transducers);
  for (std::size_t j = 0; j < columns.foci; ++j) {
    const RowOut row = row_of(rows, j);
    for (std::size_t n = 0; n < columns.transducers; ++n) {
      const std::size_t entry = n * columns.foci + j;
      row.re[n] = sizes[entry] * columns.cosine[entry];
      row.im[n] = sign * sizes[entry] * columns.sine[entry];
    }
  }
}

}  // namespace

void SplitRows::reset(std::size_t row_count, std::size_t transducer_count) {
  rows = row_count;
  transducers = transducer_count;
  stride = (transducer_count + 7) / 8 * 8;
  re.assign(rows * stride, 0);
  im.assign(rows * stride, 0);
}

void split_sounds(const Columns& columns, SplitRows& sounds) {
  split(columns, columns.loud, 1, sounds);
}
void split_asked(const Columns& columns, SplitRows& asked) {
  split(columns, columns.asked, -1, asked);
}

Complex product(const SplitRows& a, std::size_t row_a, const SplitRows& b, std::size_t row_b) {
  const Products sums = products_of(a, row_a, b, row_b);
  return {sums.re_re - sums.im_im, sums.re_im + sums.im_re};
}

Complex inner_product(const SplitRows& a, std::size_t row_a, const SplitRows& b, std::size_t row_b) {
  const Products sums = products_of(a, row_a, b, row_b);
  return {sums.re_re + sums.im_im, sums.im_re - sums.re_im};
}

void add_row(Complex factor, const SplitRows& from, std::size_t row_from, SplitRows& to, std::size_t row_to) {
  add_signed(factor, 1, from, row_from, to, row_to);
}
void add_conjugate(Complex factor, const SplitRows& from, std::size_t row_from, SplitRows& to, std::size_t row_to) {
  add_signed(factor, -1, from, row_from, to, row_to);
}

}  // namespace palpa::array
