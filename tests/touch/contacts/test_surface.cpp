// Contacts with solids of any shape, on both backends, against an independent double-precision computation.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <map>
#include <mutex>
#include <random>

#include "base/error.hpp"
#include "base/system/parallel.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "geometry/surface/surface.hpp"
#include "support/barriers.hpp"
#include "support/exhaustive.hpp"
#include "support/hand_skin.hpp"
#include "support/instrumented.hpp"
#include "support/own_cache.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "touch/check_parameters.hpp"
#include "touch/contacts/contacts_twin.hpp"
#include "touch/contacts/exact_contacts.hpp"
#include "touch/contacts/surface_models.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

std::vector<geometry::Solid> solid_of(const geometry::Mesh& mesh) {
  return geometry::make_solids({"test", {{"object", mesh}}});
}

geometry::Mesh mesh_of(const std::string& asset) {
  geometry::Mesh mesh;
  for (const geometry::SceneMesh& part : geometry::load_gltf(palpa::test::source_file("assets/" + asset)).meshes)
    geometry::append(mesh, part.mesh);
  return mesh;
}

/// A scan of a round thing: from its middle all of it is about as far away.
geometry::Mesh rough_ball() {
  geometry::Mesh ball = geometry::icosphere(0.02, 32);
  std::mt19937 random(6);
  std::normal_distribution<double> noise(1, 0.003);
  for (Vec3& p : ball.positions)
    p *= noise(random);
  return tilted(ball, {0.01, 0, 0.1});
}

/// The models' names: every topic of this folder asks for them when it starts. Those with many triangles come last.
constexpr const char* model_names[] = {"ring",       "notched_cube", "hollow_ball", "thin_plate", "needle_cylinder",
                                       "subdivided", "spikes",       "star",        "hand",       "finger",
                                       "rough_ball"};

geometry::Mesh model(int which) {
  switch (which) {
    case 0:
      return tilted(palpa::test::torus(0.012, 0.004, 40), {0.1, -0.2, 0.05});
    case 1:
      return notched_cube();
    case 2:
      return tilted(hollow_ball(), {0, 0, 0.3});
    case 3:
      return tilted(thin_plate(), {0.02, 0.03, -0.4});
    case 4:
      return tilted(needle_cylinder(400), {0, 0.01, 0});
    case 5:
      return tilted(palpa::test::divided(notched_cube(), 2), {-0.3, 0.2, 0.1});
    case 6:
      return tilted(spikes(), {0.1, 0, 0.2});
    case 7:
      return tilted(star(), {0, -0.1, 0});
    case 8:
      return mesh_of("hand-relaxed.glb");
    case 9:
      return palpa::test::finger_skin().mesh;
    default:
      return rough_ball();
  }
}

struct Checked {
  std::size_t contacts = 0, deep = 0, undecided = 0;
  double worst_deep = 0;
};

