#include "sensing/flat_patches.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>

namespace palpa::sensing {
namespace {

constexpr std::uint32_t seed_step = 4;               // pixels from seed to seed
constexpr std::int64_t seed_reach = 6;               // of a seed's window
constexpr double seed_share = 0.8;                   // of its pixels that must have data
constexpr double seed_depth_m = 0.02;                // maximum distance from the depth of its middle pixel
constexpr double noise_factor = 4;                   // a patch's points are within this many times the noise of its
                                                     // plane,
constexpr double least_m = 0.6e-3, most_m = 2.5e-3;  // within these limits
constexpr int refits = 3;
constexpr std::uint32_t least_points = 150;
constexpr std::size_t most_patches = 60;

/// Sums for 1 / z = a x + b y + c over rays (x, y, 1).
struct InverseDepth {
  glm::dmat3 left{0.0};
  Vec3 right{0};
  std::uint32_t count = 0;

  void add(const glm::vec3& point) {
    const Vec3 ray(point.x / point.z, point.y / point.z, 1);
    left += glm::outerProduct(ray, ray);
    right += ray / static_cast<double>(point.z);
    ++count;
  }
  /// (a, b, c): the plane's points have dot(that, point) = 1. nullopt if it is seen edge-on or there are too few
  /// points.
  std::optional<Vec3> solve() const {
    if (count < 6 || !(std::abs(glm::determinant(left)) > 1e-18 * std::pow(count, 3))) return std::nullopt;
    const Vec3 plane = glm::inverse(left) * right;
    if (!(glm::length(plane) > 0)) return std::nullopt;
    return plane;
  }
};

double distance(const Vec3& plane, const glm::vec3& point) {
  return std::abs(glm::dot(plane, Vec3(point)) - 1) / glm::length(plane);
}

struct Seed {
  std::uint32_t u = 0, v = 0;
  Vec3 plane{0};
  double rms_m = 0;
};

std::optional<Seed> seed_at(const StillImage& image, std::uint32_t u, std::uint32_t v) {
  const float middle = image.at(u, v).z;
  if (middle <= 0) return std::nullopt;
  InverseDepth sums;
  const auto each = [&](auto&& use) {
    for (std::int64_t y = v - seed_reach; y <= v + seed_reach; ++y) {
      for (std::int64_t x = u - seed_reach; x <= u + seed_reach; ++x) {
        const glm::vec3& point = image.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y));
        if (point.z > 0 && std::abs(point.z - middle) < seed_depth_m) use(point);
      }
    }
  };
  each([&](const glm::vec3& point) { sums.add(point); });
  constexpr double window = (2.0 * seed_reach + 1) * (2.0 * seed_reach + 1);
  if (sums.count < seed_share * window) return std::nullopt;
  const auto plane = sums.solve();
  if (!plane) return std::nullopt;
  double squares = 0;
  each([&](const glm::vec3& point) { squares += std::pow(distance(*plane, point), 2); });
  return Seed{u, v, *plane, std::sqrt(squares / sums.count)};
}

/// Sorted, flattest first.
std::vector<Seed> find_seeds(const StillImage& image) {
  std::vector<Seed> seeds;
  constexpr auto reach = static_cast<std::uint32_t>(seed_reach);
  for (std::uint32_t v = reach; v + reach < image.height; v += seed_step) {
    for (std::uint32_t u = reach; u + reach < image.width; u += seed_step) {
      if (const auto seed = seed_at(image, u, v)) seeds.push_back(*seed);
    }
  }
  std::stable_sort(seeds.begin(), seeds.end(), [](const Seed& a, const Seed& b) { return a.rms_m < b.rms_m; });
  return seeds;
}

class Growing {
 public:
  Growing(const StillImage& image, double tolerance_m)
      : image_(image), tolerance_m_(tolerance_m), mark_(image.points.size(), 0) {}

  bool taken(const Seed& seed) const { return mark_[index(seed.u, seed.v)] == used; }

  std::optional<FlatPatch> grow(const Seed& seed) {
    Vec3 plane = seed.plane;
    for (int round = 0; round <= refits; ++round) {
      flood(seed, plane);
      if (region_.size() < least_points) return std::nullopt;
      InverseDepth sums;
      for (const std::size_t i : region_)
        sums.add(image_.points[i]);
      const auto better = sums.solve();
      if (!better) return std::nullopt;
      plane = *better;
    }
    FlatPatch patch;
    Vec3 centroid(0);
    for (const std::size_t i : region_) {
      mark_[i] = used;
      centroid += Vec3(image_.points[i]) / static_cast<double>(region_.size());
    }
    patch.middle = image_.points[*std::min_element(region_.begin(), region_.end(), [&](std::size_t a, std::size_t b) {
      return glm::distance(Vec3(image_.points[a]), centroid) < glm::distance(Vec3(image_.points[b]), centroid);
    })];
    patch.points = static_cast<std::uint32_t>(region_.size());
    const double length = glm::length(plane);
    patch.plane = {-plane / length, -1 / length};
    return patch;
  }

 private:
  static constexpr std::uint32_t used = 0xffffffffU;
  std::size_t index(std::uint32_t u, std::uint32_t v) const { return std::size_t{v} * image_.width + u; }

  void flood(const Seed& seed, const Vec3& plane) {
    ++round_;
    region_.clear();
    const auto take = [&](std::size_t i) {
      if (mark_[i] == used || mark_[i] == round_) return;
      const glm::vec3& point = image_.points[i];
      if (point.z <= 0 || distance(plane, point) > tolerance_m_) return;
      mark_[i] = round_;
      region_.push_back(i);
    };
    take(index(seed.u, seed.v));
    for (std::size_t next = 0; next < region_.size(); ++next) {
      const std::size_t i = region_[next];
      const std::size_t u = i % image_.width, v = i / image_.width;
      if (u > 0) take(i - 1);
      if (u + 1 < image_.width) take(i + 1);
      if (v > 0) take(i - image_.width);
      if (v + 1 < image_.height) take(i + image_.width);
    }
  }

  const StillImage& image_;
  double tolerance_m_;
  std::vector<std::uint32_t> mark_;  ///< the last round that reached a pixel
  std::uint32_t round_ = 0;
  std::vector<std::size_t> region_;
};

}  // namespace

std::vector<FlatPatch> find_flat_patches(const StillImage& image) {
  const std::vector<Seed> seeds = find_seeds(image);
  std::vector<FlatPatch> patches;
  if (seeds.empty()) return patches;
  const double noise = seeds[seeds.size() / 4].rms_m;
  Growing growing(image, std::clamp(noise_factor * noise, least_m, most_m));
  for (const Seed& seed : seeds) {
    if (growing.taken(seed)) continue;
    if (const auto patch = growing.grow(seed)) patches.push_back(*patch);
  }
  std::stable_sort(patches.begin(), patches.end(),
                   [](const FlatPatch& a, const FlatPatch& b) { return a.points > b.points; });
  if (patches.size() > most_patches) patches.resize(most_patches);
  return patches;
}

}  // namespace palpa::sensing
