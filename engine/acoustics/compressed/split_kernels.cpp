#include "acoustics/compressed/split_kernels.hpp"

#include "acoustics/lanes.hpp"

namespace palpa::acoustics {
namespace {

/// `columns` columns from `first` on, for `vectors` vectors from `vector` on.
template <class L, std::size_t columns, std::size_t vectors>
[[gnu::always_inline]] inline void add_tile(const SplitMatrix& m, std::size_t first, const float* factors,
                                            std::size_t count, std::size_t vector, const SplitVectors& y) {
  using Float = typename L::Float;
  const float* f[columns];
  const float* column[columns];
  for (std::size_t c = 0; c < columns; ++c) {
    f[c] = factors + 2 * ((first + c) * count + vector);
    column[c] = m.of + 2 * m.stride * (first + c);
  }
  for (std::size_t row = 0; row < m.rows; row += L::width) {
    Float re[vectors], im[vectors];
    for (std::size_t v = 0; v < vectors; ++v) {
      re[v] = load_lanes<L>(y.of + 2 * y.stride * (vector + v) + row);
      im[v] = load_lanes<L>(y.of + 2 * y.stride * (vector + v) + y.stride + row);
    }
    for (std::size_t c = 0; c < columns; ++c) {
      const Float a = load_lanes<L>(column[c] + row), b = load_lanes<L>(column[c] + m.stride + row);
      for (std::size_t v = 0; v < vectors; ++v) {
        re[v] += a * f[c][2 * v];
        re[v] -= b * f[c][2 * v + 1];
        im[v] += a * f[c][2 * v + 1];
        im[v] += b * f[c][2 * v];
      }
    }
    for (std::size_t v = 0; v < vectors; ++v) {
      store_lanes<L>(re[v], y.of + 2 * y.stride * (vector + v) + row);
      store_lanes<L>(im[v], y.of + 2 * y.stride * (vector + v) + y.stride + row);
    }
  }
}

template <class L>
[[gnu::always_inline]] inline float lane_sum(const typename L::Float& value) {
  float total = 0;
  for (int lane = 0; lane < L::width; ++lane)
    total += value[lane];
  return total;
}

template <class L, std::size_t columns, std::size_t vectors>
[[gnu::always_inline]] inline void dot_tile(const SplitMatrix& m, std::size_t first, const SplitVectors& x,
                                            std::size_t count, std::size_t vector, float* factors) {
  using Float = typename L::Float;
  const float* column[columns];
  for (std::size_t c = 0; c < columns; ++c)
    column[c] = m.of + 2 * m.stride * (first + c);
  Float re[columns][vectors] = {}, im[columns][vectors] = {};
  for (std::size_t row = 0; row < m.rows; row += L::width) {
    Float x_re[vectors], x_im[vectors];
    for (std::size_t v = 0; v < vectors; ++v) {
      x_re[v] = load_lanes<L>(x.of + 2 * x.stride * (vector + v) + row);
      x_im[v] = load_lanes<L>(x.of + 2 * x.stride * (vector + v) + x.stride + row);
    }
    for (std::size_t c = 0; c < columns; ++c) {
      const Float a = load_lanes<L>(column[c] + row), b = load_lanes<L>(column[c] + m.stride + row);
      for (std::size_t v = 0; v < vectors; ++v) {
        re[c][v] += a * x_re[v];
        re[c][v] -= b * x_im[v];
        im[c][v] += a * x_im[v];
        im[c][v] += b * x_re[v];
      }
    }
  }
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t v = 0; v < vectors; ++v) {
      factors[2 * ((first + c) * count + vector + v)] = lane_sum<L>(re[c][v]);
      factors[2 * ((first + c) * count + vector + v) + 1] = lane_sum<L>(im[c][v]);
    }
  }
}

template <class L, std::size_t vectors>
[[gnu::always_inline]] inline void add_vectors(const SplitMatrix& m, const float* factors, std::size_t count,
                                               std::size_t vector, const SplitVectors& y) {
  std::size_t c = 0;
  for (; c + 4 <= m.columns; c += 4)
    add_tile<L, 4, vectors>(m, c, factors, count, vector, y);
  for (; c < m.columns; ++c)
    add_tile<L, 1, vectors>(m, c, factors, count, vector, y);
}

template <class L, std::size_t vectors>
[[gnu::always_inline]] inline void dot_vectors(const SplitMatrix& m, const SplitVectors& x, std::size_t count,
                                               std::size_t vector, float* factors) {
  std::size_t c = 0;
  for (; c + 4 <= m.columns; c += 4)
    dot_tile<L, 4, vectors>(m, c, x, count, vector, factors);
  for (; c < m.columns; ++c)
    dot_tile<L, 1, vectors>(m, c, x, count, vector, factors);
}

template <class L>
[[gnu::always_inline]] inline void add_all(const SplitMatrix& m, const float* factors, std::size_t count,
                                           const SplitVectors& y) {
  std::size_t v = 0;
  for (; v + 2 <= count; v += 2)
    add_vectors<L, 2>(m, factors, count, v, y);
  if (v < count) add_vectors<L, 1>(m, factors, count, v, y);
}

template <class L>
[[gnu::always_inline]] inline void dot_all(const SplitMatrix& m, const SplitVectors& x, std::size_t count,
                                           float* factors) {
  std::size_t v = 0;
  for (; v + 2 <= count; v += 2)
    dot_vectors<L, 2>(m, x, count, v, factors);
  if (v < count) dot_vectors<L, 1>(m, x, count, v, factors);
}

}  // namespace

void add_columns(const SplitMatrix& m, const float* factors, std::size_t count, const SplitVectors& y) {
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { add_all<L>(m, factors, count, y); });
}

void dot_columns(const SplitMatrix& m, const SplitVectors& x, std::size_t count, float* factors) {
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { dot_all<L>(m, x, count, factors); });
}

}  // namespace palpa::acoustics
