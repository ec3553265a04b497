#include "sensing/depth_noise.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "base/random.hpp"

namespace palpa::sensing {
namespace {

std::uint64_t mixed(std::uint64_t x) {
  return Random(x).next();
}

/// 32 random bits for a place; written so that compilers vectorise it.
inline std::uint32_t hash(std::uint32_t place, std::uint32_t key_a, std::uint32_t key_b) {
  std::uint32_t h = (place + key_a) * 0x9e3779b1u;
  h ^= h >> 15;
  h = (h ^ key_b) * 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  return h ^ h >> 16;
}

/// Zero mean, standard deviation 1: the sum of four bytes. Smoothing extends its short tails to those of a normal
/// distribution.
inline float white_noise(std::uint32_t bits) {
  const int sum = static_cast<int>((bits & 0xff) + (bits >> 8 & 0xff) + (bits >> 16 & 0xff) + (bits >> 24));
  return static_cast<float>(sum - 510) * (1.0f / 147.79829f);  // sqrt(4 (256^2 - 1) / 12)
}

void smooth(const float* white, std::uint32_t count, float* __restrict out) {
  for (std::uint32_t i = 0; i < count; ++i)
    out[i] = white[i] + 2 * white[i + 1] + white[i + 2];
}

/// Row v of white noise smoothed by [1 2 1] along u, between two columns. Rows and columns count from -1, for the
/// smoothing at the border.
void smooth_row(int v, const RowSpan& span, std::uint32_t width, std::uint64_t key, std::vector<float>& white,
                float* out) {
  if (span.begin >= span.end) return;
  const auto key_a = static_cast<std::uint32_t>(key), key_b = static_cast<std::uint32_t>(key >> 32);
  const std::uint32_t first = static_cast<std::uint32_t>(v + 1) * (width + 2) + span.begin;
  const std::uint32_t count = span.end - span.begin;
  white.resize(width + 2);
  float* w = white.data();
  for (std::uint32_t i = 0; i < count + 2; ++i)
    w[i] = white_noise(hash(first + i, key_a, key_b));
  smooth(w, count, out + span.begin);
}

/// Whether a step in depth larger than jump_m lies within rim_px along row or column.
bool near_silhouette(const DepthImage& image, std::uint32_t u, std::uint32_t v) {
  const std::uint32_t width = image.camera.width, height = image.camera.height;
  const float* at = image.depth.data() + std::size_t{v} * width + u;
  const auto jumps = [&](std::ptrdiff_t to) { return std::abs(at[to] - *at) > static_cast<float>(D415::jump_m); };
  for (std::uint32_t away = 1; away <= D415::rim_px; ++away) {
    const auto columns = static_cast<std::ptrdiff_t>(away), rows = columns * width;
    if ((u >= away && jumps(-columns)) || (u + away < width && jumps(columns))) return true;
    if ((v >= away && jumps(-rows)) || (v + away < height && jumps(rows))) return true;
  }
  return false;
}

/// The other side of the silhouette at (u, v): the neighbour that differs most, or a slightly larger depth if that
/// neighbour shows nothing.
float other_side(const DepthImage& image, std::uint32_t u, std::uint32_t v) {
  const int width = static_cast<int>(image.camera.width), height = static_cast<int>(image.camera.height);
  const float here = image.depth[std::size_t{v} * image.camera.width + u];
  float there = here;
  for (int step = -D415::rim_px; step <= D415::rim_px; ++step) {
    for (const auto& [du, dv] : {std::pair(step, 0), std::pair(0, step)}) {
      const int x = static_cast<int>(u) + du, y = static_cast<int>(v) + dv;
      if (x < 0 || y < 0 || x >= width || y >= height) continue;
      const float value = std::min(image.depth[std::size_t(y) * image.camera.width + x], here + 0.15f);
      if (std::abs(value - here) > std::abs(there - here)) there = value;
    }
  }
  return there;
}

/// A probability as a threshold for a 16-bit draw.
constexpr std::uint32_t share(double part) {
  return static_cast<std::uint32_t>(part * 65536);
}

/// Whether the matcher finds nothing at this cosine of incidence.
bool lost_to_grazing(float cosine, std::uint32_t draw) {
  constexpr auto all = static_cast<float>(D415::grazing_all), none = static_cast<float>(D415::grazing_none);
  return static_cast<float>(draw & 0xffff) < (none - cosine) * (65536 / (none - all));
}

}  // namespace

std::uint64_t noise_key(std::uint64_t seed, std::uint64_t sequence, std::uint64_t camera) {
  return mixed(mixed(mixed(seed) ^ sequence) ^ camera);
}

void quantize(const DepthImage& image, std::vector<std::uint16_t>& out) {
  const auto first = static_cast<double>(first_valid_depth(image.camera));
  const double per_unit = 1 / image.camera.depth_unit_m;
  out.assign(image.depth.size(), 0);
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const double raw = image.depth[i] * per_unit + 0.5;
    if (raw >= first && raw < 65536) out[i] = static_cast<std::uint16_t>(raw);  // truncated, which is a call less
  }
}

