#include "viewer/picture/detail.hpp"

#include <meshoptimizer.h>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <numeric>
#include <utility>

namespace palpa::viewer {
namespace {

glm::vec3 xyz(const shader::vec4& v) {
  return {v.x, v.y, v.z};
}

/// The vertices at one place, each with its own normal: the first of them, and a ring through all.
struct Places {
  std::vector<std::uint32_t> corners;  ///< first vertices
  std::vector<std::uint32_t> next;     ///< of each vertex: the next one at its place; after the last, the first
};

Places places_of(std::span<const shader::ViewVertex> vertices, std::span<const std::uint32_t> corners) {
  Places places;
  places.corners.resize(corners.size());
  meshopt_generateShadowIndexBuffer(places.corners.data(), corners.data(), corners.size(), vertices.data(),
                                    vertices.size(), 3 * sizeof(float), sizeof(shader::ViewVertex));
  places.next.resize(vertices.size());
  std::iota(places.next.begin(), places.next.end(), 0u);
  std::vector<bool> placed(vertices.size(), false);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::uint32_t vertex = corners[i], first = places.corners[i];
    if (vertex == first || placed[vertex]) continue;
    placed[vertex] = true;
    places.next[vertex] = std::exchange(places.next[first], vertex);
  }
  return places;
}

/// Chooses for each corner, of the vertices at its place, the one that faces as its triangle does.
void choose_normals(std::span<const shader::ViewVertex> vertices, const Places& places,
                    std::vector<std::uint32_t>& corners) {
  for (std::size_t t = 0; t < corners.size(); t += 3) {
    const glm::vec3 a = xyz(vertices[corners[t]].position);
    const glm::vec3 facing =
        glm::cross(xyz(vertices[corners[t + 1]].position) - a, xyz(vertices[corners[t + 2]].position) - a);
    for (std::size_t k = t; k < t + 3; ++k) {
      const std::uint32_t first = corners[k];
      for (std::uint32_t v = places.next[first]; v != first; v = places.next[v]) {
        if (glm::dot(xyz(vertices[v].normal), facing) > glm::dot(xyz(vertices[corners[k]].normal), facing))
          corners[k] = v;
      }
    }
  }
}

}  // namespace

std::vector<Detail> coarser(std::span<const shader::ViewVertex> vertices, std::span<const std::uint32_t> corners) {
  constexpr std::size_t dense = std::size_t{3} * 4000, coarsest = std::size_t{3} * 1000;
  constexpr float worst = 0.02f;  // of the mesh's size
  std::vector<Detail> details;
  if (corners.size() < dense) return details;
  const Places places = places_of(vertices, corners);
  const float* positions = &vertices.front().position.x;
  const auto size_m =
      static_cast<double>(meshopt_simplifyScale(positions, vertices.size(), sizeof(shader::ViewVertex)));
  std::size_t fewest = corners.size();
  while (fewest > coarsest) {
    Detail next;
    next.corners.resize(corners.size());
    float error = 0;
    const std::size_t count =
        meshopt_simplify(next.corners.data(), places.corners.data(), corners.size(), positions, vertices.size(),
                         sizeof(shader::ViewVertex), fewest / 6 * 3, worst, meshopt_SimplifyLockBorder, &error);
    if (count > fewest / 10 * 9) break;  // nothing more can go
    next.corners.resize(count);
    choose_normals(vertices, places, next.corners);
    meshopt_optimizeVertexCache(next.corners.data(), next.corners.data(), count, vertices.size());
    next.error_m = static_cast<double>(error) * size_m;
    details.push_back(std::move(next));
    fewest = count;
  }
  return details;
}

}  // namespace palpa::viewer
