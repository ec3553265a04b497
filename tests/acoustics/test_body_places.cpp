// Points close to a body and far from it: points on its skin, faces that almost touch, points a kilometre away.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/bodies/body_places.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/bodies/sphere_series.hpp"
#include "acoustics/boundary/near_pairs.hpp"
#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/elements/triangle_rules.hpp"
#include "acoustics/field/waves.hpp"
#include "acoustics/rigs.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "geometry/mesh/topology.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"

namespace palpa::acoustics {
namespace {

using Complex = std::complex<double>;
using Where = BodyPlace::Where;
constexpr double radius = 8e-3, k = 5.86 / radius;
const Vec3 along = glm::normalize(Vec3(2, -1, 3));

TEST(BodyPlaces, WhatIsBetweenPatchAndFaceIsOnTheSkin) {
  const RigidBody body(geometry::icosphere(radius, 7), k);
  const auto unknowns = body.solve(plane_wave(k, along, body.points(), body.normals()));
  const SphereSeries exact = SphereSeries::plane_wave(k, radius, along);
  const BodyPlaces places(body.patches());
  const geometry::Mesh& mesh = body.mesh();
  for (std::size_t face = 0; face < mesh.triangles.size(); face += 17) {
    const glm::uvec3& t = mesh.triangles[face];
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    for (const Vec3& flat : {(a + b + c) / 3.0, 0.7 * a + 0.2 * b + 0.1 * c, (a + b) / 2.0, 0.9 * a + 0.1 * c, a}) {
      const double bulge = radius / glm::length(flat) - 1;
      for (const double part : {0.0, 0.3, 0.8, 1.0}) {
        const BodyPlace place = places.of(flat * (1 + part * bulge));
        ASSERT_EQ(place.where, Where::skin) << face << " " << part;
        EXPECT_LE(std::abs(body.at_skin(unknowns, place.face, place.u, place.v).pressure - exact.at(flat)), 0.06);
      }
      EXPECT_EQ(places.of(flat * (1 + bulge + 3e-3)).where, Where::air);
      EXPECT_EQ(places.of(flat * (1 - bulge - 3e-3)).where, Where::inside);
      // On the other side of the face there is no patch.
      const Where behind = places.of(flat * (1 - 0.6 * bulge)).where;
      EXPECT_TRUE(bulge < 1e-3 || behind == Where::inside) << face;
    }
  }
  EXPECT_EQ(places.of({0, 0, 0}).where, Where::inside);
  EXPECT_EQ(places.of({1, 2, 3}).where, Where::air);
}

TEST(Scattered, AKilometreAwayPhasesAreWhatTheyAreNearby) {
  const RigidBody body(geometry::icosphere(radius, 6), k);
  const auto unknowns = body.solve(plane_wave(k, along, body.points(), body.normals()));
  double worst = 0;
  for (int i = 0; i < 40; ++i) {
    const double near = 100, far = 1000;
    const std::vector<Vec3> points{near * direction(i), far * direction(i)};
    const auto sound = body.scattered(unknowns, points);
    // The rest of the near field there is k a^2 / r, about 5e-4.
    const Complex pattern[]{near * sound[0] * std::polar(1.0, -k * near), far * sound[1] * std::polar(1.0, -k * far)};
    worst = std::max(worst, std::abs(pattern[1] - pattern[0]) / radius);
  }
  EXPECT_LE(worst, 1e-3);
}

/// Two cubes, one above the other at this distance.
geometry::Mesh two_cubes(double gap) {
  constexpr double half = 1e-3;
  geometry::Mesh both;
  for (const double low : {0.0, 2 * half + gap}) {
    geometry::append(both, test::divided(test::box({-half, -half, low}, {half, half, low + 2 * half}), 1));
  }
  return both;
}

/// Six samples on each of 4^cuts parts.
std::vector<TriangleSample> fine_rule(int cuts) {
  std::vector<TriangleSample> rule(six_point_rule().begin(), six_point_rule().end());
  for (int cut = 0; cut < cuts; ++cut) {
    std::vector<TriangleSample> finer;
    for (const TriangleSample& s : rule) {
      const double u = s.u / 2, v = s.v / 2, weight = s.weight / 4;
      finer.insert(finer.end(),
                   {{u, v, weight}, {u + 0.5, v, weight}, {u, v + 0.5, weight}, {0.5 - u, 0.5 - v, weight}});
    }
    rule = std::move(finer);
  }
  return rule;
}

double size_of(const Block& block) {
  double sum = 0;
  for (const std::complex<float>& entry : block)
    sum += std::norm(Complex(entry));
  return std::sqrt(sum);
}

TEST(NearPairs, FacesThatFaceEachOtherAreSampledByHowCloseTheyAre) {
  // Sides of 1.4 mm, at a distance of a seventh of that.
  const double gap = 0.2e-3;
  const Patches body = make_patches(two_cubes(gap));
  const NearPairs pairs = near_pairs(body, 732.7);
  EXPECT_FALSE(pairs.unresolved);
  const std::vector<TriangleSample> rule = fine_rule(3);
  int looked_at = 0;
  for (std::uint32_t t = 0; t < body.patches.size() && looked_at < 3; ++t) {
    const Vec3 own = body.patches[t].at(1.0 / 3, 1.0 / 3);
    if (std::abs(own.z - 2e-3) > 1e-9) continue;  // the lower cube's top
    for (std::uint32_t entry = pairs.first[t]; entry < pairs.first[t + 1] && looked_at < 3; ++entry) {
      const std::uint32_t other = pairs.trial[entry];
      const Vec3 way = body.patches[other].at(1.0 / 3, 1.0 / 3) - own;
      if (std::abs(way.z - gap) > 1e-9 || std::hypot(way.x, way.y) > 0.4e-3) continue;
      ++looked_at;
      NearPatch test{}, trial{};
      for (std::size_t i = 0; i < 6; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
          test.c[i][axis] = static_cast<float>(body.patches[t].c[i][axis] - (i == 0 ? own[axis] : 0));
          trial.c[i][axis] = static_cast<float>(body.patches[other].c[i][axis] - (i == 0 ? own[axis] : 0));
        }
      }
      Block exact{}, unused{};
      for (const TriangleSample& a : rule) {
        PairTable table;
        for (const TriangleSample& b : rule) {
          table.u.push_back(static_cast<float>(a.u));
          table.v.push_back(static_cast<float>(a.v));
          table.other_u.push_back(static_cast<float>(b.u));
          table.other_v.push_back(static_cast<float>(b.v));
          table.weight.push_back(static_cast<float>(a.weight * b.weight));
        }
        Block part;
        near_blocks(test, trial, table, 732.7F, part, unused);
        for (std::size_t i = 0; i < exact.size(); ++i)
          exact[i] += part[i];
      }
      Block wrong{};
      for (std::size_t i = 0; i < exact.size(); ++i)
        wrong[i] = pairs.blocks[entry][i] - exact[i];
      EXPECT_LE(size_of(wrong), 1e-3 * size_of(exact)) << size_of(wrong) / size_of(exact);
    }
  }
  EXPECT_EQ(looked_at, 3);
  EXPECT_TRUE(near_pairs(make_patches(two_cubes(0.05e-3)), 732.7).unresolved);
}

/// An octahedron whose faces around one corner become four times smaller from ring to ring.
geometry::Mesh graded(const Vec3& corner, double size, int levels) {
  geometry::Mesh mesh;
  mesh.positions = {corner, corner + Vec3(2 * size, 0, 0)};
  std::array<std::uint32_t, 4> ring{};
  const auto add_ring = [&](double scale) {
    std::array<std::uint32_t, 4> added{};
    const std::array<Vec3, 4> ways{Vec3(1, 1, 0), Vec3(1, 0, 1), Vec3(1, -1, 0), Vec3(1, 0, -1)};
    for (std::size_t i = 0; i < 4; ++i) {
      added[i] = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.push_back(corner + ways[i] * (size * scale));
    }
    return added;
  };
  ring = add_ring(1);
  for (std::size_t i = 0; i < 4; ++i)
    mesh.triangles.emplace_back(1, ring[i], ring[(i + 1) % 4]);
  double scale = 1;
  for (int level = 0; level < levels; ++level) {
    const std::array<std::uint32_t, 4> inner = add_ring(scale /= 4);
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t next = (i + 1) % 4;
      mesh.triangles.emplace_back(ring[i], inner[i], ring[next]);
      mesh.triangles.emplace_back(ring[next], inner[i], inner[next]);
    }
    ring = inner;
  }
  for (std::size_t i = 0; i < 4; ++i)
    mesh.triangles.emplace_back(ring[i], 0, ring[(i + 1) % 4]);
  return mesh;
}

