#include "sensing/depth_noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace palpa::sensing {
namespace {

std::uint64_t mix64(std::uint64_t x) {  // splitmix64
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

/// 32 random bits of a place; written so that compilers run several places at once.
inline std::uint32_t hash(std::uint32_t place, std::uint32_t key_a, std::uint32_t key_b) {
  std::uint32_t h = (place + key_a) * 0x9e3779b1u;
  h ^= h >> 15;
  h = (h ^ key_b) * 0x85ebca6bu;
  h ^= h >> 13;
  h *= 0xc2b2ae35u;
  return h ^ h >> 16;
}

/// Zero mean, standard deviation 1: the sum of four bytes. Smoothing brings its short tails to a normal distribution's.
inline float white_noise(std::uint32_t bits) {
  const int sum = static_cast<int>((bits & 0xff) + (bits >> 8 & 0xff) + (bits >> 16 & 0xff) + (bits >> 24));
  return static_cast<float>(sum - 510) * (1.0f / 147.79829f);  // sqrt(4 (256^2 - 1) / 12)
}

/// Row v of white noise smoothed by [1 2 1] along u. Rows and columns count from -1, for the smoothing at the border.
void smooth_row(int v, std::uint32_t width, std::uint64_t key, std::vector<float>& white, float* out) {
  const auto key_a = static_cast<std::uint32_t>(key), key_b = static_cast<std::uint32_t>(key >> 32);
  const std::uint32_t first = static_cast<std::uint32_t>(v + 1) * (width + 2);
  white.resize(width + 2);
  for (std::uint32_t i = 0; i < width + 2; ++i)
    white[i] = white_noise(hash(first + i, key_a, key_b));
  for (std::uint32_t u = 0; u < width; ++u)
    out[u] = white[u] + 2 * white[u + 1] + white[u + 2];
}

/// For each pixel of row v the largest step in depth to a neighbour within rim_px along row or column.
void find_steps(std::span<const float> depth, std::uint32_t width, std::uint32_t height, std::uint32_t v,
                std::vector<float>& steps) {
  const auto widen = [](float& step, float a, float b) {
    const float apart = std::abs(a - b);
    step = step < apart ? apart : step;
  };
  steps.assign(width, 0);
  float* out = steps.data();
  const float* row = depth.data() + std::size_t{v} * width;
  for (int away = -D415::rim_px; away <= D415::rim_px; ++away) {
    const int other = static_cast<int>(v) + away;
    if (away == 0 || other < 0 || other >= static_cast<int>(height)) continue;
    const float* line = depth.data() + static_cast<std::size_t>(other) * width;
    for (std::uint32_t u = 0; u < width; ++u)
      widen(out[u], line[u], row[u]);
  }
  for (std::uint32_t away = 1; away <= std::min<std::uint32_t>(D415::rim_px, width - 1); ++away) {
    for (std::uint32_t u = 0; u < width - away; ++u)
      widen(out[u], row[u], row[u + away]);
    for (std::uint32_t u = 0; u < width - away; ++u)
      widen(out[u + away], row[u], row[u + away]);
  }
}

/// The other side of the silhouette at (u, v): the neighbour that differs most; where it shows nothing, somewhat
/// behind.
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

/// Share of a 16-bit draw.
constexpr std::uint32_t share(double part) {
  return static_cast<std::uint32_t>(part * 65536);
}

/// The cosine of incidence decides whether the matcher finds anything.
bool lost_to_grazing(float cosine, std::uint32_t draw) {
  constexpr auto all = static_cast<float>(D415::grazing_all), none = static_cast<float>(D415::grazing_none);
  return static_cast<float>(draw & 0xffff) < (none - cosine) * (65536 / (none - all));
}

}  // namespace

std::uint64_t noise_key(std::uint64_t seed, std::uint64_t sequence, std::uint64_t camera) {
  return mix64(mix64(mix64(seed) ^ sequence) ^ camera);
}

void quantize(const DepthImage& image, std::vector<std::uint16_t>& out) {
  const auto first = static_cast<double>(first_valid_depth(image.camera));
  const double per_unit = 1 / image.camera.depth_unit_m;
  out.assign(image.depth.size(), 0);
  for (std::size_t i = 0; i < image.depth.size(); ++i) {
    const double raw = std::floor(image.depth[i] * per_unit + 0.5);
    if (raw >= first && raw <= 65535) out[i] = static_cast<std::uint16_t>(raw);
  }
}

void DepthNoise::apply(const DepthImage& image, std::uint64_t key, std::vector<std::uint16_t>& out) {
  const std::uint32_t width = image.camera.width, height = image.camera.height;
  const auto first = static_cast<float>(first_valid_depth(image.camera));
  const auto disparity = static_cast<float>(image.camera.fx * D415::baseline_m);
  constexpr auto step = static_cast<float>(D415::disparity_step_px);
  const auto units = static_cast<float>(disparity / step / image.camera.depth_unit_m);  // of depth at one step
  constexpr auto grazing = static_cast<float>(D415::grazing_none);
  // Both smoothings together leave 6/16 of the standard deviation of a sum of 16 sixteenths.
  constexpr auto noise_scale = static_cast<float>(D415::sigma_px / 6);
  const std::uint64_t faults_key = mix64(key);
  const auto faults_a = static_cast<std::uint32_t>(faults_key), faults_b = static_cast<std::uint32_t>(faults_key >> 32);

  out.assign(image.depth.size(), 0);
  smooth_.resize(std::size_t{width} * 3);
  const auto smooth = [&](int v) { return smooth_.data() + std::size_t(v + 3) % 3 * width; };
  int ready = -2;  // the last smoothed row
  for (std::uint32_t v = 0; v < height; ++v) {
    const std::size_t row = std::size_t{v} * width;
    const float* depth = image.depth.data() + row;
    if (std::all_of(depth, depth + width, [](float z) { return z == beyond; })) continue;
    for (int line = std::max(ready + 1, static_cast<int>(v) - 1); line <= static_cast<int>(v) + 1; ++line) {
      smooth_row(line, width, key, white_, smooth(line));
      ready = line;
    }
    const float *above = smooth(static_cast<int>(v) - 1), *middle = smooth(static_cast<int>(v)),
                *below = smooth(static_cast<int>(v) + 1);
    find_steps(image.depth, width, height, v, steps_);
    for (std::uint32_t u = 0; u < width; ++u) {
      if (depth[u] == beyond) continue;
      const glm::vec2 ray = image.rays[std::size_t{v} * image.pitch + u];
      const float slant = image.slant[row + u], length2 = 1 + ray.x * ray.x + ray.y * ray.y;
      const bool rim = steps_[u] > static_cast<float>(D415::jump_m);
      float z = depth[u];
      if (rim || slant * slant < grazing * grazing * length2) {
        const std::uint32_t draw = hash(static_cast<std::uint32_t>(row) + u, faults_a, faults_b);
        if (lost_to_grazing(slant / std::sqrt(length2), draw)) continue;
        if (rim) {
          const std::uint32_t fate = draw >> 16;
          if (fate < share(D415::rim_holes)) continue;
          if (fate < share(D415::rim_holes + D415::rim_flying)) {
            const float t = static_cast<float>(draw & 0xffff) * (1.0f / 65536);
            z += t * (other_side(image, u, v) - z);
          }
        }
      }
      const float noisy = disparity / z + noise_scale * (above[u] + 2 * middle[u] + below[u]);
      // Truncation after adding a half rounds, since nothing negative counts; std::lround would be a call per pixel.
      const float half_up = std::min(noisy * (1 / step), 1e9f) + 0.5f;
      const auto steps = static_cast<std::int32_t>(half_up);
      if (steps <= 0) continue;
      const float raw = units / static_cast<float>(steps) + 0.5f;
      if (raw >= first && raw < 65536) out[row + u] = static_cast<std::uint16_t>(raw);
    }
  }
}

}  // namespace palpa::sensing
