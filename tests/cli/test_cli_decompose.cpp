// `palpa decompose`, and touching its output.
#include <gtest/gtest.h>

#include <filesystem>
#include <glm/common.hpp>
#include <string>
#include <utility>
#include <vector>

#include "base/version.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/report.hpp"
#include "cli/support/told.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/parts_solid.hpp"
#include "support/json.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using geometry::SceneMesh;
using nlohmann::json;

/// All through the space between two corners.
std::vector<Vec3> cloud(const Vec3& low, const Vec3& high, int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const Vec3 steps = static_cast<double>(i) * Vec3(0.6180339887, 0.7548776662, 0.5698402910);
    points.push_back(low + (high - low) * glm::fract(steps));
  }
  return points;
}

/// Needs no V-HACD.
class DecomposeConvex : public testing::Test {
 protected:
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string scene(const std::string& name, const std::vector<SceneMesh>& meshes) const {
    geometry::write_glb(file(name), meshes);
    return file(name);
  }
  std::string points(const std::vector<Vec3>& all) const {
    geometry::write_ply(file("points.ply"), all);
    return file("points.ply");
  }
  static json contacts(const std::vector<std::string>& arguments) {
    return report_of(with({"touch", "--backend", "cpu"}, arguments))["contacts"];
  }

  const std::filesystem::path folder_ = scratch_folder("decompose");
  const std::string cube_ = source_file("assets/cube.glb").string(), out_ = file("out.glb");
};

class Decompose : public DecomposeConvex {
 protected:
  void SetUp() override {
    if (!built_with("V-HACD")) GTEST_SKIP() << "skipped: built without V-HACD";
  }
};

// One whose surface is split over nodes, and one that is inside out.
TEST_F(DecomposeConvex, ConvexSolidsAreTheirOnlyPartsAndTouchedAsBefore) {
  const Vec3 low(-0.02, -0.04, -0.02), high(0.02, 0, 0.02), aside(0.05, 0, 0);
  const geometry::Mesh whole = box(low, high);
  std::vector<SceneMesh> meshes(6);
  for (std::size_t side = 0; side < 6; ++side) {
    meshes[side].name = "side " + std::to_string(side);
    meshes[side].mesh = {whole.positions, {whole.triangles[2 * side], whole.triangles[2 * side + 1]}};
  }
  meshes.push_back({"turned", box(low + aside, high + aside)});
  geometry::flip(meshes.back().mesh);
  const std::string in = scene("boxes.glb", meshes);
  const Result result = succeeded(palpa_here({"decompose", "--scene", in, "--out", out_, "--json", "-"}));
  EXPECT_EQ(result.err_lines().size(), 1u) << result.err;
  EXPECT_CONTAINS(result.err, "mesh \"turned\" is inside out; its faces are turned");
  const json solids = json::parse(result.out)["solids"];
  ASSERT_EQ(solids.size(), 2u);
  EXPECT_EQ(solids[0]["name"], "side 0");
  for (const json& solid : solids) {
    EXPECT_EQ(solid["parts"], 1);
    EXPECT_NEAR(solid["volume_ratio"], 1, 1e-9);
    EXPECT_LT(solid["surface_error_m"]["max"], 1e-8);
  }
  const std::string ply = points(cloud(low - 0.002, high + aside + 0.002, 6000));
  const json from_file = contacts({"--scene", out_, "--points", ply});
  EXPECT_GT(from_file["count"], 200);
  EXPECT_EQ(from_file, contacts({"--scene", in, "--surface", "parts", "--points", ply}));
  EXPECT_EQ(from_file["indices"], contacts({"--scene", in, "--points", ply})["indices"]);
}

TEST_F(Decompose, ClosesTheHolesOfAnOpenMesh) {
  geometry::Mesh mesh = box({-0.02, -0.04, -0.02}, {0.02, 0, 0.02});
  mesh.triangles.pop_back();
  expect_warned({"decompose", "--scene", scene("open.glb", {{"open", mesh}}), "--out", out_, "--resolution", "30k"},
                {{{}, "mesh \"open\" has 3 open edges; its holes are closed"}});
}