TEST(NearPairs, EndOnStronglyGradedMeshes) {
  for (const Vec3& corner : {Vec3(0), Vec3(0.05, 0.02, 0.01)}) {
    const int levels = (corner == Vec3(0) ? 30 : 20) / (test::instrumented() ? 2 : 1);
    const geometry::Mesh mesh = graded(corner, 2e-3, levels);
    EXPECT_EQ(near_pairs(make_patches(mesh), k).first.size(), mesh.triangles.size() + 1);
  }
}

TEST(NearPairs, MemoryIsCountedForUnevenMeshesToo) {
  const geometry::Mesh even = geometry::icosphere(radius, 8);
  EXPECT_EQ(near_pair_count(even), near_pairs(make_patches(even), k).trial.size());
  EXPECT_NEAR(static_cast<double>(near_pair_count(even)) / 1280, 40, 5);
  // A needle's end in small faces, the rest of it in long faces, which are near to all the small ones.
  geometry::Mesh uneven = even;
  for (Vec3& p : uneven.positions)
    p.z *= p.z > 0 ? 100 : 1;
  EXPECT_GT(near_pair_count(uneven), 2 * near_pair_count(even));
  EXPECT_GT(dense_operator_bytes(uneven), dense_operator_bytes(even));
}

}  // namespace
}  // namespace palpa::acoustics
