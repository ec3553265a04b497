// What is kept between runs: the second time a model is read, everything is as it was the first time.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "geometry/solid.hpp"
#include "support/captured.hpp"
#include "support/own_cache.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

/// All of them have more triangles than are worth keeping.
Mesh fine_box() {
  return test::divided_box(Vec3(0.02, 0.015, 0.01), 5);
}

/// The triangles whose middle lies on one side.
Mesh half_of(const Mesh& mesh, bool upper) {
  Mesh half{mesh.positions, {}};
  for (const glm::uvec3& t : mesh.triangles) {
    const double z = mesh.positions[t.x].z + mesh.positions[t.y].z + mesh.positions[t.z].z;
    if ((z > 0) == upper) half.triangles.push_back(t);
  }
  return half;
}

Scene scene_of(const std::string& kind) {
  Scene scene{"test.glb", {}};
  const auto add = [&](Mesh mesh) {
    scene.meshes.push_back({"mesh " + std::to_string(scene.meshes.size()), std::move(mesh)});
  };
  Mesh mesh = fine_box();
  if (kind == "whole") {
    add(std::move(mesh));
  } else if (kind == "open pieces") {
    add(half_of(mesh, true));
    add(half_of(mesh, false));
  } else if (kind == "inside out") {
    for (glm::uvec3& t : mesh.triangles)
      std::swap(t.y, t.z);
    add(std::move(mesh));
  } else if (kind == "with a hole") {
    mesh.triangles.erase(mesh.triangles.begin() + 40);
    add(std::move(mesh));
  } else if (kind == "two alike") {
    add(mesh);
    add(test::transformed(mesh, [](const Vec3& p) { return p + Vec3(0.1, 0, 0); }));
    scene.meshes[0].haptics.delta_m = 2e-3;
  } else {
    add(test::torus(0.02, 0.006, 80));  // concave
  }
  return scene;
}

struct Read {
  std::string warnings, fault;
  std::vector<Solid> solids;
};

Read read(const std::string& kind, SurfaceKind surface) {
  Read out;
  out.warnings =
      test::stderr_of([&] { out.fault = test::error_of([&] { out.solids = make_solids(scene_of(kind), surface); }); });
  return out;
}

TEST(KeptSolids, TheSecondTimeIsAsTheFirst) {
  const test::OwnCache cache(test::scratch_folder("kept-solids"));
  bool warns = false;
  for (const SurfaceKind surface : {SurfaceKind::mesh, SurfaceKind::parts}) {
    for (const std::string kind : {"whole", "open pieces", "inside out", "with a hole", "two alike", "concave"}) {
      const Read cold = read(kind, surface), warm = read(kind, surface);
      warns = warns || !cold.warnings.empty();
      EXPECT_EQ(cold.warnings, warm.warnings) << kind;
      EXPECT_EQ(cold.fault, warm.fault) << kind;
      ASSERT_EQ(cold.solids.size(), warm.solids.size()) << kind;
      for (std::size_t s = 0; s < cold.solids.size(); ++s) {
        const Solid &a = cold.solids[s], &b = warm.solids[s];
        EXPECT_EQ(a.name, b.name) << kind;
        EXPECT_TRUE(a.mesh.positions == b.mesh.positions && a.mesh.triangles == b.mesh.triangles) << kind;
        EXPECT_EQ(a.haptics.delta_m, b.haptics.delta_m) << kind;
        EXPECT_TRUE(std::ranges::equal(a.planes, b.planes, [](const Plane& x, const Plane& y) {
          return x.normal == y.normal && x.offset == y.offset;
        })) << kind;
      }
    }
  }
  EXPECT_TRUE(warns) << "none of the models is repaired";
}

}  // namespace
}  // namespace palpa::geometry
