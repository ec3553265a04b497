// `palpa touch` on models of several kinds, against an independent computation: every point's depth by the nearest of
// all triangles and the generalized winding number, in double precision.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "cli/support/touch_json.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/solid.hpp"
#include "setup/load.hpp"
#include "setup/tasks/touch.hpp"
#include "setup/touch_input.hpp"
#include "support/instrumented.hpp"
#include "support/mesh_oracle.hpp"
#include "support/own_cache.hpp"
#include "support/shared_data.hpp"
#include "touch/types.hpp"

namespace palpa::test {
namespace {

using geometry::Mesh;

constexpr double boundary_m = 1e-6;  ///< that near to a boundary either answer is right
constexpr double pi = std::numbers::pi;

/// A grid of `rings` x `sides` quadrilaterals that closes around itself both ways.
Mesh closed_grid(std::uint32_t rings, std::uint32_t sides, const std::function<Vec3(double, double)>& at) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t k = 0; k < sides; ++k)
      mesh.positions.push_back(at(2 * pi * i / rings, 2 * pi * k / sides));
  }
  const auto index = [&](std::uint32_t i, std::uint32_t k) { return i % rings * sides + k % sides; };
  for (std::uint32_t i = 0; i < rings; ++i) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      mesh.triangles.emplace_back(index(i, k), index(i + 1, k), index(i, k + 1));
      mesh.triangles.emplace_back(index(i, k + 1), index(i + 1, k), index(i + 1, k + 1));
    }
  }
  return mesh;
}

/// A ball whose radius depends on the direction, from poles to poles.
Mesh ball(std::uint32_t rings, std::uint32_t sides, const std::function<double(const Vec3&)>& radius) {
  Mesh mesh;
  const auto add = [&](const Vec3& direction) { mesh.positions.push_back(radius(direction) * direction); };
  add({0, 0, 1});
  for (std::uint32_t i = 1; i < rings; ++i) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      const double polar = pi * i / rings, around = 2 * pi * k / sides;
      add({std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)});
    }
  }
  add({0, 0, -1});
  const auto index = [&](std::uint32_t i, std::uint32_t k) { return 1 + (i - 1) * sides + k % sides; };
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (std::uint32_t k = 0; k < sides; ++k) {
    mesh.triangles.emplace_back(0, index(1, k), index(1, k + 1));
    mesh.triangles.emplace_back(last, index(rings - 1, k + 1), index(rings - 1, k));
    for (std::uint32_t i = 1; i + 1 < rings; ++i) {
      mesh.triangles.emplace_back(index(i, k), index(i + 1, k), index(i, k + 1));
      mesh.triangles.emplace_back(index(i, k + 1), index(i + 1, k), index(i + 1, k + 1));
    }
  }
  return mesh;
}

/// An outline of the plane, counter-clockwise, drawn out from z = 0 to `height`; its lid and floor are fans around a
/// point that sees all of it.
Mesh prism(const std::vector<Vec2>& outline, const Vec2& middle, double height) {
  Mesh mesh;
  const auto count = static_cast<std::uint32_t>(outline.size());
  for (const double z : {0.0, height}) {
    for (const Vec2& p : outline)
      mesh.positions.emplace_back(p.x, p.y, z);
  }
  mesh.positions.emplace_back(middle.x, middle.y, 0);
  mesh.positions.emplace_back(middle.x, middle.y, height);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t next = (i + 1) % count;
    mesh.triangles.emplace_back(i, next, count + next);
    mesh.triangles.emplace_back(i, count + next, count + i);
    mesh.triangles.emplace_back(2 * count, next, i);
    mesh.triangles.emplace_back(2 * count + 1, count + i, count + next);
  }
  return mesh;
}

Mesh torus() {
  return closed_grid(60, 40, [](double around, double across) {
    const double r = 0.030 + 0.009 * std::cos(across);
    return Vec3(r * std::cos(around), 0.009 * std::sin(across), -r * std::sin(around));
  });
}

/// Ridges and hollows all over, nowhere flat.
Mesh star() {
  return ball(60, 90, [](const Vec3& d) {
    return 0.030 + 0.006 * std::sin(9 * std::atan2(d.y, d.x)) * (1 - d.z * d.z) + 0.003 * std::cos(11 * std::acos(d.z));
  });
}

