// What tinygltf alone would read wrongly without a word, or refuse although it is valid. palpa checks a file and
// rewrites it before tinygltf sees it.
#include <gtest/gtest.h>

#include <cstdint>

#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf_builder.hpp"
#include "geometry/packers.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

using test::box;
using test::bytes_of;
using test::fault_of_file;
using test::GltfBuilder;
using Json = GltfBuilder::Json;

const Mesh cube = box(Vec3(0), Vec3(1));

// Offsets, strides, sparse values, morph targets, bones, instances: every kind of number that moves a triangle.
GltfBuilder full_file() {
  GltfBuilder builder;
  std::vector<Vec3> late(4, Vec3(99));
  late.insert(late.end(), cube.positions.begin(), cube.positions.end());
  const int positions = builder.add_positions(late);
  builder.doc["accessors"][0]["count"] = 8;
  builder.doc["accessors"][0]["byteOffset"] = 48;
  builder.doc["accessors"][0]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", builder.add_view({9, 7})}, {"componentType", 5121}, {"byteOffset", 1}}},
      {"values", {{"bufferView", builder.add_view(bytes_of(std::vector<float>{9, 9, 2, 2, 2}))}, {"byteOffset", 8}}}};
  builder.add_mesh(positions, builder.add_indices(test::corners_of(cube)));
  const int by = builder.add_positions(std::vector<Vec3>(8, Vec3(0, 3, 0)));
  builder.add_accessor(std::vector<std::uint8_t>(32, 0), 5121, 8, "VEC4");
  builder.add_accessor(bytes_of(std::vector<float>(32, 0.25F)), 5126, 8, "VEC4");
  builder.add_accessor(bytes_of(std::vector<float>{0, 0, 0, 4, 5, 6}), 5126, 2, "VEC3");
  Json& mesh = builder.doc["meshes"][0];
  mesh["primitives"][0]["mode"] = 4;
  mesh["primitives"][0]["targets"] = {{{"POSITION", by}}};
  mesh["primitives"][0]["attributes"]["JOINTS_0"] = by + 1;
  mesh["primitives"][0]["attributes"]["WEIGHTS_0"] = by + 2;
  mesh["weights"] = {1};
  builder.doc["skins"] = Json::array({{{"joints", {1}}}});
  builder.add_node({{"mesh", 0}, {"skin", 0}});
  builder.add_node({{"translation", {7, 0, 0}}, {"children", {2}}});
  builder.add_node({{"mesh", 0},
                    {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1}},
                    {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", by + 3}}}}}}}},
                   false);
  builder.doc["scene"] = 0;
  return builder;
}

// The same document with 28.0 for each 28.
Json with_points(const Json& value) {
  if (value.is_number()) return value.get<double>();
  Json result = value;
  for (Json& item : result)
    if (item.is_structured() || item.is_number()) item = with_points(item);
  return result;
}

void expect_same(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    EXPECT_EQ(a.meshes[i].mesh.positions, b.meshes[i].mesh.positions) << i;
    EXPECT_EQ(a.meshes[i].mesh.triangles, b.meshes[i].mesh.triangles) << i;
  }
}

TEST(CheckedGltf, WholeNumbersMayBeWrittenWithAPoint) {
  const GltfBuilder plain = full_file();
  const Scene scene = load(plain);
  ASSERT_EQ(scene.meshes.size(), 3U);
  EXPECT_EQ(scene.meshes[0].mesh.positions.at(0), Vec3(7, 3, 0));
  EXPECT_EQ(scene.meshes[0].mesh.positions.at(7), Vec3(9, 5, 2));
  EXPECT_EQ(scene.meshes[2].mesh.positions.at(7), Vec3(20, 22, 19));
  for (const GltfBuilder& file :
       {plain, test::draco_file(test::draco_stream(cube, 10, false), 8, 12), test::meshopt_file(cube)}) {
    GltfBuilder points = file;
    points.doc = with_points(file.doc);
    ASSERT_NE(points.doc.dump(), file.doc.dump());
    expect_same(load(points), load(file));
  }
}

