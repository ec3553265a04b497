#include "geometry/mesh/mesh.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <span>

#include "geometry/mesh/topology.hpp"
#include "geometry/seeded_hash.hpp"

namespace palpa::geometry {
namespace {

constexpr std::uint32_t none = 0xffffffffU;

// A hash table with open addressing that maps a hash to chains of vertices; the caller compares. Its size is fixed.
class VertexTable {
 public:
  explicit VertexTable(std::size_t vertices)
      : mask_(std::bit_ceil(vertices * 2 + 2) - 1), head_(mask_ + 1, none), next_(vertices, none) {}

  // The first vertex of the bucket for which `same` returns true, or none.
  template <typename Same>
  std::uint32_t find(std::uint64_t hash, const Same& same) const {
    std::uint32_t v = head_[hash & mask_];
    while (v != none && !same(v))
      v = next_[v];
    return v;
  }
  void insert(std::uint64_t hash, std::uint32_t vertex) {
    std::uint32_t& head = head_[hash & mask_];
    next_[vertex] = head;
    head = vertex;
  }

 private:
  std::size_t mask_;
  std::vector<std::uint32_t> head_, next_;
};

// Adding +0 turns -0 into 0, so that equal positions have equal bits.
Vec3 without_negative_zero(const Vec3& p) {
  return p + Vec3(0.0);
}

std::uint64_t hash_of(const Vec3& signed_zeros) {
  const Vec3 p = without_negative_zero(signed_zeros);
  return mix_hash(mix_hash(mix_hash(hash_seed(), std::bit_cast<std::uint64_t>(p.x)), std::bit_cast<std::uint64_t>(p.y)),
                  std::bit_cast<std::uint64_t>(p.z));
}

// The same triangles with only the vertices that they use, in order of first use.
Mesh compact(const std::vector<Vec3>& positions, std::vector<glm::uvec3> triangles) {
  std::vector<std::uint32_t> index(positions.size(), none);
  Mesh out;
  for (glm::uvec3& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      std::uint32_t& v = index[t[i]];
      if (v == none) {
        v = static_cast<std::uint32_t>(out.positions.size());
        out.positions.push_back(positions[t[i]]);
      }
      t[i] = v;
    }
  }
  out.triangles = std::move(triangles);
  return out;
}

std::vector<std::uint32_t> first_equal(const std::vector<Vec3>& positions) {
  VertexTable table(positions.size());
  std::vector<std::uint32_t> first(positions.size());
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const std::uint64_t hash = hash_of(positions[v]);
    const std::uint32_t found = table.find(hash, [&](std::uint32_t w) { return positions[w] == positions[v]; });
    if (found == none) table.insert(hash, v);
    first[v] = found == none ? v : found;
  }
  return first;
}

// Uses a grid to find the first vertex within the tolerance: cells are twice as wide as the tolerance, so at most two
// per axis.
std::vector<std::uint32_t> first_near(const std::vector<Vec3>& positions, double tolerance) {
  VertexTable table(positions.size());
  std::vector<std::uint32_t> first(positions.size());
  const double cell = 2 * tolerance;
  for (std::uint32_t v = 0; v < positions.size(); ++v) {
    const Vec3& p = positions[v];
    const Vec3 low = glm::floor((p - tolerance) / cell), high = glm::floor((p + tolerance) / cell);
    std::uint32_t found = none;
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 at((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                    (corner & 4) != 0 ? high.z : low.z);
      // Chains run from newest to oldest; the oldest match of all cells is needed.
      table.find(hash_of(at), [&](std::uint32_t w) {
        if (glm::distance(positions[w], p) <= tolerance && w < found) found = w;
        return false;
      });
    }
    if (found == none) table.insert(hash_of(glm::floor(p / cell)), v);
    first[v] = found == none ? v : found;
  }
  return first;
}

}  // namespace

std::vector<std::uint32_t> weld_indices(const std::vector<Vec3>& positions, double tolerance) {
  double reach = 0;
  for (const Vec3& p : positions)
    reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  // A tolerance below the spacing of doubles is meaningless, and cells could not be distinguished.
  if (!(tolerance > reach * 1e-14) || !std::isfinite(reach)) return first_equal(positions);
  return first_near(positions, tolerance);
}

Mesh weld(const Mesh& mesh, double tolerance) {
  Mesh used = compact(mesh.positions, mesh.triangles);
  for (Vec3& p : used.positions)
    p = without_negative_zero(p);
  const std::vector<std::uint32_t> index = weld_indices(used.positions, tolerance);
  std::vector<glm::uvec3> triangles;
  triangles.reserve(used.triangles.size());
  for (const glm::uvec3& t : used.triangles) {
    const glm::uvec3 c(index[t[0]], index[t[1]], index[t[2]]);
    if (c[0] != c[1] && c[1] != c[2] && c[2] != c[0]) triangles.push_back(c);
  }
  return compact(used.positions, std::move(triangles));
}

void append(Mesh& mesh, const Mesh& more) {
  const auto shift = static_cast<std::uint32_t>(mesh.positions.size());
  // No reserve(): with the exact size, it would copy the whole mesh for every piece that is added.
  mesh.positions.insert(mesh.positions.end(), more.positions.begin(), more.positions.end());
  for (const glm::uvec3& t : more.triangles)
    mesh.triangles.push_back(t + shift);
}

void flip(Mesh& mesh) {
  for (glm::uvec3& t : mesh.triangles)
    std::swap(t[1], t[2]);
}

Box bounds(const Mesh& mesh) {
  Box box;
  for (const Vec3& p : mesh.positions)
    box.add(p);
  return box;
}

double area(const Mesh& mesh) {
  double twice = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    twice += glm::length(area_vector(mesh, t));
  return twice / 2;
}

double signed_volume(const Mesh& mesh) {
  if (mesh.triangles.empty()) return 0;
  // Relative to a point of the mesh, because the terms would cancel badly far from the origin.
  const Vec3 origin = mesh.positions[mesh.triangles[0][0]];
  double six_times = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    six_times += glm::dot(mesh.positions[t[0]] - origin,
                          glm::cross(mesh.positions[t[1]] - origin, mesh.positions[t[2]] - origin));
  }
  return six_times / 6;
}

Defects find_defects(const Mesh& welded) {
  Defects defects;
  for_each_edge(welded, [&](std::span<const Side> sides) {
    const Side& s = sides[0];
    if (sides.size() == 1) {
      if (defects.open++ == 0) defects.first_open = side_vertices(welded, s.side);
    } else if (sides.size() > 2) {
      if (defects.non_manifold++ == 0) defects.first_non_manifold = {s.low, s.high};
    } else if (s.ascending == sides[1].ascending) {
      if (defects.flipped++ == 0) defects.first_flipped = {s.low, s.high};
    }
  });
  return defects;
}

}  // namespace palpa::geometry