/// A ball with a ball-shaped hole in its middle: two shells, the inner one facing inwards.
Mesh hollow() {
  Mesh mesh = ball(40, 60, [](const Vec3&) { return 0.030; });
  Mesh hole = ball(24, 36, [](const Vec3&) { return 0.022; });
  for (Vec3& p : hole.positions)
    p += Vec3(0.004, 0, 0.001);
  geometry::flip(hole);
  geometry::append(mesh, hole);
  return mesh;
}

/// Thinner than two shells: 1 mm, and as a crescent, not convex.
Mesh plate() {
  std::vector<Vec2> outline;
  for (int i = 0; i < 120; ++i) {
    const double angle = 2 * pi * i / 120;
    outline.push_back((0.030 + 0.010 * std::cos(5 * angle)) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return prism(outline, Vec2(0), 0.001);
}

/// Sharp in both senses: spikes of 20 degrees with gorges between them, long thin triangles.
Mesh spikes() {
  std::vector<Vec2> outline;
  for (int i = 0; i < 24; ++i) {
    const double angle = 2 * pi * i / 24;
    outline.push_back((i % 2 == 0 ? 0.040 : 0.018) * Vec2(std::cos(angle), std::sin(angle)));
  }
  return prism(outline, Vec2(0), 0.025);
}

Mesh asset(const std::string& name) {
  Mesh mesh;
  for (const geometry::SceneMesh& part : geometry::load_gltf(source_file("assets/" + name)).meshes)
    geometry::append(mesh, part.mesh);
  return mesh;
}

float rounded(double value) {
  return static_cast<float>(value);
}

/// Most of them within a few millimetres of faces, corners and edges; some anywhere in and around the model.
std::vector<Vec3> points_about(const Mesh& mesh, std::size_t point_count, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> near(0, 0.0015);
  std::vector<double> areas;
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t.x];
    areas.push_back(glm::length(glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a)));
  }
  std::discrete_distribution<std::size_t> some_triangle(areas.begin(), areas.end());
  const Box box = geometry::bounds(mesh);
  std::vector<Vec3> points;
  while (points.size() < point_count) {
    const double kind = unit(random);
    Vec3 p;
    if (kind < 0.6) {
      const glm::uvec3& t = mesh.triangles[some_triangle(random)];
      const Vec3 a = mesh.positions[t.x], u = mesh.positions[t.y] - a, v = mesh.positions[t.z] - a;
      double s = unit(random), r = unit(random);
      if (s + r > 1) s = 1 - s, r = 1 - r;
      p = a + s * u + r * v - (0.0055 * unit(random) - 0.002) * glm::normalize(glm::cross(u, v));
    } else if (kind < 0.8) {
      p = mesh.positions[random() % mesh.positions.size()] + Vec3(near(random), near(random), near(random));
    } else {
      const Vec3 margin(0.002);
      p = box.low - margin + Vec3(unit(random), unit(random), unit(random)) * (box.high - box.low + 2.0 * margin);
    }
    points.emplace_back(rounded(p.x), rounded(p.y), rounded(p.z));
  }
  return points;
}

struct Model {
  const char* name;
  Mesh (*make)();
};

void PrintTo(const Model& model, std::ostream* out) {
  *out << model.name;
}

/// The contacts of the points of a file with the solids of another file, as the command computes them.
std::vector<touch::Contact> contacts_of(const std::vector<geometry::Solid>& solids, const std::string& scene,
                                        const std::string& cloud, setup::Backend backend, double delta) {
  setup::TouchTask options;
  options.compute.backend = backend;
  options.touch.parameters.delta_m = delta;
  options.touch.parameters.finger_gap_m = 0.02;  // a thin cloud would have more fingers than palpa handles
  setup::check(options, false);
  setup::TouchInputOptions input;
  input.scene = scene;
  input.points = cloud;
  return setup::touch_scene(options, scene, solids, setup::load_touch_input(input, solids)).touch().contacts;
}

class Surface : public testing::TestWithParam<Model> {
 protected:
  const std::filesystem::path folder_ = scratch_folder("surface");
  const OwnCache cache_{folder_};  ///< the second backend uses the surfaces that were prepared for the first
};

