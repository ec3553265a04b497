#include "acoustics/compressed/hat_kernels.hpp"

#include <cstddef>
#include <numbers>

#include "acoustics/lanes.hpp"

namespace palpa::acoustics {
namespace {

constexpr float quarter_of_pi_inverse = static_cast<float>(1 / (4 * std::numbers::pi));
constexpr float turn_inverse = static_cast<float>(1 / (2 * std::numbers::pi));

enum class Part { row, column };

template <class L, Part part>
[[gnu::always_inline]] inline void sums_at(std::span<const HatSample> hat, const FarGroup& patches, float k,
                                           std::size_t lane, HatSums& out) {
  using Float = typename L::Float;
  Float sums[3][2] = {};
  const float k_turns = k * turn_inverse, scale = 1 / k;
  for (int q = 0; q < 3; ++q) {
    const auto& y = patches.of[q];
    const Float at[3] = {load_lanes<L>(y[far_x] + lane), load_lanes<L>(y[far_x + 1] + lane),
                         load_lanes<L>(y[far_x + 2] + lane)};
    // Sums over the hat's samples: of D times the way (row) or D times the way along the normal (column), of G times
    // the normals, and of G times the curls (galerkin_kernels.cpp has D and G).
    Float way_re[3] = {}, way_im[3] = {}, normal_re[3] = {}, normal_im[3] = {}, curl_re[3] = {}, curl_im[3] = {};
    for (const HatSample& x : hat) {
      const Float dx = at[0] - x.at[0], dy = at[1] - x.at[1], dz = at[2] - x.at[2];
      const Float r2 = dx * dx + dy * dy + dz * dz;
      const Float inverse = inverse_root<L>(r2);
      Float sine, cosine;
      sine_cosine<L>(r2 * inverse * k_turns, sine, cosine);
      const Float size = inverse * quarter_of_pi_inverse;
      const Float g_re = size * cosine, g_im = size * sine;
      const Float d_re = inverse * (-inverse * g_re - k * g_im), d_im = inverse * (k * g_re - inverse * g_im);
      if constexpr (part == Part::row) {
        const Float m_re = d_re * x.size, m_im = d_im * x.size;
        way_re[0] += dx * m_re;
        way_im[0] += dx * m_im;
        way_re[1] += dy * m_re;
        way_im[1] += dy * m_im;
        way_re[2] += dz * m_re;
        way_im[2] += dz * m_im;
      } else {
        const Float towards = dx * x.area[0] + dy * x.area[1] + dz * x.area[2];
        way_re[0] -= towards * d_re;
        way_im[0] -= towards * d_im;
      }
      for (int i = 0; i < 3; ++i) {
        normal_re[i] += g_re * x.area[i];
        normal_im[i] += g_im * x.area[i];
        curl_re[i] += g_re * x.curl[i];
        curl_im[i] += g_im * x.curl[i];
      }
    }
    const Float n[3] = {load_lanes<L>(y[far_area] + lane), load_lanes<L>(y[far_area + 1] + lane),
                        load_lanes<L>(y[far_area + 2] + lane)};
    Float facing_re = normal_re[0] * n[0] + normal_re[1] * n[1] + normal_re[2] * n[2];
    Float facing_im = normal_im[0] * n[0] + normal_im[1] * n[1] + normal_im[2] * n[2];
    Float towards_re, towards_im;
    if constexpr (part == Part::row) {
      towards_re = way_re[0] * n[0] + way_re[1] * n[1] + way_re[2] * n[2];
      towards_im = way_im[0] * n[0] + way_im[1] * n[1] + way_im[2] * n[2];
    } else {
      // The padding has no area.
      const Float n2 = n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + 1e-30F;
      const Float area = n2 * inverse_root<L>(n2);
      towards_re = way_re[0] * area;
      towards_im = way_im[0] * area;
    }
    // -K - i k (n.n') G
    const Float own_re = facing_im * k - towards_re, own_im = -(facing_re * k) - towards_im;
    for (int c = 0; c < 3; ++c) {
      const float h = c == q ? 2.0F / 3 : 1.0F / 6;
      sums[c][0] += own_re * h;
      sums[c][1] += own_im * h;
    }
    // i/k times the curls' products: t_u - t_v, t_v, -t_u
    Float u_re{}, u_im{}, v_re{}, v_im{};
    for (std::size_t i = 0; i < 3; ++i) {
      const Float tu = load_lanes<L>(y[far_u + i] + lane) * scale, tv = load_lanes<L>(y[far_v + i] + lane) * scale;
      u_re -= tu * curl_im[i];
      u_im += tu * curl_re[i];
      v_re -= tv * curl_im[i];
      v_im += tv * curl_re[i];
    }
    sums[0][0] += u_re - v_re;
    sums[0][1] += u_im - v_im;
    sums[1][0] += v_re;
    sums[1][1] += v_im;
    sums[2][0] -= u_re;
    sums[2][1] -= u_im;
  }
  for (int c = 0; c < 3; ++c) {
    store_lanes<L>(sums[c][0], out.of[c][0] + lane);
    store_lanes<L>(sums[c][1], out.of[c][1] + lane);
  }
}

template <class L, Part part>
[[gnu::always_inline]] inline void all_sums(std::span<const HatSample> hat, const FarGroup& patches, float k,
                                            HatSums& out) {
  for (std::size_t lane = 0; lane < far_lanes; lane += L::width)
    sums_at<L, part>(hat, patches, k, lane, out);
}

}  // namespace

void hat_row(std::span<const HatSample> test, const FarGroup& trials, float wave_number, HatSums& out) {
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { all_sums<L, Part::row>(test, trials, wave_number, out); });
}

void hat_column(std::span<const HatSample> trial, const FarGroup& tests, float wave_number, HatSums& out) {
  in_wide_lanes([&]<class L>(L) PALPA_INLINED { all_sums<L, Part::column>(trial, tests, wave_number, out); });
}

}  // namespace palpa::acoustics