/// Every point that double precision decides by more than the band is decided the same way, with the same depth.
Checked expect_truth(const Touch& touch, const std::vector<glm::vec3>& points, const Truth& truth, double delta,
                     bool with_deep) {
  std::vector<const Contact*> contact(points.size(), nullptr), deep(points.size(), nullptr);
  for (const Contact& c : touch.contacts)
    contact.at(c.point) = &c;
  for (const Contact& c : touch.deep)
    deep.at(c.point) = &c;
  std::mutex mutex;
  Checked all;
  std::atomic<int> wrong{0};
  parallel_chunks(points.size(), 1000, [&](std::size_t, std::size_t begin, std::size_t end) {
    Checked mine;
    for (std::size_t i = begin; i < end && wrong < 5; ++i) {
      const double depth = truth.depth(Vec3(points[i]), i % 100 == 0);
      if (std::abs(depth) < band || std::abs(depth - delta) < band) {
        ++mine.undecided;
        continue;
      }
      const bool in_shell = depth > 0 && depth < delta, is_deep = with_deep && depth > delta;
      const bool right = (contact[i] != nullptr) == in_shell && (deep[i] != nullptr) == is_deep;
      if (!right || (in_shell && std::abs(contact[i]->depth_m - depth) > band)) {
        ++wrong;
        const std::lock_guard lock(mutex);
        ADD_FAILURE() << "point " << i << " at " << points[i].x << " " << points[i].y << " " << points[i].z << " depth "
                      << depth << " contact " << (contact[i] ? contact[i]->depth_m : 0) << " deep "
                      << (deep[i] ? deep[i]->depth_m : 0);
        continue;
      }
      mine.contacts += in_shell ? 1 : 0;
      if (!is_deep) continue;
      ++mine.deep;
      if (depth < 7e-3) mine.worst_deep = std::max(mine.worst_deep, deep[i]->depth_m / depth - 1);
      if (deep[i]->depth_m < std::min(depth, 7e-3) * (1 - 1e-5)) ++wrong;
    }
    const std::lock_guard lock(mutex);
    all.contacts += mine.contacts;
    all.deep += mine.deep;
    all.undecided += mine.undecided;
    all.worst_deep = std::max(all.worst_deep, mine.worst_deep);
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_LT(all.undecided, points.size() / 20);
  return all;
}

class Surfaces : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(, Surfaces, ::testing::Range(0, palpa::test::instrumented() ? 7 : 11),
                         [](const auto& which) { return std::string(model_names[which.param]); });

/// Contacts of two runs on the device and, with the same tables, on the host: all agree.
Touch touch_on_both(DeviceStage& device, const std::vector<glm::vec3>& points) {
  Touch gpu, again, cpu;
  device.touch(indexed(points), gpu);
  device.touch(indexed(points), again);
  expect_identical(gpu, again);
  find_contacts(indexed(points), device.solids(), device.setting().parameters, {}, cpu);
  again.finger_count = again.cluster_count = 0;
  expect_identical(again, cpu);
  EXPECT_EQ(gpu.deep.size(), cpu.deep.size());
  for (std::size_t i = 0; i < std::min(gpu.deep.size(), cpu.deep.size()); ++i) {
    EXPECT_EQ(gpu.deep[i].point, cpu.deep[i].point);
    EXPECT_EQ(gpu.deep[i].depth_m, cpu.deep[i].depth_m);
    EXPECT_EQ(gpu.deep[i].position, points[cpu.deep[i].point]);
  }
  return gpu;
}

StageSetting setting_for(const std::vector<glm::vec3>& points, const FingerOptions& parameters = {}) {
  const auto count = static_cast<std::uint32_t>(points.size());
  return {.parameters = parameters, .most_points = count, .most_contacts = count};
}

Touch touch_on_both(const std::vector<glm::vec3>& points, const std::vector<geometry::Solid>& solids,
                    const FingerOptions& parameters = {}) {
  DeviceStage device(solids, {}, setting_for(points, parameters));
  return touch_on_both(device, points);
}

/// A model as a solid, checked and prepared once for all tests that use it.
struct Model {
  std::vector<geometry::Solid> solids;
  Truth truth;
  std::vector<glm::vec3> points;
  DeviceStage device;

  explicit Model(const geometry::Mesh& mesh)
      : solids(solid_of(mesh)),
        truth(solids[0].mesh),
        points(points_near(solids[0].mesh, palpa::test::samples(25'000, 100'000), 3)),
        device(solids, {}, setting_for(points)) {}
};

Model& known_model(int which) {
  test_passes();  // made before, so that the models' memory is freed before their device
  static std::map<int, std::unique_ptr<Model>> made;
  std::unique_ptr<Model>& known = made[which];
  if (!known) known = std::make_unique<Model>(model(which));
  return *known;
}

TEST_P(Surfaces, AgreeWithBruteForce) {
  Model& model = known_model(GetParam());
  const Touch touch = touch_on_both(model.device, model.points);
  EXPECT_TRUE(touch.deep.empty());
  const Checked checked = expect_truth(touch, model.points, model.truth, 1.5e-3, false);
  EXPECT_GT(checked.contacts, model.points.size() / 20);
}

TEST_P(Surfaces, FindDeepPointsWhereAsked) {
  const Model& model = known_model(GetParam());
  const auto points = points_near(model.solids[0].mesh, palpa::test::samples(8'000, 20'000), 4);
  const FingerOptions parameters{.delta_m = 0.8e-3, .deep = true};
  const Touch touch = touch_on_both(points, model.solids, parameters);
  const Checked checked = expect_truth(touch, points, model.truth, parameters.delta_m, true);
  EXPECT_LT(checked.worst_deep, 0.0201);
}

// Large meshes are checked and prepared once: later runs read both from files.
TEST(KeptSurfaces, AnswerAsWhenTheyWereMade) {
  const std::filesystem::path folder = palpa::test::scratch_folder("kept-surfaces");
  const palpa::test::OwnCache cache(folder);
  const geometry::Mesh mesh = tilted(star(), {0, 0, 0.1});
  const auto points = points_near(mesh, palpa::test::fewer(10'000), 5);
  const auto files = [&] {
    const std::filesystem::recursive_directory_iterator all(folder), end;
    return std::count_if(all, end, [](const auto& entry) { return entry.is_regular_file(); });
  };
  Touch made, kept;
  Stage(solid_of(mesh)).touch(indexed(points), made);
  const auto after = files();
  EXPECT_GE(after, 2) << "the solid, and its surface";
  Stage(solid_of(mesh)).touch(indexed(points), kept);
  EXPECT_EQ(files(), after);
  EXPECT_GT(made.contacts.size(), points.size() / 20);
  expect_identical(made, kept);
}

/// Moves the points back instead of the solid.
std::vector<glm::vec3> carried(const Transform& T, const std::vector<glm::vec3>& points) {
  std::vector<glm::vec3> out;
  for (const glm::vec3& p : points)
    out.emplace_back(transform_point(T, Vec3(p)));
  return out;
}

TEST(Poses, OfAMovingSolidGiveWhatMovingThePointsBackGives) {
  std::vector<geometry::Solid> solids = known_model(0).solids;
  solids.push_back(cube());
  PreparedSolids prepared = prepare_solids(solids);
  const auto skin = points_near(solids[0].mesh, palpa::test::samples(10'000, 20'000), 6);
  const Truth& truth = known_model(0).truth;
  for (const double turn : {0.0, 0.3, 2.0}) {
    Transform T(std::cos(turn), std::sin(turn), 0, 0, -std::sin(turn), std::cos(turn), 0, 0, 0, 0, 1, 0, 0.05, -0.02,
                turn, 1);
    set_pose(prepared, 0, T);
    const auto moved = carried(T, skin);
    Touch here;
    find_contacts(indexed(moved), prepared, {}, {}, here);
    const Transform back = glm::inverse(T);
    std::size_t i = 0;
    for (std::uint32_t p = 0; p < moved.size(); ++p) {
      while (i < here.contacts.size() && here.contacts[i].point < p)
        ++i;
      const bool contact = i < here.contacts.size() && here.contacts[i].point == p && here.contacts[i].solid == 0;
      const double depth = truth.depth(transform_point(back, Vec3(moved[p])), false);
      if (std::abs(depth) < band || std::abs(depth - 1.5e-3) < band) continue;
      ASSERT_EQ(contact, depth > 0 && depth < 1.5e-3) << "point " << p << " depth " << depth;
    }
    EXPECT_GT(here.contacts.size(), skin.size() / 5);
    const Box box = touchable_box(prepared);
    for (const Contact& contact : here.contacts)
      EXPECT_TRUE(glm::all(glm::greaterThan(Vec3(contact.position), box.low)) &&
                  glm::all(glm::lessThan(Vec3(contact.position), box.high)));
    if (turn == 0) {
      EXPECT_NEAR(touchable_box(prepared).high.x, std::max(solids[0].bounds.high.x + 0.05, 0.02), 2e-4);
    }
  }
}

TEST(Poses, AreRigid) {
  PreparedSolids prepared = prepare_solids({cube()});
  EXPECT_ERROR(set_pose(prepared, 1, Transform(1.0)), Exit::usage, "solid 1: the scene has 1 solid");
  EXPECT_ERROR(set_pose(prepared, 0, Transform(2.0)), Exit::usage, "solid 0: not a rigid motion");
  Transform mirror(1.0);
  mirror[0][0] = -1;
  EXPECT_ERROR(set_pose(prepared, 0, mirror), Exit::usage, "solid 0: not a rigid motion");
  Transform scaled(1.0);
  scaled[1][1] = 1.01;
  EXPECT_ERROR(set_pose(prepared, 0, scaled), Exit::usage, "solid 0: not a rigid motion");
  EXPECT_NO_THROW(set_pose(prepared, 0, Transform(1.0)));
}

TEST(Deltas, MayBeASolidsOwn) {
  std::vector<geometry::Solid> solids = solid_of(model(1));
  solids[0].haptics.delta_m = 3e-3;
  const auto points = points_near(solids[0].mesh, palpa::test::fewer(20'000), 7);
  expect_truth(touch_on_both(points, solids), points, Truth(solids[0].mesh), 3e-3, false);
  // A table that was made for less is refused, not wrong.
  const PreparedSolids prepared = prepare_solids(solids);
  EXPECT_NO_THROW(check_parameters({.delta_m = 5e-3}, prepared));
  solids[0].haptics.delta_m.reset();
  EXPECT_ERROR(check_parameters({.delta_m = 5e-3}, prepare_solids(solids)), Exit::usage, "contacts up to 0.0015 m");
  EXPECT_ERROR(check_parameters({.deep = true}, prepare_solids(solids)), Exit::usage, "no deep points");
}

TEST(SeveralSurfaces, ShareTheirBuffers) {
  std::vector<geometry::Solid> solids;
  std::vector<glm::vec3> points;
  for (const int which : {1, 2, 0}) {
    const auto one = solid_of(tilted(model(which), Vec3(0.1 * which, 0, 0)));
    solids.push_back(one[0]);
    const auto near = points_near(one[0].mesh, 6'000, static_cast<unsigned>(which));
    points.insert(points.end(), near.begin(), near.end());
  }
  solids.insert(solids.begin() + 1, cube());
  const FingerOptions parameters{.deep = true};
  const Touch touch = touch_on_both(points, solids, parameters);
  std::array<int, 4> of_solid{};
  for (const Contact& contact : touch.contacts)
    ++of_solid[contact.solid];
  EXPECT_GT(of_solid[0], 500);
  EXPECT_GT(of_solid[2], 500);
  EXPECT_GT(of_solid[3], 500);
}

/// Many copies of one solid, each turned and moved, as a file has them that shows one mesh by many nodes.
std::vector<geometry::Solid> copies_of(const geometry::Mesh& mesh, std::uint32_t count, bool shared) {
  geometry::Scene scene{"test.glb", {}};
  for (std::uint32_t i = 0; i < count; ++i) {
    Transform T = glm::translate(Transform(1), Vec3(0.09 * (i % 8), 0.09 * (i / 8), 0));
    T = glm::rotate(T, 0.37 * i, glm::normalize(Vec3(1, -2, 0.5)));
    geometry::SceneMesh out{"copy", mesh};
    for (Vec3& p : out.mesh.positions)
      p = transform_point(T, p);
    if (shared) out.copy = geometry::CopyOf{0, T};
    scene.meshes.push_back(std::move(out));
  }
  return geometry::make_solids(scene);
}

TEST(RigidCopies, ShareOneSurfaceAndAnswerAsIfEachHadItsOwn) {
  constexpr std::uint32_t count = 64;  // fewer are not worth sharing
  constexpr std::uint32_t step = palpa::test::instrumented() ? 16 : 5;
  const geometry::Mesh mesh = notched_cube();
  const std::vector<geometry::Solid> solids = copies_of(mesh, count, true), alone = copies_of(mesh, count, false);
  const PreparedSolids table = prepare_solids(solids);
  for (std::uint32_t s = 1; s < count; ++s) {
    EXPECT_EQ(table.surfaces[s].cells.data(), table.surfaces[0].cells.data());
    EXPECT_EQ(table.records[s].first_cell, table.records[0].first_cell);
  }
  std::vector<glm::vec3> points;
  for (std::uint32_t s = 0; s < count; s += step) {
    const auto near = points_near(solids[s].mesh, 3'000, s);
    points.insert(points.end(), near.begin(), near.end());
  }
  const Touch touch = touch_on_both(points, solids);
  PreparedSolids still = prepare_solids(alone);
  Touch each;
  find_contacts(indexed(points), still, {}, {}, each);
  std::map<std::uint32_t, const Contact*> known;
  for (const Contact& contact : each.contacts)
    known.emplace(contact.point, &contact);
  std::size_t other = 0;
  for (const Contact& contact : touch.contacts) {
    const auto found = known.find(contact.point);
    if (found == known.end()) {
      ++other;  // within rounding of the shell's ends
      EXPECT_TRUE(contact.depth_m < band || std::abs(contact.depth_m - 1.5e-3) < band) << contact.depth_m;
      continue;
    }
    EXPECT_EQ(contact.solid, found->second->solid);
    EXPECT_NEAR(contact.depth_m, found->second->depth_m, band);
  }
  EXPECT_GT(touch.contacts.size(), 350 * count / step);
  EXPECT_LT(other, touch.contacts.size() / 100);
  // They move as any solid does.
  constexpr std::uint32_t moved = count / 4 + 1;
  PreparedSolids moving = table;
  Transform T = glm::rotate(glm::translate(Transform(1), Vec3(0.01, 0.02, 0.03)), 0.5, Vec3(0, 0, 1));
  set_pose(moving, moved, T);
  set_pose(still, moved, T);
  const shader::SolidRecord &a = moving.records[moved], &b = still.records[moved];
  const Box around = touchable_box(moving), expected = touchable_box(still);
  EXPECT_LT(glm::distance(around.low, expected.low) + glm::distance(around.high, expected.high), 0.2);
  EXPECT_NE(a.first_cell, b.first_cell);
}

TEST(RigidCopies, EachReachesAsFarAsItsOwnDelta) {
  constexpr std::uint32_t count = 64, step = palpa::test::instrumented() ? 16 : 8;
  std::vector<geometry::Solid> solids = copies_of(notched_cube(), count, true);
  std::vector<geometry::Solid> alone = copies_of(notched_cube(), count, false);
  for (std::uint32_t s = 0; s < count; ++s)
    solids[s].haptics.delta_m = alone[s].haptics.delta_m = s / step % 2 == 0 ? 1e-3 : 5e-3;
  std::vector<glm::vec3> points;
  for (std::uint32_t s = 0; s < count; s += step) {
    const auto near = points_near(solids[s].mesh, 3'000, s);
    points.insert(points.end(), near.begin(), near.end());
  }
  PreparedSolids one_each = prepare_solids(alone);
  Touch expected;
  find_contacts(indexed(points), one_each, {}, {}, expected);
  std::array<std::vector<int>, 2> found{std::vector<int>(count), std::vector<int>(count)};
  float deepest = 0;
  for (const Contact& contact : touch_on_both(points, solids).contacts) {
    ++found[0][contact.solid];
    deepest = std::max(deepest, contact.depth_m);
  }
  for (const Contact& contact : expected.contacts)
    ++found[1][contact.solid];
  EXPECT_GT(deepest, 2e-3f);
  for (std::uint32_t s = 0; s < count; s += step)
    EXPECT_NEAR(found[0][s], found[1][s], 0.01 * found[1][s] + 2) << "copy " << s;
}

TEST(MissingBarriers, AreSeenAfterTheKernelOfSurfaces) {
  const geometry::Mesh mesh = notched_cube();
  const palpa::test::NoBarrierAfter none("contacts_surface");
  const auto touch = [&] { touch_on(Backend::gpu, points_near(mesh, 300, 1), solid_of(mesh), {}, 1); };
  EXPECT_CONTAINS(palpa::test::error_of(touch, Exit::failed), "which contacts_surface wrote");
}

TEST(ManySurfaces, HaveFewerCellsEach) {
  std::vector<geometry::Solid> solids;
  const geometry::Mesh mesh = notched_cube();
  for (int i = 0; i < (palpa::test::instrumented() ? 60 : 300); ++i)
    solids.push_back(solid_of(tilted(mesh, Vec3(0.1 * i, 0, 0)))[0]);
  const PreparedSolids many = prepare_solids(solids);
  std::size_t cells = 0;
  for (const geometry::Surface& surface : many.surfaces)
    cells += surface.grid.x * surface.grid.y * surface.grid.z;
  EXPECT_LT(cells, 500'000u);
  solids.resize(1);
  EXPECT_GT(prepare_solids(solids).surfaces[0].cells.size(), 4096u);
}

}  // namespace
}  // namespace palpa::touch::test
