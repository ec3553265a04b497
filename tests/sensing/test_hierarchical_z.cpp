// Meshes with many triangles behind each other: drawn from near to far, they give the same bytes as one triangle after
// the other, with far fewer rays. If this does not help, they are rejected.
#include "sensing/hierarchical_z.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "random_rig.hpp"
#include "sensing/depth_noise.hpp"
#include "sensing/synthetic.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

using geometry::Mesh;

struct Layer {
  std::vector<float> depth, slant;
  explicit Layer(std::size_t pixels) : depth(pixels, beyond), slant(pixels, 0) {}
};

/// One triangle after the other, with every ray tested against each.
void draw_in_order(const CameraTable& table, const glm::vec2* rays, std::span<const PlacedTriangle> triangles,
                   Layer& layer) {
  for (const PlacedTriangle& t : triangles) {
    for (std::uint32_t v = 0; v < table.height; ++v) {
      for (std::uint32_t u = 0; u < table.width; ++u) {
        const glm::vec2 ray = rays[std::size_t{v} * table.pitch + u];
        const std::size_t pixel = std::size_t{v} * table.width + u;
        RayHit hit{};
        if (!meets(t.edges, ray.x, ray.y, hit) || !(hit.depth < layer.depth[pixel])) continue;
        layer.depth[pixel] = static_cast<float>(hit.depth);
        layer.slant[pixel] = hit.slant;
      }
    }
  }
}

/// Triangles in the camera's coordinates: in front of it, through its image plane, on top of each other, thin as a
/// hair.
std::vector<PlacedTriangle> soup(std::mt19937_64& random, const CameraTable& table) {
  std::normal_distribution<double> normal;
  const auto near = [&](const Vec3& at, double size) {
    return at + size * Vec3(normal(random), normal(random), normal(random));
  };
  std::vector<PlacedTriangle> triangles;
  const auto add = [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const TriangleEdges edges(a, b, c);
    if (!edges.visible()) return;
    triangles.push_back({.edges = edges, .box = {0, 0, table.width, table.height}, .near = std::min({a.z, b.z, c.z})});
  };
  for (int i = 0; i < 60; ++i) {
    const Vec3 at(0.3 * normal(random), 0.3 * normal(random), 0.2 + std::abs(normal(random)));
    const Vec3 a = near(at, 0.2), b = near(at, 0.2), c = near(at, 0.2);
    add(a, b, c);
    add(b, a, near(at, 0.2));                        // shares an edge
    add(a, b, near(c, 1e-9));                        // lies on it, as far as single precision can tell
    add(a, c, b);                                    // the same from behind
    add(a, b, a + 0.7 * (b - a) + near({}, 1e-13));  // a needle
    add(near({}, 0.3), b, c);                        // may reach behind the camera
  }
  return triangles;
}

TEST(HierarchicalZ, IsDrawnAsOneTriangleAfterTheOther) {
  std::mt19937_64 random(3);
  for (int round = 0; round < 12; ++round) {
    const Camera camera = test::random_camera(random);
    const RayTables tables = make_rays(std::span(&camera, 1));
    const CameraTable& table = tables.cameras[0];
    const std::vector<PlacedTriangle> triangles = soup(random, table);
    Layer one_by_one(pixel_count(camera)), hierarchical(pixel_count(camera));
    // Some triangles are drawn before, like objects that never move.
    draw_in_order(table, tables.rays.data(), std::span(triangles).first(30), one_by_one);
    hierarchical = one_by_one;
    draw_in_order(table, tables.rays.data(), std::span(triangles).subspan(30), one_by_one);
    std::uint64_t looks = 0;
    ASSERT_TRUE(draw_hierarchical_z(table, tables.rays.data(), std::span(triangles).subspan(30), hierarchical.depth,
                                    hierarchical.slant, ~std::uint64_t{0}, looks));
    EXPECT_EQ(hierarchical.depth, one_by_one.depth) << round;
    EXPECT_EQ(hierarchical.slant, one_by_one.slant) << round;
    EXPECT_LT(looks, triangles.size() * pixel_count(camera) / 2);
  }
}

Mesh nested(int count) {
  Mesh all;
  for (int i = 0; i < count; ++i) {
    const double half = 0.01 + 0.09 * i / count;
    geometry::append(all, test::box(Vec3(-half), Vec3(half)));
  }
  return all;
}

FrameSet rendered(const Camera& camera, std::span<const Posed> skin) {
  FrameSet set;
  SyntheticRig({camera}, {}, Noise::d415, 1).render(skin, 0, set);
  return set;
}

TEST(HierarchicalZ, ManyThingsWithinEachOtherGiveTheSamePictureWholeAndInPieces) {
  const Mesh whole = nested(200);
  Camera straight = test::d415(test::look_at(Vec3(0.3, 0.2, 0.35), Vec3(0)));
  Camera bent = straight;
  bent.distortion[0] = 0.05;
  for (const Camera& camera : {straight, bent}) {
    std::vector<Mesh> pieces;
    for (std::size_t first = 0; first < whole.triangles.size(); first += 24) {
      pieces.push_back({whole.positions, {}});
      const auto from = whole.triangles.begin() + static_cast<std::ptrdiff_t>(first);
      pieces.back().triangles.assign(from, from + 24);
    }
    std::vector<Posed> posed;
    for (const Mesh& piece : pieces)
      posed.push_back({&piece, Transform(1.0)});
    const Posed one{&whole, Transform(1.0)};
    EXPECT_EQ(rendered(camera, std::span(&one, 1)).frames[0].depth, rendered(camera, posed).frames[0].depth);
  }
}

TEST(HierarchicalZ, AMeshWithTooManyLayersIsRefused) {
  Mesh sheets;
  for (int i = 0; i < 2000; ++i) {
    const auto first = static_cast<std::uint32_t>(sheets.positions.size());
    sheets.positions.insert(sheets.positions.end(), {{-1, -1, 0.5 + 1e-13 * i}, {1, -1, 0.5}, {0, 1, 0.5}});
    sheets.triangles.emplace_back(first, first + 1, first + 2);
  }
  const Posed posed{&sheets, Transform(1.0), "sheets.ply"};
  EXPECT_REFUSED(rendered(test::d415(Transform(1.0)), std::span(&posed, 1)), "sheets.ply: camera \"d415\"");
}

}  // namespace
}  // namespace palpa::sensing
