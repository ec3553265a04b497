#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

Mesh triangle(double x) {
  return {{{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0.125}}, {{0, 1, 2}}};
}

/// A strip of `vertices` vertices.
Mesh strip(std::uint32_t vertices) {
  Mesh mesh;
  for (std::uint32_t i = 0; i < vertices; ++i)
    mesh.positions.emplace_back(i / 2, i % 2, 0);
  for (std::uint32_t i = 0; i + 2 < vertices; ++i) {
    if (i % 2 == 0)
      mesh.triangles.emplace_back(i, i + 1, i + 2);
    else
      mesh.triangles.emplace_back(i + 1, i, i + 2);
  }
  return mesh;
}

std::uint32_t word(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

class WriteGlb : public ::testing::Test {
 protected:
  std::filesystem::path file_ = test::scratch_folder("gltf_write") / "out.glb";

  std::string fault_of(const std::vector<SceneMesh>& meshes) {
    return test::error_of([&] { write_glb(file_, meshes); }, Exit::failed);
  }
};

TEST_F(WriteGlb, GivesTheSameMeshesBackWithTheirNames) {
  const std::vector<SceneMesh> meshes{
      {"a \"quoted\" \\ name", triangle(0)}, {"tab\there", triangle(-5)}, {"Würfel", strip(9)}};
  write_glb(file_, meshes);
  const Scene scene = load_gltf(file_);
  ASSERT_EQ(scene.meshes.size(), meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    EXPECT_EQ(scene.meshes[i].name, meshes[i].name);
    EXPECT_EQ(scene.meshes[i].mesh.positions, meshes[i].mesh.positions);
    EXPECT_EQ(scene.meshes[i].mesh.triangles, meshes[i].mesh.triangles);
  }
}

TEST_F(WriteGlb, GivesHapticsBack) {
  Haptics all;
  all.intensity = 0.5;
  all.press_depth_m = 0.003;
  all.click = Click{0.04, 180};
  all.stiffness = std::vector<DepthForce>{{0, 0.125}, {0.01, 1}};
  all.texture = {1, 0.25, 0};
  all.grain_m = 0.004;
  Haptics usual_click, no_click;
  usual_click.press_depth_m = 0.003;
  usual_click.click.emplace();
  no_click.click = Click{.burst_s = 0};
  std::vector<SceneMesh> meshes{
      {"all", triangle(0), all}, {"usual", triangle(2), usual_click}, {"no", triangle(4), no_click}};
  // One value differs from the usual ones.
  for (const Click& click : {Click{.hz = 160}, Click{.burst_s = 0.05}})
    meshes.push_back({"a click", triangle(6), {.press_depth_m = 0.003, .click = click}});
  for (const Haptics& one : {Haptics{.delta_m = 0.002},
                             {.dwell_s = 2e-3},
                             {.pressure_pa = 900},
                             {.foci = 7},
                             {.foci = 9, .stride = 2},
                             {.stiffness = {{{0, 0.5}}}},
                             {.texture = {{0, 0.5, 0}}},
                             {.texture = {{1, 0, 0.5}}, .grain_m = 0.005}})
    meshes.push_back({"one", triangle(8), one});
  write_glb(file_, meshes);
  const Scene scene = load_gltf(file_);
  ASSERT_EQ(scene.meshes.size(), meshes.size());
  for (std::size_t i = 0; i < meshes.size(); ++i)
    EXPECT_EQ(scene.meshes[i].haptics, meshes[i].haptics) << i;
}

TEST_F(WriteGlb, UsesShortIndicesAsLongAsTheyReach) {
  for (const std::uint32_t vertices : {65535U, 65536U}) {
    const SceneMesh item{"strip", strip(vertices)};
    write_glb(file_, {&item, 1});
    const bool is_short = vertices == 65535;
    EXPECT_EQ(test::read_text(file_).find("\"componentType\":5123") != std::string::npos, is_short);
    EXPECT_EQ(test::read_text(file_).find("\"componentType\":5125") != std::string::npos, !is_short);
    const Scene scene = load_gltf(file_);
    EXPECT_EQ(scene.meshes.at(0).mesh.positions.size(), vertices);
    EXPECT_EQ(scene.meshes.at(0).mesh.triangles, item.mesh.triangles);
  }
}

TEST_F(WriteGlb, LaysChunksOutAsTheFormatSays) {
  // One triangle: 36 bytes of positions, 6 of indices padded to 8.
  const SceneMesh item{"t", triangle(-0.25)};
  write_glb(file_, {&item, 1});
  const std::string bytes = test::read_text(file_);
  ASSERT_GT(bytes.size(), 28U);
  EXPECT_EQ(bytes.substr(0, 4), "glTF");
  EXPECT_EQ(word(bytes, 4), 2U);
  EXPECT_EQ(word(bytes, 8), bytes.size());
  const std::uint32_t json = word(bytes, 12);
  EXPECT_EQ(json % 4, 0U);
  EXPECT_EQ(bytes.substr(16, 4), "JSON");
  EXPECT_EQ(word(bytes, 20 + json), 44U);
  EXPECT_EQ(bytes.substr(24 + json, 4), std::string("BIN\0", 4));
  EXPECT_EQ(bytes.size(), 28 + json + 44);
  EXPECT_CONTAINS(bytes, "\"generator\":\"palpa\"");
  EXPECT_CONTAINS(bytes, "\"min\":[-0.25,0,0],\"max\":[0.75,1,0.125]");
}

TEST_F(WriteGlb, WritesTheSameBytesEachTime) {
  const SceneMesh item{"strip", strip(100)};
  write_glb(file_, {&item, 1});
  const std::string first = test::read_text(file_);
  write_glb(file_, {&item, 1});
  EXPECT_EQ(test::read_text(file_), first);
}

TEST_F(WriteGlb, WritesNoNegativeZero) {
  const SceneMesh item{"t", {{{-0.0, -0.0, -0.0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}}};
  write_glb(file_, {&item, 1});
  const std::string bytes = test::read_text(file_);
  const std::size_t binary = 28 + word(bytes, 12);
  EXPECT_EQ(bytes.substr(binary, 12), std::string(12, '\0'));
}

TEST_F(WriteGlb, RefusesWhatAFileCannotHold) {
  EXPECT_CONTAINS(fault_of({{"empty", {}}}), "\"empty\" has no triangles");
  Mesh broken = triangle(0);
  broken.triangles[0].z = 3;
  EXPECT_CONTAINS(fault_of({{"broken", broken}}), "index out of range");
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e39}) {
    Mesh huge = triangle(0);
    huge.positions[1].y = bad;
    EXPECT_CONTAINS(fault_of({{"huge", huge}}), "coordinate");
  }
}

TEST_F(WriteGlb, NamesAreValidJsonWhateverTheyHold) {
  write_glb(file_, std::vector<SceneMesh>{{"a\xff\x7f\"b\n", triangle(0)}});
  const Scene scene = load_gltf(file_);
  ASSERT_EQ(scene.meshes.size(), 1U);
  EXPECT_EQ(scene.meshes[0].name, "a\xef\xbf\xbd\x7f\"b\n");
}

TEST_F(WriteGlb, SaysWhenTheFileCannotBeWritten) {
  for (const char* place : {"/dev/full", "/nowhere/at/all.glb"}) {
    file_ = place;
    EXPECT_TRUE(fault_of({{"t", triangle(0)}}).starts_with(std::string(place) + ": cannot be written: ")) << place;
  }
}

}  // namespace
}  // namespace palpa::geometry
