#include "array/solvers/lower_peaks.hpp"

#include <algorithm>
#include <cmath>

#include "array/solvers/complex_system.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

void copy_row(const SplitRows& from, std::size_t row, SplitRows& to, std::size_t row_to) {
  std::copy_n(from.re.begin() + static_cast<std::ptrdiff_t>(row * from.stride), from.stride,
              to.re.begin() + static_cast<std::ptrdiff_t>(row_to * to.stride));
  std::copy_n(from.im.begin() + static_cast<std::ptrdiff_t>(row * from.stride), from.stride,
              to.im.begin() + static_cast<std::ptrdiff_t>(row_to * to.stride));
}

/// Fills `apart` and the products of its rows.
void prepare(const SplitRows& foci, const SplitRows& nulls, std::size_t null_rows, PeakScratch& scratch) {
  scratch.apart.reset(foci.rows, foci.transducers);
  scratch.products.resize(foci.rows * foci.rows);
  for (std::size_t j = 0; j < foci.rows; ++j) {
    copy_row(foci, j, scratch.apart, j);
    for (std::size_t i = 0; i < null_rows; ++i)
      add_row(-inner_product(foci, j, nulls, i), nulls, i, scratch.apart, j);
  }
  for (std::size_t j = 0; j < foci.rows; ++j) {
    for (std::size_t k = 0; k < foci.rows; ++k)
      scratch.products[j * foci.rows + k] = inner_product(scratch.apart, j, scratch.apart, k);
  }
}

void limit(double most, SplitRows& drive) {
  for (std::size_t n = 0; n < drive.stride; ++n) {
    const double size = std::sqrt(drive.re[n] * drive.re[n] + drive.im[n] * drive.im[n]);
    const double by = size > most ? most / size : 1;
    drive.re[n] *= by;
    drive.im[n] *= by;
  }
}

/// Moves to the nearest drive with the kept pressures.
void restore(const SplitRows& foci, const SplitRows& nulls, std::size_t null_rows, SplitRows& drive,
             PeakScratch& scratch) {
  for (std::size_t i = 0; i < null_rows; ++i)
    add_conjugate(-product(nulls, i, drive, 0), nulls, i, drive, 0);
  for (std::size_t j = 0; j < foci.rows; ++j)
    scratch.missing[j] = scratch.kept[j] - product(foci, j, drive, 0);
  scratch.system = scratch.products;
  solve_complex(scratch.system, scratch.missing);
  for (std::size_t j = 0; j < foci.rows; ++j)
    add_conjugate(scratch.missing[j], scratch.apart, j, drive, 0);
}

}  // namespace

double largest_of(const SplitRows& rows, std::size_t row) {
  double largest = 0;
  for (std::size_t n = 0; n < rows.transducers; ++n)
    largest = std::max(largest, std::norm(rows.at(row, n)));
  return std::sqrt(largest);
}

double lower_peaks(const SplitRows& foci, const SplitRows& nulls, std::size_t null_rows, SplitRows& drive,
                   PeakScratch& scratch) {
  prepare(foci, nulls, null_rows, scratch);
  scratch.kept.resize(foci.rows);
  scratch.missing.resize(foci.rows);
  for (std::size_t j = 0; j < foci.rows; ++j)
    scratch.kept[j] = product(foci, j, drive, 0);
  double largest = largest_of(drive, 0);
  scratch.next.reset(1, drive.transducers);
  for (std::uint32_t step = 0; step < peak_steps; ++step) {
    copy_row(drive, 0, scratch.next, 0);
    limit(peak_part * largest, scratch.next);
    restore(foci, nulls, null_rows, scratch.next, scratch);
    const double then = largest_of(scratch.next, 0);
    if (!(then < largest)) break;
    largest = then;
    copy_row(scratch.next, 0, drive, 0);
  }
  return largest;
}

}  // namespace palpa::array