TEST_F(Decompose, ItsPartsAreOneSolidAgainAndThoseThatTouchMakes) {
  geometry::Haptics haptics;
  haptics.delta_m = 0.002;
  haptics.foci = 7;
  const std::string in = scene("two.glb", {{"ell", ell(), haptics},
                                           {"beside", box({0.1, -0.04, 0}, {0.14, 0, 0.04})},
                                           {"table", box({-1, -0.06, -1}, {1, -0.05, 1}), {.touchable = false}}});
  const Result result = succeeded(palpa_here({"decompose", "--scene", in, "--parts", "4", "--out", out_}));
  EXPECT_CONTAINS(result.out, "ell: ");
  EXPECT_CONTAINS(result.out, "beside: 1 part");
  const geometry::Scene read = geometry::load_gltf(out_);
  ASSERT_GT(read.meshes.size(), 2u);
  ASSERT_LE(read.meshes.size(), 5u);
  for (const SceneMesh& mesh : read.meshes)
    EXPECT_TRUE(mesh.part);
  const std::vector<geometry::Solid> solids = geometry::make_solids(read);
  ASSERT_EQ(solids.size(), 2u);
  EXPECT_EQ(solids[0].name, "ell");
  EXPECT_EQ(solids[0].haptics, haptics);
  EXPECT_EQ(solids[0].parts.parts.size() + 1, read.meshes.size());
  EXPECT_GT(solids[0].parts.seam_m, 1e-4);
  EXPECT_EQ(solids[1].name, "beside");
  const std::string ply = points(cloud({-0.032, -0.042, -0.022}, {0.032, 0.002, 0.022}, 4000));
  const json from_file = contacts({"--scene", out_, "--points", ply});
  EXPECT_GT(from_file["count"], 100);
  EXPECT_EQ(from_file, contacts({"--scene", in, "--surface", "parts", "--parts", "4", "--points", ply}));
  expect_refused({"decompose", "--scene", out_, "--out", file("x.glb")}, {{{}, "already a part of \"ell\"", 4}});
}

TEST_F(DecomposeConvex, CutsAreNoSurfaceUnlessKept) {
  // Three overlapping slabs side by side: points through the middle meet four cuts.
  std::vector<SceneMesh> slabs;
  for (int i = 0; i < 3; ++i) {
    const double x = 0.02 * i;
    slabs.push_back({"slab " + std::to_string(i),
                     box({x, -0.04, -0.02}, {x + 0.025, 0, 0.02}),
                     {},
                     geometry::PartOf{"slabs", 0, 0}});
  }
  std::vector<Vec3> row;  // it ends 2.5 mm inside the last slab
  for (int i = 0; i < 600; ++i)
    row.emplace_back(0.00005 + 0.0001 * i + 0.0025, -0.02, 0);
  const std::vector<std::string> line{"--scene", scene("slabs.glb", slabs), "--points", points(row)};
  EXPECT_EQ(contacts(line)["count"], 0);
  // Eq. (1) of each part: 1.5 mm on the inner side of each of the four cuts.
  EXPECT_EQ(contacts(with(line, {"--internal-faces", "keep"}))["count"], 60);
}

TEST_F(DecomposeConvex, WhatIsNoPartIsRefused) {
  const auto box_with = [](const auto& change) {
    geometry::Mesh mesh = box({0, 0, 0}, {1, 1, 1});
    change(mesh);
    return mesh;
  };
  const std::vector<std::pair<geometry::Mesh, std::string>> faults{
      {ell(), "\"a part\", a part of \"thing\", is concave"},
      {box_with([](geometry::Mesh& open) { open.triangles.pop_back(); }), "is not closed"},
      {box({0, 0, 0}, {1, 1, 0}), "is "},
      {box_with([](geometry::Mesh& pair) {
         geometry::append(pair, box({2, 0, 0}, {3, 1, 1}));
       }),
       "several pieces"},
      {box_with([](geometry::Mesh& turned) { geometry::flip(turned); }), "a part is convex"}};
  for (const auto& [mesh, told] : faults) {
    const std::string bad = scene("bad.glb", {{"a part", mesh, {}, geometry::PartOf{"thing", 0, 0}}});
    expect_refused({"touch", "--scene", bad, "--points", points({{0, -0.001, 0}})}, {{{}, told, 4}});
  }
}

TEST_F(Decompose, SaysWhatIsWrongWithTheLine) {
  geometry::Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  expect_refused({"decompose", "--out", out_},
                 {{{}, "--scene is missing"},
                  {{"--scene", cube_, "--resolution", "10"}, "such as 400k"},
                  {{"--scene", cube_, "--resolution", "4.5k x"}, "such as 400k"},
                  {{"--scene", file("none.glb")}, "none.glb", 4},
                  {{"--scene", scene("scenery.glb", {{"table", ell(), {.touchable = false}}})}, "touched", 4},
                  {{"--scene", scene("flat.glb", {{"leaf", flat}})}, "mesh \"leaf\" is flat", 4}});
  EXPECT_FALSE(std::filesystem::exists(out_));
  EXPECT_FALSE(std::filesystem::exists(out_ + ".unfinished"));
  expect_refused({"decompose", "--scene", cube_}, {{{}, "--out is missing"},
                                                   {{"--out", file("no/where.glb")}, "cannot be written", 1},
                                                   {{"--out", "/dev/full"}, "cannot be written", 1}});
}

TEST_F(DecomposeConvex, WithoutVhacdAConcaveMeshIsRefusedWithHowToGetIt) {
  if (built_with("V-HACD")) GTEST_SKIP() << "skipped: built with V-HACD";
  expect_refused({"decompose", "--scene", scene("ell.glb", {{"ell", ell()}}), "--out", out_},
                 {{{},
                   "mesh \"ell\": this palpa was built without V-HACD, which makes the parts: install npm and build "
                   "again",
                   1}});
  EXPECT_FALSE(std::filesystem::exists(out_));
}

}  // namespace
}  // namespace palpa::test