TEST_P(Surface, ContactsAreThoseOfTheNearestTriangleAndTheWindingNumber) {
  const std::size_t point_count = std::getenv("PALPA_EXHAUSTIVE") ? 100'000 : fewer(30'000);
  Mesh mesh = GetParam().make();
  for (Vec3& p : mesh.positions)
    p = Vec3(rounded(p.x), rounded(p.y), rounded(p.z));
  const std::string scene = folder_ / "model.glb", cloud = folder_ / "points.ply";
  geometry::write_glb(scene, std::vector<geometry::SceneMesh>{{"model", mesh}});
  const std::vector<Vec3> points = points_about(mesh, point_count, 17);
  geometry::write_ply(cloud, points);

  const MeshOracle oracle(mesh);
  ASSERT_GT(geometry::signed_volume(mesh), 0);
  constexpr double delta = 1.5e-3;
  // Positive inside; the side matters only where the surface is near.
  std::vector<double> depths;
  depths.reserve(points.size());
  for (const Vec3& point : points) {
    const double distance = oracle.distance(point, 2 * delta);
    depths.push_back(distance < 2 * delta && oracle.winding(point) < 0.5 ? -distance : distance);
  }
  const std::vector<geometry::Solid> solids = setup::load_solids(scene);
  for (const setup::Backend backend : {setup::Backend::gpu, setup::Backend::cpu}) {
    const char* const name = backend == setup::Backend::gpu ? "gpu" : "cpu";
    std::vector<double> found(points.size(), 0);
    for (const touch::Contact& contact : contacts_of(solids, scene, cloud, backend, delta))
      found.at(contact.point) = contact.depth_m;
    std::size_t wrong = 0, contacts = 0, undecided = 0;
    double worst = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double depth = depths[i];
      if (std::abs(depth) < boundary_m || std::abs(depth - delta) < boundary_m) {
        ++undecided;
        continue;
      }
      const bool contact = depth > 0 && depth < delta;
      if (contact != (found[i] != 0) && ++wrong <= 5) {
        ADD_FAILURE() << name << ": point " << i << " is " << depth << " m deep, reported " << found[i];
      }
      if (contact && found[i] != 0) worst = std::max(worst, std::abs(depth - found[i]));
      contacts += contact ? 1 : 0;
    }
    EXPECT_EQ(wrong, 0U) << name;
    EXPECT_LT(worst, boundary_m) << name;
    EXPECT_GT(contacts, point_count / 20) << "too few contacts to show anything";
    EXPECT_LT(undecided, point_count / 500);
  }
}

const std::vector<Model> models{{"torus", torus},
                                {"spikes", spikes},
                                {"plate", plate},
                                {"hollow", hollow},
                                {"star", star},
                                {"hand", [] { return asset("hand.glb"); }},
                                {"finger", [] { return asset("finger.glb"); }}};
INSTANTIATE_TEST_SUITE_P(Models, Surface, testing::ValuesIn(the_first(3, models)),
                         [](const auto& model) { return std::string(model.param.name); });

TEST(SurfaceProgram, TellsTheSameContacts) {
  const Mesh mesh = torus();
  const auto folder = scratch_folder("surface-program");
  const std::string scene = folder / "model.glb", cloud = folder / "points.ply";
  geometry::write_glb(scene, std::vector<geometry::SceneMesh>{{"model", mesh}});
  geometry::write_ply(cloud, points_about(mesh, fewer(30'000), 3));
  const TouchReport report =
      run_touch({"--scene", scene, "--points", cloud, "--backend", "cpu", "--finger-gap", "20mm"});
  EXPECT_EQ(report.points, fewer(30'000));
  const std::vector<touch::Contact> contacts =
      contacts_of(setup::load_solids(scene), scene, cloud, setup::Backend::cpu, 1.5e-3);
  ASSERT_EQ(report.contacts.size(), contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    ASSERT_EQ(report.contacts[i], contacts[i].point);
    ASSERT_EQ(static_cast<float>(report.depths[i]), contacts[i].depth_m);
  }
}

TEST(Oracle, ItsTreeSaysWhatAllTrianglesSay) {
  for (const Model& model : models) {
    const Mesh mesh = model.make();
    const MeshOracle oracle(mesh);
    const std::vector<Vec3> points = points_about(mesh, fewer(100), 5);
    std::vector<double> least(points.size(), 1e300);
    for (const glm::uvec3& t : mesh.triangles) {
      const MeshOracle one({{mesh.positions[t.x], mesh.positions[t.y], mesh.positions[t.z]}, {{0, 1, 2}}});
      for (std::size_t i = 0; i < points.size(); ++i)
        least[i] = std::min(least[i], one.distance(points[i]));
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double exact = oracle.winding(points[i], 1e300);
      EXPECT_NEAR(exact, std::round(exact), 1e-6) << model.name;
      EXPECT_NEAR(oracle.winding(points[i]), exact, 0.25) << model.name;
      EXPECT_NEAR(oracle.distance(points[i]), least[i], 1e-12) << model.name;
    }
  }
}

}  // namespace
}  // namespace palpa::test