TEST(CheckedGltf, ZeroMayHaveAMinus) {
  const auto file = full_file().write_embedded(test::scratch_folder("gltf-checked") / "zero.gltf");
  std::string text = test::read_text(file);
  const auto zeros = {"\"mesh\":0", "\"skin\":0", "\"byteOffset\":0", "\"buffer\":0", "\"scene\":0"};
  for (const std::string zero : zeros) {
    ASSERT_NE(text.find(zero), std::string::npos) << zero;
    for (std::size_t at = text.find(zero); at != std::string::npos; at = text.find(zero, at + 1))
      text.insert(at + zero.size() - 1, "-");
  }
  test::write_text(file, text);
  expect_same(load_gltf(file), load(full_file()));
}

TEST(CheckedGltf, NumbersThatAreNoNumbersAreRefused) {
  expect_faults(full_file(), {{"/meshes/0/primitives/0/mode", "\"4\"", "\"mode\" is not a whole number"},
                              {"/meshes/0/primitives/0/indices", "\"1\"", "\"indices\" is not an index"},
                              {"/meshes/0/primitives/0/targets/0/POSITION", "\"2\"", "\"POSITION\" is not an index"},
                              {"/meshes/0/weights", "[\"1\"]", "\"weights\" holds something that is not a number"},
                              {"/accessors/0/byteOffset", "\"48\"", "\"byteOffset\" is not a whole number"},
                              {"/accessors/0/byteOffset", "48.5", "\"byteOffset\" is not a whole number"},
                              {"/accessors/0/normalized", "1", "\"normalized\" is neither true nor false"},
                              {"/accessors/0/sparse/values/byteOffset", "null", "\"byteOffset\" is not a whole number"},
                              {"/bufferViews/0/byteOffset", "-4", "\"byteOffset\" is not a whole number"},
                              {"/nodes/0/mesh", "\"0\"", "\"mesh\" is not an index"},
                              {"/nodes/0/mesh", "0.5", "\"mesh\" is not an index"},
                              {"/nodes/1/translation", "[\"7\", 0, 0]", "something that is not a number"},
                              {"/nodes/1/translation", "3", "\"translation\" is not an array"},
                              {"/skins/0/joints", "[\"1\"]", "\"joints\" is not an index"}});
}

// All are a valid number and a multiple of 2^32.
TEST(CheckedGltf, NumbersOfMoreThan32BitsAreNotCut) {
  expect_faults(full_file(),
                {{"/nodes/0/mesh", "4294967296", "names mesh 4294967296"},
                 {"/nodes/0/skin", "4294967296", "names skin 4294967296"},
                 {"/meshes/0/primitives/0/mode", "4294967300", "\"mode\" is 4294967300"},
                 {"/meshes/0/primitives/0/indices", "4294967297", "names accessor 4294967297"},
                 {"/accessors/0/bufferView", "4294967296", "names buffer view 4294967296"},
                 {"/accessors/0/byteOffset", "4294967344", "\"byteOffset\" is 4294967344"},
                 {"/accessors/0/count", "4294967304", "\"count\" is 4294967304"},
                 {"/accessors/0/componentType", "4294972422", "\"componentType\" is 4294972422"},
                 {"/accessors/0/sparse/count", "4294967297", "\"count\" is 4294967297"},
                 {"/accessors/0/sparse/values/byteOffset", "4294967304", "\"byteOffset\" is 4294967304"},
                 {"/bufferViews/0/buffer", "4294967296", "names buffer 4294967296"},
                 {"/bufferViews/0/byteLength", "18446744073709551744", "\"byteLength\" is not a whole number"},
                 {"/skins/0/joints", "[4294967297]", "names node 4294967297"},
                 {"/scene", "4294967296", "names scene 4294967296"}});
  const std::string extension = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  expect_faults(test::draco_file(test::draco_stream(cube, 10, false), 8, 12),
                {{extension + "/attributes/POSITION", "4294967303", "\"POSITION\" is 4294967303"},
                 {extension + "/bufferView", "4294967296", "names buffer view 4294967296"}});
}