void find_risks(const DepthImage& image, const PixelBox& box, std::span<Risk> risks) {
  constexpr auto grazing = static_cast<float>(D415::grazing_none);
  for (std::uint32_t v = box.y0; v < box.y1; ++v) {
    for (std::uint32_t u = box.x0; u < box.x1; ++u) {
      const std::size_t i = std::size_t{v} * image.camera.width + u;
      const glm::vec2 ray = image.rays[std::size_t{v} * image.pitch + u];
      const float slant = image.slant[i], length2 = 1 + ray.x * ray.x + ray.y * ray.y;
      if (image.depth[i] == beyond) {
        risks[i] = Risk::nothing;
      } else if (near_silhouette(image, u, v)) {
        risks[i] = Risk::rim;
      } else {
        risks[i] = slant * slant < grazing * grazing * length2 ? Risk::grazing : Risk::none;
      }
    }
  }
}

namespace {

/// The minimum of a number and a positive one. Floats are ordered like their bits, and compilers compute the minimum of
/// integers without a branch.
inline float at_most(float value, float most) {
  return std::bit_cast<float>(std::min(std::bit_cast<std::int32_t>(value), std::bit_cast<std::int32_t>(most)));
}

/// Converts disparities to depths.
struct Disparities {
  static constexpr auto step = static_cast<float>(D415::disparity_step_px);
  /// Both smoothings together leave 6/16 of the standard deviation of a sum of 16 sixteenths.
  static constexpr auto noise_scale = static_cast<float>(D415::sigma_px / 6);
  float disparity, units;
  std::int32_t first;

  explicit Disparities(const Camera& camera)
      : disparity(static_cast<float>(camera.fx * D415::baseline_m)),
        units(static_cast<float>(disparity / step / camera.depth_unit_m)),  // depth units at one step
        first(static_cast<std::int32_t>(first_valid_depth(camera))) {}

  /// The raw depth of a pixel at z metres, with smoothed noise; 0: none. Branch-free, so that compilers vectorise it.
  std::int32_t raw(float z, float noise) const {
    const float noisy = disparity / z + noise_scale * noise;
    // Truncation after adding a half rounds correctly, because negative values do not matter; std::lround would be a
    // call per pixel.
    const auto steps = static_cast<std::int32_t>(at_most(noisy * (1 / step) + 0.5f, 1e9f));
    const auto depth = static_cast<std::int32_t>(at_most(units / static_cast<float>(steps) + 0.5f, 65536.0f));
    const int fits = (steps > 0) & (depth >= first) & (depth < 65536) & (z < beyond);
    return depth & -fits;
  }
};

/// A row's pixels as if no pixel were at risk.
void quantize_row(Disparities to, std::uint32_t count, const float* depth, const float* above, const float* middle,
                  const float* below, std::int32_t* __restrict out) {
  for (std::uint32_t i = 0; i < count; ++i)
    out[i] = to.raw(depth[i], above[i] + 2 * middle[i] + below[i]);
}

/// The next pixel from `u` on that is at risk, or `end`.
std::uint32_t next_at_risk(const Risk* risks, std::uint32_t u, std::uint32_t end) {
  constexpr std::uint64_t at_risk = 0x0202020202020202ull;
  for (std::uint64_t eight = 0; u + 8 <= end; u += 8) {
    std::memcpy(&eight, risks + u, 8);
    if (eight & at_risk) break;
  }
  while (u < end && risks[u] < Risk::grazing)
    ++u;
  return u;
}

}  // namespace

