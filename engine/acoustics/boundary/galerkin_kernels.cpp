#include "acoustics/boundary/galerkin_kernels.hpp"

#include <cmath>
#include <numbers>

#include "acoustics/lanes.hpp"

namespace palpa::acoustics {
namespace {

constexpr float quarter_of_pi_inverse = static_cast<float>(1 / (4 * std::numbers::pi));
constexpr float turn_inverse = static_cast<float>(1 / (2 * std::numbers::pi));

template <class L>
struct Complex {
  typename L::Float re{}, im{};
};

/// e^{ikl} / (4 pi R) from a length l and 1/R, and (ik - 1/R) / R times that.
template <class L>
[[gnu::always_inline]] inline void green_of(const typename L::Float& length, const typename L::Float& inverse, float k,
                                            Complex<L>& g, Complex<L>& d) {
  using Float = typename L::Float;
  Float sine, cosine;
  sine_cosine<L>(length * (k * turn_inverse), sine, cosine);
  const Float size = inverse * quarter_of_pi_inverse;
  g.re = size * cosine;
  g.im = size * sine;
  d.re = inverse * (-inverse * g.re - k * g.im);
  d.im = inverse * (k * g.re - inverse * g.im);
}

/// G = e^{ikR} / (4 pi R) from a squared distance, and D = (ik - 1/R) G / R: the gradient of G by y is D (y - x).
template <class L>
[[gnu::always_inline]] inline void green(const typename L::Float& r2, float k, Complex<L>& g, Complex<L>& d) {
  const typename L::Float inverse = inverse_root<L>(r2);
  green_of<L>(r2 * inverse, inverse, k, g, d);
}

/// Takes the sums of G times products of tangents, e[a][b] with a, b = u, v. Adds to `block` i/k times those of the hat
/// functions' surface curls, which are t_u - t_v, t_v and -t_u times the area.
template <class Value>
[[gnu::always_inline]] inline void add_curls(const Value (&e)[2][2][2], float k, Value (&block)[9][2]) {
  // i/k (a + ib) = (-b + ia) / k
  const float scale = 1 / k;
  for (int part = 0; part < 2; ++part) {
    const int from = 1 - part;
    const float sign = part == 0 ? -scale : scale;
    const Value uu = e[0][0][from] * sign, uv = e[0][1][from] * sign;
    const Value vu = e[1][0][from] * sign, vv = e[1][1][from] * sign;
    block[0][part] += uu - uv - vu + vv;
    block[1][part] += uv - vv;
    block[2][part] += vu - uu;
    block[3][part] += vu - vv;
    block[4][part] += vv;
    block[5][part] -= vu;
    block[6][part] += uv - uu;
    block[7][part] -= uv;
    block[8][part] += uu;
  }
}

template <class L>
[[gnu::always_inline]] inline void far_lanes_at(const FarPatch& test, const FarGroup& trial, float k, std::size_t lane,
                                                FarBlocks& out) {
  using Float = typename L::Float;
  Float block[9][2] = {};
  Float e[2][2][2] = {};
  for (int q = 0; q < 3; ++q) {
    const float(&x)[far_numbers] = test.of[q];
    // For this test sample: sums over the trial's samples, all of them and one by one.
    Float total_re{}, total_im{};
    Float own_re[3], own_im[3];
    Float tangent_re[2][3] = {}, tangent_im[2][3] = {};
    for (int p = 0; p < 3; ++p) {
      const auto& y = trial.of[p];
      const Float dx = load_lanes<L>(y[far_x] + lane) - x[far_x];
      const Float dy = load_lanes<L>(y[far_x + 1] + lane) - x[far_x + 1];
      const Float dz = load_lanes<L>(y[far_x + 2] + lane) - x[far_x + 2];
      const Float nx = load_lanes<L>(y[far_area] + lane), ny = load_lanes<L>(y[far_area + 1] + lane),
                  nz = load_lanes<L>(y[far_area + 2] + lane);
      Complex<L> g, d;
      green<L>(dx * dx + dy * dy + dz * dz, k, g, d);
      // -K - i/k * k^2 n.n' G, the latter being -i k (n.n') G
      const Float towards = (dx * nx + dy * ny + dz * nz) * test.area[q];
      const Float facing = (nx * x[far_area] + ny * x[far_area + 1] + nz * x[far_area + 2]) * k;
      own_re[p] = facing * g.im - towards * d.re;
      own_im[p] = -facing * g.re - towards * d.im;
      total_re += own_re[p];
      total_im += own_im[p];
      for (std::size_t i = 0; i < 3; ++i) {
        const Float tu = load_lanes<L>(y[far_u + i] + lane), tv = load_lanes<L>(y[far_v + i] + lane);
        tangent_re[0][i] += tu * g.re;
        tangent_im[0][i] += tu * g.im;
        tangent_re[1][i] += tv * g.re;
        tangent_im[1][i] += tv * g.im;
      }
    }
    // A hat function is 1/6 in two samples and 2/3 in the sample of its corner.
    for (int j = 0; j < 3; ++j) {
      const Float re = total_re * (1.0F / 6) + own_re[j] * 0.5F, im = total_im * (1.0F / 6) + own_im[j] * 0.5F;
      for (int i = 0; i < 3; ++i) {
        const float hat = i == q ? 2.0F / 3 : 1.0F / 6;
        block[3 * i + j][0] += re * hat;
        block[3 * i + j][1] += im * hat;
      }
    }
    for (int b = 0; b < 2; ++b) {
      for (std::size_t i = 0; i < 3; ++i) {
        e[0][b][0] += tangent_re[b][i] * x[far_u + i];
        e[0][b][1] += tangent_im[b][i] * x[far_u + i];
        e[1][b][0] += tangent_re[b][i] * x[far_v + i];
        e[1][b][1] += tangent_im[b][i] * x[far_v + i];
      }
    }
  }
  add_curls(e, k, block);
  for (int entry = 0; entry < 9; ++entry) {
    store_lanes<L>(block[entry][0], out.of[entry][0] + lane);
    store_lanes<L>(block[entry][1], out.of[entry][1] + lane);
  }
}

template <class L>
struct Sample {
  typename L::Float at[3], area[3], along[2][3], hat[3];
};

template <class L>
[[gnu::always_inline]] inline void sample(const NearPatch& patch, const typename L::Float& u,
                                          const typename L::Float& v, Sample<L>& out) {
  for (int i = 0; i < 3; ++i) {
    const float c1 = patch.c[1][i], c2 = patch.c[2][i], c3 = patch.c[3][i], c4 = patch.c[4][i], c5 = patch.c[5][i];
    out.at[i] = patch.c[0][i] + u * (c1 + u * c3 + v * c4) + v * (c2 + v * c5);
    out.along[0][i] = c1 + u * (2 * c3) + v * c4;
    out.along[1][i] = c2 + u * c4 + v * (2 * c5);
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, l = (i + 2) % 3;
    out.area[i] = out.along[0][j] * out.along[1][l] - out.along[0][l] * out.along[1][j];
  }
  out.hat[0] = 1.0F - u - v;
  out.hat[1] = u;
  out.hat[2] = v;
}

template <class L>
float sum(const typename L::Float& value) {
  float total = 0;
  for (int lane = 0; lane < L::width; ++lane)
    total += value[lane];
  return total;
}

template <class L>
[[gnu::always_inline]] inline void near_lanes(const NearPatch& test, const NearPatch& trial, const PairTable& table,
                                              float k, Block& block, Block& exchanged) {
  using Float = typename L::Float;
  Float own[9][2] = {}, other[9][2] = {}, shared[9][2] = {};
  Float e[2][2][2] = {};
  for (std::size_t first = 0; first < table.size(); first += L::width) {
    Sample<L> x, y;
    sample<L>(test, load_lanes<L>(&table.u[first]), load_lanes<L>(&table.v[first]), x);
    sample<L>(trial, load_lanes<L>(&table.other_u[first]), load_lanes<L>(&table.other_v[first]), y);
    const Float weight = load_lanes<L>(&table.weight[first]);
    const Float dx = y.at[0] - x.at[0], dy = y.at[1] - x.at[1], dz = y.at[2] - x.at[2];
    Complex<L> g, d;
    green<L>(dx * dx + dy * dy + dz * dz, k, g, d);
    const Float facing = (x.area[0] * y.area[0] + x.area[1] * y.area[1] + x.area[2] * y.area[2]) * k * weight;
    const Float x2 = x.area[0] * x.area[0] + x.area[1] * x.area[1] + x.area[2] * x.area[2];
    const Float y2 = y.area[0] * y.area[0] + y.area[1] * y.area[1] + y.area[2] * y.area[2];
    const Float to_y = (dx * y.area[0] + dy * y.area[1] + dz * y.area[2]) * (x2 * inverse_root<L>(x2)) * weight;
    const Float to_x = -(dx * x.area[0] + dy * x.area[1] + dz * x.area[2]) * (y2 * inverse_root<L>(y2)) * weight;
    const Float own_re = -to_y * d.re, own_im = -to_y * d.im;
    const Float other_re = -to_x * d.re, other_im = -to_x * d.im;
    const Float shared_re = facing * g.im, shared_im = -facing * g.re;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        const Float hats = x.hat[i] * y.hat[j];
        own[3 * i + j][0] += hats * own_re;
        own[3 * i + j][1] += hats * own_im;
        other[3 * i + j][0] += hats * other_re;
        other[3 * i + j][1] += hats * other_im;
        shared[3 * i + j][0] += hats * shared_re;
        shared[3 * i + j][1] += hats * shared_im;
      }
    }
    const Float g_re = g.re * weight, g_im = g.im * weight;
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) {
        const Float product =
            x.along[a][0] * y.along[b][0] + x.along[a][1] * y.along[b][1] + x.along[a][2] * y.along[b][2];
        e[a][b][0] += product * g_re;
        e[a][b][1] += product * g_im;
      }
    }
  }
  add_curls(e, k, shared);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const std::size_t at = 3 * i + j;
      block[at] = {sum<L>(own[at][0] + shared[at][0]), sum<L>(own[at][1] + shared[at][1])};
      exchanged[3 * j + i] = {sum<L>(other[at][0] + shared[at][0]), sum<L>(other[at][1] + shared[at][1])};
    }
  }
}

