// Complex rows with one entry per transducer, real and imaginary parts apart, so that compilers vectorise over the
// transducers. Every processor gives the same bits.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"

namespace palpa::array {

/// Rows begin at multiples of `stride`, a multiple of 8; entries beyond the last transducer are 0.
struct SplitRows {
  std::size_t rows = 0, transducers = 0, stride = 0;
  std::vector<double> re, im;

  /// Keeps its storage. All entries become 0.
  void reset(std::size_t row_count, std::size_t transducer_count);
  std::complex<double> at(std::size_t row, std::size_t transducer) const {
    return {re[row * stride + transducer], im[row * stride + transducer]};
  }
};

/// The two kinds of columns as rows: G, the sound of the transducers at each focus, and B, what each focus asks for.
void split_sounds(const Columns& columns, SplitRows& sounds);
void split_asked(const Columns& columns, SplitRows& asked);

/// sum over n of a_n b_n, and of a_n conj(b_n).
std::complex<double> product(const SplitRows& a, std::size_t row_a, const SplitRows& b, std::size_t row_b);
std::complex<double> inner_product(const SplitRows& a, std::size_t row_a, const SplitRows& b, std::size_t row_b);

/// to += factor * from, and to += factor * conj(from).
void add_row(std::complex<double> factor, const SplitRows& from, std::size_t row_from, SplitRows& to,
             std::size_t row_to);
void add_conjugate(std::complex<double> factor, const SplitRows& from, std::size_t row_from, SplitRows& to,
                   std::size_t row_to);

}  // namespace palpa::array