void DepthNoise::apply(const DepthImage& image, std::span<const Risk> risks, std::span<const RowSpan> spans,
                       std::uint64_t key, std::vector<std::uint16_t>& out) {
  const std::uint32_t width = image.camera.width, height = image.camera.height;
  const Disparities disparities(image.camera);
  const std::uint64_t faults_key = mixed(key);
  const auto faults_a = static_cast<std::uint32_t>(faults_key), faults_b = static_cast<std::uint32_t>(faults_key >> 32);

  out.assign(image.depth.size(), 0);
  smooth_.resize(std::size_t{width} * 3);
  const auto smoothed = [&](int v) { return smooth_.data() + std::size_t(v + 3) % 3 * width; };
  // A smoothed row covers all columns that the rows using it need: itself, the one above, the one below.
  const auto needed = [&](int line) {
    RowSpan all{width, 0};
    for (int v = std::max(line - 1, 0); v <= std::min(line + 1, static_cast<int>(height) - 1); ++v) {
      if (spans[v].begin >= spans[v].end) continue;
      all = {std::min(all.begin, spans[v].begin), std::max(all.end, spans[v].end)};
    }
    return all;
  };
  int ready = -2;  // the last smoothed row
  for (std::uint32_t v = 0; v < height; ++v) {
    const RowSpan span = spans[v];
    if (span.begin >= span.end) continue;
    for (int line = std::max(ready + 1, static_cast<int>(v) - 1); line <= static_cast<int>(v) + 1; ++line) {
      smooth_row(line, needed(line), width, key, white_, smoothed(line));
      ready = line;
    }
    const float *above = smoothed(static_cast<int>(v) - 1), *middle = smoothed(static_cast<int>(v)),
                *below = smoothed(static_cast<int>(v) + 1);
    const std::size_t row = std::size_t{v} * width;
    const float* depth = image.depth.data() + row;
    std::uint16_t* raw = out.data() + row;
    const auto noise = [&](std::uint32_t u) { return above[u] + 2 * middle[u] + below[u]; };
    const std::uint32_t from = span.begin, count = span.end - from;
    raw_.resize(width);
    quantize_row(disparities, count, depth + from, above + from, middle + from, below + from, raw_.data());
    std::copy_n(raw_.data(), count, raw + from);
    for (std::uint32_t u = next_at_risk(risks.data() + row, span.begin, span.end); u < span.end;
         u = next_at_risk(risks.data() + row, u + 1, span.end)) {
      const glm::vec2 ray = image.rays[std::size_t{v} * image.pitch + u];
      const float length2 = 1 + ray.x * ray.x + ray.y * ray.y;
      const std::uint32_t draw = hash(static_cast<std::uint32_t>(row) + u, faults_a, faults_b), fate = draw >> 16;
      const bool rim = risks[row + u] == Risk::rim;
      if (lost_to_grazing(image.slant[row + u] / std::sqrt(length2), draw) || (rim && fate < share(D415::rim_holes))) {
        raw[u] = 0;
      } else if (rim && fate < share(D415::rim_holes + D415::rim_flying)) {
        const float t = static_cast<float>(draw & 0xffff) * (1.0f / 65536);
        raw[u] =
            static_cast<std::uint16_t>(disparities.raw(depth[u] + t * (other_side(image, u, v) - depth[u]), noise(u)));
      }
    }
  }
}

}  // namespace palpa::sensing