TEST(CheckedGltf, WhatIsLeftOutShiftsNothing) {
  const GltfBuilder plain = full_file();
  GltfBuilder more = plain;
  Json& primitives = more.doc["meshes"][0]["primitives"];
  const Json triangles = primitives[0];
  const Json points{{"attributes", {{"POSITION", 0}}}, {"mode", 0}};
  const Json nowhere{{"attributes", Json::object()}, {"targets", {Json::object()}}};
  primitives = {triangles, points, nowhere, points};
  expect_same(load(more), load(plain));
  // The first one counts the morph targets.
  primitives = {points, triangles};
  primitives[0]["targets"] = triangles["targets"];
  expect_same(load(more), load(plain));
  primitives[0].erase("attributes");
  EXPECT_CONTAINS(fault_of(more), "mesh 0, primitive 0: \"attributes\" is missing");
}

TEST(CheckedGltf, WhatTheSceneDoesNotNeedMayBeMissing) {
  const GltfBuilder plain = full_file();
  GltfBuilder more = plain;
  more.doc["buffers"] = {{{"byteLength", more.bin.size()}},
                         {{"byteLength", 4}, {"uri", "absent.bin"}},
                         {{"byteLength", 4}, {"uri", "data:text/plain,abcd"}},
                         {{"byteLength", 4}},
                         Json::object()};
  for (const char* key : {"accessors", "bufferViews", "meshes", "skins", "nodes", "images", "textures", "materials"})
    more.doc[key].push_back(Json::object());
  expect_same(load(more), load(plain));
  EXPECT_CONTAINS(warnings_of(more, 3), "(the scene does not need it)");
  // Compressed data need neither a view of the accessors nor the buffer that stands in for it.
  GltfBuilder packed = test::meshopt_file(cube);
  packed.doc["buffers"][1].erase("uri");
  EXPECT_EQ(load(packed).meshes.at(0).mesh.positions, cube.positions);
}

TEST(CheckedGltf, DataUrisOfAnyTypeAreRead) {
  const auto file = test::scratch_folder("gltf-types") / "model.gltf";
  const std::string written = test::read_text(full_file().write_embedded(file));
  const std::string usual = "data:application/octet-stream;base64,";
  for (const char* type : {"data:;base64,", "data:text/plain;charset=utf-8;base64,",
                           "data:application/gltf-buffer;base64,", "data:application/x-of-my-own;base64,"}) {
    std::string text = written;
    text.replace(text.find(usual), usual.size(), type);
    test::write_text(file, text);
    expect_same(load_gltf(file), load(full_file()));
  }
}

TEST(CheckedGltf, ABinChunkEndsWithItsFile) {
  const auto file = test::scratch_folder("gltf-chunks") / "model.glb";
  const GltfBuilder builder(cube);
  for (const unsigned char more : {0, 4, 8}) {
    std::vector<unsigned char> bytes = builder.glb();
    const std::size_t chunk = bytes.size() - builder.bin.size() - 8;
    ASSERT_EQ(bytes[chunk + 4], 'B');
    bytes[chunk] = static_cast<unsigned char>(bytes[chunk] + more);
    test::write_bytes(file, bytes.data(), bytes.size());
    EXPECT_EQ(fault_of_file(file).find("chunk 1 is cut off") != std::string::npos, more > 0) << int{more};
  }
}

TEST(CheckedGltf, FilesAreOnlyLookedForBesideTheModel) {
  const auto folder = test::scratch_folder("gltf-beside");
  std::filesystem::create_directories(folder / "models");
  const auto file = GltfBuilder(cube).write_with_bin(folder / "models" / "model.gltf");
  const auto before = std::filesystem::current_path();
  EXPECT_EQ(fault_of_file(file), "");
  for (const auto& entry : std::filesystem::directory_iterator(folder / "models"))
    if (entry.path().extension() == ".bin") std::filesystem::rename(entry.path(), folder / entry.path().filename());
  std::filesystem::current_path(folder);
  EXPECT_CONTAINS(fault_of_file(file), "buffer 0");
  std::filesystem::current_path(before);
}

}  // namespace
}  // namespace palpa::geometry
