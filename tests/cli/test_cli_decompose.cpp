// `palpa decompose`, and touching its output.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <fstream>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/parts/vhacd.hpp"
#include "geometry/parts_solid.hpp"
#include "support/json.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

using geometry::SceneMesh;
using nlohmann::json;

/// All through a box of 40 mm, top at y = 0, and just outside of it.
std::vector<Vec3> cloud_around_a_box() {
  std::vector<Vec3> cloud;
  for (int i = 0; i < 3000; ++i) {
    const auto unit = [&](double factor) { return std::fmod(i * factor, 1.0); };
    cloud.emplace_back(-0.022 + 0.044 * unit(0.6180339887), -0.042 + 0.044 * unit(0.7548776662),
                       -0.022 + 0.044 * unit(0.5698402910));
  }
  return cloud;
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
    std::ofstream out(file("points.ply"));
    out << "ply\nformat ascii 1.0\nelement vertex " << all.size()
        << "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (const Vec3& p : all)
      out << p.x << ' ' << p.y << ' ' << p.z << '\n';
    return file("points.ply");
  }
  json touch(const std::vector<std::string>& arguments) const {
    std::vector<std::string> line{"touch", "--backend", "cpu", "--json", "-"};
    line.insert(line.end(), arguments.begin(), arguments.end());
    const Result result = palpa_here(line);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.exit_code == 0 ? json::parse(result.out) : json();
  }

  /// `out` is the one part of the box in `in`, and touching it is touching `in` with --surface parts.
  void expect_a_box_either_way(const json& report, const std::string& in, const std::string& out) const {
    EXPECT_EQ(report["solids"][0]["parts"], 1);
    EXPECT_NEAR(report["solids"][0]["volume_ratio"], 1, 1e-9);
    const std::string ply = points(cloud_around_a_box());
    const json from_file = touch({"--scene", out, "--points", ply});
    EXPECT_GT(from_file["contacts"]["count"], 100);
    EXPECT_EQ(from_file["contacts"], touch({"--scene", in, "--surface", "parts", "--points", ply})["contacts"]);
  }

  const std::filesystem::path folder_ = scratch_folder("decompose");
};

class Decompose : public DecomposeConvex {
 protected:
  void SetUp() override {
    if (!geometry::has_vhacd()) GTEST_SKIP() << "skipped: built without V-HACD";
  }
};

