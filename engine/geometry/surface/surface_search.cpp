#include "geometry/surface/surface_search.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "geometry/surface/surface_samples.hpp"
#include "shaders/touch/contacts/surface_math.h"

namespace palpa::geometry {

SurfaceSearch::SurfaceSearch(const Bvh& bvh, const SurfaceTriangles& triangles, const Vec3& centre, double epsilon)
    : bvh_(bvh),
      t_(triangles),
      centre_(centre),
      epsilon_(epsilon),
      slabs_(make_slabs(bvh.nodes(), triangles.triangles, 2 * epsilon)) {}

std::uint32_t SurfaceSearch::nearest(const glm::vec3& p, std::uint32_t guess, float& distance2,
                                     std::uint64_t& steps) const {
  std::uint32_t best = guess;
  distance2 = shader::surface_distance2(t_.triangles[guess], float3(p));
  const Vec3 world = Vec3(p) + centre_;
  const std::span<const Bvh::Node> nodes = bvh_.nodes();
  std::array<std::pair<std::uint32_t, double>, 64> stack;
  std::size_t depth = 0;
  const auto apart2_of = [&](std::uint32_t node) {
    const double across = distance(slabs_[node], p);
    return std::max(geometry::distance2(nodes[node].box, world), across * across);
  };
  stack[depth++] = {0, 0.0};
  const auto square_allowed = [&] {
    const double allowed = std::sqrt(static_cast<double>(distance2)) + 4 * epsilon_;
    return allowed * allowed;
  };
  double allowed2 = square_allowed();
  while (depth > 0) {
    ++steps;
    const auto [index, apart2] = stack[--depth];
    if (apart2 > allowed2) continue;
    const Bvh::Node& node = nodes[index];
    if (node.second != 0) {
      const double first = apart2_of(index + 1), second = apart2_of(node.second);
      const bool first_nearer = first <= second;
      stack[depth++] = first_nearer ? std::pair(node.second, second) : std::pair(index + 1, first);
      stack[depth++] = first_nearer ? std::pair(index + 1, first) : std::pair(node.second, second);
      continue;
    }
    for (std::uint32_t t = node.begin; t < node.end; ++t) {
      const float d = shader::surface_distance2(t_.triangles[t], float3(p));
      if (d < distance2 || (d == distance2 && t < best)) {
        distance2 = d;
        best = t;
      }
    }
    allowed2 = square_allowed();
  }
  return best;
}

void SurfaceSearch::gather(const Contest& contest, const Corners& corners, std::vector<std::uint32_t>& list,
                           std::uint64_t& steps) const {
  const std::span<const Bvh::Node> nodes = bvh_.nodes();
  std::array<std::uint32_t, 64> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  std::array<float, 8> d, x, y, z;
  std::array<Vec3, 8> world;
  for (std::size_t c = 0; c < 8; ++c) {
    world[c] = Vec3(corners[c]) + centre_;
    x[c] = corners[c].x;
    y[c] = corners[c].y;
    z[c] = corners[c].z;
  }
  while (depth > 0) {
    steps += 8;
    const std::uint32_t index = stack[--depth];
    const Bvh::Node& node = nodes[index];
    for (std::size_t c = 0; c < 8; ++c) {
      const float across = distance(slabs_[index], corners[c]);
      const auto apart2 = static_cast<float>(geometry::distance2(node.box, world[c]));
      d[c] = apart2 > across * across ? apart2 : across * across;
    }
    if (contest.beats(d)) continue;
    if (node.second != 0) {
      stack[depth++] = node.second;
      stack[depth++] = index + 1;
      continue;
    }
    for (std::uint32_t t = node.begin; t < node.end; ++t) {
      distances2(t_.triangles[t], x.data(), y.data(), z.data(), 8, d.data());
      if (!contest.beats(d)) list.push_back(t);
    }
  }
}

}  // namespace palpa::geometry
