// Many nodes that show one mesh: the results for the first hold for all, and each gives the same answers as alone.
#include "geometry/rigid_copies.hpp"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "base/log.hpp"
#include "geometry/solid.hpp"
#include "support/captured.hpp"
#include "support/occurrences.hpp"
#include "support/shapes.hpp"

namespace palpa::geometry {
namespace {

// Adds a copy of a scene's mesh `number`.
void add_copy(Scene& scene, const std::string& name, const Mesh& mesh, std::uint32_t number, const Transform& T) {
  SceneMesh out{name, test::transformed(mesh, [&](const Vec3& p) { return transform_point(T, p); })};
  out.copy = CopyOf{number, T};
  scene.meshes.push_back(std::move(out));
}

// Other values of everything that is felt, for each number.
Haptics unlike_haptics(std::uint32_t number) {
  const double part = 1.0 / (1 + number);
  return {.delta_m = 0.01 * part,
          .dwell_s = 0.1 * part,
          .intensity = part,
          .pressure_pa = 1e4 * part,
          .press_depth_m = 0.1 * part,
          .foci = 1 + number % 64,
          .stride = 1 + number,
          .click = Click{0.03 + 0.03 * part, 150 + 50 * part},
          .stiffness = {{{0, part}, {0.01, 1}}},
          .texture = {{1, part, 0}},
          .grain_m = 0.1 * part};
}

// This many copies, each turned and moved, and felt in its own way; every third is twice as large, every fifth
// mirrored.
Scene copies_of(const Mesh& mesh, std::uint32_t count) {
  Scene scene{"test.glb", {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    Transform T = glm::translate(Transform(1), Vec3(0.3 * i, 0.1, -0.2));
    T = glm::rotate(T, 0.1 * i, glm::normalize(Vec3(1, 2, 3)));
    T = glm::scale(T, Vec3(i % 3 == 2 ? 2 : 1) * Vec3(1, 1, i % 5 == 4 ? -1 : 1));
    add_copy(scene, "copy " + std::to_string(i), mesh, 0, T);
    if (i % 5 == 4) flip(scene.meshes.back().mesh);
    scene.meshes.back().haptics = unlike_haptics(i);
  }
  return scene;
}

Scene without_copies(Scene scene) {
  for (SceneMesh& mesh : scene.meshes)
    mesh.copy.reset();
  return scene;
}

std::string debug_lines_of(const std::function<void()>& action) {
  const log::Level before = log::level();
  log::set_level(log::Level::debug);
  std::string lines = test::stderr_of(action);
  log::set_level(before);
  return lines;
}

TEST(RigidCopies, AreCheckedOncePerScaleAndMirroring) {
  const Scene scene = copies_of(test::ell(), 120);
  std::vector<Solid> solids;
  const std::string lines = debug_lines_of([&] { solids = make_solids(scene); });
  EXPECT_EQ(test::occurrences(lines, "is checked"), 4U);
  const std::vector<Solid> alone = make_solids(without_copies(scene));
  ASSERT_EQ(solids.size(), alone.size());
  for (std::size_t i = 0; i < solids.size(); ++i) {
    EXPECT_EQ(solids[i].name, alone[i].name);
    EXPECT_EQ(solids[i].file, alone[i].file);
    EXPECT_TRUE(solids[i].haptics == scene.meshes[i].haptics && alone[i].haptics == scene.meshes[i].haptics) << i;
    EXPECT_EQ(solids[i].mesh.positions, alone[i].mesh.positions);
    EXPECT_EQ(solids[i].mesh.triangles, alone[i].mesh.triangles);
    EXPECT_EQ(solids[i].bounds.low, alone[i].bounds.low);
    EXPECT_TRUE(solids[i].copy.shape != nullptr);
    EXPECT_TRUE(alone[i].copy.shape == nullptr);
  }
  EXPECT_TRUE(solids[0].copy.shape == solids[1].copy.shape);
  EXPECT_FALSE(solids[0].copy.shape == solids[2].copy.shape);
  EXPECT_FALSE(solids[0].copy.shape == solids[4].copy.shape);
}

TEST(RigidCopies, OfAConvexMeshHaveItsPlanes) {
  const Scene scene = copies_of(test::sphere(0.05, 6, 8), 90);
  const std::vector<Solid> solids = make_solids(scene), alone = make_solids(without_copies(scene));
  for (std::size_t i = 0; i < solids.size(); ++i) {
    ASSERT_EQ(solids[i].planes.size(), alone[i].planes.size());
    for (std::size_t m = 0; m < solids[i].planes.size(); ++m) {
      EXPECT_LT(glm::distance(solids[i].planes[m].normal, alone[i].planes[m].normal), 1e-9);
      EXPECT_NEAR(solids[i].planes[m].offset, alone[i].planes[m].offset, 1e-9);
    }
  }
}

TEST(RigidCopies, FewCopiesAreEachChecked) {
  const Scene scene = copies_of(test::ell(), 12);
  EXPECT_EQ(test::occurrences(debug_lines_of([&] { make_solids(scene); }), "is checked"), 12U);
}

TEST(RigidCopies, OpenCopiesCloseTogether) {
  // Halves of boxes, two nodes each.
  Mesh half = test::box(Vec3(0), Vec3(0.01)), other = half;
  half.triangles.resize(6);
  other.triangles.erase(other.triangles.begin(), other.triangles.begin() + 6);
  Scene scene{"test.glb", {}};
  for (std::uint32_t i = 0; i < 60; ++i) {
    const Transform T = glm::translate(Transform(1), Vec3(0.02 * i, 0, 0));
    add_copy(scene, "piece", half, 0, T);
    add_copy(scene, "piece", other, 1, T);
  }
  const std::vector<Solid> solids = make_solids(scene);
  EXPECT_EQ(solids.size(), 60U);
  for (const Solid& solid : solids)
    EXPECT_EQ(solid.planes.size(), 6U);
}

TEST(RigidCopies, SceneryAndPartsAreNoCopies) {
  Scene scene = copies_of(test::ell(), 120);
  scene.meshes[0].haptics.touchable = false;
  scene.meshes[1].part = PartOf{"solid"};
  const std::vector<std::uint32_t> first = find_rigid_copies(scene);
  EXPECT_EQ(first[0], 0U);
  EXPECT_EQ(first[1], 1U);
  EXPECT_EQ(first[3], 3U);
  EXPECT_EQ(first[6], 3U);
}

}  // namespace
}  // namespace palpa::geometry