TEST_F(DecomposeConvex, ASurfaceSplitOverNodesIsOneSolid) {
  const geometry::Mesh whole = box({-0.02, -0.04, -0.02}, {0.02, 0, 0.02});
  std::vector<SceneMesh> sides(6);
  for (std::size_t side = 0; side < 6; ++side) {
    sides[side].name = "side " + std::to_string(side);
    sides[side].mesh = {whole.positions, {whole.triangles[2 * side], whole.triangles[2 * side + 1]}};
  }
  const std::string in = scene("sides.glb", sides), out = file("sides-parts.glb");
  const Result result = palpa({"decompose", "--scene", in, "--out", out, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json report = json::parse(result.out);
  ASSERT_EQ(report["solids"].size(), 1u);
  EXPECT_EQ(report["solids"][0]["name"], "side 0");
  expect_a_box_either_way(report, in, out);
}

TEST_F(DecomposeConvex, AMeshThatIsInsideOutIsTurned) {
  geometry::Mesh mesh = box({-0.02, -0.04, -0.02}, {0.02, 0, 0.02});
  geometry::flip(mesh);
  const std::string in = scene("turned.glb", {{"turned", mesh}}), out = file("turned-parts.glb");
  const Result result = palpa({"decompose", "--scene", in, "--out", out, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("mesh \"turned\" is inside out; its faces are turned"), std::string::npos) << result.err;
  const json report = json::parse(result.out);
  expect_a_box_either_way(report, in, out);
}

TEST_F(Decompose, ClosesTheHolesOfAnOpenMesh) {
  geometry::Mesh mesh = box({-0.02, -0.04, -0.02}, {0.02, 0, 0.02});
  mesh.triangles.pop_back();
  const Result result = palpa({"decompose", "--scene", scene("open.glb", {{"open", mesh}}), "--out", file("closed.glb"),
                               "--resolution", "30k", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("mesh \"open\" has 3 open edges; its holes are closed"), std::string::npos) << result.err;
  const json report = json::parse(result.out);
  EXPECT_NEAR(report["solids"][0]["volume_m3"], 6.4e-5, 0.1 * 6.4e-5);
}

TEST_F(DecomposeConvex, OfACubeIsTheCube) {
  const std::string out = file("cube-parts.glb");
  const Result result =
      palpa({"decompose", "--scene", source_file("assets/cube.glb"), "--parts", "8", "--out", out, "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  const json report = json::parse(result.out);
  ASSERT_EQ(report["solids"].size(), 1u);
  EXPECT_EQ(report["solids"][0]["name"], "cube");
  EXPECT_EQ(report["solids"][0]["parts"], 1);
  EXPECT_NEAR(report["solids"][0]["volume_ratio"], 1, 1e-9);
  EXPECT_LT(report["solids"][0]["surface_error_m"]["max"], 1e-9);
  const std::vector<std::string> press{"--points", source_file("assets/finger.ply"), "--penetration", "3mm"};
  const auto with = [&](std::vector<std::string> line) {
    line.insert(line.end(), press.begin(), press.end());
    return touch(line);
  };
  const json whole = with({"--scene", source_file("assets/cube.glb")});
  const json parts = with({"--scene", out});
  EXPECT_EQ(parts["contacts"]["indices"], whole["contacts"]["indices"]);
  EXPECT_EQ(parts["fingers"][0]["solid"], "cube");
  EXPECT_EQ(parts["fingers"].size(), whole["fingers"].size());
}

TEST_F(Decompose, MarksItsPartsSoThatTheyAreOneSolidAgain) {
  geometry::Haptics haptics;
  haptics.delta_m = 0.002;
  haptics.foci = 7;
  const std::string in = scene("two.glb", {{"ell", ell(), haptics},
                                           {"beside", box({0.1, -0.04, 0}, {0.14, 0, 0.04})},
                                           {"table", box({-1, -0.06, -1}, {1, -0.05, 1}), {.touchable = false}}});
  const std::string out = file("parts.glb");
  const Result result = palpa({"decompose", "--scene", in, "--parts", "6", "--resolution", "30k", "--out", out});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("ell: "), std::string::npos);
  EXPECT_NE(result.out.find("beside: 1 part"), std::string::npos);
  const geometry::Scene read = geometry::load_gltf(out);
  ASSERT_GT(read.meshes.size(), 2u);
  ASSERT_LE(read.meshes.size(), 7u);
  for (const SceneMesh& mesh : read.meshes)
    EXPECT_TRUE(mesh.part);
  const std::vector<geometry::Solid> solids = geometry::make_solids(read);
  ASSERT_EQ(solids.size(), 2u);
  EXPECT_EQ(solids[0].name, "ell");
  EXPECT_EQ(solids[0].haptics, haptics);
  EXPECT_EQ(solids[0].parts.parts.size() + 1, read.meshes.size());
  EXPECT_GT(solids[0].parts.seam_m, 1e-4);
  EXPECT_EQ(solids[1].name, "beside");

  // The same bytes again.
  ASSERT_EQ(
      palpa({"decompose", "--scene", in, "--parts", "6", "--resolution", "30k", "--out", file("again.glb")}).exit_code,
      0);
  const auto bytes = [](const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(bytes(out), bytes(file("again.glb")));
  expect_failure(palpa({"decompose", "--scene", out, "--out", file("x.glb")}), 4, "already a part of \"ell\"");
}

TEST_F(Decompose, CutsAreNoSurfaceUnlessKept) {
  // Three overlapping slabs side by side: points through the middle meet four cuts.
  std::vector<SceneMesh> slabs;
  for (int i = 0; i < 3; ++i) {
    const double x = 0.02 * i;
    slabs.push_back({"slab " + std::to_string(i),
                     box({x, -0.04, -0.02}, {x + 0.025, 0, 0.02}),
                     {},
                     geometry::PartOf{"slabs", 0, 0}});
  }
  const std::string in = scene("slabs.glb", slabs);
  std::vector<Vec3> line;
  for (int i = 0; i < 600; ++i)
    line.emplace_back(0.00005 + 0.0001 * i + 0.0025, -0.02, 0);
  const std::string ply = points(line);
  const json drop = touch({"--scene", in, "--points", ply});
  const json keep = touch({"--scene", in, "--points", ply, "--internal-faces", "keep"});
  // The row ends 2.5 mm inside the last slab.
  EXPECT_EQ(drop["contacts"]["count"], 0);
  // Eq. (1) of each part: 1.5 mm on the inner side of each of the four cuts.
  EXPECT_EQ(keep["contacts"]["count"], 60);
}

TEST_F(Decompose, OnTheFlyIsTheSameAsFromTheFile) {
  const std::string in = scene("ell.glb", {{"ell", ell()}});
  const std::string out = file("ell-parts.glb");
  ASSERT_EQ(palpa({"decompose", "--scene", in, "--parts", "4", "--out", out}).exit_code, 0);
  std::vector<Vec3> cloud;
  for (int i = 0; i < 4000; ++i) {
    const auto unit = [&](double factor) { return std::fmod(i * factor, 1.0); };
    cloud.emplace_back(-0.032 + 0.064 * unit(0.6180339887), -0.042 + 0.044 * unit(0.7548776662),
                       -0.022 + 0.044 * unit(0.5698402910));
  }
  const std::string ply = points(cloud);
  const json from_file = touch({"--scene", out, "--points", ply});
  const json made = touch({"--scene", in, "--surface", "parts", "--parts", "4", "--points", ply});
  EXPECT_EQ(made["contacts"], from_file["contacts"]);
  EXPECT_GT(made["contacts"]["count"], 100);
}

TEST_F(Decompose, RefusesWhatIsNoPart) {
  const geometry::PartOf part{"thing", 0, 0};
  const std::string ply = points({{0, -0.001, 0}});
  const auto fault = [&](const geometry::Mesh& mesh, const std::string& words) {
    expect_failure(palpa_here({"touch", "--scene", scene("bad.glb", {{"a part", mesh, {}, part}}), "--points", ply}), 4,
                   words);
  };
  fault(ell(), "\"a part\", a part of \"thing\", is concave");
  geometry::Mesh open = box({0, 0, 0}, {1, 1, 1});
  open.triangles.pop_back();
  fault(open, "is not closed");
  geometry::Mesh flat = box({0, 0, 0}, {1, 1, 0});
  fault(flat, "is ");
  geometry::Mesh pair = box({0, 0, 0}, {1, 1, 1});
  geometry::append(pair, box({2, 0, 0}, {3, 1, 1}));
  fault(pair, "several pieces");
  geometry::Mesh turned = box({0, 0, 0}, {1, 1, 1});
  geometry::flip(turned);
  fault(turned, "a part is convex");
}

TEST_F(Decompose, SaysWhatIsWrongWithTheLine) {
  const std::string cube = source_file("assets/cube.glb");
  const std::string out = file("out.glb");
  expect_failure(palpa_here({"decompose", "--out", out}), 2, "--scene is missing");
  expect_failure(palpa_here({"decompose", "--scene", cube}), 2, "--out is missing");
  expect_failure(palpa_here({"decompose", "--scene", cube, "--out", out, "--parts", "0"}), 2, "from 1 to 1024");
  expect_failure(palpa_here({"decompose", "--scene", cube, "--out", out, "--parts", "1025"}), 2, "from 1 to 1024");
  expect_failure(palpa_here({"decompose", "--scene", cube, "--out", out, "--resolution", "10"}), 2, "such as 400k");
  expect_failure(palpa_here({"decompose", "--scene", cube, "--out", out, "--resolution", "4.5k x"}), 2, "such as 400k");
  expect_failure(palpa_here({"decompose", "--scene", cube, "--out", out, "--error", "0"}), 2, "--error");
  expect_failure(palpa_here({"decompose", "--scene", file("none.glb"), "--out", out}), 4, "none.glb");
  expect_failure(palpa_here({"decompose", "--scene", cube, "--out", (folder_ / "no" / "where.glb").string()}), 1,
                 "cannot be written");
  expect_failure(palpa_here({"decompose", "--scene", cube, "--out", "/dev/full"}), 1, "cannot be written");
  const std::string scenery = scene("scenery.glb", {{"table", ell(), {.touchable = false}}});
  expect_failure(palpa_here({"decompose", "--scene", scenery, "--out", out}), 4, "touched");
  geometry::Mesh flat;
  flat.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  flat.triangles = {{0, 1, 2}};
  expect_failure(palpa_here({"decompose", "--scene", scene("flat.glb", {{"leaf", flat}}), "--out", out}), 4,
                 "mesh \"leaf\" is flat");
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_FALSE(std::filesystem::exists(out + ".unfinished"));
}

TEST_F(Decompose, LeavesNothingBehindWhenInterrupted) {
  PALPA_TERMINAL_OR_SKIP();
  // Long enough to be caught in the act: many bumps, many voxels.
  geometry::Mesh mesh;
  for (int i = 0; i < 40; ++i) {
    const double x = 0.02 * (i % 8), z = 0.02 * (i / 8);
    geometry::append(mesh, box({x, -0.04, z}, {x + 0.012, 0.003 * i, z + 0.012}));
  }
  const std::string in = scene("bumps.glb", {{"bumps", mesh}}), out = file("interrupted.glb");
  Terminal terminal({"decompose", "--scene", in, "--resolution", "4M", "--out", out});
  EXPECT_TRUE(terminal.shows("mesh \"bumps\": cutting it into convex parts")) << terminal.text();
  terminal.type("\x03");
  EXPECT_EQ(terminal.ended_by_signal(), SIGINT) << terminal.text();
  EXPECT_LT(terminal.processor_s_to_end(), slowest);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1) << "only the scene is there";
}

TEST_F(DecomposeConvex, WithoutVhacdAConcaveMeshIsRefusedWithHowToGetIt) {
  if (geometry::has_vhacd()) GTEST_SKIP() << "skipped: built with V-HACD";
  expect_failure(
      palpa({"decompose", "--scene", scene("ell.glb", {{"ell", ell()}}), "--out", file("out.glb")}), 1,
      "mesh \"ell\": this palpa was built without V-HACD, which makes the parts: install npm and build again");
  EXPECT_FALSE(std::filesystem::exists(file("out.glb")));
}

}  // namespace
}  // namespace palpa::test