template <class L>
[[gnu::always_inline]] inline void layer_all(const std::array<float, 3>& point, const LayerGroup& patches, float k,
                                             LayerSums& out) {
  using Float = typename L::Float;
  const float range = std::sqrt(point[0] * point[0] + point[1] * point[1] + point[2] * point[2]);
  for (std::size_t lane = 0; lane < far_lanes; lane += L::width) {
    Float re{}, im{};
    for (const auto& y : patches.of) {
      const Float ax = load_lanes<L>(y[0] + lane), ay = load_lanes<L>(y[1] + lane), az = load_lanes<L>(y[2] + lane);
      const Float dx = ax - point[0], dy = ay - point[1], dz = az - point[2];
      const Float r2 = dx * dx + dy * dy + dz * dz;
      const Float inverse = inverse_root<L>(r2);
      // r - range would lose its digits as a difference: (r^2 - range^2) / (r + range).
      const Float ahead =
          (ax * (ax - 2 * point[0]) + ay * (ay - 2 * point[1]) + az * (az - 2 * point[2])) / (r2 * inverse + range);
      Complex<L> g, d;
      green_of<L>(ahead, inverse, k, g, d);
      const Float towards =
          dx * load_lanes<L>(y[3] + lane) + dy * load_lanes<L>(y[4] + lane) + dz * load_lanes<L>(y[5] + lane);
      const Float p_re = load_lanes<L>(y[6] + lane) * towards, p_im = load_lanes<L>(y[7] + lane) * towards;
      re += p_re * d.re - p_im * d.im;
      im += p_re * d.im + p_im * d.re;
    }
    store_lanes<L>(re, out.of[0] + lane);
    store_lanes<L>(im, out.of[1] + lane);
  }
}

template <class L>
[[gnu::always_inline]] inline void far_all(const FarPatch& test, const FarGroup& trial, float k, FarBlocks& out) {
  for (std::size_t lane = 0; lane < far_lanes; lane += L::width)
    far_lanes_at<L>(test, trial, k, lane, out);
}

}  // namespace

void far_blocks(const FarPatch& test, const FarGroup& trial, float wave_number, FarBlocks& out) {
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { far_all<L>(test, trial, wave_number, out); });
}

void layer_sums(const std::array<float, 3>& point, const LayerGroup& patches, float wave_number, LayerSums& out) {
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { layer_all<L>(point, patches, wave_number, out); });
}

void near_blocks(const NearPatch& test, const NearPatch& trial, const PairTable& table, float wave_number, Block& block,
                 Block& exchanged) {
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { near_lanes<L>(test, trial, table, wave_number, block, exchanged); });
}

}  // namespace palpa::acoustics
