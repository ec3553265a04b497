// Checks of every shape.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "geometry/mesh/mesh.hpp"
#include "geometry/mesh/shells.hpp"
#include "geometry/mesh/topology.hpp"

namespace palpa::assets {

/// One closed, consistently oriented shell without handles that faces outwards, no vertex unused or doubled.
inline void expect_sphere_like(const geometry::Mesh& mesh) {
  const geometry::Mesh welded = geometry::weld(mesh);
  EXPECT_EQ(welded.positions.size(), mesh.positions.size());
  ASSERT_EQ(welded.triangles.size(), mesh.triangles.size());
  ASSERT_TRUE(geometry::find_defects(welded).closed_and_oriented());
  EXPECT_EQ(geometry::find_shells(welded, geometry::twins(welded)).list.size(), 1U);
  // Euler: V - E + F = 2 and E = 3 F / 2.
  EXPECT_EQ(2 * mesh.positions.size(), mesh.triangles.size() + 4);
  EXPECT_GT(geometry::signed_volume(mesh), 0.0);
}

inline Vec3 unit_normal(const geometry::Mesh& mesh, const glm::uvec3& t) {
  return glm::normalize(
      glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x]));
}

/// The greatest height of any vertex above any triangle's plane: 0 for a convex mesh.
inline double worst_concavity(const geometry::Mesh& mesh) {
  double worst = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 normal = unit_normal(mesh, t);
    for (const Vec3& p : mesh.positions)
      worst = std::max(worst, glm::dot(normal, p - mesh.positions[t.x]));
  }
  return worst;
}

/// The mean length of the edges whose ends both satisfy `within`.
template <class Within>
double mean_edge(const geometry::Mesh& mesh, const Within& within) {
  double sum = 0.0;
  int count = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) {
      const Vec3 &p = mesh.positions[t[c]], &q = mesh.positions[t[(c + 1) % 3]];
      if (!within(p) || !within(q)) continue;
      sum += glm::distance(p, q);
      ++count;
    }
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / count;
}

}  // namespace palpa::assets
